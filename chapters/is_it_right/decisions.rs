//! Decisions about a renderer from its samples, and how often they are wrong.
//!
//! ```text
//! different: p = P(|T_ν| ≥ |x̄ − μ|/s) ≤ α          equal to ± δ: |x̄ − μ| + t_2α s ≤ δ          any time: E_n(μ) ≥ 1/α
//! power(n) = P(|Z + d √n/cv| > z_α)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p | p-value of "the renderer is right" | [`p_value`] |
//! | E_n | e-value after n batches | [`anytime`] |
//! | δ | margin of equivalence: the bias of the darker renderer | [`delta`] |
//! | d | bias of the darker renderer as a part of its mean | [`power`] |
//! | rate | number of events over number of experiments, with the error of a binomial law | [`rate`] |
//!
//! References: Welch (1947); Holm (1979); Schuirmann (1987) for equivalence; Ville (1939) for tests at any time.

use super::experiments::{ALPHA, BATCHES, CV, Experiment, RHO, SAMPLES, SHORT, TESTS, smallest};
use fredholm::report::book::Number;
use fredholm::stats::{MeanSequence, critical, two_sided_p};

/// A batch after which the watched tests look for the first time.
pub const FIRST: u64 = 10;

/// r/n with its standard error. The error uses (r + 1)/(n + 2), so that a rate of 0 or 1 has an error, too.
pub fn rate(events: impl Iterator<Item = bool>) -> Number {
    let (mut r, mut n) = (0.0, 0.0);
    for event in events {
        r += f64::from(u8::from(event));
        n += 1.0;
    }
    let q: f64 = (r + 1.0) / (n + 2.0);
    Number { value: r / n, std_error: (q * (1.0 - q) / n).sqrt() }
}

fn sequence(batches: &[f64]) -> MeanSequence {
    let mut s = MeanSequence::default();
    batches.iter().for_each(|&x| s.push(x));
    s
}

/// (x̄ − μ)/s.
pub fn t(batches: &[f64]) -> f64 {
    let s = sequence(batches);
    (s.mean() - RHO) / s.std_error()
}

// ANCHOR: test
/// p-value of the null hypothesis "the mean of these batches is μ".
pub fn p_value(batches: &[f64]) -> f64 {
    two_sided_p(t(batches), batches.len() as f64 - 1.0)
}

/// How often is a renderer rejected after n batches?
pub fn rejected(all: &[Experiment], n: usize) -> Number {
    rate(all.iter().map(|batches| p_value(&batches[..n]) <= ALPHA))
}

/// Families of tests of the same renderer: how often does at least one test of a family raise an alarm?
pub fn families(all: &[Experiment], correct: fn(&[f64]) -> Vec<f64>) -> Number {
    let p: Vec<f64> = all.iter().flat_map(|batches| batches.chunks_exact(SHORT).map(p_value)).collect();
    rate(p.chunks_exact(TESTS).map(|family| correct(family).iter().any(|&p| p <= ALPHA)))
}
// ANCHOR_END: test

/// p-values of whole experiments.
pub fn p_values(all: &[Experiment]) -> Vec<f64> {
    all.iter().map(|batches| p_value(batches)).collect()
}

// ANCHOR: watch
/// The test looks after every batch and stops at its first alarm: rate of alarms up to each batch.
pub fn watch(all: &[Experiment], alarm: impl Fn(&MeanSequence) -> bool) -> Vec<Number> {
    let first_alarm = |batches: &Experiment| {
        let mut s = MeanSequence::default();
        batches.iter().position(|&x| {
            s.push(x);
            s.count() >= FIRST && alarm(&s)
        })
    };
    let first: Vec<Option<usize>> = all.iter().map(first_alarm).collect();
    (0..BATCHES).map(|n| rate(first.iter().map(|alarm| alarm.is_some_and(|at| at <= n)))).collect()
}

/// E_n(μ) ≥ 1/α: this test is valid at any time.
pub fn anytime(s: &MeanSequence) -> bool {
    s.log_e(RHO, 0.0) >= -ALPHA.ln()
}

/// |t| ≥ t_α: this test is valid for one look.
pub fn fixed() -> impl Fn(&MeanSequence) -> bool {
    let limit: Vec<f64> = (0..=BATCHES).map(|n| critical(ALPHA, n as f64 - 1.0)).collect();
    move |s| (s.mean() - RHO).abs() >= limit[s.count() as usize] * s.std_error()
}
// ANCHOR_END: watch

/// δ: the bias of the darker renderer.
pub fn delta() -> f64 {
    RHO * (1.0 - smallest())
}

// ANCHOR: equal
/// How often is a renderer proved to be right to ± δ? Two one-sided tests of level α: the 1 − 2α interval lies within ± δ.
pub fn called_equal(all: &[Experiment]) -> Number {
    let quantile = critical(2.0 * ALPHA, BATCHES as f64 - 1.0);
    let equal = |s: MeanSequence| (s.mean() - RHO).abs() + quantile * s.std_error() <= delta();
    rate(all.iter().map(|batches| equal(sequence(batches))))
}
// ANCHOR_END: equal

/// P(Z > x) for a standard normal Z.
fn beyond(x: f64) -> f64 {
    let tail = 0.5 * two_sided_p(x, f64::INFINITY);
    if x < 0.0 { 1.0 - tail } else { tail }
}

/// Predicted rate at which the darker renderer is rejected after `samples` samples.
pub fn power(samples: f64) -> f64 {
    let (z, d) = (critical(ALPHA, f64::INFINITY), 1.0 / smallest() - 1.0);
    let shift = d * samples.sqrt() / CV;
    beyond(z - shift) + beyond(z + shift)
}

/// Predicted rate at which the right renderer is proved to be right to ± δ.
pub fn power_of_equality() -> f64 {
    let room = delta() * (SAMPLES as f64).sqrt() / (RHO * CV) - critical(2.0 * ALPHA, f64::INFINITY);
    1.0 - 2.0 * beyond(room)
}
