//! Tests for too much or too little light in regions where few pixels carry all the noise, so that a t-test is not valid.
//!
//! ```text
//! too much:    W = mean over λ of Π_i (1 + λ (S_i/μ_i − 1)),   S_i ≥ 0, E S_i ≤ μ_i   ⟹   E W ≤ 1,   P(W ≥ 1/p) ≤ p
//! too little:  p = exp(−t²/2V),   t = Σ (P_i − S_i),   V = (1 + 4ν) Σ s_i²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S_i | value of pixel i of the suspect | argument |
//! | P_i, s_i | prediction for pixel i, with its standard error | argument |
//! | μ_i | upper bound of the expected value: P_i + 3 s_i plus 2 % of the mean of the region | [`excess`] |
//! | λ | fraction of the wealth that is bet on one pixel | [`STAKES`] |
//! | ν | variance of the suspect divided by that of the prediction: the median over the regions | argument of [`deficit`] |
//!
//! Too much light is tested by betting. W is the wealth of a gambler who bets on every pixel that it is brighter than μ_i;
//! if the renderer is correct, W is rarely large (Markov's inequality; Shafer 2021, *Testing by betting*). The test needs no
//! assumption on the distribution of the noise, only that radiance is not negative. A rare firefly of a correct renderer is
//! balanced by all the pixels without one.
//!
//! Too little light cannot be tested with the scatter of the suspect itself, because light that is missing causes no
//! scatter. The variance of the prediction is used instead, times four, because two ways of sampling are not equally noisy
//! everywhere. The lower tail of a sum of non-negative values is no heavier than that of a normal distribution (Maurer
//! 2003). Both tests need a prediction with small errors.

/// The values of λ.
const STAKES: [f64; 4] = [0.003, 0.02, 0.1, 0.4];
/// A pixel of the prediction counts as known if its error is at most this fraction of its value.
const KNOWN: f64 = 0.2;
/// Smallest number of known pixels for a test.
const LEAST: usize = 4;

/// A pixel: S, P and s.
pub(super) type Pixel = [f64; 3];

/// p-value of the hypothesis that the suspect is not brighter than predicted. It is 1 if a value is negative or the
/// prediction is not known well enough.
pub(super) fn excess(pixels: &[Pixel]) -> f64 {
    let mean = pixels.iter().map(|x| x[1]).sum::<f64>() / pixels.len() as f64;
    if pixels.iter().any(|x| x[0] < 0.0 || x[0].is_nan()) {
        return 1.0;
    }
    let known: Vec<f64> = pixels
        .iter()
        .filter(|[_, p, s]| *p > 0.0 && *s <= KNOWN * p)
        .map(|[suspect, p, s]| suspect / (p + 3.0 * s + 0.02 * mean))
        .collect();
    // most of the region must be known
    if known.len() < LEAST || 2 * known.len() < pixels.len() {
        return 1.0;
    }
    let wealth = |stake: f64| known.iter().map(|x| (stake * (x - 1.0)).ln_1p()).sum::<f64>().exp();
    let wealth = STAKES.into_iter().map(wealth).sum::<f64>() / STAKES.len() as f64;
    // factor 2 because this test is used in addition to a t-test: two tests share one probability of error
    (2.0 / wealth).min(1.0)
}

/// p-value of the hypothesis that the suspect is not darker than predicted. `noise` is the variance of the suspect divided
/// by that of the prediction.
pub(super) fn deficit(pixels: &[Pixel], noise: f64) -> f64 {
    let (t, v) = pixels.iter().fold((0.0, 0.0), |a, [suspect, p, s]| (a.0 + p - suspect, a.1 + s * s));
    if t.is_nan() || t <= 0.0 || !noise.is_finite() || v == 0.0 {
        return 1.0;
    }
    (2.0 * (-t * t / (2.0 * v * (1.0 + 4.0 * noise.max(0.0)))).exp()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Key, Purpose, Rng};

    /// Pixels whose value is 1000 with probability `rare`, and otherwise such that the mean is 1.
    fn spiky(seed: u64, rare: f64, factor: f64) -> Vec<Pixel> {
        let key = Key::new(seed, "spikes");
        let left = (1.0 - 1000.0 * rare) / (1.0 - rare);
        let value = |p| if f64::from(Rng::at(key, p, 0, 0, Purpose::Start).one()) < rare { 1000.0 } else { left };
        (0..256).map(|p| [factor * value(p), 1.0, 0.01]).collect()
    }

    #[test]
    fn fireflies_of_a_right_renderer_are_no_excess_and_others_are() {
        // about one picture in five has a firefly, which makes it five times as bright
        let level = 0.05;
        let alarms = (0..400).filter(|s| excess(&spiky(*s, 8e-4, 1.0)) < level).count();
        assert!(alarms <= 20, "{alarms}");
        // eight fireflies that no dark pixels balance
        let mut wrong = spiky(1, 0.0, 1.0);
        (0..8).for_each(|i| wrong[32 * i][0] = 1000.0);
        assert!(excess(&wrong) < 1e-9);
        wrong[3][0] = -1.0;
        assert_eq!(excess(&wrong), 1.0);
        // a prediction with large errors gives no evidence
        let vague: Vec<Pixel> = wrong.iter().map(|x| [x[0].abs(), 1.0, 0.5]).collect();
        assert_eq!(excess(&vague), 1.0);
    }

    #[test]
    fn a_lamp_that_is_not_there_is_a_deficit() {
        let lamp = |seen: f64, error: f64| vec![[seen, 10.0, error], [seen, 10.0, error], [0.0, 0.0, 0.0]];
        assert!(deficit(&lamp(0.0, 0.2), 8.0) < 1e-9);
        assert_eq!(deficit(&lamp(10.0, 0.2), 8.0), 1.0);
        assert_eq!(deficit(&lamp(12.0, 0.2), 8.0), 1.0);
        // a lamp that the prediction itself hit only once
        assert!(deficit(&lamp(0.0, 10.0), 1.0) > 0.1);
    }
}
