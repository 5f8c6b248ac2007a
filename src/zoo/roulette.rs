//! Mistakes in Russian roulette: survivors get a weight other than 1/s.
//!
//! ```text
//! E[ X 1{survives}/s ] = X,      s = 1 − q;      any other weight w leaves a factor s w per test
//! ```
//!
//! The test at vertex v comes after v has been scored. With next-event estimation, term k has therefore passed k − 1 tests.
//! In a furnace with BSDF sampling only, it has passed k tests: the result is `Σ (ρ s)^k` without a weight, and
//! `Σ (ρ s/q)^k` if it is divided by q.

use super::signature::{flat, per_bounce};
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;

/// The members of this family.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "roulette-unweighted",
        what: "survivors of Russian roulette are not weighted",
        place: "roulette: α ← α instead of α/s, s = 1 − q; here q = 0.3 at every vertex",
        expected: "s^(k−1) T^k E for k ≥ 1; in a furnace with BSDF sampling only, Σ (ρ s)^k = 1/(1 − ρ s)",
        signature: "a straight line in log r_k from k = 1 on: s^(k−1) = 0.7^(k−1)",
        ratio: |k| per_bounce(0.7, k),
        technique: Technique::Connect,
        ends: Ends::Roulette(0.3),
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 32,
        mistake: &Unweighted,
    },
    Bug {
        name: "roulette-weighted-twice",
        what: "survivors of Russian roulette are weighted twice",
        place: "roulette: α ← α/s² instead of α/s, s = 1 − q; here q = 0.1 at every vertex",
        expected: "s^−(k−1) T^k E for k ≥ 1",
        signature: "a straight line in log r_k from k = 1 on: s^−(k−1) = 1.11^(k−1)",
        ratio: |k| per_bounce(1.0 / 0.9, k),
        technique: Technique::Connect,
        ends: Ends::Roulette(0.1),
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 256,
        mistake: &Twice,
    },
    Bug {
        name: "roulette-divides-by-q",
        what: "survivors are divided by the probability of termination instead of that of survival",
        place: "roulette: α ← α/q instead of α/(1 − q); here q = 0.6 at every vertex; at q = ½ the mistake has no effect",
        expected: "(s/q)^(k−1) T^k E for k ≥ 1; in a furnace with BSDF sampling only, the sum 1/(1 − s ρ/q)",
        signature: "a straight line in log r_k from k = 1 on: (s/q)^(k−1) = 0.67^(k−1)",
        ratio: |k| per_bounce(0.4 / 0.6, k),
        technique: Technique::Connect,
        ends: Ends::Roulette(0.6),
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 64,
        mistake: &ByQ,
    },
    Bug {
        name: "roulette-before-light",
        what: "the roulette test comes before the light sample, its weight is applied after it",
        place: "order: test, score, weight instead of score, test, weight; here q = 0.3 at every vertex",
        expected: "s T^k E for k ≥ 1; inside an emitting sphere 1 + s ρ/(1 − ρ)",
        signature: "flat: s = 0.7 at every k ≥ 1",
        ratio: |k| flat(0.7, k),
        technique: Technique::Connect,
        ends: Ends::Roulette(0.3),
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::BLACK_ROOM),
        spp: 32,
        mistake: &BeforeLight,
    },
];

struct Unweighted;
impl Mistake for Unweighted {
    fn survivor(&self, _: f32) -> f32 {
        1.0
    }
}

struct Twice;
impl Mistake for Twice {
    fn survivor(&self, s: f32) -> f32 {
        1.0 / (s * s)
    }
}

struct ByQ;
impl Mistake for ByQ {
    fn survivor(&self, s: f32) -> f32 {
        1.0 / (1.0 - s)
    }
}

struct BeforeLight;
impl Mistake for BeforeLight {
    fn roulette_before_light(&self) -> bool {
        true
    }
}
