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
//! | mirror | [`mirror`] |
//! | metal, smooth or rough | [`conductor`] |
//! | glass, smooth | [`dielectric`] |
//! | glass, rough | [`rough_dielectric`] |
//! | plastic: a Lambertian base under a [`coat`], smooth or rough | [`plastic`] |
//! | Phong | [`phong`] |
//!
//! What they share: Fresnel's equations in [`fresnel`], microfacets in [`ggx`].
//!
//! f(ω_o, ω_i)/η_i², with η_i the index on the side of ω_i, does not change when the two change places; so radiance and
//! flux differ by the factor η_o²/η_i² where light crosses the surface, and by nothing else.

pub mod coat;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
pub mod fresnel;
pub mod ggx;
pub mod mirror;
pub mod phong;
pub mod plastic;
pub mod rough_dielectric;
mod sampling;

use super::description::{BsdfDescription, Colour};
use crate::math::Rgb;
use conductor::Conductor;
use dielectric::{Dielectric, Odds};
use diffuse::Diffuse;
use fresnel::Interface;
use ggx::Microfacets;
use glam::{DVec3, Vec3};
use mirror::Mirror;
use phong::Phong;
use plastic::Plastic;
use rough_dielectric::RoughDielectric;
pub use sampling::{BsdfSample, Sampling, TransportMode};

/// How one side of a surface scatters at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Nothing leaves.
    Black,
    /// Lambertian.
    Diffuse(Diffuse),
    /// A perfect mirror.
    Mirror(Mirror),
    /// A metal, smooth or rough.
    Conductor(Conductor),
    /// Smooth glass.
    Dielectric(Dielectric),
    /// Rough glass.
    RoughDielectric(RoughDielectric),
    /// A coated base, smooth or rough.
    Plastic(Plastic),
    /// The modified Phong model.
    Phong(Phong),
}

fn rgb(c: DVec3) -> Rgb {
    c.as_vec3()
}

/// White where a texture will tell.
fn uniform(colour: &Colour) -> Rgb {
    match colour {
        Colour::Uniform(c) => rgb(*c),
        Colour::Texture(_) => Rgb::ONE,
    }
}

impl Bsdf {
    /// The side of a surface: `back` is the side the normal points away from. A textured reflectance is white until
    /// [`Self::with_reflectance`] says more. Tables are made here: once per material, not per hit.
    pub fn new(description: &BsdfDescription, back: bool) -> Self {
        match description {
            BsdfDescription::Diffuse { reflectance } => Self::Diffuse(Diffuse { reflectance: uniform(reflectance) }),
            BsdfDescription::Mirror { reflectance } => Self::Mirror(Mirror { reflectance: rgb(*reflectance) }),
            BsdfDescription::Conductor { metal, rough } => Self::Conductor(Conductor::new(*metal, *rough)),
            BsdfDescription::Dielectric { ior, ior_outside, choice, rough } => {
                let (here, beyond) = if back { (*ior, *ior_outside) } else { (*ior_outside, *ior) };
                let (interface, odds) = (Interface::new(here, beyond), Odds::new(*choice));
                match rough {
                    // between equal indices a rough boundary is as invisible as a smooth one
                    Some(ggx) if interface.eta != 1.0 => {
                        Self::RoughDielectric(RoughDielectric { interface, odds, facets: Microfacets::new(*ggx) })
                    }
                    _ => Self::Dielectric(Dielectric { interface, odds }),
                }
            }
            BsdfDescription::Plastic { reflectance, ior, rough } => {
                Self::Plastic(Plastic::new(uniform(reflectance), *ior, *rough))
            }
            BsdfDescription::Phong { reflectance, specular, exponent } => {
                Self::Phong(Phong::new(uniform(reflectance), rgb(*specular), *exponent as f32))
            }
        }
    }

