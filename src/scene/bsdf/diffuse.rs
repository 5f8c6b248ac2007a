//! The Lambertian surface: `f = ρ/π`, whatever the directions.
//!
//! `∫ f cos θ dω = ρ`, the albedo. Reference: Lambert, *Photometria* (1760).
//!
//! | sampling | weight f·cos θ / p |
//! |---|---|
//! | uniform, p = 1/2π | 2ρ cos θ |
//! | cosine, p = cos θ/π | ρ |

use crate::math::{
    Rgb,
    direction::{cosine_hemisphere, uniform_hemisphere},
};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// How directions are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Uniform over the hemisphere.
    Uniform,
    /// Proportional to the cosine.
    Cosine,
    /// Whatever suits the surface; the cosine for a Lambertian one.
    #[default]
    Bsdf,
}

impl Sampling {
    /// Density of a direction with this cosine, sr⁻¹.
    #[inline(always)]
    pub fn pdf(self, cosine: f32) -> f32 {
        match self {
            Self::Uniform => 1.0 / TAU,
            Self::Cosine | Self::Bsdf => cosine * FRAC_1_PI,
        }
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
