//! What an MTL material is here. The format predates microfacets; this is the mapping, first match wins.
//!
//! | statement | material |
//! |---|---|
//! | `d` < 1, or `illum` 4, 6, 7, 9 with `Ni` > 1 | dielectric of `ior` Ni (1.5 without) |
//! | `Ks` = 0, or `illum` 0, 1 | diffuse `Kd` |
//! | `illum` 3 … 9, and `Kd` at most a tenth of `Ks` | mirror `Ks` |
//! | `Ks` > 0 with `Ns` | phong: reflectance `Kd`, specular `Ks`, exponent `Ns` |
//! | `Ks` > 0 without `Ns` | diffuse `Kd` |
//!
//! `map_Kd` times `Kd` takes the place of `Kd` where polygons have `vt`. What returns more than it receives is scaled,
//! what is left out is named: both in a warning.

use super::{
    image,
    materials::{IOR, LARGEST_EXPONENT, ROUNDING, albedos, largest},
    mtl::Entry,
};
use crate::scene::{
    SceneError,
    description::{BsdfDescription, Choice, Colour},
    raster::Raster,
};
use glam::DVec3;
use std::sync::Arc;

/// Albedo of what has no `Kd`.
pub(super) const GREY: DVec3 = DVec3::splat(0.5);
/// Index of glass without `Ni`.
const GLASS: f64 = 1.5;
/// A diffuse part this much weaker than the mirror is left out.
const FAINT: f64 = 0.1;

/// A Lambertian surface without a file to say more.
pub(super) fn grey() -> BsdfDescription {
    BsdfDescription::Diffuse { reflectance: Colour::Uniform(GREY) }
}

/// How a material scatters. `placed`: its polygons have texture coordinates. `warn` receives `has …`, `is …`.
pub(super) fn bsdf(m: &Entry, placed: bool, warn: &mut dyn FnMut(String)) -> Result<BsdfDescription, SceneError> {
    if let (Some(d), Some(t)) = (m.opacity, m.transparency)
        && (d + t - 1.0).abs() > ROUNDING
    {
        warn(format!("has d {d} and Tr {t}, which contradict each other: d counts"));
    }
    if !m.ignored.is_empty() {
        warn(format!("has {} ignored", m.ignored.join(", ")));
    }
    let opaque = m.opacity.or(m.transparency.map(|t| 1.0 - t)).is_none_or(|d| d == 1.0);
    let illum = m.illum.unwrap_or(2);
    let refracts = [4, 6, 7, 9].contains(&illum);
    if !opaque || refracts && m.ior.is_some_and(|n| n > 1.0) {
        return Ok(glass(m, warn));
    }
    if refracts {
        warn(format!("has illum {illum}, but neither d below 1 nor Ni above 1: it is opaque"));
    }
    let ks = m.specular.unwrap_or(DVec3::ZERO);
    let mirrors = (3..=9).contains(&illum) && ks != DVec3::ZERO;
    if mirrors && m.diffuse.unwrap_or(DVec3::ZERO).max_element() <= FAINT * ks.max_element() {
        return Ok(mirror(m, ks, warn));
    }
    let reflectance = colour(m, placed, warn)?;
    if ks == DVec3::ZERO {
        return Ok(BsdfDescription::Diffuse { reflectance });
    }
    match m.exponent {
        _ if illum < 2 => warn(format!("has Ks, which illum {illum} leaves out")),
        None => warn("has Ks but no Ns, it is diffuse".into()),
        Some(n) if n > LARGEST_EXPONENT => warn(format!("has Ns {n}, which is too narrow a lobe: it is diffuse")),
        Some(exponent) => {
            if mirrors {
                warn(format!("mirrors in illum {illum} beside its Kd: it is a lobe of exponent {exponent}"));
            }
            return Ok(phong(reflectance, ks, exponent, warn));
        }
    }
    Ok(BsdfDescription::Diffuse { reflectance })
}

