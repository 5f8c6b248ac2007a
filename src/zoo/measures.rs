//! A density per area where one per solid angle belongs: parts of the Jacobian are missing.
//!
//! ```text
//! p_ω = p_A r²/cos θ_y      f cos θ_x E/p_ω = f E cos θ_x cos θ_y/(r² p_A)
//! ```
//!
//! None of them is the same in a scene ten times as large, and none shows under a sky, whose density is per solid angle from the start.
//! Inside a sphere of radius R that glows, one bounce gives 2ρ without cos θ_y, 2ρR² without 1/r², 8ρR²/3 without both; under a disk of
//! radius R at height h, d² = h² + R²: `2(1 − h/d)`, `h² ln(1 + R²/h²)`, `2h(d − h)` instead of `R²/d²`.

use super::mistake::Connection;
use super::signature::unknown;
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;

/// The members.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "area-density",
        what: "the density of the light point per area is used as one per solid angle",
        place: "connection: f cos θ_x E/p_A instead of f cos θ_x E/p_ω, p_ω = p_A r²/cos θ_y",
        expected: "inside a glowing sphere of radius R: 8ρR²/3 for one bounce instead of ρ",
        signature: "about flat in k, but not in space: least under the light, and it grows with the scale of the scene",
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
        expected: "inside a glowing sphere of radius R: 2ρR² for one bounce instead of ρ",
        signature: "about flat in k; darker near the light, brighter far from it, and it grows with the scale of the scene",
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
        expected: "inside a glowing sphere: 2ρ for one bounce instead of ρ",
        signature: "about flat in k; most where light leaves the lamp at a grazing angle",
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
        signature: "about flat in k; most where light arrives at a grazing angle: on the walls",
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
