//! Keys that several kinds of material have, within what conserves energy.
//!
//! | symbol | meaning | legal |
//! |---|---|---|
//! | ρ | `reflectance`, or each texel of `texture` | [0, 1] |
//! | ρ + s | with `specular`, per channel | at most 1 |
//! | η | `ior`, `ior_outside` | [1, 10] |
//! | η + ik | `eta`, `k` of a metal | (0, 100], [0, 100] |
//! | α | `alpha`, width of GGX (Walter, Marschner, Li and Torrance 2007), not squared | [0.001, 1] |

use super::cursor::{Cursor, beside};
use super::image;
use crate::scene::SceneError;
use crate::scene::bsdf::colour::Colour;
use crate::scene::bsdf::ggx::{Ggx, Masking};
use crate::scene::raster::Raster;
use glam::DVec3;
use std::sync::Arc;

/// Widths below are smooth to `f32`.
const NARROWEST: f64 = 0.001;
/// Indices of refraction from vacuum to beyond every solid.
pub(in crate::scene) const IOR: [f64; 2] = [1.0, 10.0];
/// Lobes narrower than this exponent are mirrors to `f32`.
pub(in crate::scene) const LARGEST_EXPONENT: f64 = 1e6;
/// Sums of decimal fractions are above 1 by rounding at most this much.
pub(in crate::scene) const ROUNDING: f64 = 1e-9;
/// How a reflectance is written.
pub(in crate::scene) const REFLECTANCE: &str = "reflectance = [r, g, b] with values in [0, 1]";

/// `reflectance` or `texture`.
///
/// # Errors
/// If neither or both are there, or an albedo is above 1.
pub fn colour(c: &Cursor) -> Result<Colour, SceneError> {
    match (c.get("reflectance"), c.get("texture")) {
        (Some(_), Some(t)) => Err(t.error("reflectance and texture are both given").help("keep one of them")),
        (None, Some(t)) => {
            let raster = albedos(&beside(t.file, t.text()?)).map_err(|e| t.place(e))?;
            Ok(Colour::Texture(Arc::new(raster)))
        }
        _ => {
            let example = "reflectance = [r, g, b] with values in [0, 1], or texture = \"file.png\"";
            c.require("reflectance", example)?.reflectance().map(Colour::Uniform)
        }
    }
}

/// Microfacets (`alpha`, `masking`), if there is a width.
///
/// # Errors
/// If the width is outside of what can be computed.
pub fn rough(c: &Cursor) -> Result<Option<Ggx>, SceneError> {
    let Some(at) = c.get("alpha") else {
        return match c.get("masking") {
            Some(m) => Err(m.error("masking without alpha").help("a smooth surface masks nothing: add alpha")),
            None => Ok(None),
        };
    };
    let alpha = at.number()?;
    if alpha < NARROWEST {
        let e = at.error(format!("alpha {alpha} is below {NARROWEST}"));
        return Err(e.help("leave alpha out for a smooth surface"));
    }
    if alpha > 1.0 {
        return Err(at.error(format!("alpha {alpha} is above 1")).help("1 is as rough as GGX gets here"));
    }
    let words = [("height-correlated", Masking::HeightCorrelated), ("separable", Masking::Separable)];
    let masking = c.get("masking").map_or(Ok(Masking::HeightCorrelated), |m| m.choice("kind of masking", &words))?;
    Ok(Some(Ggx { alpha, masking }))
}

/// The largest albedo of each channel.
pub(in crate::scene) fn largest(colour: &Colour) -> DVec3 {
    match colour {
        Colour::Uniform(rho) => *rho,
        Colour::Texture(t) => image::largest(t).as_dvec3(),
    }
}

/// An image of albedos, none above 1. Whoever named the file adds the place to the error.
pub(super) fn albedos(path: &std::path::Path) -> Result<Raster, SceneError> {
    let raster = image::read(path)?;
    match raster.texels.iter().position(|t| t.max_element() > 1.0) {
        Some(i) => {
            let (texel, value) = (image::texel(&raster, i), raster.texels[i].max_element());
            let what = format!("{texel} of `{}` reflects {value}, more than it receives", path.display());
            Err(SceneError::new(what).help("the texels of a texture are albedos in [0, 1]"))
        }
        None => Ok(raster),
    }
}

/// A colour that is so much darker.
pub(in crate::scene) fn times(colour: Colour, factor: f64) -> Colour {
    match colour {
        Colour::Uniform(c) => Colour::Uniform(c * factor),
        Colour::Texture(t) if factor == 1.0 => Colour::Texture(t),
        Colour::Texture(t) => Colour::Texture(Arc::new(times_raster(&t, DVec3::splat(factor)))),
    }
}

pub(super) fn times_raster(raster: &Raster, factor: DVec3) -> Raster {
    Raster::new(raster.size, raster.texels.iter().map(|&t| (t.as_dvec3() * factor).as_vec3()).collect())
}
