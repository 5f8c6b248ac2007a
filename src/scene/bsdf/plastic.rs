//! A Lambertian base under a dielectric coat, smooth or rough.
//!
//! ```text
//! f = f_coat + T(ω_o) T(ω_i) ρ/(π η² (1 − ρ F_in))        1 − F_in = T̄/η²
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | f_coat | BSDF of the coat alone: a delta if it is smooth | [`Coat::eval`] |
//! | T, T̄ | fraction of the light that enters through the coat: 1 − F and 1 − F_out if it is smooth | [`super::coat`] |
//! | ρ | albedo of the base | [`Plastic::new`] |
//! | F_in | fraction of the light from the base that the coat reflects back to the base | [`Plastic::new`] |
//! | β | T̄ρ/(η² (1 − ρ F_in)): fraction of the light that enters and comes out again; 1 if ρ = 1 | `out` |
//! | p | probability of sampling the coat: E/(E + Tβ), with E its albedo and β of the largest channel | `p_coat` |
//!
//! The factor 1/(1 − ρ F_in) sums the reflections between base and coat. The factor 1/η² comes from refraction: light from
//! the base fills a larger solid angle outside. The albedo is E(ω_o) + T(ω_o) β, which is exactly 1 for a white base. f is
//! reciprocal because it is a product of the same function of ω_o and ω_i.
//!
//! References: Wolff, *Diffuse-reflectance model for smooth dielectric surfaces* (JOSA A 11(11), 1994), with the sum of
//! Saunderson, *Calculation of the Color of Pigmented Plastics* (JOSA 32, 1942); the rough coat enters as the albedo of
//! Kelemen and Szirmay-Kalos in [`super::coat`].

use super::coat::Coat;
use super::colour::Colour;
use super::ggx::{Ggx, Microfacets, half, reflect};
use super::mirror::reflection;
use super::{BsdfSample, Model, Sampling, Surface, TransportMode};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, keys, keys::IOR};
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;

/// One side of a Lambertian base under a dielectric coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// The coat.
    pub coat: Coat,
    /// β/(π T̄), sr⁻¹: f of the base without the two factors T.
    base: Rgb,
    /// β: fraction of the entered light that comes out again.
    out: Rgb,
}

impl Plastic {
    /// A base of albedo ρ under a coat of relative index `ior` ≥ 1.
    pub fn new(reflectance: Rgb, ior: f64, rough: Option<Ggx>) -> Self {
        Self { coat: Coat::new(ior, rough.map(Microfacets::new)), base: Rgb::ZERO, out: Rgb::ZERO }
            .with_reflectance(reflectance)
    }

    /// p(ω_o): probability of sampling the coat; 1 if no light comes from the base.
    #[inline(always)]
    fn p_coat(&self, wo: Vec3) -> f32 {
        let t = self.coat.transmittance(wo.z);
        let base = t * self.out.max_element();
        if base > 0.0 { (1.0 - t) / (1.0 - t + base) } else { 1.0 }
    }
}

impl Model for Plastic {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let base = self.base * (self.coat.transmittance(wo.z) * self.coat.transmittance(wi.z));
        base + self.coat.eval(wo, wi)
    }

    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let p = self.p_coat(wo);
        match self.coat.facets() {
            None => (1.0 - p) * sampling.pdf(wi.z),
            Some(_) if sampling != Sampling::Bsdf => sampling.pdf(wi.z),
            Some(facets) => p * 0.25 * facets.visible(wo.z, half(wo, wi).0) + (1.0 - p) * sampling.pdf(wi.z),
        }
    }

    /// Samples the coat if `u[2]` < p, otherwise the base. A rough coat is sampled only if `sampling` is [`Sampling::Bsdf`].
    /// `None` if the direction points below the surface.
    #[inline(always)]
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        let p = self.p_coat(wo);
        let coat = u[2] < p;
        let wi = match self.coat.facets() {
            None if coat => {
                let weight = Rgb::splat(self.coat.albedo(wo.z) / p);
                return Some(BsdfSample { wi: reflection(wo), weight, pdf: p, delta: true });
            }
            Some(facets) if coat && sampling == Sampling::Bsdf => reflect(wo, facets.sample(wo, [u[0], u[1]])),
            _ => sampling.direction([u[0], u[1]]),
        };
        BsdfSample::of(wi, self.eval(wo, wi, mode), self.pdf(wo, wi, sampling))
    }

    /// E + Tβ: exact for a smooth coat, an upper bound for a rough one.
    #[inline(always)]
    fn albedo(&self, wo: Vec3) -> Rgb {
        let t = self.coat.transmittance(wo.z);
        Rgb::splat(1.0 - t) + t * self.out
    }

    /// The largest albedo: at the angle where the coat reflects most.
    #[inline(always)]
    fn max_albedo(&self) -> Rgb {
        let e = self.coat.max_albedo();
        Rgb::splat(e) + (1.0 - e) * self.out
    }

    /// The same with another albedo ρ of the base.
    fn with_reflectance(self, reflectance: Rgb) -> Self {
        // η² (1 − ρ F_in)
        let kept = self.coat.interface.eta2() * (1.0 - reflectance) + reflectance * self.coat.mean;
        let escape = reflectance / kept;
        Self { base: escape * FRAC_1_PI, out: escape * self.coat.mean, ..self }
    }

    fn has_delta(&self) -> bool {
        self.coat.facets().is_none()
    }
}

/// A coated base as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct PlasticSurface {
    /// Albedo of the base, in [0, 1].
    pub reflectance: Colour,
    /// Index of refraction of the coat.
    pub ior: f64,
    /// Microfacets of the coat; `None` for a smooth coat.
    pub rough: Option<Ggx>,
}

impl Surface for PlasticSurface {
    type Side = Plastic;
    const KIND: &'static str = "plastic";
    const KEYS: &'static [&'static str] = &["reflectance", "texture", "ior", "alpha", "masking"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        let ior = c.get("ior").map_or(Ok(1.5), |i| i.within("ior", IOR[0], IOR[1]))?;
        Ok(Self { reflectance: keys::colour(c)?, ior, rough: keys::rough(c)? })
    }
    fn side(&self, _: bool) -> Plastic {
        Plastic::new(self.reflectance.uniform(), self.ior, self.rough)
    }
    fn colour(&self) -> Option<&Colour> {
        Some(&self.reflectance)
    }
    fn words(&self) -> String {
        format!("reflectance {}, index {}, {}", self.reflectance.words(), self.ior, Ggx::words(self.rough))
    }
    fn examples() -> Vec<Self> {
        let reflectance = Colour::Uniform(DVec3::new(0.2, 0.5, 0.9));
        Ggx::examples().map(|rough| Self { reflectance: reflectance.clone(), ior: 1.5, rough }).into()
    }
}
