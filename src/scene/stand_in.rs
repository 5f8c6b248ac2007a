//! The stand-in of a scene: the same shapes with every surface Lambertian and of one colour, which a radiosity matrix can
//! represent.
//!
//! The reflectance is `ρ = ∫ f cos θ dω` at normal incidence, with the mean colour of an image. Glass becomes black, because
//! a Lambertian surface would send light to other places than glass does. The stand-in is a different scene with a different
//! solution. A guide is computed from it, which decides only where to sample and does not change the estimated image. The
//! option `--lambertian` renders the stand-in itself.

use super::bsdf::Bsdf;
use super::description::{BsdfDescription, Description, Material};
use glam::{DVec3, Vec3};

/// The same shapes and lights with Lambertian surfaces of one colour. Surfaces that already are so stay unchanged.
pub fn stand_in(description: &Description) -> Description {
    let rho = |m: &Material| m.lambertian().unwrap_or_else(|| albedo(&m.bsdf));
    let materials = description.materials.iter().map(|m| Material::diffuse(m.name.clone(), rho(m), m.sides));
    Description { materials: materials.collect(), ..description.clone() }
}

fn albedo(bsdf: &BsdfDescription) -> DVec3 {
    if bsdf.lets_through() {
        return DVec3::ZERO;
    }
    let side = Bsdf::new(bsdf, false);
    let side = bsdf.colour().map_or(side, |colour| side.with_reflectance(colour.mean().as_vec3()));
    side.albedo(Vec3::Z).as_dvec3().clamp(DVec3::ZERO, DVec3::ONE)
}
