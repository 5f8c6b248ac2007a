//! Types for sampling a BSDF: the density of directions, the transported quantity, and a sampled direction.
//!
//! `E[f cos θ_i L/p] = ∫ f cos θ_i L dω_i` for directions ω_i sampled with density p.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p | density of the sampled directions | [`Sampling`] |
//! | f(ω_i → ω_o), f(ω_o → ω_i) | direction in which light travels | [`TransportMode`] |
//! | ω_i, f·cos θ_i/p, p | a sampled direction, its weight and its density | [`BsdfSample`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (PhD thesis, Stanford, 1997), chapter 5 for
//! the two directions of transport.

use crate::math::{
    Rgb,
    direction::{cosine_hemisphere, uniform_hemisphere},
};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Density with which directions are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Uniform over the hemisphere, or over the sphere if the surface transmits.
    Uniform,
    /// Proportional to the cosine.
    Cosine,
    /// The density that suits each surface best; the cosine for a Lambertian one.
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

    /// A random direction of the upper hemisphere with this density.
    #[inline(always)]
    pub(super) fn direction(self, u: [f32; 2]) -> Vec3 {
        match self {
            Self::Uniform => uniform_hemisphere(Vec3::Z, u).0,
            Self::Cosine | Self::Bsdf => cosine_hemisphere(Vec3::Z, u).0,
        }
    }
}

/// The quantity that a path transports. The two differ where refraction narrows a beam: radiance grows by η², flux does not
/// change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// Radiance, on paths from the eye: f(ω_i → ω_o).
    Radiance,
    /// Flux, on paths from the light: f(ω_o → ω_i).
    Flux,
}

impl TransportMode {
    /// Factor on light that crosses to a side whose squared index is `eta2` times that of the side of ω_o.
    #[inline(always)]
    pub(super) fn squeezed(self, eta2: f32) -> f32 {
        match self {
            Self::Radiance => 1.0 / eta2,
            Self::Flux => 1.0,
        }
    }
}

/// A sampled direction with its weight and density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// ω_i: the sampled direction, local.
    pub wi: Vec3,
    /// Weight f·|cos θ_i|/p.
    pub weight: Rgb,
    /// Density in solid angle, summed over all non-delta ways to sample ω_i. For a delta direction: the probability of
    /// choosing it.
    pub pdf: f32,
    /// True if the direction came from a delta part, so that no other technique can find it.
    pub delta: bool,
}

impl BsdfSample {
    /// A sample of the non-delta part. `None` for a direction in the surface, or where the density is 0.
    #[inline(always)]
    pub(super) fn of(wi: Vec3, f: Rgb, pdf: f32) -> Option<Self> {
        let sample = Self { wi, weight: f * (wi.z.abs() / pdf), pdf, delta: false };
        if (wi.z != 0.0) & (pdf > 0.0) { Some(sample) } else { None }
    }
}
