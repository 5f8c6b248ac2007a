//! Metals, smooth or rough.
//!
//! ```text
//! smooth   f = F(ω_o·n) δ(ω_i − r(ω_o))/cos θ_i
//! rough    f = F(ω_o·h) D(h) G(ω_o, ω_i)/(4 cos θ_o cos θ_i)        p(ω_i) = D_ωo(h)/(4 ω_o·h)
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | F | Fresnel reflectance of η + ik, or one colour at every angle | [`Conductor::fresnel`] |
//! | h | half-way between ω_o and ω_i | [`half`] |
//! | D, G, D_ωo | microfacets | [`super::ggx`] |
//! | 4 ω_o·h | dω_i/dh of a reflection | [`Conductor::pdf`] |
//!
//! Light that a microfacet reflects onto another is lost, so a rough metal with F = 1 has an albedo below 1. The weight
//! f cos θ_i/p = F G/G₁(ω_o) is at most F.
//!
//! References: Torrance and Sparrow, *Theory for Off-Specular Reflection From Roughened Surfaces* (JOSA 57(9), 1967);
//! Cook and Torrance, *A Reflectance Model for Computer Graphics* (TOG 1(1), 1982); microfacets as in [`super::ggx`].

use super::ggx::{Microfacets, half, reflect};
use super::mirror::reflection;
use super::{BsdfSample, fresnel, rgb};
use crate::math::Rgb;
use crate::scene::description::{Ggx, Metal};
use glam::Vec3;

/// A metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    metal: Reflects,
    /// Microfacets; smooth without.
    pub rough: Option<Microfacets>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Reflects {
    Index { eta: Rgb, k: Rgb },
    Colour(Rgb),
}

impl Conductor {
    /// From a description.
    pub fn new(metal: Metal, rough: Option<Ggx>) -> Self {
        let metal = match metal {
            Metal::Fresnel { eta, k } => Reflects::Index { eta: rgb(eta), k: rgb(k) },
            Metal::Reflectance(reflectance) => Reflects::Colour(rgb(reflectance)),
        };
        Self { metal, rough: rough.map(Microfacets::new) }
    }

    /// F at cosine c.
    #[inline(always)]
    pub fn fresnel(&self, c: f32) -> Rgb {
        match self.metal {
            Reflects::Index { eta, k } => fresnel::conductor(c, eta, k),
            Reflects::Colour(reflectance) => reflectance,
        }
    }

    /// f, sr⁻¹: zero of a smooth metal.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        match self.rough {
            Some(facets) if wi.z > 0.0 => {
                let (h, c) = half(wo, wi);
                self.fresnel(c) * (facets.d(h) * facets.seen(wo.z, wi.z))
            }
            _ => Rgb::ZERO,
        }
    }

    /// Density of [`Self::sample`], sr⁻¹.
    #[inline(always)]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self.rough {
            Some(facets) if wi.z > 0.0 => 0.25 * facets.visible(wo.z, half(wo, wi).0),
            _ => 0.0,
        }
    }

    /// The mirror direction, or the reflection by a normal seen from ω_o. None below the surface.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let Some(facets) = self.rough else {
            return Some(BsdfSample { wi: reflection(wo), weight: self.fresnel(wo.z), pdf: 1.0, delta: true });
        };
        let wi = reflect(wo, facets.sample(wo, u));
        if wi.z <= 0.0 {
            return None;
        }
        // from the pair of directions, as eval and pdf see it
        let weight = self.fresnel(half(wo, wi).1) * facets.lit(wo.z, wi.z);
        Some(BsdfSample { wi, weight, pdf: self.pdf(wo, wi), delta: false })
    }

    /// Exact for a smooth metal; for a rough one the largest F, which G/G₁ ≤ 1 can only lower.
    #[inline(always)]
    pub fn albedo(&self, wo: Vec3) -> Rgb {
        match self.rough {
            None => self.fresnel(wo.z),
            Some(_) => self.max_albedo(),
        }
    }

    /// The largest F: 1 for a complex index, where everything is reflected at grazing angles.
    #[inline(always)]
    pub fn max_albedo(&self) -> Rgb {
        match self.metal {
            Reflects::Index { .. } => Rgb::ONE,
            Reflects::Colour(reflectance) => reflectance,
        }
    }
}
