//! Mistakes that put a wrong constant into `f cos θ/p`.
//!
//! ```text
//! f = ρ/π      ∫ f cos θ dω = ρ      p = cos θ/π  or  1/2π
//! ```
//!
//! | member | result in a furnace with E = 1 |
//! |---|---|
//! | missing-pi | T^k E = (πρ)^k |
//! | half-bounce | with BSDF sampling only, (ρ/2)^k |
//! | cosine-twice | (2ρ/3)^k, because E[cos θ] = ⅔ for cosine-distributed directions |
//! | cosine-missing | (2ρ)^k |

use super::signature::{flat, per_bounce, per_reflection, unknown};
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::math::Rgb;
use crate::math::direction::uniform_hemisphere;
use crate::scene::bsdf::Sampling;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The members of this family.
pub static BUGS: [Bug; 5] = [
    Bug {
        name: "missing-pi-connection",
        what: "the BSDF in the light connection is not divided by π",
        place: "connection: f cos θ_x E/p_ω with f = ρ instead of ρ/π; the bounce is right",
        expected: "π T^k E for k ≥ 1",
        signature: "flat: π at every k ≥ 1",
        ratio: |k| flat(std::f64::consts::PI, k),
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 16,
        mistake: &MissingPiConnection,
    },
    Bug {
        name: "missing-pi",
        what: "the Lambertian BSDF is ρ instead of ρ/π, everywhere",
        place: "BSDF: f = ρ instead of ρ/π, in the connection and in the bounce",
        expected: "π^k T^k E; in a furnace (πρ)^k",
        signature: "a straight line in log r_k: π^k",
        ratio: |k| per_reflection(std::f64::consts::PI, k),
        technique: Technique::Connect,
        ends: Ends::AtK,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 16,
        mistake: &MissingPi,
    },
    Bug {
        name: "half-bounce",
        what: "the assumed density of the bounce is twice too large, so that every bounce counts half",
        place: "bounce: α ← α f cos θ/(2p) instead of α f cos θ/p; direct light is right",
        expected: "2^−(k−1) T^k E for k ≥ 1, with next-event estimation",
        signature: "a straight line in log r_k from k = 1 on: (1/2)^(k−1)",
        ratio: |k| per_bounce(0.5, k),
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 32,
        mistake: &HalfBounce,
    },
    Bug {
        name: "cosine-twice",
        what: "directions are sampled with the cosine, and the weight contains the cosine once more",
        place: "bounce: α ← α ρ cos θ instead of α ρ",
        expected: "in a furnace with BSDF sampling only: (2ρ/3)^k, with the sum 1/(1 − 2ρ/3)",
        signature: "1 at k = 1, then falling, about (2/3)^(k−1); strongest where light arrives at grazing angles",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 64,
        mistake: &CosineTwice,
    },
    Bug {
        name: "cosine-missing",
        what: "directions are sampled uniformly, and the cosine of the rendering equation is missing",
        place: "bounce: α ← α f · 2π instead of α f cos θ · 2π",
        expected: "in a furnace with BSDF sampling only: (2ρ)^k, a divergent series for ρ ≥ ½",
        signature: "1 at k = 1, then growing, about 2^(k−1)",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AtK,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 64,
        mistake: &CosineMissing,
    },
];

struct MissingPiConnection;
impl Mistake for MissingPiConnection {
    fn connection(&self, value: Rgb) -> Rgb {
        value * PI
    }
}

struct MissingPi;
impl Mistake for MissingPi {
    fn lambert(&self, rho: Rgb) -> Rgb {
        rho
    }
}

struct HalfBounce;
impl Mistake for HalfBounce {
    fn bounce(&self, f: Rgb, cosine: f32, p: f32) -> Rgb {
        f * (cosine / (2.0 * p))
    }
}

struct CosineTwice;
impl Mistake for CosineTwice {
    fn bounce(&self, f: Rgb, cosine: f32, p: f32) -> Rgb {
        f * (cosine * cosine / p)
    }
}

struct CosineMissing;
impl Mistake for CosineMissing {
    fn direction(&self, n: Vec3, _: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        (uniform_hemisphere(n, u).0, 1.0 / TAU)
    }
    fn bounce(&self, f: Rgb, _: f32, p: f32) -> Rgb {
        f * (1.0 / p)
    }
}
