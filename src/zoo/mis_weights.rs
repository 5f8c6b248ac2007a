//! Mistakes in the MIS weights: the weights of the two techniques to find light do not sum to one.
//!
//! ```text
//! w_c = p_c/(p_c + p_s)      w_s = p_s/(p_s + p_c)      w_c + w_s = 1 for every path, densities in one measure
//! ```
//!
//! Inside an emitting sphere of radius R both densities are equal, and both weights are ½. With p_A instead of p_ω in w_c,
//! one bounce gives `ρ(½ + 2(a − a² ln(1 + 1/a)))`, a = 1/4R², instead of ρ. For some R this is nearly correct, for others
//! far off.

use super::mistake::Connection;
use super::signature::{flat, unknown};
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;

/// The members of this family.
pub static BUGS: [Bug; 3] = [
    Bug {
        name: "double-emission",
        what: "light is counted by the connection, and again where the path hits the lamp",
        place: "MIS weights: w_c = w_s = 1 instead of w_c + w_s = 1",
        expected: "2 T^k E for k ≥ 1; in a furnace (1 + ρ)/(1 − ρ) instead of 1/(1 − ρ)",
        signature: "flat: 2 at every k ≥ 1",
        ratio: |k| flat(2.0, k),
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 128,
        mistake: &DoubleEmission,
    },
    Bug {
        name: "mixed-measures",
        what: "the MIS weight of the connection mixes a density per area with one per solid angle",
        place: "MIS weights: w_c = p_A/(p_A + p_s) instead of p_ω/(p_ω + p_s); w_s is right",
        expected: "inside an emitting sphere of radius R: ρ(½ + 2(a − a² ln(1 + 1/a))), a = 1/4R², for one bounce",
        signature: "flat in k, near 1 at one scale of the scene, far from it at another",
        ratio: unknown,
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::LARGE_SPHERE,
        blind: Some(Stage::SKY_BOWL),
        spp: 32,
        mistake: &MixedMeasures,
    },
    Bug {
        name: "mixed-heuristics",
        what: "connections are weighted by the power heuristic, hits by the balance heuristic",
        place: "MIS weights: w_c = p_c²/(p_c² + p_s²) together with w_s = p_s/(p_s + p_c): they do not sum to 1",
        expected: "a path whose two densities differ by a factor t counts 1 + (t² − t)/((1 + t²)(1 + t)) times, which is 0.85 to 1.15; in the scene `sphere` t is 10",
        signature: "flat in k: 1.081 on the sphere whose emitting cap is a tenth of its area",
        ratio: |k| flat(1.0 + 90.0 / 1111.0, k),
        technique: Technique::Mis,
        ends: Ends::AsSet,
        exposed_by: Stage::SPHERE,
        blind: Some(Stage::GLASS_BALL),
        spp: 64,
        mistake: &MixedHeuristics,
    },
];

struct DoubleEmission;
impl Mistake for DoubleEmission {
    fn connection_share(&self, _: Technique, _: &Connection, _: f32) -> f32 {
        1.0
    }
    fn hit_share(&self, _: Technique, _: f32, _: f32) -> f32 {
        1.0
    }
}

struct MixedMeasures;
impl Mistake for MixedMeasures {
    fn connection_share(&self, technique: Technique, c: &Connection, other: f32) -> f32 {
        technique.connection(c.per_area.unwrap_or(c.per_angle), other)
    }
}

struct MixedHeuristics;
impl Mistake for MixedHeuristics {
    fn connection_share(&self, _: Technique, c: &Connection, other: f32) -> f32 {
        Technique::Power.connection(c.per_angle, other)
    }
}
