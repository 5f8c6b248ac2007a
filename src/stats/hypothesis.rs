//! Tests of one mean against another.
//!
//! ```text
//! t = (ā − b̄) / √(s_a² + s_b²)      ν = (s_a² + s_b²)² / (s_a⁴/ν_a + s_b⁴/ν_b)      p = P(|T_ν| ≥ |t|)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ā, s_a, ν_a | a mean, its standard error, degrees of freedom of that error: replicates − 1, ∞ if exact | [`Measured`] |
//! | ν | degrees of freedom of the difference | [`difference`] |
//! | p | two-sided p-value | [`two_sided_p`] |
//! | t* | the critical value: P(\|T_ν\| ≥ t*) = level | [`critical`] |
//!
//! If one side is exact this is Student's test (1908), otherwise Welch's (*Biometrika* 34, 1947). Families of tests are
//! adjusted by Holm's method (*Scand. J. Statistics* 6, 1979). It does not need independence, which matters because the
//! terms of the prefix estimator are correlated.

use crate::terms::Estimate;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Differences below this fraction of the value come from rounding in the `f32` transport, not from physics. Even an
/// estimator without variance (in a furnace) has them. The fraction is far below every δ in use.
pub const ROUNDING: f64 = 1e-6;

/// Above this many degrees of freedom the incomplete beta function is slow to converge, and [`two_sided_p`] maps t to
/// the normal deviate with the same tail instead (Wallace, *Ann. Math. Stat.* 30, 1959).
const LARGE_DOF: f64 = 1e4;

/// One scalar with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub mean: f64,
    /// Its standard error; 0 if exact, NaN if unknown.
    pub std_error: f64,
    /// Degrees of freedom of `std_error`; ∞ if exact.
    pub dof: f64,
}

impl Measured {
    /// One channel (0, 1, 2 = red, green, blue) of an estimate. Its replicates give the degrees of freedom.
    pub fn of(estimate: &Estimate, channel: usize) -> Self {
        let dof = if estimate.replicates == 0 { f64::INFINITY } else { estimate.replicates as f64 - 1.0 };
        Self { mean: estimate.mean[channel], std_error: estimate.std_error[channel], dof }
    }

    /// A value known without error.
    pub fn exact(mean: f64) -> Self {
        Self { mean, std_error: 0.0, dof: f64::INFINITY }
    }
}

/// a − b with the error and the degrees of freedom of Welch and Satterthwaite.
///
/// ```
/// use fredholm::stats::{Measured, difference};
/// let a = Measured { mean: 3.0, std_error: 0.3, dof: 15.0 };
/// assert_eq!(difference(a, Measured::exact(2.0)).dof, 15.0); // Student's test
/// let b = Measured { mean: 2.0, std_error: 0.3, dof: 15.0 };
/// assert_eq!(difference(a, b).dof, 30.0);
/// ```
pub fn difference(a: Measured, b: Measured) -> Measured {
    let (va, vb) = (a.std_error * a.std_error, b.std_error * b.std_error);
    let std_error = (va + vb).sqrt();
    // normalised by the larger variance, so that s⁴ of a very dim term cannot underflow
    let scale = va.max(vb);
    let dof = if va + vb == 0.0 {
        f64::INFINITY
    } else if !(va + vb).is_finite() {
        // an unknown or infinite error: the degrees of freedom do not follow from the numbers
        a.dof.min(b.dof)
    } else {
        let (ra, rb) = (va / scale, vb / scale);
        (ra + rb) * (ra + rb) / (ra * ra / a.dof + rb * rb / b.dof)
    };
    Measured { mean: a.mean - b.mean, std_error, dof }
}

/// P(|T_ν| ≥ |t|); ν = ∞ is the normal distribution. NaN if t or ν is NaN or ν ≤ 0.
pub fn two_sided_p(t: f64, dof: f64) -> f64 {
    if t.is_nan() || dof.is_nan() || dof <= 0.0 {
        return f64::NAN;
    }
    // the upper tail itself, not 1 − cdf, because levels go down to 1e-12 here
    let t = t.abs();
    let normal = |z: f64| 2.0 * Normal::standard().sf(z);
    if dof.is_infinite() || t.is_infinite() {
        normal(t)
    } else if dof > LARGE_DOF {
        normal((dof * (t * t / dof).ln_1p()).sqrt() * (8.0 * dof + 1.0) / (8.0 * dof + 3.0))
    } else {
        StudentsT::new(0.0, 1.0, dof).map_or(f64::NAN, |d| 2.0 * d.sf(t))
    }
}

/// t* with P(|T_ν| ≥ t*) = `level`, 0 < level < 1. NaN outside, or if ν is not positive.
///
/// ```
/// use fredholm::stats::critical;
/// assert!((critical(0.05, f64::INFINITY) - 1.9599639845).abs() < 1e-9);
/// ```
pub fn critical(level: f64, dof: f64) -> f64 {
    if !(level > 0.0 && level < 1.0 && dof > 0.0) {
        return f64::NAN;
    }
    // ln p is a concave, falling function of ln t. So from any start Newton's method overshoots at most once, and then
    // converges from the right. (The library's quantile function fails at ν = 1 and at large ν.)
    let mut t = -Normal::standard().inverse_cdf(0.5 * level);
    if dof.is_infinite() {
        return t;
    }
    for _ in 0..50 {
        let (p, h) = (two_sided_p(t, dof), 1e-4);
        let slope = (two_sided_p(t * (1.0 + h), dof) / two_sided_p(t / (1.0 + h), dof)).ln() / (2.0 * h.ln_1p());
        let step = (level / p).ln() / slope;
        t *= step.exp();
        if step.abs() < 1e-12 {
            break;
        }
    }
    t
}

