//! Reading of `[[lights]]`: lights without a surface.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | I | radiant intensity of a point light, W·sr⁻¹ | `intensity` |
//! | E⊥ | irradiance of a surface perpendicular to parallel light, W·m⁻² | `irradiance` |
//! | L(ω) | radiance from infinity, W·sr⁻¹·m⁻² | `radiance` or `file`, times `scale` |

use super::{
    beside,
    cursor::{Cursor, LARGEST_LIGHT, SMALLEST_LENGTH},
    image,
};
use crate::scene::{
    SceneError,
    description::{LightDescription, Sky},
    raster::Raster,
};
use glam::DVec3;
use std::sync::Arc;

/// The kinds of light, each with its keys.
pub(super) const KINDS: [(&str, &[&str]); 3] = [
    ("point", &["type", "position", "intensity"]),
    ("directional", &["type", "direction", "irradiance"]),
    ("environment", &["type", "radiance", "file", "mapping", "rotate", "scale"]),
];

/// Mapping between the directions of the sky and the pixels of an image.
#[derive(Clone, Copy)]
enum Mapping {
    LatLong,
    MirrorBall,
}
const MAPPINGS: [(&str, Mapping); 2] = [("latlong", Mapping::LatLong), ("mirror-ball", Mapping::MirrorBall)];

/// Reads every light, in file order.
pub(super) fn read(list: &Cursor) -> Result<Vec<LightDescription>, SceneError> {
    let mut out: Vec<LightDescription> = Vec::new();
    for c in list.items("an array of tables, [[lights]]")? {
        let at = c.require("type", "type = \"point\"; types: point, directional, environment")?;
        let kinds: Vec<(&str, (&str, &[&str]))> = KINDS.iter().map(|&(k, keys)| (k, (k, keys))).collect();
        let (kind, keys) = at.choice("type of light", &kinds)?;
        c.only(keys)?;
        out.push(match kind {
            "point" => point(&c)?,
            "directional" => directional(&c)?,
            _ if out.iter().any(|l| matches!(l, LightDescription::Environment { .. })) => {
                let e = at.error("there is a second environment");
                return Err(e.help("a scene has only one sky: merge the two images into one"));
            }
            _ => environment(&c)?,
        });
    }
    Ok(out)
}

/// Returns true if a light emits nothing.
pub(super) fn dark(light: &LightDescription) -> bool {
    let black = |r: &Raster| image::largest(r).max_element() == 0.0;
    match light {
        LightDescription::Point { intensity: i, .. } | LightDescription::Directional { irradiance: i, .. } => {
            *i == DVec3::ZERO
        }
        LightDescription::Environment { scale: 0.0, .. } => true,
        LightDescription::Environment { sky: Sky::Constant(l), .. } => *l == DVec3::ZERO,
        LightDescription::Environment { sky: Sky::LatLong(r) | Sky::MirrorBall(r), .. } => black(r),
    }
}

fn point(c: &Cursor) -> Result<LightDescription, SceneError> {
    let position = c.require("position", "the position of the light: position = [0, 1, 0]")?.vector()?;
    let intensity =
        c.require("intensity", "the radiant intensity in W/sr: intensity = [1, 1, 1]")?.light("intensity")?;
    Ok(LightDescription::Point { position, intensity })
}

fn directional(c: &Cursor) -> Result<LightDescription, SceneError> {
    let at = c.require("direction", "the direction in which the light travels: direction = [0, -1, 0]")?;
    let direction = at.vector()?;
    if direction.length() < SMALLEST_LENGTH {
        return Err(at
            .error("the direction has zero length")
            .help("write the direction in which the light travels, such as [0, -1, 0]"));
    }
    let example = "the irradiance of a surface perpendicular to the light, in W/m²: irradiance = [1, 1, 1]";
    let irradiance = c.require("irradiance", example)?.light("irradiance")?;
    Ok(LightDescription::Directional { direction, irradiance })
}

fn environment(c: &Cursor) -> Result<LightDescription, SceneError> {
    let sky = match (c.get("radiance"), c.get("file")) {
        (Some(_), Some(file)) => {
            return Err(file.error("radiance and file are both given").help("keep one of them"));
        }
        (None, Some(file)) => photograph(c, &file)?,
        _ => {
            let example = "radiance = [1, 1, 1] for a constant sky, or file = \"sky.exr\"";
            let radiance = c.require("radiance", example)?.light("radiance")?;
            if let Some(mapping) = c.get("mapping") {
                return Err(mapping
                    .error("mapping is given without file")
                    .help("a constant sky has no mapping: remove the key"));
            }
            Sky::Constant(radiance)
        }
    };
    let rotate = c.get("rotate").map_or(Ok(0.0), |r| r.number())?;
    let scale = c.get("scale").map_or(Ok(1.0), |s| s.within("scale", 0.0, LARGEST_LIGHT))?;
    let brightest = match &sky {
        Sky::Constant(l) => l.max_element(),
        Sky::LatLong(r) | Sky::MirrorBall(r) => f64::from(image::largest(r).max_element()),
    };
    if brightest * scale > LARGEST_LIGHT {
        let at = c.get("scale").or(c.get("file")).unwrap_or(c.clone());
        return Err(at.error(format!("the radiance {:.3e} is too large", brightest * scale)).help("stay below 1e30"));
    }
    Ok(LightDescription::Environment { sky, rotate, scale })
}

fn photograph(c: &Cursor, file: &Cursor) -> Result<Sky, SceneError> {
    let mapping = c.get("mapping").map_or(Ok(Mapping::LatLong), |m| m.choice("mapping of a sky", &MAPPINGS))?;
    let raster = image::read(&beside(file.file, file.text()?)).map_err(|e| file.place(e))?;
    let [w, h] = raster.size;
    match mapping {
        Mapping::MirrorBall if w != h => {
            let e = file.error(format!("the photograph of a mirror sphere is {w}×{h} pixels, not square"));
            Err(e.help("crop it to the square around the sphere"))
        }
        Mapping::MirrorBall => Ok(Sky::MirrorBall(Arc::new(raster))),
        Mapping::LatLong => Ok(Sky::LatLong(Arc::new(raster))),
    }
}
