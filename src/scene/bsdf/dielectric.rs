//! Smooth glass: part of the light is reflected, the rest refracted.
//!
//! ```text
//! f = F δ(ω_i − r(ω_o))/cos θ_i + (1 − F) e δ(ω_i − t(ω_o))/|cos θ_i|        e = 1/η² for radiance, 1 for flux
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | η | index on the side of ω_i beyond the surface over that on the side of ω_o | [`Interface`] |
//! | F | Fresnel reflectance; 1 under total internal reflection | [`Interface::reflectance`] |
//! | t(ω_o) | (−x/η, −y/η, −g/η), Snell's law | [`Dielectric::sample`] |
//! | p | probability of reflection: F, or a constant | [`Odds::of_reflection`] |
//!
//! Refraction into the denser side squeezes a beam, so that radiance over η² is what stays along a ray; flux is not
//! squeezed. References: Born and Wolf, *Principles of Optics* (7th ed. 1999), section 1.5; Veach, *Non-symmetric
//! Scattering in Light Transport Algorithms* (EGWR 1996).

use super::fresnel::Interface;
use super::mirror::reflection;
use super::{BsdfSample, TransportMode};
use crate::math::Rgb;
use crate::scene::description::Choice;
use glam::Vec3;

/// How reflection or refraction is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Odds {
    /// By F.
    Fresnel,
    /// By a constant, unless nothing is refracted.
    Constant(f32),
}

impl Odds {
    /// From a description.
    pub fn new(choice: Choice) -> Self {
        match choice {
            Choice::Fresnel => Self::Fresnel,
            Choice::Constant(p) => Self::Constant(p as f32),
        }
    }

    /// p, where the reflectance is `f`.
    #[inline(always)]
    pub fn of_reflection(self, f: f32) -> f32 {
        match self {
            Self::Constant(p) if f < 1.0 => p,
            _ => f,
        }
    }
}

/// A smooth boundary between two dielectrics, seen from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// The indices.
    pub interface: Interface,
    /// How a side is chosen.
    pub odds: Odds,
}

impl Dielectric {
    /// Reflects if `u` < p, refracts otherwise.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, mode: TransportMode, u: f32) -> BsdfSample {
        let f = self.interface.reflectance(wo.z);
        let p = self.odds.of_reflection(f);
        match self.interface.refracted(wo.z) {
            Some(g) if u >= p => {
                let wi = Vec3::new(-wo.x, -wo.y, -g) / self.interface.eta;
                let weight = (1.0 - f) / (1.0 - p) * mode.squeezed(self.interface.eta2());
                BsdfSample { wi: wi.normalize(), weight: Rgb::splat(weight), pdf: 1.0 - p, delta: true }
            }
            _ => BsdfSample { wi: reflection(wo), weight: Rgb::splat(f / p), pdf: p, delta: true },
        }
    }
}
