//! Scattering by surfaces: the BSDF `f(ω_o, ω_i)`, in sr⁻¹, and methods to sample it.
//!
//! `(K L)(ω_o) = ∫ f(ω_o, ω_i) L(ω_i) |cos θ_i| dω_i`
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | ω_o | direction back along the path: towards the eye, or towards the light if paths start at a light | first argument |
//! | ω_i | direction in which the path goes on | second argument |
//! | f | BSDF without its delta part | [`Bsdf::eval`] |
//! | f·cos θ_i/p | weight of a sampled direction | [`BsdfSample::weight`] |
//! | ∫ f cos θ_i dω_i | albedo | [`Bsdf::albedo`] |
//!
//! Directions are local: z points along the normal of the side on which ω_o lies, so ω_o.z > 0. A direction with ω_i.z < 0
//! is transmission.
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
//! All kinds have the same interface ([`Model`]). Each kind declares its own properties for scene files ([`Surface`]), and
//! the [`register`] lists all kinds. They share Fresnel's equations in [`fresnel`] and microfacets in [`ggx`].
//!
//! f(ω_o, ω_i)/η_i² is symmetric, with η_i the index on the side of ω_i: it does not change if ω_o and ω_i change places. So
//! the BSDFs for radiance and for flux differ only where light crosses the surface, by the factor η_o²/η_i².

pub mod coat;
pub mod colour;
pub mod conductor;
pub mod dielectric;
pub mod diffuse;
#[cfg(test)]
mod example;
pub mod fresnel;
pub mod ggx;
#[cfg(test)]
mod laws;
pub mod mirror;
mod model;
mod odds;
pub mod phong;
pub mod plastic;
pub mod register;
pub mod rough_dielectric;
mod sampling;
pub mod surface;
pub mod world;

pub use model::{Model, Visitor};
pub use register::Bsdf;
pub use sampling::{BsdfSample, Sampling, TransportMode};
pub use surface::Surface;
pub use world::{Departure, Towards};
