//! The Lambertian surface: `f = ρ/π`, whatever the directions.
//!
//! `∫ f cos θ dω = ρ`, the albedo. Reference: Lambert, *Photometria* (1760).
//!
//! | sampling | weight f·cos θ / p |
//! |---|---|
//! | uniform, p = 1/2π | 2ρ cos θ |
//! | cosine, p = cos θ/π | ρ |

use super::Sampling;
use crate::math::{
    Rgb,
    direction::{cosine_hemisphere, uniform_hemisphere},
};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// f = ρ/π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// ρ.
    pub reflectance: Rgb,
}

impl Diffuse {
    /// f, sr⁻¹.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3) -> Rgb {
        if wi.z > 0.0 { self.f() } else { Rgb::ZERO }
    }

    /// f on the side of the normal, sr⁻¹.
    #[inline(always)]
    pub fn f(&self) -> Rgb {
        self.reflectance * FRAC_1_PI
    }
}

/// A direction about the normal, its cosine and its density.
#[inline(always)]
pub fn direction(n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, f32, f32) {
    let (d, cosine) = match sampling {
        Sampling::Uniform => uniform_hemisphere(n, u),
        Sampling::Cosine | Sampling::Bsdf => cosine_hemisphere(n, u),
    };
    (d, cosine, sampling.pdf(cosine))
}

/// A direction about the normal, with the weight `f cos θ / p` and the density.
#[inline(always)]
pub fn sample(albedo: Rgb, n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, Rgb, f32) {
    let (d, cosine, pdf) = direction(n, sampling, u);
    let weight = if sampling == Sampling::Uniform { albedo * (2.0 * cosine) } else { albedo };
    (d, weight, pdf)
}