    /// The same with another reflectance where a texture gives it: that of the diffuse part.
    #[must_use]
    pub fn with_reflectance(self, reflectance: Rgb) -> Self {
        match self {
            Self::Diffuse(_) => Self::Diffuse(Diffuse { reflectance }),
            Self::Plastic(plastic) => Self::Plastic(plastic.with_reflectance(reflectance)),
            Self::Phong(phong) => Self::Phong(phong.with_diffuse(reflectance)),
            Self::Black | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) | Self::RoughDielectric(_) => self,
        }
    }

    /// f(ω_o, ω_i), sr⁻¹, without its delta part.
    pub fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        match self {
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => Rgb::ZERO,
            Self::Diffuse(f) => f.eval(wi),
            Self::Conductor(f) => f.eval(wo, wi),
            Self::RoughDielectric(f) => f.eval(wo, wi, mode),
            Self::Plastic(f) => f.eval(wo, wi),
            Self::Phong(f) => f.eval(wo, wi),
        }
    }

    /// A direction; none where there is none to go to. `u[0]`, `u[1]` choose it, `u[2]` chooses between parts. The weight
    /// may be zero where `sampling` does not follow f.
    pub fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        let at = [u[0], u[1]];
        match self {
            Self::Black => None,
            Self::Diffuse(f) => {
                let (wi, weight, pdf) = diffuse::sample(f.reflectance, Vec3::Z, sampling, at);
                Some(BsdfSample { wi, weight, pdf, delta: false })
            }
            Self::Mirror(f) => Some(f.sample(wo)),
            Self::Dielectric(f) => Some(f.sample(wo, mode, u[2])),
            Self::Plastic(f) => f.sample(wo, sampling, u),
            Self::Conductor(f) if f.rough.is_none() || sampling == Sampling::Bsdf => f.sample(wo, at),
            Self::RoughDielectric(f) if sampling == Sampling::Bsdf => f.sample(wo, mode, u),
            Self::Phong(f) if sampling == Sampling::Bsdf => f.sample(wo, u),
            Self::Conductor(_) | Self::RoughDielectric(_) | Self::Phong(_) => {
                let up = sampling.direction(at);
                let wi = if self.transmits() && u[2] >= 0.5 { -up } else { up };
                BsdfSample::of(wi, self.eval(wo, wi, mode), self.pdf(wo, wi, sampling))
            }
        }
    }

    /// Density with which [`Self::sample`] draws ω_i, delta parts excepted.
    pub fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        match self {
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => 0.0,
            Self::Conductor(f) if f.rough.is_none() => 0.0,
            Self::Plastic(f) => f.pdf(wo, wi, sampling),
            Self::Conductor(f) if sampling == Sampling::Bsdf => f.pdf(wo, wi),
            Self::RoughDielectric(f) if sampling == Sampling::Bsdf => f.pdf(wo, wi),
            Self::Phong(f) if sampling == Sampling::Bsdf => f.pdf(wo, wi),
            Self::RoughDielectric(_) => 0.5 * sampling.pdf(wi.z.abs()),
            Self::Diffuse(_) | Self::Conductor(_) | Self::Phong(_) => {
                if wi.z > 0.0 {
                    sampling.pdf(wi.z)
                } else {
                    0.0
                }
            }
        }
    }

    /// The share of the energy that is scattered, per channel: ∫ f(ω_o → ω_i) cos θ_i dω_i with its delta part. Exact of
    /// what is smooth or Lambertian; an upper bound of microfacets and Phong's lobe, which their files give.
    pub fn albedo(&self, wo: Vec3) -> Rgb {
        match self {
            Self::Black => Rgb::ZERO,
            Self::Diffuse(f) => f.reflectance,
            Self::Mirror(f) => f.reflectance,
            Self::Conductor(f) => f.albedo(wo),
            Self::Dielectric(_) | Self::RoughDielectric(_) => Rgb::ONE,
            Self::Plastic(f) => f.albedo(wo),
            Self::Phong(f) => f.max_albedo(),
        }
    }

    /// The largest albedo of any direction: the local bound on ‖K‖₁.
    pub fn max_albedo(&self) -> Rgb {
        match self {
            Self::Black => Rgb::ZERO,
            Self::Diffuse(f) => f.reflectance,
            Self::Mirror(f) => f.reflectance,
            Self::Conductor(f) => f.max_albedo(),
            Self::Dielectric(_) | Self::RoughDielectric(_) => Rgb::ONE,
            Self::Plastic(f) => f.max_albedo(),
            Self::Phong(f) => f.max_albedo(),
        }
    }

    /// Whether f has a part that connections can find.
    pub fn connects(&self) -> bool {
        match self {
            Self::Black | Self::Mirror(_) | Self::Dielectric(_) => false,
            Self::Conductor(f) => f.rough.is_some(),
            Self::Diffuse(_) | Self::RoughDielectric(_) | Self::Plastic(_) | Self::Phong(_) => true,
        }
    }

    /// Whether f has a delta part.
    pub fn has_delta(&self) -> bool {
        match self {
            Self::Mirror(_) | Self::Dielectric(_) => true,
            Self::Conductor(f) => f.rough.is_none(),
            Self::Plastic(f) => f.coat.facets().is_none(),
            Self::Black | Self::Diffuse(_) | Self::RoughDielectric(_) | Self::Phong(_) => false,
        }
    }

    /// Whether f reaches the other side without a delta.
    pub(crate) fn transmits(&self) -> bool {
        matches!(self, Self::RoughDielectric(_))
    }
}
