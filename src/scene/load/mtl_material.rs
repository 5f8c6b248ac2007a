//! An MTL material, with the questions that the kinds of surface ask in order to accept it.

use super::keys::{LARGEST_EXPONENT, ROUNDING, albedos, times_raster};
use super::{image, mtl::Entry};
use crate::scene::SceneError;
use crate::scene::bsdf::colour::Colour;
use glam::DVec3;
use std::sync::Arc;

/// A number without the digits that are only rounding, such as 1.14 in place of 1.1400000000000001.
fn rounded(x: f64) -> f64 {
    format!("{x:.6e}").parse().unwrap_or(x)
}

/// Albedo of a material without `Kd`.
pub(super) const GREY: DVec3 = DVec3::splat(0.5);
/// A mirror ignores its diffuse part if the ratio of `Kd` to `Ks` is at most this.
const FAINT: f64 = 0.1;

/// An MTL material that is offered to the kinds of surface.
pub struct MtlMaterial<'a> {
    pub(in crate::scene) entry: &'a Entry,
    pub(super) placed: bool,
    pub(super) warn: &'a mut dyn FnMut(String),
}

impl MtlMaterial<'_> {
    /// Adds a warning about something that is ignored or changed. The text continues "material NAME" and starts with `has`
    /// or `is`.
    pub fn warn(&mut self, what: String) {
        (self.warn)(what);
    }

    /// `illum`; 2 if it is not given.
    pub fn illum(&self) -> u32 {
        self.entry.illum.unwrap_or(2)
    }

    /// `Ks`; black if it is not given.
    pub fn specular(&self) -> DVec3 {
        self.entry.specular.unwrap_or(DVec3::ZERO)
    }

    pub(super) fn refracts(&self) -> bool {
        [4, 6, 7, 9].contains(&self.illum())
    }

    /// Returns true if light passes through the material.
    pub fn is_glass(&self) -> bool {
        let m = self.entry;
        let opaque = m.opacity.or(m.transparency.map(|t| 1.0 - t)).is_none_or(|d| d == 1.0);
        !opaque || self.refracts() && m.ior.is_some_and(|n| n > 1.0)
    }

    /// Returns true if the material has a mirror part.
    pub fn mirrors(&self) -> bool {
        (3..=9).contains(&self.illum()) && self.specular() != DVec3::ZERO
    }

    /// Returns true if the material is a mirror with almost no other part.
    pub fn is_mirror(&self) -> bool {
        let kd = self.entry.diffuse.unwrap_or(DVec3::ZERO).max_element();
        !self.is_glass() && self.mirrors() && kd <= FAINT * self.specular().max_element()
    }

    /// The reason why `Ks` does not become a lobe; `None` if it does, or if there is no `Ks`.
    pub fn lost_lobe(&self) -> Option<String> {
        if self.specular() == DVec3::ZERO {
            return None;
        }
        match self.entry.exponent {
            _ if self.illum() < 2 => Some(format!("has Ks, which illum {} does not use", self.illum())),
            None => Some("has Ks but no Ns, so it is rendered as diffuse".into()),
            Some(n) if n > LARGEST_EXPONENT => {
                Some(format!("has Ns {n}, which makes the lobe too narrow; it is rendered as diffuse"))
            }
            Some(_) => None,
        }
    }

    /// The names of the diffuse statements that a mirror ignores; `None` if there are none.
    pub fn base(&self) -> Option<&'static str> {
        if self.entry.texture.is_some() {
            return Some("Kd and map_Kd");
        }
        self.entry.diffuse.is_some_and(|kd| kd != DVec3::ZERO).then_some("Kd")
    }

    /// The names of the colours that clear glass ignores.
    pub fn tints(&self) -> Vec<&'static str> {
        let m = self.entry;
        let lost = [("Kd", m.diffuse, DVec3::ZERO), ("Tf", m.filter, DVec3::ONE)];
        let lost = lost.iter().filter(|(_, c, none)| c.is_some_and(|c| c != *none)).map(|l| l.0);
        lost.chain(m.texture.is_some().then_some("map_Kd")).collect()
    }

    /// The number by which to divide the albedo so that no channel exceeds 1; warns if it is not 1.
    pub fn excess(&mut self, what: &str, albedo: DVec3) -> f64 {
        let most = albedo.max_element();
        if most <= 1.0 + ROUNDING {
            return 1.0;
        }
        self.warn(format!(
            "reflects more light than it receives: {what} {}, so its colours are divided by that",
            rounded(most)
        ));
        most
    }

    /// The diffuse colour: `Kd`, or `map_Kd` times `Kd`.
    ///
    /// # Errors
    /// If the image cannot be read, or a texel of it is above 1.
    pub fn colour(&mut self) -> Result<Colour, SceneError> {
        let m = self.entry;
        let mut usable = false;
        if let Some(t) = &m.texture {
            let shown = t.path.file_name().unwrap_or_default().to_string_lossy();
            if !self.placed {
                self.warn(format!("has map_Kd {shown}, but its polygons have no vt; Kd is used"));
            } else if !t.path.is_file() {
                self.warn(format!("has map_Kd {shown}, but there is no file {}; Kd is used", t.path.display()));
            } else if !image::is_image(&t.path) {
                self.warn(format!("has map_Kd {shown}, which is not an EXR, HDR, PNG or JPEG file; Kd is used"));
            } else {
                usable = true;
            }
        }
        let Some(t) = m.texture.as_ref().filter(|_| usable) else {
            if m.diffuse.is_none() {
                self.warn("has no Kd; grey 0.5 is used".into());
            }
            return Ok(Colour::Uniform(m.diffuse.unwrap_or(GREY)));
        };
        if !t.options.is_empty() {
            self.warn(format!("has map_Kd options that are ignored: {}", t.options));
        }
        let factor = m.diffuse.unwrap_or(DVec3::ONE);
        if factor == DVec3::ZERO {
            self.warn("has Kd 0, which makes its map_Kd black".into());
        }
        let raster = albedos(&t.path).map_err(|e| e.at(&t.mtl, t.line).key(format!("{}.map_Kd", m.name)))?;
        Ok(Colour::Texture(Arc::new(if factor == DVec3::ONE { raster } else { times_raster(&raster, factor) })))
    }
}
