//! The signature r_k in closed form, for the mistakes that have one.
//!
//! | factor c is applied | r_k, k ≥ 1 | the mistake is in |
//! |---|---|---|
//! | once to every term | c | the connection to the light |
//! | at every bounce | c^(k−1) | the bounce, or the roulette |
//! | at every reflection | c^k | the BSDF |
//!
//! In all three cases r_0 = 1, because light seen directly involves neither a connection nor a bounce.

use crate::stats::Evidence;
use crate::terms::{Estimate, Functional};

/// A signature that is the same at all terms: c for k ≥ 1, and 1 for k = 0.
pub fn flat(c: f64, k: usize) -> Option<f64> {
    Some(if k == 0 { 1.0 } else { c })
}

/// A factor c per bounce after direct light: c^(k−1) for k ≥ 1.
pub fn per_bounce(c: f64, k: usize) -> Option<f64> {
    Some(c.powi(k.saturating_sub(1) as i32))
}

/// A factor c per reflection: c^k.
pub fn per_reflection(c: f64, k: usize) -> Option<f64> {
    Some(c.powi(k as i32))
}

/// A signature that depends on the scene: always none.
pub fn unknown(_: usize) -> Option<f64> {
    None
}

/// A measured r_k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// T_k^wrong / T_k^right, from means over the channels.
    pub value: f64,
    /// Standard error of `value`. It is an upper bound if the channels are not perfectly correlated; NaN if it is not known.
    pub std_error: f64,
    /// Number of replicates from which the error is computed.
    pub replicates: u64,
}

impl Ratio {
    /// The ratio of two independent estimates, with its error by the delta method. NaN if the correct estimate is zero.
    pub fn of(wrong: &Estimate, right: &Estimate) -> Self {
        let average = |e: &Estimate| {
            let known = Evidence::of(e).no_error.is_none();
            (e.mean.element_sum() / 3.0, if known { e.std_error.element_sum() / 3.0 } else { f64::NAN })
        };
        let ((a, sa), (b, sb)) = (average(wrong), average(right));
        let value = a / b;
        let std_error = ((sa / b).powi(2) + (value * sb / b).powi(2)).sqrt();
        Self { value, std_error, replicates: wrong.replicates.min(right.replicates) }
    }
}

/// The measured ratios r_0, …, r_K.
pub fn measured(wrong: &Functional, right: &Functional) -> Vec<Ratio> {
    wrong.terms.iter().zip(&right.terms).map(|(w, r)| Ratio::of(w, r)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn ratios_have_the_error_of_both() {
        let of = |m: f64, s: f64| Estimate {
            mean: DVec3::splat(m),
            std_error: DVec3::splat(s),
            replicates: 16,
            events: None,
        };
        let r = Ratio::of(&of(6.0, 0.3), &of(3.0, 0.2));
        assert!((r.value - 2.0).abs() < 1e-12 && (r.std_error - (0.01f64 + 4.0 / 9.0 * 0.04).sqrt()).abs() < 1e-12);
        assert!(Ratio::of(&of(0.0, 0.0), &of(0.0, 0.0)).value.is_nan());
    }

    #[test]
    fn the_three_patterns() {
        assert_eq!([0, 1, 2, 3].map(|k| flat(2.0, k)), [1.0, 2.0, 2.0, 2.0].map(Some));
        assert_eq!([0, 1, 2, 3].map(|k| per_bounce(2.0, k)), [1.0, 1.0, 2.0, 4.0].map(Some));
        assert_eq!([0, 1, 2, 3].map(|k| per_reflection(2.0, k)), [1.0, 2.0, 4.0, 8.0].map(Some));
    }
}
