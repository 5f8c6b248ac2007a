//! A scene with every surface Lambertian, of one colour: what a matrix can hold.
//!
//! `ρ = ∫ f cos θ dω` at normal incidence, the mean of an image where there is one; glass is black, because what lies behind it is not
//! where a Lambertian surface would send light. It is another scene with another solution: what a guide believes in, which decides where
//! to look and never what is seen, and what `--lambertian` asks for.

use super::bsdf::Bsdf;
use super::description::{BsdfDescription, Description, Material};
use glam::{DVec3, Vec3};

/// The same shapes and lights with Lambertian surfaces; those that are stay as they are.
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
