//! Rough glass: every microfacet reflects and refracts like smooth glass.
//!
//! ```text
//! reflection     f = F D G/(4 |cos θ_o| |cos θ_i|)                                          h ∝ ω_o + ω_i
//! transmission   f = (1 − F) D G η² e (ω_o·h) |ω_i·h|/(|ω_o + η ω_i|² |cos θ_o| |cos θ_i|)   h ∝ ±(ω_o + η ω_i)
//! densities      p D_ωo(h)/(4 ω_o·h)        (1 − p) D_ωo(h) η² |ω_i·h|/|ω_o + η ω_i|²
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | η, F, p, e | as for smooth glass, with the micronormal in place of the normal | [`super::dielectric`] |
//! | h | normal of a microfacet (micronormal), on the side of ω_o | `facet` |
//! | D, G, D_ωo | microfacet distribution, masking and shadowing, density of the normals visible from ω_o | [`super::ggx`] |
//! | η² abs(ω_i·h)/abs(ω_o + η ω_i)² | dh/dω_i of a refraction | `jacobian` |
//!
//! Reference: Walter, Marschner, Li and Torrance, *Microfacet Models for Refraction through Rough Surfaces* (EGSR 2007),
//! with the visible normals of [`super::ggx`]. The weights f |cos θ_i|/p of reflection and of transmission are those of
//! smooth glass times G/G₁(ω_o).

use super::fresnel::Interface;
use super::ggx::{Microfacets, half, reflect};
use super::model::sample_blindly;
use super::odds::Odds;
use super::{BsdfSample, Model, Sampling, TransportMode};
use crate::math::Rgb;
use glam::Vec3;

/// A rough boundary between two dielectrics, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    /// The indices on both sides.
    pub interface: Interface,
    /// Rule that chooses between reflection and refraction at each microfacet.
    pub odds: Odds,
    /// The microfacets.
    pub facets: Microfacets,
}

/// The microfacet that reflects or refracts ω_o to ω_i.
#[derive(Clone, Copy, Debug)]
struct Facet {
    h: Vec3,
    /// ω_o·h.
    cosine: f32,
    /// dh/dω_i.
    jacobian: f32,
    /// F for a reflection, 1 − F for a refraction.
    share: f32,
    /// p for a reflection, 1 − p for a refraction.
    probability: f32,
}

impl RoughDielectric {
    /// The only microfacet that takes ω_o to ω_i; `None` if there is none.
    #[inline(always)]
    fn facet(&self, wo: Vec3, wi: Vec3) -> Option<Facet> {
        if wi.z > 0.0 {
            let (h, cosine) = half(wo, wi);
            let share = self.interface.reflectance(cosine);
            let probability = self.odds.of_reflection(share);
            return Some(Facet { h, cosine, jacobian: 0.25 / cosine, share, probability });
        }
        let sum = wo + self.interface.eta * wi;
        let length = sum.length();
        let h = if sum.z > 0.0 { sum } else { -sum } / length;
        let (co, ci) = (wo.dot(h), -wi.dot(h));
        if wi.z == 0.0 || co <= 0.0 || ci <= 0.0 {
            return None;
        }
        let f = self.interface.between(co, self.interface.eta * ci);
        if f >= 1.0 {
            return None;
        }
        let jacobian = self.interface.eta2() * ci / (length * length);
        Some(Facet { h, cosine: co, jacobian, share: 1.0 - f, probability: 1.0 - self.odds.of_reflection(f) })
    }

    /// e for a sample in direction ω_i: 1 for a reflection.
    #[inline(always)]
    fn squeezed(&self, wi: Vec3, mode: TransportMode) -> f32 {
        if wi.z > 0.0 { 1.0 } else { mode.squeezed(self.interface.eta2()) }
    }

    #[inline(always)]
    fn density(&self, wo: Vec3, m: &Facet) -> f32 {
        m.probability * self.facets.visible(wo.z, m.h) * m.cosine * m.jacobian
    }
}

impl Model for RoughDielectric {
    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> Rgb {
        let Some(m) = self.facet(wo, wi) else { return Rgb::ZERO };
        let seen = 4.0 * self.facets.seen(wo.z, wi.z.abs()) * m.cosine;
        Rgb::splat(m.share * self.facets.d(m.h) * seen * m.jacobian * self.squeezed(wi, mode))
    }

    #[inline(always)]
    fn pdf(&self, wo: Vec3, wi: Vec3, sampling: Sampling) -> f32 {
        if sampling != Sampling::Bsdf {
            return 0.5 * sampling.pdf(wi.z.abs());
        }
        match self.facet(wo, wi) {
            Some(m) => self.density(wo, &m),
            None => 0.0,
        }
    }

    /// Samples a normal visible from ω_o, then reflects there if `u[2]` < p and refracts otherwise. `None` if the result is
    /// on the wrong side of the surface.
    #[inline(always)]
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample> {
        if sampling != Sampling::Bsdf {
            return sample_blindly(self, wo, sampling, mode, u);
        }
        let h = self.facets.sample(wo, [u[0], u[1]]);
        let c = wo.dot(h);
        if c <= 0.0 {
            return None;
        }
        let p = self.odds.of_reflection(self.interface.reflectance(c));
        let wi = match self.interface.refracted(c) {
            Some(g) if u[2] >= p => (((c - g) * h - wo) / self.interface.eta).normalize(),
            _ => reflect(wo, h),
        };
        let reflected = u[2] < p;
        if (wi.z > 0.0) != reflected {
            return None;
        }
        // computed from the pair of directions, as in eval and pdf
        let m = self.facet(wo, wi)?;
        let pdf = self.density(wo, &m);
        let weight = m.share / m.probability * self.facets.lit(wo.z, wi.z.abs()) * self.squeezed(wi, mode);
        let sample = BsdfSample { wi, weight: Rgb::splat(weight), pdf, delta: false };
        if pdf > 0.0 { Some(sample) } else { None }
    }

    fn max_albedo(&self) -> Rgb {
        Rgb::ONE
    }
    fn transmits(&self) -> bool {
        true
    }
}
