//! Conversion of MTL materials to surfaces. The format is older than microfacet models; the first matching row of this table
//! applies.
//!
//! | statement | material |
//! |---|---|
//! | `d` < 1, or `illum` 4, 6, 7, 9 with `Ni` > 1 | dielectric with `ior` Ni (1.5 if not given) |
//! | `Ks` = 0, or `illum` 0, 1 | diffuse `Kd` |
//! | `illum` 3 … 9, and `Kd` at most a tenth of `Ks` | mirror `Ks` |
//! | `Ks` > 0 with `Ns` | phong: reflectance `Kd`, specular `Ks`, exponent `Ns` |
//! | `Ks` > 0 without `Ns` | diffuse `Kd` |
//!
//! Each kind of surface accepts its own materials ([`Surface::from_mtl`](crate::scene::bsdf::Surface::from_mtl)); this
//! module offers the material to them. If polygons have `vt`, `map_Kd` times `Kd` replaces `Kd`. A material that reflects
//! more light than it receives is scaled, and unused statements are ignored. A warning reports both.

use super::keys::ROUNDING;
use super::mtl::Entry;
use super::mtl_material::{GREY, MtlMaterial};
use crate::scene::{
    SceneError,
    bsdf::register::KINDS,
    description::{BsdfDescription, Colour, DiffuseSurface},
};

/// The Lambertian surface of a material that no MTL file defines.
pub(super) fn grey() -> BsdfDescription {
    DiffuseSurface { reflectance: Colour::Uniform(GREY) }.into()
}

/// The surface of an MTL material. `placed` is true if its polygons have texture coordinates. `warn` receives messages that
/// start with `has` or `is`.
pub(super) fn surface(m: &Entry, placed: bool, warn: &mut dyn FnMut(String)) -> Result<BsdfDescription, SceneError> {
    if let Some(fault) = &m.fault {
        return Err(fault.clone());
    }
    if let (Some(d), Some(t)) = (m.opacity, m.transparency)
        && (d + t - 1.0).abs() > ROUNDING
    {
        warn(format!("has d {d} and Tr {t}, which contradict each other; d is used"));
    }
    if !m.ignored.is_empty() {
        warn(format!("has statements that are ignored: {}", m.ignored.join(", ")));
    }
    let mut m = MtlMaterial { entry: m, placed, warn };
    if m.refracts() && !m.is_glass() {
        let illum = m.illum();
        m.warn(format!("has illum {illum}, but neither d below 1 nor Ni above 1, so it is opaque"));
    }
    for kind in KINDS.iter().rev() {
        if let Some(found) = (kind.from_mtl)(&mut m)? {
            return Ok(found);
        }
    }
    Ok(grey())
}
