//! Mistakes in direction sampling: the true density of a direction differs from the one the estimator assumes.
//!
//! ```text
//! assumed p = cos θ/π, weight ρ       sampled: uniform, or on a disk with radius u instead of √u, or with θ uniform
//! ```
//!
//! In a furnace the directions of rays have no effect. It therefore hides all members but `cosine-as-uniform`, whose weight
//! 2ρ cos θ has the mean 4ρ/3. A sphere lit by its cap hides them, too, because all its points are equivalent. Under a disk
//! of radius R at height h, with d² = h² + R², the correct value R²/d² becomes `1 − h/d`, `R/d` and `(2/π) atan(R/h)`.

use super::signature::unknown;
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::math::direction::{about, cos_sin_turn, cosine_hemisphere, uniform_hemisphere};
use crate::scene::bsdf::Sampling;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

/// The members of this family.
pub static BUGS: [Bug; 4] = [
    Bug {
        name: "malley-without-root",
        what: "the disk that is projected to the hemisphere is sampled with radius u instead of √u",
        place: "direction: sin θ = u instead of √u, assumed p = cos θ/π",
        expected: "under a disk of radius R at height h: R/d instead of R²/d², d² = h² + R²",
        signature: "above 1 where light arrives along the normal, below 1 where it arrives from the side; small in a bright room",
        ratio: unknown,
        technique: Technique::Scatter,
        ends: Ends::AsSet,
        exposed_by: Stage::DISK,
        blind: Some(Stage::FURNACE),
        spp: 32,
        mistake: &MalleyWithoutRoot,
    },
    Bug {
        name: "uniform-theta",
        what: "the polar angle is uniform, but weighted as if directions had density cos θ/π",
        place: "direction: θ = (π/2) u instead of asin √u, assumed p = cos θ/π",
        expected: "under a disk of radius R at height h: (2/π) atan(R/h) instead of R²/d², d² = h² + R²",
        signature: "above 1 where light arrives along the normal or grazing, below 1 between; small in a bright room",
        ratio: unknown,
        technique: Technique::Scatter,
        ends: Ends::AsSet,
        exposed_by: Stage::DISK,
        blind: Some(Stage::FURNACE),
        spp: 64,
        mistake: &UniformTheta,
    },
    Bug {
        name: "uniform-as-cosine",
        what: "directions are uniform, but weighted as if they had density cos θ/π",
        place: "direction: p = 1/2π, assumed cos θ/π",
        expected: "under a disk of radius R at height h: 1 − h/d instead of R²/d², d² = h² + R²",
        signature: "1 at k = 1; then too bright where light arrives at grazing angles, too dark where it arrives along the normal",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SPHERE),
        spp: 256,
        mistake: &UniformAsCosine,
    },
    Bug {
        name: "cosine-as-uniform",
        what: "directions have density cos θ/π, but are weighted as if they were uniform",
        place: "direction: p = cos θ/π, assumed 1/2π",
        expected: "in a furnace with BSDF sampling only: (4ρ/3)^k, with the sum 1/(1 − 4ρ/3)",
        signature: "1 at k = 1, then growing, about (4/3)^(k−1)",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AtK,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::GLASS_BALL),
        spp: 64,
        mistake: &CosineAsUniform,
    },
];

struct UniformAsCosine;
impl Mistake for UniformAsCosine {
    fn direction(&self, n: Vec3, _: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        let (d, cosine) = uniform_hemisphere(n, u);
        (d, cosine * FRAC_1_PI)
    }
}

struct CosineAsUniform;
impl Mistake for CosineAsUniform {
    fn direction(&self, n: Vec3, _: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        (cosine_hemisphere(n, u).0, 1.0 / TAU)
    }
}

struct MalleyWithoutRoot;
impl Mistake for MalleyWithoutRoot {
    fn direction(&self, n: Vec3, _: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        let ((cos, sin), r) = (cos_sin_turn(u[1]), u[0]);
        let z = (1.0 - r * r).sqrt();
        (about(n, r * cos, r * sin, z), z * FRAC_1_PI)
    }
}

struct UniformTheta;
impl Mistake for UniformTheta {
    fn direction(&self, n: Vec3, _: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        let ((cos, sin), (r, z)) = (cos_sin_turn(u[1]), (FRAC_PI_2 * u[0]).sin_cos());
        (about(n, r * cos, r * sin, z), z * FRAC_1_PI)
    }
}
