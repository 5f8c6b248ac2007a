//! Phong's lobe about the mirror direction, normalised and reciprocal.
//!
//! ```text
//! f = k_d/π + k_s (n + 2)/2π (cos α)ⁿ        p(ω_i) = (1 − p_s) cos θ_i/π + p_s (n + 1)/2π (cos α)ⁿ
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | k_d, k_s | albedo of the base, and of the lobe at normal incidence; k_d + k_s ≤ 1 | [`Phong::new`] |
//! | n | exponent | [`Phong::new`] |
//! | α | angle between ω_i and the mirror direction of ω_o; f has no lobe beyond π/2 | `lobe` |
//! | p_s | probability of the lobe, k_s/(k_d + k_s) of the largest channels | [`Phong::sample`] |
//!
//! At oblique incidence a part of the lobe is below the surface; that part of the samples is lost, and the albedo is below
//! k_d + k_s. cos α is taken from |ω_i − r|² = 2(1 − cos α), which keeps its digits at large n.
//!
//! Reference: Lafortune and Willems, *Using the Modified Phong Reflectance Model for Physically Based Rendering* (Report
//! CW 197, K.U. Leuven, 1994).

use super::mirror::reflection;
use super::{BsdfSample, Sampling};
use crate::math::Rgb;
use crate::math::direction::{about, cos_sin_turn, cosine_hemisphere};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// The modified Phong model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    diffuse: Rgb,
    specular: Rgb,
    exponent: f32,
    p_specular: f32,
}

impl Phong {
    /// k_d, k_s and n.
    pub fn new(diffuse: Rgb, specular: Rgb, exponent: f32) -> Self {
        let (d, s) = (diffuse.max_element(), specular.max_element());
        Self { diffuse, specular, exponent, p_specular: if s > 0.0 { s / (d + s) } else { 0.0 } }
    }

    /// The same with another k_d.
    pub fn with_diffuse(self, diffuse: Rgb) -> Self {
        Self::new(diffuse, self.specular, self.exponent)
    }

    /// (cos α)ⁿ/2π.
    #[inline(always)]
    fn lobe(&self, wo: Vec3, wi: Vec3) -> f32 {
        let versine = 0.5 * (wi - reflection(wo)).length_squared();
        if versine < 1.0 { (self.exponent * (-versine).ln_1p()).exp() / TAU } else { 0.0 }
    }

    /// f, sr⁻¹.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wi.z <= 0.0 {
            return Rgb::ZERO;
        }
        self.diffuse * FRAC_1_PI + self.specular * ((self.exponent + 2.0) * self.lobe(wo, wi))
    }

    /// Density of [`Self::sample`], sr⁻¹.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let lobe = (self.exponent + 1.0) * self.lobe(wo, wi);
        (1.0 - self.p_specular) * Sampling::Cosine.pdf(wi.z) + self.p_specular * lobe
    }

    /// From the lobe if `u[2]` < p_s, about the normal otherwise. None below the surface.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u: [f32; 3]) -> Option<BsdfSample> {
        let wi = if u[2] < self.p_specular {
            let log = (-u[0]).ln_1p() / (self.exponent + 1.0);
            let (cos, sin) = (log.exp(), (-(2.0 * log).exp_m1()).sqrt());
            let (x, y) = cos_sin_turn(u[1]);
            about(reflection(wo), sin * x, sin * y, cos).normalize()
        } else {
            cosine_hemisphere(Vec3::Z, [u[0], u[1]]).0
        };
        BsdfSample::of(wi, self.eval(wo, wi), self.pdf(wo, wi))
    }

    /// k_d + k_s: exact at normal incidence, a bound elsewhere.
    #[inline(always)]
    pub fn max_albedo(&self) -> Rgb {
        self.diffuse + self.specular
    }
}
