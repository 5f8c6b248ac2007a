//! The slope of the variance against the number of samples, on logarithmic axes.
//!
//! ```text
//! ln V(n) = ln c + b ln n      b = −1: independent samples;  b < −1: stratified or low-discrepancy points
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V(n) | variance of the mean of n samples, estimated from R replicates | `points` |
//! | ν | degrees of freedom of each V(n) | `dof` |
//! | b | the slope | [`Slope::slope`] |
//! | b_(i) | the slope without replicate i | [`falling_slope`] |
//!
//! A variance from ν degrees of freedom follows V χ²_ν/ν. So ln V(n) has the variance ψ′(ν/2) ≈ 2/ν + 2/ν² for any V, and
//! all points have equal weight. The points share their replicates: V(n) is read off the running means at n = 1, 2, 4, ….
//! For n ≤ m the means of independent samples have the correlation √(n/m), and their sample variances the square of that. So
//! the fit uses Cov(ln V(n), ln V(m)) = (2/ν + 2/ν²) · n/m. **Approximation:** to this order the matrix is exact for
//! independent samples. Stratified and low-discrepancy points lose their correlation faster, so for them it is too large.

//!
//! This error holds for one functional of independent normal samples. A variance averaged over pixels has more degrees of
//! freedom, but their number is unknown; samples with heavy tails have fewer. [`falling_slope`] therefore uses the same fit,
//! but takes the error from fits that each leave out one replicate. They assume neither:
//!
//! `s_b² = (R−1)/R · Σ_i (b_(i) − b̄_(·))²`, with R − 1 degrees of freedom.
//!
//! The logarithm of a noisy variance is skewed, and on average too small by half its relative variance. Because of that,
//! plain 95 % intervals from few pixels miss the true slope in 12 to 17 % of all cases. `s_b` is therefore widened by
//! √(1 + 8 r), where r is the largest relative variance of a point. The caller, who has counted the events, leaves out
//! points whose variance rests on few events ([`evidence`](super::evidence)). Measured coverage: DESIGN.md.

use super::line;
use crate::terms::scatter::jackknife;
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Effect of skewness: the squared error of a slope grows by this factor times the relative variance of its noisiest point.
const SKEW: f64 = 8.0;

/// A slope in log-log scale with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// b, the slope.
    pub slope: f64,
    /// Standard error of b.
    pub std_error: f64,
    /// ln c, the fitted logarithm of V(1).
    pub intercept: f64,
    /// Misfit; about `points − 2` if the curve is a power law.
    pub chi_squared: f64,
    /// Probability of a misfit at least this large if the curve is a power law. NaN with two points.
    pub p: f64,
}

/// Fits b to `points` = (n, V(n)). `dof` is R − 1 for the variance of one functional; for a variance averaged over
/// pixels it lies between R − 1 and pixels × (R − 1), and R − 1 is the cautious choice.
///
/// None with fewer than two different n, or if a variance is not positive and finite (an estimator with zero variance has no
/// slope).
pub fn variance_slope(points: &[(f64, f64)], dof: f64) -> Option<Slope> {
    if points.iter().any(|&(n, v)| !(n > 0.0 && v > 0.0 && n.is_finite() && v.is_finite())) {
        return None;
    }
    let x: Vec<f64> = points.iter().map(|p| p.0.ln()).collect();
    let y: Vec<f64> = points.iter().map(|p| p.1.ln()).collect();
    let relative = 2.0 / dof + 2.0 / (dof * dof);
    let covariance = DMatrix::from_fn(x.len(), x.len(), |i, j| relative * (-(x[i] - x[j]).abs()).exp());
    let line = line::fit(&x, &y, covariance)?;
    let p = ChiSquared::new(x.len() as f64 - 2.0).map_or(f64::NAN, |d| d.sf(line.chi_squared));
    Some(Slope {
        slope: line.slope,
        std_error: line.std_error,
        intercept: line.intercept,
        chi_squared: line.chi_squared,
        p,
    })
}

/// Fits b to the curve of `points` = (n, θ(n)). Its error comes from the curves that leave out one replicate each:
/// `without[j][i]` is θ at the j-th n without replicate i. θ may be a variance or a squared error.
///
/// `chi_squared` and `p` are those of [`variance_slope`], with degrees of freedom estimated from the scatter of the points.
/// They only show how well a straight line describes the curve.
///
/// None where [`variance_slope`] gives none, or with fewer than three replicates.
pub fn falling_slope(points: &[(f64, f64)], without: &[Vec<f64>]) -> Option<Slope> {
    let replicates = without.first().map_or(0, Vec::len);
    if replicates < 3 || points.len() != without.len() {
        return None;
    }
    let relative = |(w, p): (&Vec<f64>, &(f64, f64))| (jackknife(w.iter().copied()) / p.1).powi(2);
    let scatter = without.iter().zip(points).map(relative).sum::<f64>() / points.len() as f64;
    let all = variance_slope(points, 2.0 / scatter)?;
    let leave = |i: usize| {
        let curve: Vec<_> = points.iter().zip(without).map(|(p, w)| (p.0, w[i])).collect();
        variance_slope(&curve, 2.0 / scatter).map(|s| s.slope)
    };
    let slopes = (0..replicates).map(leave).collect::<Option<Vec<f64>>>()?;
    let largest = without.iter().zip(points).map(relative).fold(0.0, f64::max);
    Some(Slope { std_error: jackknife(slopes.into_iter()) * (1.0 + SKEW * largest).sqrt(), ..all })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn an_exact_power_law_is_found() {
        for b in [-1.0, -1.5, -3.0] {
            let points: Vec<_> = (0..6).map(|i| f64::from(1 << i)).map(|n| (n, 7.0 * n.powf(b))).collect();
            let s = variance_slope(&points, 15.0).unwrap();
            assert!((s.slope - b).abs() < 1e-12 && (s.intercept - 7f64.ln()).abs() < 1e-12);
            assert!(s.chi_squared < 1e-20 && s.p > 0.999);
        }
    }

    #[test]
    fn two_points_by_hand() {
        // Var(y₂ − y₁) = 2 r (1 − n/m), r = 2/ν + 2/ν²
        let s = variance_slope(&[(1.0, 8.0), (4.0, 2.0)], 10.0).unwrap();
        let r: f64 = 0.22;
        assert!((s.slope + 1.0).abs() < 1e-12);
        assert!((s.std_error - (2.0 * r * 0.75).sqrt() / 4f64.ln()).abs() < 1e-12);
        assert!(s.p.is_nan());
    }

    #[test]
    fn no_slope_without_variance() {
        assert!(variance_slope(&[(1.0, 0.0), (2.0, 0.0)], 15.0).is_none());
        assert!(variance_slope(&[(1.0, f64::NAN), (2.0, 1.0)], 15.0).is_none());
        assert!(variance_slope(&[(1.0, 1.0)], 15.0).is_none());
    }
}
