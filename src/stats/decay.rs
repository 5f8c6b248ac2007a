//! The observed rate of decay of the terms.
//!
//! ```text
//! ln m_k ≈ a + k ln γ      over a window of the tail      Cov(ln m_j, ln m_k) ≈ C_jk / (m_j m_k)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | m_k | measured value of ‖T^k E‖ or ⟨W, T^k E⟩ | [`TermMeans::mean`] |
//! | C | covariance of the m_k; terms from prefixes of the same paths are correlated | [`TermMeans::covariance`] |
//! | R, ν | number of replicates behind C; degrees of freedom ν = R − 1 | [`TermMeans::replicates`] |
//! | γ | the observed rate | [`Rate::rate`] |
//!
//! γ is an *observed* rate: it is neither a bound nor a norm. ‖T^k E‖ = γ ‖T^{k−1}E‖ holds in a furnace. Elsewhere the ratio
//! of successive terms drifts to the spectral radius as k grows, if it converges at all. `chi_squared` shows whether one
//! rate fits the window.
//!
//! The logarithm is linearised (delta method). The rule of 5 standard errors in [`tail_window`] keeps the error of that
//! below 2 %. C itself is estimated from R replicates. With p points in the window, the plain error of generalised least
//! squares is therefore too small by (ν − p + 2)/ν · (ν − p + 1)/(ν − 1) in variance, and the misfit follows Hotelling's
//! distribution instead of χ². Both are corrected here. Rao, *Biometrika* 46 (1959); Grizzle and Allen, *Biometrics* 25
//! (1969).

use super::{Evidence, Moments, line};
use crate::terms::{Estimate, functional::Replicates};
use glam::DVec3;
use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::ops::Range;

/// Means of the terms k = 0..=K in one channel, measured together.
#[derive(Clone, Debug, PartialEq)]
pub struct TermMeans {
    /// m_k, for each k.
    pub mean: Vec<f64>,
    /// C, of the means (not of one replicate).
    pub covariance: DMatrix<f64>,
    /// R, the number of replicates; 0 if the terms are exact.
    pub replicates: u64,
    /// Evidence behind each mean; empty if events were not counted.
    pub evidence: Vec<Evidence>,
}

impl TermMeans {
    /// Terms known without error, from the matrix.
    pub fn exact(mean: &[f64]) -> Self {
        Self {
            mean: mean.to_vec(),
            covariance: DMatrix::zeros(mean.len(), mean.len()),
            replicates: 0,
            evidence: vec![],
        }
    }

    /// Terms whose estimators share no paths (estimator `single`): C is diagonal.
    pub fn independent(terms: &[Estimate], channel: usize) -> Self {
        let variance: Vec<f64> = terms.iter().map(|t| t.std_error[channel].powi(2)).collect();
        Self {
            mean: terms.iter().map(|t| t.mean[channel]).collect(),
            covariance: DMatrix::from_diagonal(&variance.into()),
            replicates: terms.iter().map(|t| t.replicates).min().unwrap_or(0),
            evidence: terms.iter().map(Evidence::of).collect(),
        }
    }
}

impl From<&Replicates> for TermMeans {
    /// Takes the mean over channels of every term, without the tail.
    fn from(r: &Replicates) -> Self {
        Self::weighed(r, DVec3::splat(1.0 / 3.0))
    }
}

impl TermMeans {
    /// One channel of every term, without the tail.
    pub fn channel(r: &Replicates, channel: usize) -> Self {
        Self::weighed(r, DVec3::AXES[channel])
    }

    /// A weighted sum of the channels.
    fn weighed(r: &Replicates, weights: DVec3) -> Self {
        let terms = r.mean.len().saturating_sub(1);
        let of = |v: DVec3| v.dot(weights);
        let n = r.deviation.len() as f64;
        let covariance =
            |a: usize, b: usize| r.deviation.iter().map(|d| of(d[a]) * of(d[b])).sum::<f64>() * n / (n - 1.0);
        Self {
            mean: r.mean[..terms].iter().map(|&m| of(m)).collect(),
            covariance: DMatrix::from_fn(terms, terms, covariance),
            replicates: r.deviation.len() as u64,
            evidence: (0..terms).map(|k| Evidence::of(&r.estimate(k..k + 1))).collect(),
        }
    }
}

