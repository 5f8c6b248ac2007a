//! The perfect mirror: `f = ρ δ(ω_i − r(ω_o))/cos θ_i`, with r the reflection about the normal.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | ρ | albedo, the same at every angle | [`Mirror::reflectance`] |
//! | r(ω_o) | (−x, −y, z) | [`reflection`] |
//!
//! Reference: Euclid, *Catoptrics* (c. 300 BC), proposition 1.

use super::colour::rgb;
use super::{BsdfSample, Model, Sampling, Surface, TransportMode};
use crate::math::Rgb;
use crate::scene::SceneError;
use crate::scene::load::{Cursor, MtlMaterial, keys};
use glam::{DVec3, Vec3};

/// A mirror that reflects the fraction ρ at every angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// ρ: albedo per channel.
    pub reflectance: Rgb,
}

impl Model for Mirror {
    /// The mirror direction, the only possible one.
    #[inline(always)]
    fn sample(&self, wo: Vec3, _: Sampling, _: TransportMode, _: [f32; 3]) -> Option<BsdfSample> {
        Some(BsdfSample { wi: reflection(wo), weight: self.reflectance, pdf: 1.0, delta: true })
    }
    fn max_albedo(&self) -> Rgb {
        self.reflectance
    }
    fn connects(&self) -> bool {
        false
    }
    fn has_delta(&self) -> bool {
        true
    }
}

/// A mirror as described in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorSurface {
    /// Albedo per channel, in [0, 1].
    pub reflectance: DVec3,
}

impl Surface for MirrorSurface {
    type Side = Mirror;
    const KIND: &'static str = "mirror";
    const KEYS: &'static [&'static str] = &["reflectance"];

    fn read(c: &Cursor<'_>) -> Result<Self, SceneError> {
        Ok(Self { reflectance: c.require("reflectance", keys::REFLECTANCE)?.reflectance()? })
    }
    /// An MTL material is a mirror if `illum` is 3 … 9 and `Kd` is at most a tenth of `Ks`.
    fn from_mtl(m: &mut MtlMaterial<'_>) -> Result<Option<Self>, SceneError> {
        if !m.is_mirror() {
            return Ok(None);
        }
        if let Some(lost) = m.base() {
            m.warn(format!("is rendered as a mirror, without its {lost}"));
        }
        let ks = m.specular();
        Ok(Some(Self { reflectance: ks / m.excess("Ks reaches", ks) }))
    }
    fn side(&self, _: bool) -> Mirror {
        Mirror { reflectance: self.reflectance.as_vec3() }
    }
    fn words(&self) -> String {
        format!("reflectance {}", rgb(self.reflectance))
    }
    fn examples() -> Vec<Self> {
        vec![Self { reflectance: DVec3::new(0.9, 0.8, 0.7) }]
    }
}

/// r(ω_o): the mirror direction (−x, −y, z).
#[inline(always)]
pub fn reflection(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}
