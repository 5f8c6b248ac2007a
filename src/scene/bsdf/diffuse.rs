//! The Lambertian surface: `f = ρ/π` for all directions.
//!
//! `∫ f cos θ dω = ρ`, the albedo. Reference: Lambert, *Photometria* (1760).
//!
//! | sampling | weight f·cos θ / p |
//! |---|---|
//! | uniform, p = 1/2π | 2ρ cos θ |
//! | cosine, p = cos θ/π | ρ |

use super::colour::Colour;
use super::model::blind_pdf;
use super::{BsdfSample, Departure, Model, Sampling, Surface, Towards, TransportMode};
use crate::math::{
    Rgb,
    direction::{cosine_hemisphere, uniform_hemisphere},
};
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial, keys};
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;

/// One side of a Lambertian surface, f = ρ/π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// ρ: albedo per channel.
    pub reflectance: Rgb,
}

impl Diffuse {
    /// f for directions on the side of the normal, sr⁻¹.
    #[inline(always)]
    pub fn f(&self) -> Rgb {
        self.reflectance * FRAC_1_PI
    }
}

impl Model for Diffuse {
    #[inline(always)]
    fn eval(&self, _: Vec3, wi: Vec3, _: TransportMode) -> Rgb {
        if wi.z > 0.0 { self.f() } else { Rgb::ZERO }
    }
    #[inline(always)]
    fn sample(&self, _: Vec3, sampling: Sampling, _: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        let (wi, weight, pdf) = sample(self.reflectance, Vec3::Z, sampling, [u[0], u[1]]);
        Some(BsdfSample { wi, weight, pdf, delta: false })
    }
    #[inline(always)]
    fn pdf(&self, _: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        blind_pdf(wi, sampling)
    }
    fn max_albedo(&self) -> Rgb {
        self.reflectance
    }
    #[inline(always)]
    fn with_reflectance(self, reflectance: Rgb) -> Self {
        Self { reflectance }
    }

    /// Without local coordinates: f does not depend on them.
    #[inline(always)]
    fn depart(&self, n: Vec3, _: Vec3, sampling: Sampling, _: TransportMode, u: [f32; 3]) -> Option<Departure> {
        let (direction, weight, pdf) = sample(self.reflectance, n, sampling, [u[0], u[1]]);
        let some = Departure { direction, normal: n, weight, pdf, delta: false };
        if self.reflectance == Rgb::ZERO { None } else { Some(some) }
    }
    #[inline(always)]
    fn towards(&self, n: Vec3, _: Vec3, to: Vec3, sampling: Sampling, _: TransportMode) -> Option<Towards> {
        let cos = n.dot(to);
        let value = self.reflectance * (FRAC_1_PI * cos);
        let some = Towards { value, pdf: sampling.pdf(cos), normal: n };
        if cos > 0.0 { Some(some) } else { None }
    }
    #[inline(always)]
    fn connect(&self, n: Vec3, _: Vec3, to: Vec3, pdf: f32, sampling: Sampling) -> Option<Towards> {
        let cos = n.dot(to);
        let value = self.reflectance * (FRAC_1_PI * cos / pdf);
        let some = Towards { value, pdf: sampling.pdf(cos), normal: n };
        if (cos > 0.0) & (self.reflectance != Rgb::ZERO) { Some(some) } else { None }
    }
}

/// A Lambertian surface as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct DiffuseSurface {
    /// Albedo per channel, in [0, 1].
    pub reflectance: Colour,
}

impl Surface for DiffuseSurface {
    type Side = Diffuse;
    const KIND: &'static str = "diffuse";
    const KEYS: &'static [&'static str] = &["reflectance", "texture"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        Ok(Self { reflectance: keys::colour(c)? })
    }
    /// Takes every MTL material that no other kind accepts.
    fn from_mtl(m: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        let reflectance = m.colour()?;
        if let Some(why) = m.lost_lobe() {
            m.warn(why);
        }
        Ok(Some(Self { reflectance }))
    }
    fn side(&self, _: bool) -> Diffuse {
        Diffuse { reflectance: self.reflectance.uniform() }
    }
    fn colour(&self) -> Option<&Colour> {
        Some(&self.reflectance)
    }
    fn words(&self) -> String {
        format!("reflectance {}", self.reflectance.words())
    }
    fn examples() -> Vec<Self> {
        [DVec3::new(0.2, 0.5, 0.9), DVec3::ONE].map(|rho| Self { reflectance: Colour::Uniform(rho) }).into()
    }
}

/// A random direction about the normal, its cosine and its density (sr⁻¹).
#[inline(always)]
pub fn direction(n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, f32, f32) {
    let (d, cosine) = match sampling {
        Sampling::Uniform => uniform_hemisphere(n, u),
        Sampling::Cosine | Sampling::Bsdf => cosine_hemisphere(n, u),
    };
    (d, cosine, sampling.pdf(cosine))
}

/// A random direction about the normal, its weight `f cos θ / p` and its density (sr⁻¹).
#[inline(always)]
pub fn sample(albedo: Rgb, n: Vec3, sampling: Sampling, u: [f32; 2]) -> (Vec3, Rgb, f32) {
    let (d, cosine, pdf) = direction(n, sampling, u);
    let weight = if sampling == Sampling::Uniform { albedo * (2.0 * cosine) } else { albedo };
    (d, weight, pdf)
}
