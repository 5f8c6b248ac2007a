//! Mistakes in light sampling: the choice of the light, the point on it, visibility, and the emitting side.
//!
//! ```text
//! T E = Σ_i P_i E[ f cos θ E(y)/(P_i p_ω) V ]
//! ```
//!
//! Here P_i is the probability of light i of n, and D_i its direct light. If lights are chosen with P_i but divided by 1/n,
//! the result is `n Σ P_i D_i` instead of `Σ D_i`.
//!
//! On a disk light of radius R at height h, the radius u instead of √u gives `(R²/2)(1/d² + atan(R/h)/(Rh))` instead of
//! R²/d², with d² = h² + R².
//!
//! A sky of constant radiance that is sampled with uniform θ and φ has the density 1/(2π² sin θ). If it is divided by 1/4π,
//! an open floor receives 4ρ/π instead of ρ.

use super::signature::unknown;
use super::{Bug, Ends, Mistake, Stage};
use crate::estimator::Technique;
use crate::scene::{ESCAPED, LightSample, Scene, Vertex};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// The members of this family.
pub static BUGS: [Bug; 6] = [
    Bug {
        name: "wrong-light-choice",
        what: "lights are chosen by their power, but divided by 1/n",
        place: "choice: P_i = Φ_i/ΣΦ, believed 1/n",
        expected: "n Σ P_i D_i instead of Σ D_i, with D_i the direct light of light i",
        signature: "about flat in k; bright lamps too bright, dim lamps too dim",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::MANY_LIGHTS,
        blind: Some(Stage::CORNELL),
        spp: 32,
        mistake: &WrongLightChoice,
    },
    Bug {
        name: "light-choice-off-by-one",
        what: "the light after the chosen one is used: never the first, the last twice as often",
        place: "choice: i + 1 instead of i, at most n, divided by the probability of i",
        expected: "Σ D_i − D_1 + D_n",
        signature: "about flat in k; the light of one lamp is missing, that of another counts twice",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::TWO_LAMPS,
        blind: Some(Stage::CORNELL),
        spp: 32,
        mistake: &LightChoiceOffByOne,
    },
    Bug {
        name: "disk-light-without-root",
        what: "sample points on a disk light cluster at its centre: radius u instead of √u",
        place: "light point: r = R u instead of R √u, assumed density 1/πR²",
        expected: "under a disk of radius R at height h: (R²/2)(1/d² + atan(R/h)/(Rh)) instead of R²/d², d² = h² + R²",
        signature: "about flat in k; too bright under the middle of the lamp, too dark at its side",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::DISK,
        blind: Some(Stage::SPHERE),
        spp: 128,
        mistake: &DiskLightWithoutRoot,
    },
    Bug {
        name: "no-shadow-test",
        what: "connections are made without a shadow test",
        place: "connection: V = 1",
        expected: "direct light without shadows: ρ E F(x → light) with the whole light in view",
        signature: "above 1, about flat in k; the excess lies where there should be shadow",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::CORNELL,
        blind: Some(Stage::SPHERE),
        spp: 64,
        mistake: &NoShadowTest,
    },
    Bug {
        name: "light-from-behind",
        what: "a lamp that should emit only from its front also emits from its back",
        place: "connection: |cos θ_y| instead of max(0, cos θ_y)",
        expected: "T E + ρ E F(x → back of the light)",
        signature: "above 1, largest at k = 1; the excess lies on surfaces behind the lamp",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::LOW_LAMP,
        blind: Some(Stage::SPHERE),
        spp: 64,
        mistake: &LightFromBehind,
    },
    Bug {
        name: "sky-without-sine",
        what: "sky directions are sampled with uniform angles, without the sine of the polar angle",
        place: "sky: θ = π u, density 1/(2π² sin θ), assumed density 1/4π",
        expected: "an open floor under a constant sky: 4ρ/π instead of ρ",
        signature: "flat in k; too bright where light comes from the poles of the sky, too dark from its horizon",
        ratio: unknown,
        technique: Technique::Connect,
        ends: Ends::AsSet,
        exposed_by: Stage::SKY_BOWL,
        blind: Some(Stage::CORNELL),
        spp: 64,
        mistake: &SkyWithoutSine,
    },
];

/// The largest number below 1.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

struct WrongLightChoice;
impl Mistake for WrongLightChoice {
    fn light_numbers(&self, scene: &Scene, u: [f32; 4]) -> [f32; 4] {
        // map u[0] to a number for which a uniform choice selects the light that a choice by power would select
        let powers = scene.lights.powers();
        let mut left = f64::from(u[0]) * powers.iter().sum::<f64>();
        let chosen = powers.iter().position(|power| {
            left -= power;
            left < 0.0
        });
        let n = powers.len();
        [(chosen.unwrap_or(n - 1) as f32 + 0.5) / n as f32, u[1], u[2], u[3]]
    }
}

struct LightChoiceOffByOne;
impl Mistake for LightChoiceOffByOne {
    fn light_numbers(&self, scene: &Scene, u: [f32; 4]) -> [f32; 4] {
        [(u[0] + 1.0 / scene.lights.len() as f32).min(LAST), u[1], u[2], u[3]]
    }
}

struct DiskLightWithoutRoot;
impl Mistake for DiskLightWithoutRoot {
    fn light_numbers(&self, _: &Scene, u: [f32; 4]) -> [f32; 4] {
        // light sampling takes the square root of the third number as radius: squaring it cancels the root
        [u[0], u[1], u[2] * u[2], u[3]]
    }
}

struct NoShadowTest;
impl Mistake for NoShadowTest {
    fn visible(&self, _: &Scene, _: Vec3, _: Vec3, _: Vec3, _: Vec3) -> bool {
        true
    }
}

struct LightFromBehind;
impl Mistake for LightFromBehind {
    fn facing(&self, cos_y: f32) -> f32 {
        cos_y.abs()
    }
}

struct SkyWithoutSine;
impl Mistake for SkyWithoutSine {
    fn light(&self, scene: &Scene, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        let right = scene.propose_light(at, u)?;
        if right.state.side != ESCAPED {
            return Some(right);
        }
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = ((PI * u[2]).sin_cos(), (TAU * u[3]).sin_cos());
        let to = Vec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        let state = Vertex { n: Vec3::ZERO, ..Vertex::escaped(scene.beyond(at.p, to), to) };
        Some(LightSample { state, to, ..right })
    }
}
