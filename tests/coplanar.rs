//! Surfaces that coincide: emitters lie in front, in every way of sampling and in the matrix; what has no right answer is
//! named, and only where somebody sees it.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

#[path = "coplanar/commands.rs"]
mod commands;
mod common;
#[path = "coplanar/light.rs"]
mod light;
#[path = "coplanar/overlaps.rs"]
mod overlaps;

use common::scenes::quad;
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::engine::by_matrix::Matrix;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::coplanar;
use fredholm::estimator::Technique;
use fredholm::progress::Progress;
use fredholm::scene::coplanar::{Kind, Overlap, Surfaces};
use fredholm::scene::description::{CameraDescription, Description, Geometry, Material, Shape, Sides};
use fredholm::scene::{Primitive, Scene, builtin, load};
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, Outcome, compare};
use fredholm::terms::{Estimate, Series};
use glam::{DQuat, DVec3};

/// The room of `faults/lamp_in_ceiling.toml`, two metres wide, 0.6 grey.
fn room() -> Geometry {
    Geometry::Box { min: DVec3::NEG_ONE, max: DVec3::ONE, rotate_y: 0.0, inward: true }
}

fn block(min: [f64; 3], max: [f64; 3]) -> Geometry {
    Geometry::Box { min: min.into(), max: max.into(), rotate_y: 0.0, inward: false }
}

/// A quad that is seen from below.
fn below(min: [f64; 2], max: [f64; 2], y: f64) -> Geometry {
    let v = DVec3::new;
    quad(v(min[0], y, min[1]), v(max[0] - min[0], 0.0, 0.0), v(0.0, 0.0, max[1] - min[1]))
}

/// A quad that is seen from above.
fn above(min: [f64; 2], max: [f64; 2], y: f64) -> Geometry {
    let v = DVec3::new;
    quad(v(min[0], y, min[1]), v(0.0, 0.0, max[1] - min[1]), v(max[0] - min[0], 0.0, 0.0))
}

const GREY: f64 = 0.6;

struct Part(Geometry, f64, f64, Sides);

fn dark(g: Geometry) -> Part {
    Part(g, GREY, 0.0, Sides::Front)
}

fn lamp(g: Geometry) -> Part {
    Part(g, GREY, 10.0, Sides::Front)
}

fn scene(parts: Vec<Part>) -> Description {
    let v = DVec3::new;
    let camera = CameraDescription {
        origin: v(0.0, 0.0, 0.95),
        target: v(0.0, 0.3, 0.0),
        up: DVec3::Y,
        fov: 90.0,
        size: [16, 16],
    };
    let material = |(i, p): (usize, &Part)| Material::diffuse(i.to_string(), DVec3::splat(p.1), p.3);
    let shape = |(i, p): (usize, &Part)| Shape {
        name: format!("shapes[{i}]"),
        geometry: p.0.clone(),
        material: i,
        emission: DVec3::splat(p.2),
    };
    Description {
        name: "coplanar".into(),
        camera,
        materials: parts.iter().enumerate().map(material).collect(),
        shapes: parts.iter().enumerate().map(shape).collect(),
        lights: vec![],
        expect: None,
    }
}

/// Every vertex through a map; `length` is the map's factor on lengths.
fn mapped(d: &Description, length: f64, f: impl Fn(DVec3) -> DVec3) -> Description {
    let mut d = d.clone();
    let edge = |o: DVec3, e: DVec3| f(o + e) - f(o);
    for s in &mut d.shapes {
        s.geometry = match s.geometry.clone() {
            Geometry::Quad { origin, edge_u, edge_v } => quad(f(origin), edge(origin, edge_u), edge(origin, edge_v)),
            Geometry::Box { min, max, rotate_y, inward } => {
                assert!(rotate_y == 0.0);
                Geometry::Box { min: f(min), max: f(max), rotate_y, inward }
            }
            Geometry::Disk { center, normal, radius } => {
                Geometry::Disk { center: f(center), normal: edge(center, normal), radius: length * radius }
            }
            Geometry::Sphere { center, radius, z, inward } => {
                Geometry::Sphere { center: f(center), radius: length * radius, z, inward }
            }
            Geometry::Mesh { vertices, faces, uvs } => {
                Geometry::Mesh { vertices: vertices.into_iter().map(&f).collect(), faces, uvs }
            }
        };
    }
    (d.camera.origin, d.camera.target) = (f(d.camera.origin), f(d.camera.target));
    d
}

/// The faces of a box as quads, so that it can be turned about any axis.
fn faces(g: &Geometry) -> Vec<Geometry> {
    let one = |p: &Primitive| match *p {
        Primitive::Parallelogram { origin, edge_u, edge_v } => quad(origin, edge_u, edge_v),
        _ => unreachable!(),
    };
    g.primitives().iter().map(one).collect()
}

/// Two triangles instead of a quad.
fn mesh(g: &Geometry) -> Geometry {
    let Geometry::Quad { origin: o, edge_u: u, edge_v: v } = *g else { panic!() };
    Geometry::Mesh { vertices: vec![o, o + u, o + u + v, o + v], faces: vec![[0, 1, 2], [0, 2, 3]], uvs: vec![] }
}

/// As rays and patches meet them.
fn surfaces(d: &Description) -> Surfaces {
    d.centred().scene.surfaces()
}

fn moved(s: &Surfaces, d: &Description) -> Vec<usize> {
    let before = d.centred().scene.primitives();
    (0..s.list.len()).filter(|&i| s.list[i] != before[i]).collect()
}

/// Names of the pairs that are seen and have no right answer.
fn warned(d: &Description) -> Vec<[String; 2]> {
    coplanar::seen(&Scene::new(d)).iter().map(|r| r.names.clone()).collect()
}

fn settings(technique: Technique, spp: u32, seed: u64) -> Settings {
    Settings { spp, seed, technique, max_bounces: 3, ..Settings::default() }
}

/// A lamp in the plane y = 1 as quad, mesh and disk.
fn lamp_shapes() -> [Geometry; 3] {
    let square = below([-0.3, -0.3], [0.3, 0.3], 1.0);
    [square.clone(), mesh(&square), Geometry::Disk { center: DVec3::Y, normal: DVec3::NEG_Y, radius: 0.3 }]
}

fn any_axis(noise: &mut common::Noise) -> DVec3 {
    DVec3::new(noise.uniform() - 0.5, noise.uniform() - 0.5, noise.uniform() - 0.5).normalize()
}
