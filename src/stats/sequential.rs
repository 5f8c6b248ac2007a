//! The mean of a stream of batches, with a test that remains valid when it is evaluated after every batch.
//!
//! ```text
//! E_n(m) = ∫ p_δ(x_1..x_n) N(δ; 0, g) dδ / p_0(x_1..x_n)
//!        = (1 + ng)^(−1/2) · ( (S + n d²) / (S + n d²/(1 + ng)) )^(n/2)          d = |x̄ − m|
//!
//! mean = m, normal batches:   P( some n has E_n(m) ≥ 1/α ) ≤ α
//! C_n = { m : E_n(m) < 1/α } = x̄ ± r_n      r_n² = S (c − 1) / (n (1 − c/(1 + ng))),   c = ((1 + ng)/α²)^(1/n)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_i | mean of batch i; batches are independent and identically distributed | [`MeanSequence::push`] |
//! | x̄, S | mean of the batches so far, Σ (x_i − x̄)² | [`MeanSequence`] |
//! | δ | (mean − m)/σ, the effect in standard deviations of one batch | |
//! | g | variance of the prior of δ; it decides where the test is most sensitive, not whether it is valid | [`PRIOR`] |
//! | E_n(m) | e-value against "the mean is m" | [`MeanSequence::log_e`] |
//! | r_n | half width of the confidence sequence, an interval that is valid for all n at once | [`MeanSequence::radius`] |
//! | a | allowance: only means outside m ± a count as evidence against m | `allowance` |
//!
//! p_δ is the density of the batches up to their scale (of x_i/|x_1|), which does not contain σ. So E_n is a likelihood
//! ratio of two simple hypotheses, a martingale that starts at 1. Ville's inequality bounds its maximum. In terms of
//! Student's t and ν = n − 1 it is the Bayes factor of the t-test with a normal prior on the effect. It cannot reject before
//! about `ln(1/α²)/ln(1 + ng)` batches, whatever their values are.
//!
//! **Assumption:** batches are normal. They are means of many paths, so this holds nearly; `tests/sequential.rs` measures
//! how nearly. If few events carry a mean, there is no verdict ([`detector`](super::detector)).
//!
//! References: Ville (1939); Lai, *On confidence sequences*, Annals of Statistics 4 (1976); Gönen, Johnson, Lu and Westfall,
//! *The Bayesian two-sample t test*, American Statistician 59 (2005); Pérez-Ortiz, Lardy, de Heide and Grünwald, *E-statistics,
//! group invariance and anytime-valid testing*, Annals of Statistics 52 (2024); Wang and Ramdas, *Anytime-valid t-tests and confidence
//! sequences for Gaussian means with unknown variance* (2023).

use super::power::one_sided_normal;

/// g. For a given n, the interval is narrowest where ng ≈ 2 ln(1/α) + …: at some hundred batches for the levels in use. For
/// ten times fewer or more batches it is a few percent wider than necessary.
pub const PRIOR: f64 = 0.1;

/// Running mean of batches, with a test that is valid at any time.
///
/// ```
/// use fredholm::stats::MeanSequence;
/// let mut s = MeanSequence::default();
/// (0..200).for_each(|i| s.push(1.0 + 0.01 * f64::from(i % 7 - 3)));
/// assert!(s.log_e(1.0, 0.0) < 0.0); // nothing speaks against 1
/// assert!(s.log_e(1.02, 0.0) > 1e6f64.ln());
/// assert!(s.radius(1e-6) < 0.02);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanSequence {
    count: u64,
    mean: f64,
    /// S, updated about the running mean (Welford 1962).
    square: f64,
}

impl MeanSequence {
    /// Takes in one batch. After a value that is not finite, every answer is NaN.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let before = x - self.mean;
        self.mean += before / self.count as f64;
        self.square += before * (x - self.mean);
    }

    /// Number of batches so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// x̄; 0 before the first batch.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// √(S/(n(n − 1))): the standard error of x̄. NaN with fewer than two batches.
    pub fn std_error(&self) -> f64 {
        let n = self.count as f64;
        if self.count < 2 { f64::NAN } else { (self.square / (n * (n - 1.0))).sqrt() }
    }

    /// ln of the smallest E_n(m) over all m within `allowance` of `null`: the evidence against all of these m.
    pub fn log_e(&self, null: f64, allowance: f64) -> f64 {
        let n = self.count as f64;
        let spread = 1.0 + n * PRIOR;
        let beyond = (self.mean - null).abs() - allowance;
        if beyond.is_nan() || self.square.is_nan() {
            return f64::NAN;
        }
        let d2 = n * beyond.max(0.0).powi(2);
        let ratio = if d2 == 0.0 { 1.0 } else { (self.square + d2) / (self.square + d2 / spread) };
        0.5 * (n * ratio.ln() - spread.ln())
    }

    /// r_n at level `alpha`: with probability 1 − α the true mean is within r_n of x̄ for all n at once. ∞ as long as there
    /// are too few batches.
    pub fn radius(&self, alpha: f64) -> f64 {
        let n = self.count as f64;
        let spread = 1.0 + n * PRIOR;
        // ln c is kept instead of c, because c − 1 is small when there are many batches
        let log_c = (spread.ln() - 2.0 * alpha.ln()) / n;
        let room = 1.0 - (log_c - spread.ln()).exp();
        if room > 0.0 { (self.square * log_c.exp_m1() / (n * room)).sqrt() } else { f64::INFINITY }
    }
}