fn glass(m: &Entry, warn: &mut dyn FnMut(String)) -> BsdfDescription {
    let ior = match m.ior {
        Some(n) if (IOR[0]..=IOR[1]).contains(&n) => n,
        Some(n) => {
            warn(format!("has Ni {n} outside [{}, {}], {GLASS} is used", IOR[0], IOR[1]));
            GLASS
        }
        None => {
            warn(format!("has no Ni, {GLASS} is used"));
            GLASS
        }
    };
    if ior == 1.0 {
        warn("has Ni 1 and d below 1, it is invisible".into());
    }
    let lost = [("Kd", m.diffuse, DVec3::ZERO), ("Tf", m.filter, DVec3::ONE)];
    let mut lost: Vec<&str> = lost.iter().filter(|(_, c, none)| c.is_some_and(|c| c != *none)).map(|l| l.0).collect();
    lost.extend(m.texture.is_some().then_some("map_Kd"));
    if !lost.is_empty() {
        warn(format!("is clear glass, without its {}", lost.join(", ")));
    }
    BsdfDescription::Dielectric { ior, ior_outside: 1.0, choice: Choice::Fresnel, rough: None }
}

fn mirror(m: &Entry, ks: DVec3, warn: &mut dyn FnMut(String)) -> BsdfDescription {
    let lost = m.diffuse.is_some_and(|kd| kd != DVec3::ZERO);
    if lost || m.texture.is_some() {
        let what = if m.texture.is_some() { "Kd and map_Kd" } else { "Kd" };
        warn(format!("is a mirror, without its {what}"));
    }
    BsdfDescription::Mirror { reflectance: ks / excess("Ks reaches", ks, warn) }
}

fn phong(kd: Colour, ks: DVec3, exponent: f64, warn: &mut dyn FnMut(String)) -> BsdfDescription {
    let excess = excess("Kd + Ks reach", largest(&kd) + ks, warn);
    let reflectance = match kd {
        Colour::Uniform(kd) => Colour::Uniform(kd / excess),
        Colour::Texture(t) if excess == 1.0 => Colour::Texture(t),
        Colour::Texture(t) => Colour::Texture(Arc::new(times(&t, DVec3::splat(1.0 / excess)))),
    };
    BsdfDescription::Phong { reflectance, specular: ks / excess, exponent }
}

/// What to divide by so that no channel returns more than it receives.
fn excess(what: &str, albedo: DVec3, warn: &mut dyn FnMut(String)) -> f64 {
    let most = albedo.max_element();
    if most <= 1.0 + ROUNDING {
        return 1.0;
    }
    warn(format!("returns more than it receives, {what} {most}: divided by that"));
    most
}

/// `Kd`, or `map_Kd` times `Kd`.
fn colour(m: &Entry, placed: bool, warn: &mut dyn FnMut(String)) -> Result<Colour, SceneError> {
    let mut usable = false;
    if let Some(t) = &m.texture {
        let shown = t.path.file_name().unwrap_or_default().to_string_lossy();
        if !placed {
            warn(format!("has map_Kd {shown} on polygons without vt, Kd is used"));
        } else if !t.path.is_file() {
            warn(format!("has map_Kd {shown}, which is missing, Kd is used"));
        } else if !image::is_image(&t.path) {
            warn(format!("has map_Kd {shown}, which is no EXR, HDR, PNG or JPEG, Kd is used"));
        } else {
            usable = true;
        }
    }
    let Some(t) = m.texture.as_ref().filter(|_| usable) else {
        if m.diffuse.is_none() {
            warn("has no Kd, it is grey 0.5".into());
        }
        return Ok(Colour::Uniform(m.diffuse.unwrap_or(GREY)));
    };
    if !t.options.is_empty() {
        warn(format!("has map_Kd options {} ignored", t.options));
    }
    let factor = m.diffuse.unwrap_or(DVec3::ONE);
    if factor == DVec3::ZERO {
        warn("has Kd 0, which makes its map_Kd black".into());
    }
    let raster = albedos(&t.path).map_err(|e| e.at(&t.mtl, t.line).key(format!("{}.map_Kd", m.name)))?;
    Ok(Colour::Texture(Arc::new(if factor == DVec3::ONE { raster } else { times(&raster, factor) })))
}

fn times(raster: &Raster, factor: DVec3) -> Raster {
    Raster::new(raster.size, raster.texels.iter().map(|&t| (t.as_dvec3() * factor).as_vec3()).collect())
}
