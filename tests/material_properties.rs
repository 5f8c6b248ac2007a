//! What holds in every scene, tried on random ones with every material and every light.
//!
//! The strongest is [`weights_are_those_of_the_path`]: a path z_0 … z_k has one contribution F and, for each way s to find
//! it, one density p_s. Both are written down here once more, in `f64`, from positions and BSDFs alone. Whatever the
//! bidirectional estimator finds must have `value · p_s = F` and `weight = p_s / Σ p_r`. The right-hand sides do not know
//! which way found the path, so the weights of all ways sum to 1, both ends agree on F (reciprocity, with the η² of
//! refraction), and a walk's densities are those of the pair of states.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

#[path = "material_properties/any_scene.rs"]
mod any_scene;
mod common;
#[path = "material_properties/means.rs"]
mod means;
#[path = "material_properties/one_path.rs"]
mod one_path;
#[path = "material_properties/plain.rs"]
mod plain;

use common::judge::Jury;
use common::ledger;
use common::random::{cases, draw, glass, items, opaque, schedule, world};
use common::sampling::{Start, Starts, collect, plan};
use common::scenes::{description, quad, room, sphere};
use fredholm::estimator::bidirectional::Found;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{
    Batch, Bidirectional, Job, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, Technique,
};
use fredholm::math::direction::Frame;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::SurfaceStrip;
use fredholm::operator::{Adjoint, Role, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::{Bsdf, Sampling, TransportMode};
use fredholm::scene::description::{BsdfDescription, Description, Geometry, LightDescription, Shape, Sides};
use fredholm::scene::emitter::environment::Environment;
use fredholm::scene::{ESCAPED, LIGHT, Primitive, Scene, SurfaceSensor, Vertex};
use fredholm::stats::critical;
use fredholm::terms::TermFilm;
use fredholm::terms::functional::{Replicates, image_replicates};
use glam::{DQuat, DVec3, Vec3};
use proptest::prelude::*;
use std::f64::consts::PI;

const K: usize = 4;

/// Which estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Single,
    Prefix,
    Path,
    Light,
    Bidirectional,
}

fn film<'s>(
    scene: &'s Scene,
    sensor: &impl Sensor<SceneTransport<'s>>,
    kind: Kind,
    plan: &Plan,
    (spp, replicates): (u32, usize),
    key: Key,
) -> TermFilm {
    let (t, plan) = (SceneTransport::new(scene), plan.clone());
    let amount = Amount { spp, replicates, key };
    match kind {
        Kind::Single => render(&t, sensor, &SingleTerm(plan), amount, Progress::NONE),
        Kind::Prefix => render(&t, sensor, &Prefix(plan), amount, Progress::NONE),
        Kind::Path => render(&t, sensor, &PathTracer(plan), amount, Progress::NONE),
        Kind::Light => render(&t, sensor, &LightTracer(plan), amount, Progress::NONE),
        Kind::Bidirectional => render(&t, sensor, &Bidirectional(plan), amount, Progress::NONE),
    }
}

/// What each estimator is tried with: every technique where it matters.
fn ways() -> Vec<(Kind, Technique)> {
    let mut all = vec![(Kind::Light, Technique::Mis), (Kind::Bidirectional, Technique::Mis)];
    all.push((Kind::Bidirectional, Technique::Power));
    for technique in Technique::ALL {
        all.extend([(Kind::Prefix, technique), (Kind::Single, technique), (Kind::Path, technique)]);
    }
    all
}

fn bits(film: &TermFilm) -> Vec<u64> {
    let s = film.shape;
    let all = (0..s.pixels()).flat_map(|p| (0..s.replicates).flat_map(move |r| (0..s.slots).map(move |k| (p, r, k))));
    all.flat_map(|(p, r, k)| film.sum(p, r, k).to_array()).map(f64::to_bits).collect()
}

/// All lengths times s.
fn scaled(d: &Description, s: f64) -> Description {
    transformed(d, DQuat::IDENTITY, s, true)
}

/// Turned about the origin and scaled by s. Kept whole where the turn allows it, else taken apart into primitives.
fn transformed(d: &Description, turn: DQuat, s: f64, whole: bool) -> Description {
    let mut all = d.clone();
    let map = |p: DVec3| turn * p * s;
    (all.camera.origin, all.camera.target) = (map(d.camera.origin), map(d.camera.target));
    all.camera.up = turn * d.camera.up;
    for light in &mut all.lights {
        match light {
            LightDescription::Point { position, intensity } => {
                (*position, *intensity) = (map(*position), *intensity * s * s)
            }
            LightDescription::Directional { direction, .. } => *direction = turn * *direction,
            LightDescription::Environment { .. } => {}
        }
    }
    if whole {
        for shape in &mut all.shapes {
            match &mut shape.geometry {
                Geometry::Mesh { vertices, .. } => vertices.iter_mut().for_each(|v| *v *= s),
                Geometry::Quad { origin, edge_u, edge_v } => [origin, edge_u, edge_v].into_iter().for_each(|v| *v *= s),
                Geometry::Box { min, max, .. } => [min, max].into_iter().for_each(|v| *v *= s),
                Geometry::Sphere { center, radius, .. } | Geometry::Disk { center, radius, .. } => {
                    *center *= s;
                    *radius *= s;
                }
            }
        }
        return all;
    }
    all.shapes.clear();
    for (shape, primitive) in d.primitives() {
        let geometry = match primitive {
            Primitive::Triangle(p) => {
                Geometry::Mesh { vertices: p.map(map).to_vec(), faces: vec![[0, 1, 2]], uvs: vec![] }
            }
            Primitive::Parallelogram { origin, edge_u, edge_v } => {
                Geometry::Quad { origin: map(origin), edge_u: map(edge_u), edge_v: map(edge_v) }
            }
            Primitive::Sphere { center, radius, z, inward } => {
                Geometry::Sphere { center: map(center), radius: radius * s, z, inward }
            }
            Primitive::Disk { center, normal, radius } => {
                Geometry::Disk { center: map(center), normal: turn * normal, radius: radius * s }
            }
        };
        all.shapes.push(Shape { geometry, ..d.shapes[shape].clone() });
    }
    all
}

fn small(mut d: Description) -> Description {
    d.camera.size = [6, 4];
    d
}