impl From<&Moments> for TermMeans {
    /// Takes terms that were measured together in every replicate.
    fn from(moments: &Moments) -> Self {
        Self {
            mean: moments.mean().iter().copied().collect(),
            covariance: moments.covariance_of_mean(),
            replicates: moments.count(),
            evidence: vec![],
        }
    }
}

/// An observed rate of decay.
#[derive(Clone, Debug, PartialEq)]
pub struct Rate {
    /// γ, the observed rate.
    pub rate: f64,
    /// Its standard error; 0 if the terms are exact.
    pub std_error: f64,
    /// e^a: the fit is `amplitude · rate^k`.
    pub amplitude: f64,
    /// The values of k in the fit.
    pub window: Range<usize>,
    /// Misfit of the fit; about `window.len() − 2` if one rate fits. NaN if
    /// the terms have no noise: then any misfit means that the decay is not exactly geometric.
    pub chi_squared: f64,
    /// Probability of a misfit at least this large if one rate fits. NaN with two points or exact terms.
    pub p: f64,
}

/// Reason why there is no rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRate {
    /// Fewer than two terms rise above their noise.
    #[error("only {0} of the terms k ≥ 1 exceed 5 standard errors; a rate needs two: raise the samples per pixel")]
    TooFewTerms(usize),
    /// R is too small for the covariance of the window, or an error in it is unknown or zero.
    #[error(
        "the covariance of the terms in the window is not known well enough: a rate needs more replicates than terms"
    )]
    Covariance,
}

impl TermMeans {
    /// Returns true if term k has a known standard error.
    pub fn has_error(&self, k: usize) -> bool {
        self.evidence.get(k).is_none_or(|e| e.no_error.is_none())
    }
}

/// The window of the fit. Terms k = 1, 2, … count as long as each is above 5 standard errors and its error is known; k = 0
/// is emission and never counts. The window is the later half of this run, and has at least three terms if the run has them.
pub fn tail_window(terms: &TermMeans) -> Range<usize> {
    let visible = |&k: &usize| terms.mean[k] > 5.0 * terms.covariance[(k, k)].sqrt() && terms.has_error(k);
    let end = 1 + (1..terms.mean.len()).take_while(visible).count();
    let run = end - 1;
    let keep = run.div_ceil(2).max(3).min(run);
    end - keep..end
}

/// Fits the rate over [`tail_window`].
///
/// # Errors
/// [`NoRate`] if noise leaves fewer than two terms, or if their covariance is degenerate.
///
/// ```
/// use fredholm::stats::{TermMeans, observed_rate};
/// let furnace: Vec<f64> = (0..8).map(|k| 0.7f64.powi(k)).collect();
/// let fit = observed_rate(&TermMeans::exact(&furnace)).unwrap();
/// assert!((fit.rate - 0.7).abs() < 1e-12);
/// assert_eq!(fit.window, 4..8);
/// ```
pub fn observed_rate(terms: &TermMeans) -> Result<Rate, NoRate> {
    let window = tail_window(terms);
    if window.len() < 2 {
        return Err(NoRate::TooFewTerms(window.len()));
    }
    let k: Vec<f64> = window.clone().map(|k| k as f64).collect();
    let m = &terms.mean[window.clone()];
    let y: Vec<f64> = m.iter().map(|m| m.ln()).collect();
    let n = m.len();

    // exact terms: no weights for the fit, and no error to report
    if terms.replicates == 0 {
        let line = line::fit(&k, &y, DMatrix::identity(n, n)).ok_or(NoRate::Covariance)?;
        let (rate, amplitude) = (line.slope.exp(), line.intercept.exp());
        return Ok(Rate { rate, std_error: 0.0, amplitude, window, chi_squared: f64::NAN, p: f64::NAN });
    }

    // delta method: relative covariance
    let first = window.start;
    let relative = DMatrix::from_fn(n, n, |i, j| terms.covariance[(first + i, first + j)] / (m[i] * m[j]));
    let line = line::fit(&k, &y, relative).ok_or(NoRate::Covariance)?;

    // C has ν degrees of freedom, and the fit uses `spare` of them for its weights
    let (nu, spare) = (terms.replicates as f64 - 1.0, n as f64 - 2.0);
    if nu - spare - 1.0 <= 0.0 {
        return Err(NoRate::Covariance);
    }
    let inflate = nu / (nu - spare) * (nu - 1.0) / (nu - spare - 1.0);
    let rate = line.slope.exp();
    let f = line.chi_squared * (nu - spare + 1.0) / (nu * spare);
    Ok(Rate {
        rate,
        std_error: rate * line.std_error * inflate.sqrt(),
        amplitude: line.intercept.exp(),
        window,
        chi_squared: line.chi_squared,
        p: FisherSnedecor::new(spare, nu - spare + 1.0).map_or(f64::NAN, |d| d.sf(f)),
    })
}

