//! The places in which a path tracer can be wrong: one method each, whose default is right.
//!
//! ```text
//! X_k = α_{k−1} w_c · f cos θ_x E(y)/p_ω   +   α_k w_s E(x_k)        α ← α · f cos θ/p · 1/s
//! ```
//!
//! | symbol | meaning | method |
//! |---|---|---|
//! | u | random numbers by address | [`Mistake::address`] |
//! | y, p_ω | light point, and its density in solid angle | [`Mistake::light_numbers`], [`Mistake::light`], [`Mistake::density`] |
//! | cos θ_x, cos θ_y, V | the rest of a connection | [`Mistake::receiver_cosine`], [`Mistake::facing`], [`Mistake::visible`] |
//! | f | ρ/π | [`Mistake::lambert`] |
//! | ω, p | direction, and its density | [`Mistake::direction`] |
//! | f cos θ/p | weight of a bounce | [`Mistake::bounce`], [`Mistake::glass`] |
//! | 1/s | weight of a survivor, s = 1 − q | [`Mistake::survivor`], [`Mistake::roulette_before_light`] |
//! | w_c, w_s | shares of the two ways to find light | [`Mistake::connection_share`], [`Mistake::hit_share`] |
//! | k | the slot a term goes to | [`Mistake::slot`] |
//!
//! A member of the zoo overrides one of them.

use crate::estimator::Technique;
use crate::math::Rgb;
use crate::math::direction::{cosine_hemisphere, uniform_hemisphere};
use crate::scene::bsdf::dielectric::SmoothDielectric;
use crate::scene::bsdf::{BsdfSample, Sampling, TransportMode};
use crate::scene::{LightSample, Scene, Vertex};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A connection from x to a light point y, in the words of the lecture.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// y.
    pub light: Vertex,
    /// |x − y|², m².
    pub r2: f32,
    /// cos θ_x.
    pub cos_x: f32,
    /// cos θ_y; 1 where the light has no surface.
    pub cos_y: f32,
    /// p_A = P_i/A_i, m⁻², where the point was drawn by area; else nothing.
    pub per_area: Option<f32>,
    /// p_ω: p_A r²/cos θ_y of a point drawn by area.
    pub per_angle: f32,
}

/// What may go wrong. Every default is right.
pub trait Mistake: Sync {
    /// The pixel and sample whose random numbers a path uses: its own.
    fn address(&self, pixel: u32, sample: u32) -> (u32, u32) {
        (pixel, sample)
    }

    /// The numbers that choose a light (the first), its primitive (the second) and a point of it (the others).
    fn light_numbers(&self, _scene: &Scene, u: [f32; 4]) -> [f32; 4] {
        u
    }

    /// The light that they choose.
    fn light(&self, scene: &Scene, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        scene.propose_light(at, u)
    }

    /// cos θ_y as far as it counts: a light shines from its front, where this is positive.
    fn facing(&self, cos_y: f32) -> f32 {
        cos_y
    }

    /// What is scored where the front of a light looks away: nothing.
    fn averted(&self) -> Rgb {
        Rgb::ZERO
    }

    /// cos θ_x, which turns radiance into irradiance.
    fn receiver_cosine(&self, cos_x: f32) -> f32 {
        cos_x
    }

    /// The density of y that a connection is divided by: in solid angle, as the integral is.
    fn density(&self, c: &Connection) -> f32 {
        c.per_angle
    }

    /// V: nothing stands between x and y.
    fn visible(&self, scene: &Scene, x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> bool {
        !scene.blocked(x, n, y, m)
    }

    /// A connection as it is scored, given its right value.
    fn connection(&self, value: Rgb) -> Rgb {
        value
    }

    /// w_c, where the connection has density p_ω and scattering would have `other`.
    fn connection_share(&self, technique: Technique, c: &Connection, other: f32) -> f32 {
        technique.connection(c.per_angle, other)
    }

    /// w_s, where scattering had density `p` and a connection would have `other`: 0 where it could not find the light.
    fn hit_share(&self, technique: Technique, p: f32, other: f32) -> f32 {
        technique.hit(p, other)
    }

    /// f of a Lambertian surface.
    fn lambert(&self, rho: Rgb) -> Rgb {
        rho * FRAC_1_PI
    }

    /// A direction about `n`, and the density it is believed to have.
    fn direction(&self, n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, f32) {
        let (d, cosine) = match sampling {
            Sampling::Uniform => uniform_hemisphere(n, u),
            Sampling::Cosine | Sampling::Bsdf => cosine_hemisphere(n, u),
        };
        (d, sampling.pdf(cosine))
    }

    /// f cos θ/p, the weight of a bounce off a Lambertian surface.
    fn bounce(&self, f: Rgb, cosine: f32, p: f32) -> Rgb {
        f * (cosine / p)
    }

    /// Reflection or refraction at smooth glass, with its weight.
    fn glass(&self, glass: &SmoothDielectric, wo: Vec3, u: f32) -> Option<BsdfSample> {
        Some(glass.choose(wo, TransportMode::Radiance, u))
    }

    /// Whether roulette is tested before the light is sampled, and its weight applied after: it is not.
    fn roulette_before_light(&self) -> bool {
        false
    }

    /// The weight of a path that survives with probability `s`.
    fn survivor(&self, s: f32) -> f32 {
        1.0 / s
    }

    /// Where term k is written, with slots 0..=K and K + 1 for the tail; nothing: it is lost.
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        Some(k.min(max_bounces + 1))
    }

    /// What is done to a finished number, a term of one path or their sum, before it is averaged.
    fn finish(&self, value: Rgb) -> Rgb {
        value
    }

    /// Whether [`Mistake::finish`] does anything: then the image is no sum of its terms.
    fn finishes(&self) -> bool {
        false
    }
}

/// No mistake: the control.
#[derive(Clone, Copy, Debug)]
pub struct Right;
impl Mistake for Right {}