/// Holm's adjusted p-values, in the order given. Rejecting all tests with value ≤ α keeps the chance of any false
/// rejection ≤ α, for any dependence between the tests. p_(i) → max_{j ≤ i} min(1, (m − j + 1) p_(j)), where m is the number
/// of tests. A NaN stays NaN and still counts in m.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].abs().total_cmp(&p[b].abs())); // NaN last, whichever its sign
    let mut adjusted = vec![f64::NAN; p.len()];
    let mut largest = 0.0f64;
    for (i, &at) in order.iter().enumerate().take_while(|&(_, &at)| !p[at].is_nan()) {
        largest = largest.max(((p.len() - i) as f64 * p[at]).min(1.0));
        adjusted[at] = largest;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn p_values_of_small_dof_are_elementary() {
        for t in [0.1, 1.0, 3.0, 30.0, 1e4] {
            let cauchy = 1.0 - 2.0 / std::f64::consts::PI * f64::atan(t);
            assert!((two_sided_p(t, 1.0) - cauchy).abs() < 1e-12, "{t}");
            let two: f64 = 2.0 / (t * t + 2.0 + t * (t * t + 2.0).sqrt()); // 1 − t/√(2+t²), free of cancellation
            assert!((two_sided_p(t, 2.0) / two - 1.0).abs() < 1e-9, "{t}: {} {two}", two_sided_p(t, 2.0));
        }
    }

    #[test]
    fn critical_values_invert_p_from_1e_minus_1_to_1e_minus_12() {
        for dof in [1.0, 2.5, 15.0, 31.7, 255.0, 1e4, 9e6, 2e7, f64::INFINITY] {
            for exponent in 1..=12 {
                let level = 10f64.powi(-exponent);
                let back = two_sided_p(critical(level, dof), dof);
                assert!((back / level - 1.0).abs() < 1e-6, "dof {dof}, level {level}: {back}");
            }
            assert!((two_sided_p(critical(0.9, dof), dof) - 0.9).abs() < 1e-6);
        }
    }

    #[test]
    fn critical_values_match_printed_tables() {
        // Student's table at 5 %, 1 % and 0.1 %; then the very small levels that a test suite uses
        for (level, dof, t) in [
            (0.05, 10.0, 2.228139),
            (0.01, 15.0, 2.946713),
            (0.001, 30.0, 3.645959),
            (1e-9, f64::INFINITY, 6.109410),
            (1e-9, 255.0, 6.35),
            (1e-9, 31.0, 8.61),
        ] {
            let got = critical(level, dof);
            assert!((got - t).abs() < if level < 1e-6 { 6e-3 } else { 1e-6 }, "{level} {dof}: {got}");
        }
    }

    #[test]
    fn the_two_branches_for_the_tail_meet() {
        for t in [0.3, 2.0, 4.0, 6.0, 7.0] {
            let (below, above) = (two_sided_p(t, LARGE_DOF), two_sided_p(t, LARGE_DOF * (1.0 + 1e-9)));
            assert!((below / above - 1.0).abs() < 1e-6, "{t}: {below} {above}");
            let (far, limit) = (two_sided_p(t, 1e14), two_sided_p(t, f64::INFINITY));
            assert!((far / limit - 1.0).abs() < 1e-9, "{t}: {far} {limit}");
        }
    }

    #[test]
    fn welch_dof_lies_between_the_smaller_and_the_sum() {
        for ratio in [1e-9, 0.3, 1.0, 7.0, 1e9] {
            let a = Measured { mean: 0.0, std_error: 1.0, dof: 15.0 };
            let b = Measured { mean: 0.0, std_error: ratio, dof: 63.0 };
            let dof = difference(a, b).dof;
            assert!((15.0 - 1e-9..=78.0 + 1e-9).contains(&dof), "{ratio}: {dof}");
            assert_eq!(difference(a, b).dof, difference(b, a).dof);
        }
        let tiny = Measured { mean: 0.0, std_error: 1e-120, dof: 15.0 };
        assert_eq!(difference(tiny, tiny).dof, 30.0);
        assert_eq!(difference(Measured::exact(1.0), Measured::exact(1.0)).dof, f64::INFINITY);
    }

    #[test]
    fn unknown_errors_stay_unknown() {
        let one = Measured { mean: 1.0, std_error: f64::NAN, dof: 0.0 };
        let d = difference(one, Measured::exact(1.0));
        assert!(d.std_error.is_nan() && two_sided_p(d.mean / d.std_error, d.dof).is_nan());
        assert!(critical(1e-3, 0.0).is_nan() && critical(0.0, 3.0).is_nan() && critical(f64::NAN, 3.0).is_nan());
    }

    #[test]
    fn holm_by_hand() {
        assert_eq!(holm(&[0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02]);
        assert_eq!(holm(&[0.5, 0.9]), [1.0, 1.0]);
        let with_nan = holm(&[0.01, f64::NAN, 0.2]);
        assert!((with_nan[0] - 0.03).abs() < 1e-15 && with_nan[1].is_nan() && with_nan[2] == 0.4);
        assert!(holm(&[]).is_empty());
    }
}
