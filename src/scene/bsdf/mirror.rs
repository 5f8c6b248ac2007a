//! The perfect mirror: `f = ρ δ(ω_i − r(ω_o))/cos θ_i`, with r the reflection about the normal.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | ρ | albedo, the same at every angle | [`Mirror::reflectance`] |
//! | r(ω_o) | (−x, −y, z) | [`reflection`] |
//!
//! Reference: Euclid, *Catoptrics* (c. 300 BC), proposition 1.

use super::BsdfSample;
use crate::math::Rgb;
use glam::Vec3;

/// Reflects a share ρ, whatever the angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// ρ.
    pub reflectance: Rgb,
}

impl Mirror {
    /// The one direction there is.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3) -> BsdfSample {
        BsdfSample { wi: reflection(wo), weight: self.reflectance, pdf: 1.0, delta: true }
    }
}

/// r(ω_o).
#[inline(always)]
pub fn reflection(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}
