//! The steps of a path tracer that can be wrong: one method each. The default method is correct.
//!
//! ```text
//! X_k = α_{k−1} w_c · f cos θ_x E(y)/p_ω   +   α_k w_s E(x_k)        α ← α · f cos θ/p · 1/s
//! ```
//!
//! | symbol | meaning | method |
//! |---|---|---|
//! | u | random numbers, addressed by pixel and sample | [`Mistake::address`] |
//! | y, p_ω | point on a light, and its density per solid angle | [`Mistake::light_numbers`], [`Mistake::light`], [`Mistake::density`] |
//! | cos θ_x, cos θ_y, V | the other factors of a connection | [`Mistake::receiver_cosine`], [`Mistake::facing`], [`Mistake::visible`] |
//! | f | ρ/π | [`Mistake::lambert`] |
//! | ω, p | sampled direction, and its density | [`Mistake::direction`] |
//! | f cos θ/p | weight of a bounce | [`Mistake::bounce`], [`Mistake::glass`] |
//! | 1/s | weight of a path that survives roulette, s = 1 − q | [`Mistake::survivor`], [`Mistake::roulette_before_light`] |
//! | w_c, w_s | MIS weights of the two techniques to find light: connection and scattering | [`Mistake::connection_share`], [`Mistake::hit_share`] |
//! | k | number of the term, and of the slot where it is stored | [`Mistake::slot`] |
//!
//! Most members of the zoo override one of these methods.

use crate::estimator::Technique;
use crate::math::Rgb;
use crate::math::direction::{cosine_hemisphere, uniform_hemisphere};
use crate::scene::bsdf::dielectric::SmoothDielectric;
use crate::scene::bsdf::{BsdfSample, Sampling, TransportMode};
use crate::scene::{LightSample, Scene, Vertex};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A connection from x to a point y on a light.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// The point y.
    pub light: Vertex,
    /// |x − y|², m².
    pub r2: f32,
    /// cos θ_x.
    pub cos_x: f32,
    /// cos θ_y; 1 where the light has no surface.
    pub cos_y: f32,
    /// p_A = P_i/A_i, m⁻², if the point was sampled by area; else none.
    pub per_area: Option<f32>,
    /// p_ω. For a point sampled by area, p_ω = p_A r²/cos θ_y.
    pub per_angle: f32,
}

/// The steps that a mistake can replace. Every default is correct.
pub trait Mistake: Sync {
    /// The pixel and sample whose random numbers a path uses. By default its own.
    fn address(&self, pixel: u32, sample: u32) -> (u32, u32) {
        (pixel, sample)
    }

    /// The four random numbers of a light sample: the first chooses the light, the second its primitive, the others a point
    /// on it.
    fn light_numbers(&self, _scene: &Scene, u: [f32; 4]) -> [f32; 4] {
        u
    }

    /// The light sample that these numbers give.
    fn light(&self, scene: &Scene, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        scene.propose_light(at, u)
    }

    /// cos θ_y as used in the connection. A light emits from its front, where the cosine is positive.
    fn facing(&self, cos_y: f32) -> f32 {
        cos_y
    }

    /// The value that is scored if the light faces away from x. By default zero.
    fn averted(&self) -> Rgb {
        Rgb::ZERO
    }

    /// cos θ_x, the cosine at the receiving surface.
    fn receiver_cosine(&self, cos_x: f32) -> f32 {
        cos_x
    }

    /// The density of y by which a connection is divided. It is per solid angle, because the integral is over directions.
    fn density(&self, c: &Connection) -> f32 {
        c.per_angle
    }

    /// V: returns true if nothing blocks the segment from x to y.
    fn visible(&self, scene: &Scene, x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> bool {
        !scene.blocked(x, n, y, m)
    }

    /// The value that is scored for a connection, given the correct value.
    fn connection(&self, value: Rgb) -> Rgb {
        value
    }

    /// w_c: the MIS weight of a connection. The connection has density p_ω; scattering would sample the same direction with
    /// density `other`.
    fn connection_share(&self, technique: Technique, c: &Connection, other: f32) -> f32 {
        technique.connection(c.per_angle, other)
    }

    /// w_s: the MIS weight of a hit. Scattering had density `p`; a connection would have density `other`, which is 0 if it
    /// cannot find this light.
    fn hit_share(&self, technique: Technique, p: f32, other: f32) -> f32 {
        technique.hit(p, other)
    }

    /// f of a Lambertian surface.
    fn lambert(&self, rho: Rgb) -> Rgb {
        rho * FRAC_1_PI
    }

    /// A direction about `n`, and the density that the estimator assumes for it.
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

    /// Returns true if the roulette test comes before the light sample and its weight is applied after it. By default false.
    fn roulette_before_light(&self) -> bool {
        false
    }

    /// The weight factor of a path that survives roulette with probability `s`.
    fn survivor(&self, s: f32) -> f32 {
        1.0 / s
    }

    /// The slot in which term k is stored: 0..=K for the terms, K + 1 for the tail. None if the term is lost.
    fn slot(&self, k: usize, max_bounces: usize) -> Option<usize> {
        Some(k.min(max_bounces + 1))
    }

    /// Applied to the value of a path, term by term or for the sum of its terms, before it is averaged. By default the value
    /// is unchanged.
    fn finish(&self, value: Rgb) -> Rgb {
        value
    }

    /// Returns true if [`Mistake::finish`] changes values. The image is then not the sum of its terms.
    fn finishes(&self) -> bool {
        false
    }
}

/// No mistake: the correct estimator, used as a control.
#[derive(Clone, Copy, Debug)]
pub struct Right;
impl Mistake for Right {}
