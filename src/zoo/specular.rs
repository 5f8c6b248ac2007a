//! Mistakes at mirrors and glass.
//!
//! ```text
//! weight = F/p or (1 − F)/(1 − p) · 1/η²      emission counts after a delta vertex: no connection finds what it shows
//! ```
//!
//! Consider a ray that meets a glass ball with reflectance R in a sky of radiance 1. Then T¹ = R and T^k = (1 − R)² R^(k−2)
//! for k ≥ 2. If the sample is not divided by the probability ½ of its choice, every interface halves the terms. The sum is
//! then `R/2 + (1 − R)²/(4(1 − R/2))`. If the factor η² is applied only where the path enters the glass, the sum is
//! `R + (1 − R)/η²`.

use super::signature::{per_reflection, unknown};
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::scene::bsdf::dielectric::{Odds, SmoothDielectric};
use crate::scene::bsdf::{BsdfSample, TransportMode};
use glam::Vec3;

/// The members of this family.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "no-emission-after-mirror",
        what: "emission is never counted on a hit, not even after a mirror or glass",
        place: "MIS weights: w_s = 0 where no connection can find the light, instead of 1",
        expected: "lamps are black in mirrors, and there are no caustics",
        signature: "below 1 from k = 1 on; 0 in mirrors at k = 1",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL_SPHERES,
        blind: Some(Stage::CORNELL),
        spp: 256,
        mistake: &NoEmissionAfterMirror,
    },
    Bug {
        name: "glass-without-choice",
        what: "reflection or refraction is chosen with probability ½, but not divided by it",
        place: "glass: weight F or 1 − F instead of 2F or 2(1 − F)",
        expected: "2^−k T^k E for a ball in a white sky; the sum is R/2 + (1 − R)²/(4(1 − R/2)) instead of 1",
        signature: "a straight line in log r_k: (1/2)^k where all surfaces are glass",
        ratio: |k| per_reflection(0.5, k),
        technique: Technique::Connect,
        ends: Ends::AtK,
        exposed_by: Stage::GLASS_BALL,
        blind: Some(Stage::CORNELL),
        spp: 16,
        mistake: &GlassWithoutChoice,
    },
    Bug {
        name: "eta-squared-once",
        what: "radiance is divided by η² where a path enters glass, not multiplied where it leaves",
        place: "glass: the factor η² of refraction is left out where a path leaves the denser side",
        expected: "T^k E/η² for k ≥ 2 of a ball in a white sky; the sum is R + (1 − R)/η² instead of 1",
        signature: "1 at k = 0 and 1, then flat: 1/η² = 0.44",
        ratio: |k| Some(if k < 2 { 1.0 } else { 1.0 / 2.25 }),
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::GLASS_BALL,
        blind: Some(Stage::CORNELL),
        spp: 16,
        mistake: &EtaSquaredOnce,
    },
    Bug {
        name: "total-reflection-dropped",
        what: "paths end at a total reflection inside glass",
        place: "glass: no sample where Snell's law has no solution, instead of a reflection with weight 1",
        expected: "black areas in glass objects with corners; in a ball seen from outside, no total reflection occurs",
        signature: "r_k = 1 for k = 0 and 1, then r_k < 1 and falls with k",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AtK,
        exposed_by: Stage::GLASS_CUBE,
        blind: Some(Stage::GLASS_BALL),
        spp: 32,
        mistake: &TotalReflectionDropped,
    },
];

struct NoEmissionAfterMirror;
impl Mistake for NoEmissionAfterMirror {
    fn hit_share(&self, technique: Technique, p: f32, other: f32) -> f32 {
        if other == 0.0 { 0.0 } else { technique.hit(p, other) }
    }
}

struct GlassWithoutChoice;
impl Mistake for GlassWithoutChoice {
    fn glass(&self, glass: &SmoothDielectric, wo: Vec3, u: f32) -> Option<BsdfSample> {
        let s = SmoothDielectric { odds: Odds::Constant(0.5), ..*glass }.choose(wo, TransportMode::Radiance, u);
        Some(BsdfSample { weight: s.weight * s.pdf, ..s })
    }
}

struct EtaSquaredOnce;
impl Mistake for EtaSquaredOnce {
    fn glass(&self, glass: &SmoothDielectric, wo: Vec3, u: f32) -> Option<BsdfSample> {
        let s = glass.choose(wo, TransportMode::Radiance, u);
        let out = s.wi.z < 0.0 && glass.interface.eta < 1.0;
        Some(if out { BsdfSample { weight: s.weight * glass.interface.eta2(), ..s } } else { s })
    }
}

struct TotalReflectionDropped;
impl Mistake for TotalReflectionDropped {
    fn glass(&self, glass: &SmoothDielectric, wo: Vec3, u: f32) -> Option<BsdfSample> {
        glass.interface.refracted(wo.z)?;
        Some(glass.choose(wo, TransportMode::Radiance, u))
    }
}
