//! What is drawn, how, and what for.
//!
//! `⟨f cos θ_i L/p⟩ = ∫ f cos θ_i L dω_i` over the directions ω_i drawn with density p.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p | density that was asked for | [`Sampling`] |
//! | f(ω_i → ω_o), f(ω_o → ω_i) | the way light takes | [`TransportMode`] |
//! | ω_i, f·cos θ_i/p, p | a draw | [`BsdfSample`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (PhD thesis, Stanford, 1997), chapter 5
//! for the two ways.

use crate::math::{
    Rgb,
    direction::{cosine_hemisphere, uniform_hemisphere},
};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// How directions are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Uniform over the hemisphere, or over the sphere where the surface transmits.
    Uniform,
    /// Proportional to the cosine.
    Cosine,
    /// Whatever suits the surface; the cosine for a Lambertian one.
    #[default]
    Bsdf,
}

impl Sampling {
    /// Density of a direction with this cosine over the hemisphere, sr⁻¹.
    #[inline(always)]
    pub fn pdf(self, cosine: f32) -> f32 {
        match self {
            Self::Uniform => 1.0 / TAU,
            Self::Cosine | Self::Bsdf => cosine * FRAC_1_PI,
        }
    }

    /// A direction of the upper hemisphere with this density.
    #[inline(always)]
    pub(super) fn direction(self, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Uniform => uniform_hemisphere(Vec3::Z, u).0,
            Self::Cosine | Self::Bsdf => cosine_hemisphere(Vec3::Z, u).0,
        }
    }
}

/// What is carried along the walk. Differs where refraction squeezes a beam: radiance grows by η², flux does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// Radiance, from the eye: f(ω_i → ω_o).
    Radiance,
    /// Flux, from the light: f(ω_o → ω_i).
    Flux,
}

impl TransportMode {
    /// Factor on what crosses to the side with η² times the squared index.
    #[inline(always)]
    pub(super) fn squeezed(self, eta2: f32) -> f32 {
        match self {
            Self::Radiance => 1.0 / eta2,
            Self::Flux => 1.0,
        }
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// ω_i.
    pub wi: Vec3,
    /// f·|cos θ_i|/p.
    pub weight: Rgb,
    /// Density in solid angle, summed over all ways to draw ω_i but delta ones; of a delta direction, the probability of its choice.
    pub pdf: f32,
    /// Whether the direction came from a delta part: it cannot be found in any other way.
    pub delta: bool,
}

impl BsdfSample {
    /// A direction that can be found in other ways too; none on or below the surface, or where nothing is sampled.
    #[inline(always)]
    pub(super) fn of(wi: Vec3, f: Rgb, pdf: f32) -> Option<Self> {
        (wi.z != 0.0 && pdf > 0.0).then(|| Self { wi, weight: f * (wi.z.abs() / pdf), pdf, delta: false })
    }
}
