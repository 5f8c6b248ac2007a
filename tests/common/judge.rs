//! Judging many estimates against known values, with the power of every judgement stated.
//!
//! An estimate with standard error s is compared at the level of its account, with critical value t*. With
//! `reach = 2 t* s`, an effect of that size is missed as rarely as a false alarm is raised, so
//!
//! | reach | judgement |
//! |---|---|
//! | ≤ δ | equivalence: the whole interval lies within ±δ of the truth |
//! | ≤ visible | consistency: an error of this size would have been seen |
//! | beyond | none: the test could not fail for any reason worth knowing, and the caller must not count it |
//!
//! The middle row also keeps the t-test honest for terms that roulette makes rare: reach ≤ ½ of a term that consists of
//! n equal events needs n = (4 t*)² ≈ 800 of them, enough for their sum to be normal at this depth.

use super::Account;
use super::ledger;
use fredholm::terms::{Estimate, TermFilm};
use glam::DVec3;

/// How an estimate was judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    Equivalent,
    Consistent,
    TooNoisy,
}

/// An account with its critical value, and how often it could prove what.
pub struct Jury {
    pub account: Account,
    level: f64,
    threshold: (f64, f64),
    pub equivalent: u32,
    pub consistent: u32,
    pub too_noisy: u32,
}

impl Jury {
    pub fn open(name: &str) -> Self {
        let level = ledger::share(name).level();
        Self { account: super::open(name), level, threshold: (0.0, 0.0), equivalent: 0, consistent: 0, too_noisy: 0 }
    }

    pub fn seed(&self) -> u64 {
        self.account.seed()
    }

    fn reach(&mut self, e: &Estimate) -> DVec3 {
        // no replicates: the error is known
        let dof = if e.replicates == 0 { f64::INFINITY } else { e.replicates as f64 - 1.0 };
        if self.threshold.0 != dof {
            self.threshold = (dof, fredholm::stats::critical(self.level, dof));
        }
        e.std_error * (2.0 * self.threshold.1)
    }

    /// Judges one estimate; panics if it contradicts `truth`.
    #[track_caller]
    pub fn judge(&mut self, what: &str, e: &Estimate, truth: DVec3, delta: DVec3, visible: DVec3) -> Judged {
        let reach = self.reach(e);
        if reach.cmple(delta).all() {
            self.equivalent += 1;
            self.account.assert_equivalent(what, e, truth, delta);
            Judged::Equivalent
        } else if reach.cmple(visible).all() {
            self.consistent += 1;
            self.account.assert_consistent(what, e, truth);
            Judged::Consistent
        } else {
            assert!(!reach.is_nan(), "{what}: {e:?}");
            self.too_noisy += 1;
            Judged::TooNoisy
        }
    }

    /// The usual margins for a part of a whole: δ = 1 % of the part + 10⁻⁴ of the whole, visible = half the part.
    #[track_caller]
    pub fn part(&mut self, what: &str, e: &Estimate, truth: DVec3, whole: DVec3) -> Judged {
        let delta = 0.01 * truth + 1e-4 * whole;
        self.judge(what, e, truth, delta, delta.max(0.5 * truth))
    }

    /// Asserts how many judgements were proofs of equivalence, and how many were none: a test that quietly loses its
    /// power fails.
    #[track_caller]
    pub fn assert_power(&self, least_equivalent: f64, most_too_noisy: f64) {
        let all = f64::from(self.equivalent + self.consistent + self.too_noisy);
        let shares = [self.equivalent, self.consistent, self.too_noisy].map(|n| f64::from(n) / all);
        let text = format!(
            "of {all} values {:.3} were proved equivalent, {:.3} consistent, {:.3} were too noisy to judge",
            shares[0], shares[1], shares[2]
        );
        eprintln!("{text}");
        assert!(shares[0] >= least_equivalent && shares[2] <= most_too_noisy, "{text}");
    }
}

/// Mean and error at one pixel of the sum over some slots.
pub fn at(film: &TermFilm, pixel: usize, slots: std::ops::Range<usize>) -> Estimate {
    let (mean, std_error) = film.pixel(pixel, slots);
    Estimate { mean, std_error, replicates: film.shape.replicates as u64, events: None }
}