/// m_{k+1}/m_k with its standard error, to first order:
/// `s² = r² (C_kk/m_k² + C_{k+1,k+1}/m_{k+1}² − 2 C_{k,k+1}/(m_k m_{k+1}))`. None if there is no term k + 1 or m_k = 0.
pub fn ratio(terms: &TermMeans, k: usize) -> Option<(f64, f64)> {
    let (a, b) = (*terms.mean.get(k)?, *terms.mean.get(k + 1)?);
    if a == 0.0 {
        return None;
    }
    let (c, r) = (&terms.covariance, b / a);
    // written without dividing by b, which may be 0
    let variance = c[(k + 1, k + 1)] + r * r * c[(k, k)] - 2.0 * r * c[(k, k + 1)];
    // a perfectly correlated pair may leave −1e-20 of rounding
    let rounding = 1e-14 * (c[(k + 1, k + 1)] + r * r * c[(k, k)]);
    Some((r, if variance.abs() <= rounding { 0.0 } else { variance.sqrt() / a.abs() }))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn with_errors(mean: &[f64], relative: f64, correlation: f64) -> TermMeans {
        let covariance = DMatrix::from_fn(mean.len(), mean.len(), |i, j| {
            relative * relative * mean[i] * mean[j] * correlation.powi((i as i32 - j as i32).abs())
        });
        TermMeans { mean: mean.to_vec(), covariance, replicates: 256, evidence: vec![] }
    }

    fn powers(rate: f64, n: i32) -> Vec<f64> {
        (0..n).map(|k| 3.0 * rate.powi(k)).collect()
    }

    #[test]
    fn a_geometric_series_has_its_rate_whatever_the_weights() {
        for correlation in [0.0, 0.5, 0.9] {
            let fit = observed_rate(&with_errors(&powers(0.6, 10), 0.01, correlation)).unwrap();
            assert!((fit.rate - 0.6).abs() < 1e-12 && (fit.amplitude - 3.0).abs() < 1e-11);
            assert!(fit.chi_squared < 1e-15 && fit.p > 0.999);
        }
    }

    #[test]
    fn correlation_shrinks_the_error_of_the_rate_and_a_common_factor_is_no_error_at_all() {
        let error = |c| observed_rate(&with_errors(&powers(0.6, 10), 0.01, c)).unwrap().std_error;
        assert!(error(0.0) > 1.4 * error(0.9) && error(0.9) > 0.0);
        let common = with_errors(&powers(0.5, 4), 0.1, 1.0);
        let (r, s) = ratio(&common, 1).unwrap();
        assert_eq!((r, s), (0.5, 0.0));
    }

    #[test]
    fn the_error_of_an_independent_fit_is_the_schoolbook_one() {
        let terms = with_errors(&powers(0.6, 7), 0.01, 0.0); // window 4..7: Σ(k − k̄)² = 2
        let fit = observed_rate(&terms).unwrap();
        assert_eq!(fit.window, 4..7);
        let inflate = 255.0 / 254.0 * 254.0 / 253.0;
        assert!((fit.std_error / (0.6 * 0.01 * (0.5f64 * inflate).sqrt()) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn the_window_is_the_later_half_of_what_rises_above_noise() {
        let mut terms = with_errors(&powers(0.5, 12), 0.01, 0.0);
        assert_eq!(tail_window(&terms), 6..12);
        terms.covariance[(9, 9)] = (0.25 * terms.mean[9]).powi(2); // 4 s: the run ends at 8
        assert_eq!(tail_window(&terms), 5..9);
        terms.covariance[(4, 4)] = f64::NAN;
        assert_eq!(tail_window(&terms), 1..4);
        terms.mean[2] = -1.0;
        assert_eq!(observed_rate(&terms), Err(NoRate::TooFewTerms(1)));
        terms.mean[1] = 0.0;
        assert_eq!(observed_rate(&terms), Err(NoRate::TooFewTerms(0)));
        assert_eq!(observed_rate(&TermMeans::exact(&[1.0])), Err(NoRate::TooFewTerms(0)));
    }

    #[test]
    fn a_drifting_ratio_is_seen_as_misfit() {
        let drift: Vec<f64> = (0..9).map(|k| 0.9f64.powi(k) + 0.2f64.powi(k) + 0.5 * 0.6f64.powi(k)).collect();
        let fit = observed_rate(&with_errors(&drift, 1e-4, 0.0)).unwrap();
        assert!(fit.p < 1e-6, "{fit:?}");
        assert!(fit.rate < 0.9);
    }

    #[test]
    fn degenerate_covariances_are_refused() {
        let mut terms = with_errors(&powers(0.6, 10), 0.01, 0.0);
        terms.replicates = 4;
        assert_eq!(observed_rate(&terms), Err(NoRate::Covariance));
        terms.replicates = 16;
        terms.covariance[(8, 8)] = 0.0;
        assert_eq!(observed_rate(&terms), Err(NoRate::Covariance));
    }

    #[test]
    fn replicates_become_the_mean_over_channels_with_its_covariance() {
        let row = |a: f64, b: f64, tail: f64| {
            vec![DVec3::new(3.0 * a, 0.0, 0.0), DVec3::new(0.0, b, 2.0 * b), DVec3::splat(tail)]
        };
        let deviation = vec![row(0.1, 0.2, 5.0), row(-0.1, -0.2, -5.0)];
        let r = Replicates { mean: row(4.0, 2.0, 9.0), deviation, counted: vec![] };
        let terms = TermMeans::from(&r);
        assert_eq!((terms.mean.as_slice(), terms.replicates), ([4.0, 2.0].as_slice(), 2));
        // n/(n − 1) Σ d_a d_b = 2 · (2 · 0.1 · 0.2)
        let expected = [0.04, 0.08, 0.08, 0.16];
        assert!(terms.covariance.iter().zip(expected).all(|(c, e)| (c - e).abs() < 1e-15), "{:?}", terms.covariance);
    }

    #[test]
    fn ratios_by_hand() {
        let e = |m: f64, s: f64| Estimate {
            mean: DVec3::splat(m),
            std_error: DVec3::splat(s),
            replicates: 16,
            events: None,
        };
        let terms = TermMeans::independent(&[e(4.0, 0.4), e(2.0, 0.1), e(0.0, 0.1)], 1);
        let (r, s) = ratio(&terms, 0).unwrap();
        assert!((r - 0.5).abs() < 1e-15 && (s - 0.5 * (0.1f64 * 0.1 + 0.05 * 0.05).sqrt()).abs() < 1e-15);
        assert_eq!(ratio(&terms, 1).unwrap(), (0.0, 0.05));
        assert!(ratio(&terms, 2).is_none() && ratio(&TermMeans::exact(&[0.0, 1.0]), 0).is_none());
        assert_eq!(ratio(&TermMeans::exact(&[2.0, 1.0]), 0), Some((0.5, 0.0)));
    }
}
