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
        if wi.z > 0.0 { self.reflectance * FRAC_1_PI } else { Rgb::ZERO }
    }
}

/// A direction about the normal, with the weight `f cos θ / p` and the density.
#[inline(always)]
pub fn sample(albedo: Rgb, n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, Rgb, f32) {
    match sampling {
        Sampling::Uniform => {
            let (d, cosine) = uniform_hemisphere(n, u);
            (d, albedo * (2.0 * cosine), sampling.pdf(cosine))
        }
        Sampling::Cosine | Sampling::Bsdf => {
            let (d, cosine) = cosine_hemisphere(n, u);
            (d, albedo, sampling.pdf(cosine))
        }
    }
}
