//! Number of samples that a test needs, and the smallest effect that a test of given size can detect.
//!
//! ```text
//! n = ((z_α + z_β) cv / δ)²          smallest visible effect = (t_α + z_β) s
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | α | two-sided level of one comparison | `alpha` |
//! | β | probability to miss an effect of size δ | `beta` |
//! | cv | standard deviation of one sample over the mean | `cv` |
//! | δ | effect, relative to the mean | `delta` |
//! | s | standard error of the comparison | `std_error` |
//! | z, t | quantiles of the normal and of Student's distribution | [`critical`] |
//!
//! Cohen, *Statistical Power Analysis for the Behavioral Sciences* (1988). A test that does not reject proves nothing by
//! itself. These two numbers show what it could have detected.

use super::hypothesis::critical;

/// z_β with P(Z ≥ z_β) = β, for β < 1/2.
pub(super) fn one_sided_normal(beta: f64) -> f64 {
    critical(2.0 * beta, f64::INFINITY)
}

/// Samples needed to detect a relative effect `delta` with probability 1 − `beta` in a test of two-sided level `alpha`.
///
/// ```
/// use fredholm::stats::needed_samples;
/// // 1000 comparisons sharing 1e-6, a bias of 1 %, samples as wide as their mean
/// let n = needed_samples(1.0, 0.01, 1e-6 / 1000.0, 1e-3);
/// assert!((n / 8.46e5 - 1.0).abs() < 1e-3);
/// ```
pub fn needed_samples(cv: f64, delta: f64, alpha: f64, beta: f64) -> f64 {
    let z = critical(alpha, f64::INFINITY) + one_sided_normal(beta);
    (z * cv / delta).powi(2)
}

/// The smallest true effect that a comparison with this standard error and `dof` rejects with probability 1 − `beta`. The
/// uncertainty of the standard error enters only through t_α. At 15 degrees of freedom the true power is therefore a little
/// lower.
pub fn min_detectable(std_error: f64, dof: f64, alpha: f64, beta: f64) -> f64 {
    // an exact comparison has no noise that could hide an effect
    if std_error == 0.0 { 0.0 } else { (critical(alpha, dof) + one_sided_normal(beta)) * std_error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_sizes_of_the_plan() {
        for (delta, beta, n) in [(0.01, 1e-3, 8.46e5), (0.01, 1e-6, 1.18e6), (0.003, 1e-3, 9.4e6)] {
            let got = needed_samples(1.0, delta, 1e-9, beta);
            assert!((got / n - 1.0).abs() < 5e-3, "{delta} {beta}: {got}");
        }
    }

    #[test]
    fn the_two_formulas_are_inverse_to_each_other() {
        let (cv, delta) = (1.7, 0.02);
        let n = needed_samples(cv, delta, 1e-6, 0.01);
        let effect = min_detectable(cv / n.sqrt(), f64::INFINITY, 1e-6, 0.01);
        assert!((effect - delta).abs() < 1e-12);
        assert_eq!(min_detectable(0.0, f64::INFINITY, 1e-6, 0.01), 0.0);
        assert!(min_detectable(f64::NAN, 0.0, 1e-6, 0.01).is_nan());
    }
}
