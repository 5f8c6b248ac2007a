//! The exponent of a cost, from repeated measurements at several sizes.
//!
//! ```text
//! ln t_ir = ln c + b ln n_i + d_i + e_ir         y_i = median over r of ln t_ir
//! s² = Σ_ir (ln t_ir − mean_i)² / Σ_i (R_i − 1)     Var(y_i) ≤ (π/2) s²/R_i
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n_i, t_ir | size, and the r-th of R_i measurements of the cost at this size | [`Sized`] |
//! | b, c | exponent, and cost of size 1 | [`PowerLaw`] |
//! | e_ir | noise of a measurement: its standard deviation relative to t is the same at every size | |
//! | s | that standard deviation, estimated from all sizes together | [`PowerLaw::spread`] |
//! | d_i | how far the cost is from a power law at this size | |
//! | χ² | misfit of the line through the y_i, with their variances from s | [`PowerLaw::misfit`] |
//!
//! The median is taken because another program on the machine makes single measurements too long, never too short. For normal
//! noise its variance is at most π/2 times that of the mean, for any R.
//!
//! A cost need not be a power law: caches fill up, and constant parts fade. If the points scatter about the line more than the
//! noise explains (χ² > m − 2 for m sizes), the standard error of b is widened by √(χ²/(m − 2)), and it has m − 2 degrees of
//! freedom (Birge, *Physical Review* 40, 1932). The 95 % interval then covers b for d_i that behave like noise. d_i that bend the
//! curve make b the mean exponent over these sizes; [`PowerLaw::last`] is the exponent between the last two.

use super::line;
use nalgebra::DMatrix;

/// Var(median)/Var(mean) of normal values: π/2 for many, less for few.
const OF_MEDIAN: f64 = std::f64::consts::FRAC_PI_2;

/// Repeated measurements of a cost at one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Sized {
    /// n, the size.
    pub size: f64,
    /// The measured costs, in any unit.
    pub costs: Vec<f64>,
}

/// A fitted exponent. The cost is about c nᵇ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// b, the exponent.
    pub exponent: f64,
    /// Its standard error, with noise and misfit. NaN if neither is known (two sizes, measured once).
    pub std_error: f64,
    /// Degrees of freedom of the standard error.
    pub dof: u64,
    /// ln c.
    pub intercept: f64,
    /// √(χ²/(m − 2)): about 1 if there is only noise; NaN with two sizes, or without repeats.
    pub misfit: f64,
    /// s, the standard deviation of a measurement as a fraction of it; NaN without repeats.
    pub spread: f64,
    /// The exponent between the last two sizes, and its standard error from the noise.
    pub last: [f64; 2],
}

impl Sized {
    /// The median cost; NaN if there is none.
    pub fn median(&self) -> f64 {
        let mut sorted = self.costs.clone();
        sorted.sort_by(f64::total_cmp);
        match sorted.len() {
            0 => f64::NAN,
            n if n % 2 == 1 => sorted[n / 2],
            // the geometric mean, so that its logarithm is the median of the logarithms
            n => (sorted[n / 2 - 1] * sorted[n / 2]).sqrt(),
        }
    }

    /// Σ_r (ln t_r − mean)², and its degrees of freedom.
    fn scatter(&self) -> (f64, u64) {
        let n = self.costs.len() as f64;
        let mean = self.costs.iter().map(|t| t.ln()).sum::<f64>() / n;
        (self.costs.iter().map(|t| (t.ln() - mean).powi(2)).sum(), self.costs.len() as u64 - 1)
    }
}

/// s of all sizes together, and its degrees of freedom; NaN without repeats.
pub fn spread(points: &[Sized]) -> (f64, u64) {
    let (sum, dof) = points.iter().map(Sized::scatter).fold((0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    ((sum / dof as f64).sqrt(), dof)
}

/// Standard error of the median cost of a size as a fraction of the cost, for the spread s.
pub fn error_of_median(point: &Sized, spread: f64) -> f64 {
    spread
        * if point.costs.len() > 2 { OF_MEDIAN / point.costs.len() as f64 } else { 1.0 / point.costs.len() as f64 }
            .sqrt()
}

/// Fits the exponent. None with fewer than two different sizes, or if a size or a cost is not positive and finite, or if a size
/// has no cost.
///
/// ```
/// use fredholm::stats::power_law::{Sized, power_law};
/// let points: Vec<Sized> = [1.0, 10.0, 100.0].map(|n: f64| Sized { size: n, costs: vec![3.0 * n.powf(1.5)] }).into();
/// let fit = power_law(&points).unwrap();
/// assert!((fit.exponent - 1.5).abs() < 1e-12 && fit.std_error < 1e-12 && (fit.intercept.exp() - 3.0).abs() < 1e-12);
/// ```
pub fn power_law(points: &[Sized]) -> Option<PowerLaw> {
    let positive = |x: &f64| x.is_finite() && *x > 0.0;
    if points.iter().any(|p| p.costs.is_empty() || !positive(&p.size) || !p.costs.iter().all(positive)) {
        return None;
    }
    let x: Vec<f64> = points.iter().map(|p| p.size.ln()).collect();
    let y: Vec<f64> = points.iter().map(|p| p.median().ln()).collect();
    let (spread, noise_dof) = spread(points);
    let noisy = spread > 0.0;
    let variance: Vec<f64> =
        points.iter().map(|p| error_of_median(p, if noisy { spread } else { 1.0 }).powi(2)).collect();
    let line = line::fit(&x, &y, DMatrix::from_diagonal(&variance.clone().into()))?;
    let scatter_dof = points.len() as u64 - 2;
    let ratio = if scatter_dof > 0 { (line.chi_squared / scatter_dof as f64).sqrt() } else { f64::NAN };
    let (widened, dof) = match (noisy, scatter_dof) {
        (true, 0) => (1.0, noise_dof),
        (true, _) if ratio <= 1.0 => (1.0, noise_dof),
        // without repeats only the scatter about the line is known
        _ => (ratio, scatter_dof),
    };
    let mut ends: Vec<usize> = (0..points.len()).collect();
    ends.sort_by(|&a, &b| x[b].total_cmp(&x[a]));
    let (a, b) = (ends[1], ends[0]);
    let step = x[b] - x[a];
    let noise = if noisy || noise_dof > 0 { (variance[a] + variance[b]).sqrt() / step } else { f64::NAN };
    Some(PowerLaw {
        exponent: line.slope,
        std_error: line.std_error * widened,
        dof,
        intercept: line.intercept,
        misfit: if noisy { ratio } else { f64::NAN },
        spread,
        last: [(y[b] - y[a]) / step, if noisy { noise } else { 0.0 * noise }],
    })
}
