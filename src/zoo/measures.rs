//! Mistakes of measure: a density per area is used instead of one per solid angle, so that parts of the Jacobian are
//! missing.
//!
//! ```text
//! p_ω = p_A r²/cos θ_y      f cos θ_x E/p_ω = f E cos θ_x cos θ_y/(r² p_A)
//! ```
//!
//! Without 1/r², the image depends on the scale: in a scene ten times as large, direct light is a hundred times as bright. A
//! missing cosine alone has no unit, so that it gives the same wrong image at every scale. None of these mistakes shows under
//! a sky, because the density of the sky is per solid angle from the start.
//!
//! Inside an emitting sphere of radius R, one bounce should give ρ. It gives 2ρ without cos θ_y, 2ρR² without 1/r², and
//! 8ρR²/3 without both. Under a disk of radius R at height h, with d² = h² + R², direct light should be `R²/d²`. It is
//! `2(1 − h/d)` without one cosine, `h² ln(1 + R²/h²)` without 1/r², and `2h(d − h)` without both.

use super::mistake::Connection;
use super::signature::unknown;
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;

/// The members of this family.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "area-density",
        what: "the density of the light point per area is used as if it were per solid angle",
        place: "connection: f cos θ_x E/p_A instead of f cos θ_x E/p_ω, p_ω = p_A r²/cos θ_y",
        expected: "inside an emitting sphere of radius R, one bounce of this mistake gives 8ρR²/3 where ρ is correct",
        signature: "about flat in k, but not in space: smallest under the light; it grows with the scale of the scene",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SKY_BOWL),
        spp: 16,
        mistake: &AreaDensity,
    },
    Bug {
        name: "no-inverse-square",
        what: "the connection lacks 1/r²",
        place: "connection: f E cos θ_x cos θ_y/p_A instead of f E cos θ_x cos θ_y/(r² p_A)",
        expected: "inside an emitting sphere of radius R: 2ρR² for one bounce instead of ρ",
        signature: "about flat in k; too dark near the light, too bright far from it; it grows with the scale of the scene",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SKY_BOWL),
        spp: 16,
        mistake: &NoInverseSquare,
    },
    Bug {
        name: "no-light-cosine",
        what: "the connection lacks the cosine at the light",
        place: "connection: f E cos θ_x/(r² p_A) instead of f E cos θ_x cos θ_y/(r² p_A)",
        expected: "inside an emitting sphere: 2ρ for one bounce instead of ρ",
        signature: "about flat in k; strongest where light leaves the lamp at a grazing angle",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SKY_BOWL),
        spp: 32,
        mistake: &NoLightCosine,
    },
    Bug {
        name: "no-receiver-cosine",
        what: "the connection lacks the cosine at the surface",
        place: "connection: f E cos θ_y/(r² p_A) instead of f E cos θ_x cos θ_y/(r² p_A)",
        expected: "under a disk of radius R at height h: 2(1 − h/d) instead of R²/d², d² = h² + R²",
        signature: "about flat in k; strongest where light arrives at a grazing angle: on the walls",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 32,
        mistake: &NoReceiverCosine,
    },
];

struct AreaDensity;
impl Mistake for AreaDensity {
    fn density(&self, c: &Connection) -> f32 {
        c.per_area.unwrap_or(c.per_angle)
    }
}

struct NoInverseSquare;
impl Mistake for NoInverseSquare {
    fn density(&self, c: &Connection) -> f32 {
        c.per_area.map_or(c.per_angle, |p| p / c.cos_y)
    }
}

struct NoLightCosine;
impl Mistake for NoLightCosine {
    fn density(&self, c: &Connection) -> f32 {
        c.per_area.map_or(c.per_angle, |p| p * c.r2)
    }
}

struct NoReceiverCosine;
impl Mistake for NoReceiverCosine {
    fn receiver_cosine(&self, _: f32) -> f32 {
        1.0
    }
}
