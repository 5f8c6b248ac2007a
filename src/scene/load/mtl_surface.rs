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
//! Each kind takes what is its own ([`Surface::from_mtl`](crate::scene::bsdf::Surface::from_mtl)); what they ask is here. `map_Kd` times
//! `Kd` takes the place of `Kd` where polygons have `vt`. What returns more than it receives is scaled, what is left out is named: both
//! in a warning.

use super::keys::ROUNDING;
use super::mtl::Entry;
use super::mtl_material::{GREY, MtlMaterial};
use crate::scene::{
    SceneError,
    bsdf::register::KINDS,
    description::{BsdfDescription, Colour, DiffuseSurface},
};

/// A Lambertian surface without a file to say more.
pub(super) fn grey() -> BsdfDescription {
    DiffuseSurface { reflectance: Colour::Uniform(GREY) }.into()
}

/// How a material scatters. `placed`: its polygons have texture coordinates. `warn` receives `has …`, `is …`.
pub(super) fn surface(m: &Entry, placed: bool, warn: &mut dyn FnMut(String)) -> Result<BsdfDescription, SceneError> {
    if let (Some(d), Some(t)) = (m.opacity, m.transparency)
        && (d + t - 1.0).abs() > ROUNDING
    {
        warn(format!("has d {d} and Tr {t}, which contradict each other: d counts"));
    }
    if !m.ignored.is_empty() {
        warn(format!("has {} ignored", m.ignored.join(", ")));
    }
    let mut m = MtlMaterial { entry: m, placed, warn };
    if m.refracts() && !m.is_glass() {
        let illum = m.illum();
        m.warn(format!("has illum {illum}, but neither d below 1 nor Ni above 1: it is opaque"));
    }
    for kind in KINDS.iter().rev() {
        if let Some(found) = (kind.from_mtl)(&mut m)? {
            return Ok(found);
        }
    }
    Ok(grey())
}
