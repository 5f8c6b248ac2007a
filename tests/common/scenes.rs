//! Scenes as lists of surfaces, one material each.

use fredholm::scene::description::{CameraDescription, Description, Geometry, Material, Shape, Sides};
use glam::DVec3;

/// A one-sided surface: geometry, albedo, emission.
pub type Surface = (Geometry, DVec3, DVec3);

/// A description of these surfaces, with a camera at the origin that looks down −z.
pub fn description(surfaces: &[Surface]) -> Description {
    let material = |(i, s): (usize, &Surface)| Material::diffuse(i.to_string(), s.1, Sides::Front);
    let shape = |(i, s): (usize, &Surface)| Shape {
        name: format!("shapes[{i}]"),
        geometry: s.0.clone(),
        material: i,
        emission: s.2,
    };
    Description {
        name: "test".into(),
        camera: CameraDescription { origin: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y, fov: 90.0, size: [8, 8] },
        materials: surfaces.iter().enumerate().map(material).collect(),
        shapes: surfaces.iter().enumerate().map(shape).collect(),
        lights: vec![],
        expect: None,
    }
}

/// A whole sphere.
pub fn sphere(center: DVec3, radius: f64, inward: bool) -> Geometry {
    Geometry::Sphere { center, radius, z: [-1.0, 1.0], inward }
}

/// The inside of a sphere about the origin, in bands from the north pole down: `cuts` are z/R.
pub fn bands(radius: f64, cuts: &[f64], rho: &[f64], emission: &[f64]) -> Vec<Surface> {
    let band = |i: usize| {
        let z = [cuts[i + 1], cuts[i]];
        let geometry = Geometry::Sphere { center: DVec3::ZERO, radius, z, inward: true };
        (geometry, DVec3::splat(rho[i]), DVec3::splat(emission[i]))
    };
    (0..rho.len()).map(band).collect()
}

/// An inward box turned by `degrees` about the vertical.
pub fn room(min: DVec3, max: DVec3, degrees: f64) -> Geometry {
    Geometry::Box { min, max, rotate_y: degrees, inward: true }
}

pub fn quad(origin: DVec3, edge_u: DVec3, edge_v: DVec3) -> Geometry {
    Geometry::Quad { origin, edge_u, edge_v }
}

/// The faces −x, +x, −y, +y, −z, +z of the unit cube [0, 1]³, fronts inside.
pub fn cube_faces() -> [Geometry; 6] {
    let e = [DVec3::X, DVec3::Y, DVec3::Z];
    std::array::from_fn(|i| {
        let (axis, far) = (i / 2, i % 2);
        let (u, v) = (e[(axis + 1) % 3], e[(axis + 2) % 3]);
        let origin = e[axis] * far as f64;
        if far == 0 { quad(origin, u, v) } else { quad(origin, v, u) }
    })
}
