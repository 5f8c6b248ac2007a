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
//! All answer the same questions ([`Model`]) and say of themselves what a scene file may say of them ([`Surface`]); the
//! [`register`] lists them. What they share: Fresnel's equations in [`fresnel`], microfacets in [`ggx`].
//!
//! f(ω_o, ω_i)/η_i², with η_i the index on the side of ω_i, does not change when the two change places; so radiance and
//! flux differ by the factor η_o²/η_i² where light crosses the surface, and by nothing else.

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

pub use model::Model;
pub use register::Bsdf;
pub use sampling::{BsdfSample, Sampling, TransportMode};
pub use surface::Surface;
