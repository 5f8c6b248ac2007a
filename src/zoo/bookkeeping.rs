//! Mistakes after the light has been found correctly: terms lost or misnumbered, values clamped, encoded, repeated or
//! undefined.
//!
//! ```text
//! L = Σ_k T^k E      mean of N independent samples: variance σ²/N      E[g(X)] ≠ g(E[X]) for a nonlinear g
//! ```
//!
//! Sums in a furnace with E = 1: truncated after term n, `(1 − ρ^(n+1))/(1 − ρ)`; without direct emission, `ρ/(1 − ρ)`; one
//! bounce short, `(1 − ρ^K)/(1 − ρ)`.

use super::signature::unknown;
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::math::Rgb;

/// The last term that `truncated` keeps.
const DEEPEST: usize = 3;
/// The exponent with which `gamma-before-mean` encodes samples.
const GAMMA: f32 = 2.2;
/// Number of different samples per pixel of `same-numbers`.
pub const DIFFERENT: u32 = 16;

/// The members of this family.
pub static BUGS: [Bug; 8] = [
    Bug {
        name: "truncated",
        what: "paths stop after three bounces, and the result is taken for the whole image",
        place: "loop: Σ_{k≤3} T^k E instead of Σ_k T^k E",
        expected: "in a furnace (1 − ρ⁴)/(1 − ρ)",
        signature: "1 up to k = 3, then 0",
        ratio: |k| Some(if k <= DEEPEST { 1.0 } else { 0.0 }),
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 64,
        mistake: &Truncated(DEEPEST),
    },
    Bug {
        name: "one-bounce-short",
        what: "K bounces are requested, but the loop ends one bounce early",
        place: "loop: k < K instead of k ≤ K, without a tail",
        expected: "in a furnace (1 − ρ^K)/(1 − ρ)",
        signature: "1 up to k = K − 1, then 0",
        ratio: unknown,
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 64,
        mistake: &OneBounceShort,
    },
    Bug {
        name: "off-by-one",
        what: "terms are numbered from 1: direct emission is written as k = 1",
        place: "numbering: T^k E in slot k + 1",
        expected: "T^(k−1) E in place of T^k E; the whole image is correct",
        signature: "0 at k = 0, then T^(k−1) E/T^k E: the terms are shifted by one",
        ratio: unknown,
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: None,
        spp: 16,
        mistake: &OffByOne,
    },
    Bug {
        name: "emission-missing",
        what: "the emission of surfaces that the eye sees directly is left out",
        place: "start: X_0 = 0 instead of E(x_0)",
        expected: "in a furnace ρ/(1 − ρ) instead of 1/(1 − ρ)",
        signature: "r_0 = 0, and r_k = 1 for all other k",
        ratio: |k| Some(if k == 0 { 0.0 } else { 1.0 }),
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SKY_BOWL),
        spp: 16,
        mistake: &EmissionMissing,
    },
    Bug {
        name: "clamped",
        what: "samples are clamped at 0.5 to avoid fireflies, each term and the sum of all",
        place: "sample: min(X, c) instead of X, c = 0.5",
        expected: "in a furnace min(ρ^k, c) for each term, min(1/(1 − ρ), c) for the sum",
        signature: "below 1 where light is bright or rarely found, closer to 1 for larger k; the same for any number of samples",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::DIM_SPHERE),
        spp: 16,
        mistake: &Clamped(0.5),
    },
    Bug {
        name: "gamma-before-mean",
        what: "samples are gamma-encoded before they are averaged, and written as if linear",
        place: "sample: X^(1/2.2) instead of X, each term and the sum of all",
        expected: "in a furnace ρ^(k/2.2) for each term, (1 − ρ)^(−1/2.2) for the sum",
        signature: "above 1 where samples are below 1, and growing with k; the terms do not sum to the whole",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 16,
        mistake: &GammaBeforeMean,
    },
    Bug {
        name: "same-numbers",
        what: "the random generator restarts every 16 samples, so that the same samples repeat",
        place: "random numbers: sample i mod 16 instead of i",
        expected: "means are correct; the variance stays that of 16 samples instead of falling as 1/N",
        signature: "1 at every k, but more samples change nothing: slope 0 instead of −1",
        ratio: |_| Some(1.0),
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 256,
        mistake: &SameNumbers,
    },
    Bug {
        name: "not-a-number",
        what: "a light that faces away has density 0, and the resulting 0/0 is added to the image",
        place: "connection: f cos θ_x E/p_ω with E = 0 and p_ω = 0, instead of no sample",
        expected: "pixels that are NaN",
        signature: "NaN wherever the front of the lamp cannot be seen",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SPHERE),
        spp: 16,
        mistake: &NotANumber,
    },
];

/// Paths stop after this many bounces.
pub struct Truncated(pub usize);
impl Mistake for Truncated {
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        (k <= self.0).then_some(k.min(max_bounces + 1))
    }
}

struct OneBounceShort;
impl Mistake for OneBounceShort {
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        (k < max_bounces).then_some(k)
    }
}

struct OffByOne;
impl Mistake for OffByOne {
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        Some((k + 1).min(max_bounces + 1))
    }
}

struct EmissionMissing;
impl Mistake for EmissionMissing {
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        (k > 0).then_some(k.min(max_bounces + 1))
    }
}

/// Samples are clamped at this value.
pub struct Clamped(pub f32);
impl Mistake for Clamped {
    fn finish(&self, value: Rgb) -> Rgb {
        value.min(Rgb::splat(self.0))
    }
    fn finishes(&self) -> bool {
        true
    }
}

struct GammaBeforeMean;
impl Mistake for GammaBeforeMean {
    fn finish(&self, value: Rgb) -> Rgb {
        value.powf(1.0 / GAMMA)
    }
    fn finishes(&self) -> bool {
        true
    }
}

struct SameNumbers;
impl Mistake for SameNumbers {
    fn address(&self, pixel: u32, sample: u32) -> (u32, u32) {
        (pixel, sample % DIFFERENT)
    }
}

struct NotANumber;
impl Mistake for NotANumber {
    fn averted(&self) -> Rgb {
        Rgb::ZERO / 0.0
    }
}