/// Number of batches after which a bias of `effect` standard deviations of one batch is detected with probability 1 − `beta`
/// at level `alpha`: the first n with r_n + z_β σ/√n ≤ effect · σ.
///
/// ```
/// use fredholm::stats::sequential::planned_batches;
/// let n = planned_batches(0.1, 1e-3, 1e-3);
/// assert!((5700..5800).contains(&n), "{n}"); // a test planned for one look needs 4071
/// ```
pub fn planned_batches(effect: f64, alpha: f64, beta: f64) -> u64 {
    let z = one_sided_normal(beta);
    let found = |n: u64| {
        let s = MeanSequence { count: n, mean: 0.0, square: n as f64 };
        s.radius(alpha) + z / (n as f64).sqrt() <= effect
    };
    let mut high = 2;
    while !found(high) {
        high *= 2;
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if found(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequence(n: u32) -> MeanSequence {
        let mut s = MeanSequence::default();
        let at = |i: u32| i.wrapping_mul(i).wrapping_mul(7).wrapping_add(i.wrapping_mul(13)) % 101;
        (0..n).for_each(|i| s.push(2.0 + f64::from(at(i)) / 50.0));
        s
    }

    /// Compares the closed form with the mixture that it stands for, by quadrature over δ and the scale. With the right Haar
    /// measure dσ/σ, `p_δ ∝ ∫ σ^(−n−1) exp(−Σ (x_i − m − δσ)²/2σ²) dσ`.
    #[test]
    fn the_closed_form_is_the_integral() {
        let s = sequence(9);
        for null in [2.0, 2.9, 3.4] {
            let (n, x) = (9.0f64, s.mean() - null);
            // Σ (x_i − m − δσ)² = S + n (x̄ − m − δσ)²
            let density = |delta: f64| {
                let one = |log_sigma: f64| {
                    let sigma = log_sigma.exp();
                    let square = s.square + n * (x - delta * sigma).powi(2);
                    (-n * log_sigma - 0.5 * square / (sigma * sigma)).exp()
                };
                (-4000..4000).map(|i| one(f64::from(i) * 2e-3)).sum::<f64>()
            };
            let sd = PRIOR.sqrt();
            let prior = |delta: f64| (-0.5 * (delta / sd).powi(2)).exp() / (sd * std::f64::consts::TAU.sqrt());
            let step = 0.01;
            let mixture: f64 = (-400..=400).map(|i| f64::from(i) * step).map(|d| step * prior(d) * density(d)).sum();
            let e = (mixture / density(0.0)).ln();
            assert!((e - s.log_e(null, 0.0)).abs() < 1e-6, "{null}: {e} {}", s.log_e(null, 0.0));
        }
    }

    #[test]
    fn the_interval_holds_what_is_not_rejected() {
        for (n, alpha) in [(40, 0.05), (40, 1e-6), (500, 1e-9), (100_000, 1e-3)] {
            let s = sequence(n);
            let r = s.radius(alpha);
            assert!(r.is_finite());
            for side in [-1.0, 1.0] {
                assert!(s.log_e(s.mean() + side * 0.999_9 * r, 0.0) < -f64::ln(alpha));
                assert!(s.log_e(s.mean() + side * 1.000_1 * r, 0.0) > -f64::ln(alpha));
            }
        }
        assert_eq!(sequence(5).radius(1e-6), f64::INFINITY);
        assert_eq!(MeanSequence::default().radius(0.5), f64::INFINITY);
    }

    #[test]
    fn an_allowance_moves_the_null_hypothesis() {
        let s = sequence(200);
        let at = s.mean() + 0.3;
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        same(s.log_e(at, 0.1), s.log_e(s.mean() + 0.2, 0.0));
        same(s.log_e(at, 0.4), s.log_e(s.mean(), 0.0));
    }

    #[test]
    fn batches_without_spread_are_decided_by_their_number() {
        let mut s = MeanSequence::default();
        (0..40).for_each(|_| s.push(1.5));
        assert_eq!(s.radius(1e-6), 0.0);
        assert!(s.log_e(1.5, 0.0) < 0.0);
        assert!(s.log_e(1.4, 0.0) > 1e6f64.ln());
        assert!(s.log_e(1.4, 0.2) < 0.0);
        s.push(f64::NAN);
        assert!(s.log_e(1.5, 0.0).is_nan() && s.radius(0.1).is_nan() && s.mean().is_nan());
    }
}
