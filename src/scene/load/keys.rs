//! Keys that several kinds of material share, with the limits that energy conservation sets.
//!
//! | symbol | meaning | legal |
//! |---|---|---|
//! | ρ | `reflectance`, or each texel of `texture` | [0, 1] |
//! | ρ + s | sum of the albedo and `specular`, per channel | at most 1 |
//! | η | `ior`, `ior_outside` | [1, 10] |
//! | η + ik | `eta`, `k` of a metal | (0, 100], [0, 100] |
//! | α | `alpha`, roughness of GGX (Walter, Marschner, Li and Torrance 2007), as it enters the distribution | [0.001, 1] |

use super::cursor::{Cursor, beside};
use super::image;
use crate::scene::SceneError;
use crate::scene::bsdf::colour::Colour;
use crate::scene::bsdf::ggx::{Ggx, Masking};
use crate::scene::raster::Raster;
use glam::DVec3;
use std::sync::Arc;

/// Smallest roughness α; in `f32` a smaller one cannot be distinguished from a smooth surface.
const NARROWEST: f64 = 0.001;
/// Allowed indices of refraction, from vacuum to above every solid.
pub(in crate::scene) const IOR: [f64; 2] = [1.0, 10.0];
/// Largest exponent of a lobe; in `f32` a narrower lobe cannot be distinguished from a mirror.
pub(in crate::scene) const LARGEST_EXPONENT: f64 = 1e6;
/// Largest excess over 1 that the rounding of decimal fractions may cause in a sum.
pub(in crate::scene) const ROUNDING: f64 = 1e-9;
/// Example of a reflectance in help texts.
pub(in crate::scene) const REFLECTANCE: &str = "reflectance = [r, g, b] with values in [0, 1]";

/// Reads `reflectance` or `texture`.
///
/// # Errors
/// If neither or both keys are given, or an albedo is above 1.
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

/// Reads the microfacets (`alpha`, `masking`); `None` if `alpha` is not given.
///
/// # Errors
/// If `alpha` is outside the range that can be computed, or `masking` is given without it.
pub fn rough(c: &Cursor) -> Result<Option<Ggx>, SceneError> {
    let Some(at) = c.get("alpha") else {
        return match c.get("masking") {
            Some(m) => Err(m
                .error("masking is given without alpha")
                .help("a smooth surface has no masking: add alpha, or remove masking")),
            None => Ok(None),
        };
    };
    let alpha = at.number()?;
    if alpha < NARROWEST {
        let e = at.error(format!("alpha {alpha} is below {NARROWEST}"));
        return Err(e.help("leave alpha out for a smooth surface"));
    }
    if alpha > 1.0 {
        return Err(at.error(format!("alpha {alpha} is above 1")).help("the largest roughness is 1"));
    }
    let words = [("height-correlated", Masking::HeightCorrelated), ("separable", Masking::Separable)];
    let masking = c.get("masking").map_or(Ok(Masking::HeightCorrelated), |m| m.choice("kind of masking", &words))?;
    Ok(Some(Ggx { alpha, masking }))
}

/// The largest albedo per channel, over all texels of an image.
pub(in crate::scene) fn largest(colour: &Colour) -> DVec3 {
    match colour {
        Colour::Uniform(rho) => *rho,
        Colour::Texture(t) => image::largest(t).as_dvec3(),
    }
}

/// Reads an image of albedos, none above 1. The caller adds the place where the file is named to the error.
pub(super) fn albedos(path: &std::path::Path) -> Result<Raster, SceneError> {
    let raster = image::read(path)?;
    match raster.texels.iter().position(|t| t.max_element() > 1.0) {
        Some(i) => {
            let (texel, value) = (image::texel(&raster, i), raster.texels[i].max_element());
            let what = format!("{texel} of `{}` reflects {value} times the light that it receives", path.display());
            Err(SceneError::new(what).help("the texels of a texture are albedos in [0, 1]"))
        }
        None => Ok(raster),
    }
}

/// The colour multiplied by `factor`.
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
