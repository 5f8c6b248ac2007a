//! Too much or too little light where few pixels carry all the noise, and no t-test can be trusted.
//!
//! ```text
//! too much:    W = mean over λ of Π_i (1 + λ (S_i/μ_i − 1)),   S_i ≥ 0, E S_i ≤ μ_i   ⟹   E W ≤ 1,   P(W ≥ 1/p) ≤ p
//! too little:  p = exp(−t²/2V),   t = Σ (P_i − S_i),   V = (1 + 4ν) Σ s_i²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S_i | a pixel of the suspect | argument |
//! | P_i, s_i | what an explanation predicts for it, with its standard error | argument |
//! | μ_i | P_i + 3 s_i, and a fiftieth of the mean of the region: no pixel is thought darker than it may be | [`excess`] |
//! | λ | what is staked on a pixel | [`STAKES`] |
//! | ν | variance of the suspect over that of the prediction, the median of the regions | argument of [`deficit`] |
//!
//! Too much is judged by betting on it: radiance is not negative, so that no law of its noise is needed, and the rarest firefly of
//! a right renderer is paid for by all the pixels without one (Markov's inequality; Shafer 2021, *Testing by betting*). Too little
//! does not show in the suspect's own scatter: what it misses has no noise. Its variance is taken from the prediction instead,
//! four times over, since two ways of sampling are not equally noisy everywhere; the lower tail of a sum that cannot be negative is
//! no heavier than that of a normal one (Maurer 2003). Both ask for a prediction that is itself well known.

/// λ.
const STAKES: [f64; 4] = [0.003, 0.02, 0.1, 0.4];
/// A pixel of the prediction is known if its error is at most this part of it.
const KNOWN: f64 = 0.2;
/// Fewer known pixels are no ground to stand on.
const LEAST: usize = 4;

/// A pixel: S, P, s.
pub(super) type Pixel = [f64; 3];

/// p-value of a suspect that is no brighter than predicted; 1 if a value is negative or the prediction is not known.
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
    // beside the t-test, that is used where it can be: two tests, one chance of error
    (2.0 / wealth).min(1.0)
}

/// p-value of a suspect that is no darker than predicted, whose variance is `noise` times that of the prediction.
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

    /// Pixels whose samples are 1000 with probability `rare` and else what is left of a mean of 1.
    fn spiky(seed: u64, rare: f64, factor: f64) -> Vec<Pixel> {
        let key = Key::new(seed, "spikes");
        let left = (1.0 - 1000.0 * rare) / (1.0 - rare);
        let value = |p| if f64::from(Rng::at(key, p, 0, 0, Purpose::Start).one()) < rare { 1000.0 } else { left };
        (0..256).map(|p| [factor * value(p), 1.0, 0.01]).collect()
    }

    #[test]
    fn fireflies_of_a_right_renderer_are_no_excess_and_others_are() {
        // about one picture in five has a firefly that makes it five times as bright
        let level = 0.05;
        let alarms = (0..400).filter(|s| excess(&spiky(*s, 8e-4, 1.0)) < level).count();
        assert!(alarms <= 20, "{alarms}");
        // eight fireflies that nothing pays for
        let mut wrong = spiky(1, 0.0, 1.0);
        (0..8).for_each(|i| wrong[32 * i][0] = 1000.0);
        assert!(excess(&wrong) < 1e-9);
        wrong[3][0] = -1.0;
        assert_eq!(excess(&wrong), 1.0);
        // a prediction that is not known forbids nothing
        let vague: Vec<Pixel> = wrong.iter().map(|x| [x[0].abs(), 1.0, 0.5]).collect();
        assert_eq!(excess(&vague), 1.0);
    }

    #[test]
    fn a_lamp_that_is_not_there_is_a_deficit() {
        let lamp = |seen: f64, error: f64| vec![[seen, 10.0, error], [seen, 10.0, error], [0.0, 0.0, 0.0]];
        assert!(deficit(&lamp(0.0, 0.2), 8.0) < 1e-9);
        assert_eq!(deficit(&lamp(10.0, 0.2), 8.0), 1.0);
        assert_eq!(deficit(&lamp(12.0, 0.2), 8.0), 1.0);
        // one that the prediction itself met once
        assert!(deficit(&lamp(0.0, 10.0), 1.0) > 0.1);
    }
}
