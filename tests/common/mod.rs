//! What the tests share: accounts in the ledger with their seeds, and numbers that do not come from the library.
// every test file uses its own part
#![allow(dead_code, missing_docs, unreachable_pub, clippy::unwrap_used, clippy::print_stderr)]

pub mod judge;
pub mod ledger;
pub mod program;
pub mod random;
pub mod sampling;
pub mod scenes;
pub mod truth;

pub use ledger::Account;
use statrs::distribution::{Binomial, DiscreteCDF};

/// Opens the account of the test `name`. `FREDHOLM_SEED=n` gives the whole run other seeds (0 if unset), one per name;
/// a failure prints the line that repeats it.
pub fn open(name: &str) -> Account {
    let base = match std::env::var("FREDHOLM_SEED") {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("FREDHOLM_SEED={text} is not a whole number")),
        Err(_) => 0,
    };
    ledger::open(name, base)
}

/// Random numbers independent of the library's own: SplitMix64 (Steele, Lea, Flood 2014).
pub struct Noise(pub u64);

impl Noise {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Standard normal (Box and Muller, one of the pair).
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Asserts that `hits` of `trials` is no surprise if each hits with probability `p`: one comparison of the account,
/// exact binomial, two-sided.
#[track_caller]
pub fn assert_rate(account: &mut Account, what: &str, hits: u64, trials: u64, p: f64) {
    let level = account.spend(1);
    let binomial = Binomial::new(p, trials).unwrap();
    let tail = binomial.cdf(hits).min(if hits == 0 { 1.0 } else { binomial.sf(hits - 1) });
    let seed = account.seed();
    assert!(
        tail > 0.5 * level,
        "{what}: {hits} of {trials}, expected {:.1} (tail {tail:.1e}, seed {seed})",
        p * trials as f64
    );
}

/// The same for an upper limit: only more hits than `p` explains fail.
#[track_caller]
pub fn assert_rate_at_most(account: &mut Account, what: &str, hits: u64, trials: u64, p: f64) {
    let level = account.spend(1);
    let tail = at_least(hits, trials, p);
    let seed = account.seed();
    assert!(
        tail > level,
        "{what}: {hits} of {trials}, at most {:.1} expected (tail {tail:.1e}, seed {seed})",
        p * trials as f64
    );
}

/// The chance of `hits` of `trials` or more, if each hits with probability `p`.
pub fn at_least(hits: u64, trials: u64, p: f64) -> f64 {
    if hits == 0 { 1.0 } else { Binomial::new(p, trials).unwrap().sf(hits - 1) }
}
