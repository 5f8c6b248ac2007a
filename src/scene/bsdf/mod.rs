//! How a surface scatters: `f(ω_o, ω_i)`, in sr⁻¹, and ways to sample it.
//!
//! `(K L)(ω_o) = ∫ f(ω_o, ω_i) L(ω_i) |cos θ_i| dω_i`
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | ω_o | where the walk came from: towards the eye, or towards the light when light is followed | first argument |
//! | ω_i | where it goes on | second argument |
//! | f | without its delta part | [`Bsdf::eval`] |
//! | f·cos θ_i/p | weight of a sampled direction | [`BsdfSample::weight`] |
//! | ∫ f cos θ_i dω_i | albedo | [`Bsdf::albedo`] |
//!
//! Directions are local: z along the normal of the side ω_o is on, so ω_o.z > 0; ω_i.z < 0 is transmission.
//!
//! | kind | file |
//! |---|---|
//! | Lambertian | [`diffuse`] |

pub mod diffuse;

use super::description::BsdfDescription;
use crate::math::Rgb;
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
}

/// What is carried along the walk. Differs where refraction squeezes a beam: radiance grows by η², flux does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Radiance, from the eye: f(ω_i → ω_o).
    Radiance,
    /// Flux, from the light: f(ω_o → ω_i).
    Flux,
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

/// How one side of a surface scatters at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Nothing leaves.
    Black,
    /// Lambertian.
    Diffuse(diffuse::Diffuse),
}

impl Bsdf {
    /// The side of a surface: `back` is the side the normal points away from.
    pub fn new(description: &BsdfDescription, back: bool) -> Self {
        match description {
            BsdfDescription::Diffuse { reflectance: super::description::Colour::Uniform(r) } => Self::Diffuse(diffuse::Diffuse { reflectance: r.as_vec3() }),
            _ => { let _ = back; Self::Black }
        }
    }

    /// The same with another reflectance where a texture gives it: that of the diffuse part.
    #[must_use]
    pub fn with_reflectance(self, reflectance: Rgb) -> Self {
        match self {
            Self::Diffuse(_) => Self::Diffuse(diffuse::Diffuse { reflectance }),
            Self::Black => self,
        }
    }

    /// f(ω_o, ω_i), sr⁻¹, without its delta part.
    pub fn eval(&self, _wo: Vec3, _wi: Vec3, _carried: Carried) -> Rgb {
        Rgb::ZERO
    }

    /// A direction; nothing when the sample is zero. `u[2]` chooses between parts.
    pub fn sample(&self, _wo: Vec3, _sampling: Sampling, _carried: Carried, _u: [f32; 3]) -> Option<BsdfSample> {
        None
    }

    /// Density with which [`Self::sample`] draws ω_i, delta parts excepted.
    pub fn pdf(&self, _wo: Vec3, _wi: Vec3, _sampling: Sampling) -> f32 {
        0.0
    }

    /// The share of the energy that is scattered, per channel: ∫ f(ω_o → ω_i) cos θ_i dω_i with its delta part.
    pub fn albedo(&self, _wo: Vec3) -> Rgb {
        Rgb::ZERO
    }

    /// The largest albedo of any direction: the local bound on ‖K‖₁.
    pub fn max_albedo(&self) -> Rgb {
        if let Self::Diffuse(d) = self { return d.reflectance; }
        Rgb::ZERO
    }

    /// Whether f has a part that connections can find.
    pub fn connects(&self) -> bool {
        false
    }

    /// Whether f has a delta part.
    pub fn has_delta(&self) -> bool {
        false
    }
}
