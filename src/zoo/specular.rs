//! Mirrors and glass.
//!
//! ```text
//! weight = F/p or (1 − F)/(1 − p) · 1/η²      emission counts after a delta vertex: no connection finds what it shows
//! ```
//!
//! Along a ray that meets a ball of glass with reflectance R in a sky of radiance 1, T¹ = R and T^k = (1 − R)² R^(k−2); without the
//! probability of choice every meeting halves them: `R/2 + (1 − R)²/(4(1 − R/2))` in all. With η² counted on the way in only: `R + (1 − R)/η²`.

use super::signature::{per_reflection, unknown};
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::scene::bsdf::dielectric::{Odds, SmoothDielectric};
use crate::scene::bsdf::{BsdfSample, TransportMode};
use glam::Vec3;

/// The members.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "no-emission-after-mirror",
        what: "emission is never counted on a hit, not even after a mirror or glass",
        place: "shares: w_s = 0 where no connection can find the light, instead of 1",
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
        what: "reflection or refraction is chosen by a coin, and not divided by its ½",
        place: "glass: weight F or 1 − F instead of 2F or 2(1 − F)",
        expected: "2^−k T^k E of a ball in a white sky: R/2 + (1 − R)²/(4(1 − R/2)) in all, instead of 1",
        signature: "straight in log r_k: (1/2)^k where all is glass",
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
        what: "radiance is divided by η² where light goes in, and not multiplied where it comes out",
        place: "glass: the factor 1/η² is left out on the way out of the denser side",
        expected: "T^k E/η² for k ≥ 2 of a ball in a white sky: R + (1 − R)/η² in all, instead of 1",
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
        what: "a path ends where glass reflects totally",
        place: "glass: no sample where Snell's law has no solution, instead of a reflection with weight 1",
        expected: "black cores and rims in whatever has corners; a ball seen from outside never reflects totally inside",
        signature: "1 up to k = 1, then below 1, falling with k",
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
