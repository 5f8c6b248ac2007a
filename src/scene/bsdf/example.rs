//! The worked example of `CONTRIBUTING.md`: Minnaert's model of a surface. It is compiled and tested, but scene files cannot
//! use it because it is not in the register.
//!
//! ```text
//! f = ρ (n + 2)/2π (cos θ_o cos θ_i)ⁿ        albedo ρ cosⁿ θ_o        p = cos θ_i/π
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | ρ | albedo at normal incidence | [`MinnaertSurface::reflectance`] |
//! | n | rate at which the surface darkens towards the rim; 0 is Lambertian | [`MinnaertSurface::exponent`] |
//!
//! Reference: Minnaert, *The Reciprocity Principle in Lunar Photometry* (Astrophysical Journal 93, 1941).

use super::colour::Colour;
use super::model::{blind_pdf, sample_blindly};
use super::{BsdfSample, Model, Sampling, Surface, TransportMode};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, keys};
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;

/// The BSDF of one side of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Minnaert {
    reflectance: Rgb,
    exponent: f32,
}

impl Model for Minnaert {
    fn eval(&self, wo: Vec3, wi: Vec3, _: TransportMode) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        let n = self.exponent;
        self.reflectance * ((n + 2.0) / TAU * (wo.z * wi.z).powf(n))
    }
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        sample_blindly(self, wo, sampling, mode, u)
    }
    fn pdf(&self, _: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        blind_pdf(wi, sampling)
    }
    fn albedo(&self, wo: Vec3) -> Rgb {
        self.reflectance * wo.z.powf(self.exponent)
    }
    fn max_albedo(&self) -> Rgb {
        self.reflectance
    }
    fn with_reflectance(self, reflectance: Rgb) -> Self {
        Self { reflectance, ..self }
    }
}

/// The surface as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
struct MinnaertSurface {
    /// ρ, in [0, 1]: albedo at normal incidence.
    reflectance: Colour,
    /// n, at least 0: rate of darkening.
    exponent: f64,
}

impl Surface for MinnaertSurface {
    type Side = Minnaert;
    const KIND: &'static str = "minnaert";
    const KEYS: &'static [&'static str] = &["reflectance", "texture", "exponent"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        let exponent =
            c.require("exponent", "the rate at which it darkens: exponent = 0.5")?.within("exponent", 0.0, 100.0)?;
        Ok(Self { reflectance: keys::colour(c)?, exponent })
    }
    fn side(&self, _: bool) -> Minnaert {
        Minnaert { reflectance: self.reflectance.uniform(), exponent: self.exponent as f32 }
    }
    fn colour(&self) -> Option<&Colour> {
        Some(&self.reflectance)
    }
    fn words(&self) -> String {
        format!("reflectance {}, exponent {}", self.reflectance.words(), self.exponent)
    }
    fn examples() -> Vec<Self> {
        [0.0, 0.5, 3.0].map(|exponent| Self { reflectance: Colour::Uniform(DVec3::splat(0.8)), exponent }).into()
    }
}

/// Compares the albedo with the midpoint rule over cos θ_i.
#[test]
fn the_albedo_is_that_of_the_formula() {
    for surface in MinnaertSurface::examples() {
        let f = surface.side(false);
        for wo in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.96, 0.28)] {
            let n = 10_000;
            let at = |i: i32| {
                let z = (i as f32 + 0.5) / n as f32;
                let wi = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
                f64::from(f.eval(wo, wi, TransportMode::Radiance).x * z) * f64::from(TAU) / f64::from(n)
            };
            let albedo: f64 = (0..n).map(at).sum();
            assert!((albedo - f64::from(f.albedo(wo).x)).abs() < 1e-4, "{surface:?}, {wo}: {albedo}");
        }
    }
}
