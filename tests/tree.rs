//! The tree of boxes against a test of every shape: the same distance and the same shape, bit by bit, for every way to go
//! through the tree and every instruction set of this machine.
#![allow(clippy::unwrap_used)]

#[path = "../benches/ray_sets/mod.rs"]
#[allow(dead_code)]
mod ray_sets;

use fredholm::scene::batch::{RayBatch, Way};
use fredholm::scene::description::*;
use fredholm::scene::{Description, Primitive, Scene};
use glam::{DVec3, Vec3};
use ray_sets::{BATCH, Ray, random, room};

const WAYS: [Way; 4] = [Way::Tree, Way::Single, Way::Plain, Way::Avx2];

fn scene(shapes: Vec<Geometry>) -> Description {
    let shape = |(i, geometry)| Shape { name: format!("shape {i}"), geometry, material: 0, emission: DVec3::ZERO };
    let mut d = room(12);
    d.shapes = shapes.into_iter().enumerate().map(shape).collect();
    d
}

fn mesh(triangles: &[[DVec3; 3]]) -> Geometry {
    let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry::Mesh { vertices: triangles.concat(), faces, uvs: vec![] }
}

fn vectors(seed: u64) -> impl FnMut() -> DVec3 {
    let mut next = random(seed);
    move || DVec3::new(f64::from(next()), f64::from(next()), f64::from(next())) - 0.5
}

/// Triangles of many sizes, some of them needles, of which every third shares an edge with the one before.
fn heap(n: usize, seed: u64) -> Geometry {
    let mut v = vectors(seed);
    let mut list: Vec<[DVec3; 3]> = vec![];
    for i in 0..n {
        let (size, at) = ([0.5, 0.05, 0.2][i % 3], 2.0 * v());
        let needle = if i % 5 == 0 { 1e-4 } else { 1.0 };
        match list.last() {
            Some([a, b, _]) if i % 3 == 2 => list.push([*b, *a, *a + size * v()]),
            _ => {
                let along = size * v();
                list.push([at, at + along, at + 0.5 * along + needle * size * v()]);
            }
        }
    }
    mesh(&list)
}

/// Every kind of primitive, along the axes and askew.
fn mixed(scale: f64) -> Description {
    let v = |x: f64, y: f64, z: f64| scale * DVec3::new(x, y, z);
    let mut all = vec![Geometry::Box { min: v(-1.0, -1.0, -1.0), max: v(1.0, 1.0, 1.0), rotate_y: 0.0, inward: true }];
    for i in 0..12 {
        let a = f64::from(i);
        let at = v(0.7 * (2.1 * a).sin(), 0.7 * (1.3 * a).cos(), 0.7 * (3.7 * a).sin());
        let (min, max) = (at - v(0.1, 0.05, 0.12), at + v(0.1, 0.05, 0.12));
        all.push(Geometry::Box { min, max, rotate_y: 30.0 * a, inward: false });
        let z = if i % 2 == 0 { [-1.0, 1.0] } else { [-0.5, 0.7] };
        all.push(Geometry::Sphere { center: -at, radius: scale * 0.1, z, inward: i % 3 == 0 });
        all.push(Geometry::Disk {
            center: at + v(0.0, 0.1, 0.0),
            normal: DVec3::new(a.sin(), 1.0, 0.0),
            radius: scale * 0.2,
        });
        all.push(Geometry::Quad { origin: -at, edge_u: v(0.3, 0.0, 0.1), edge_v: v(0.0, 0.2, 0.01 * a) });
    }
    let Geometry::Mesh { vertices, faces, uvs } = heap(60, 3) else { unreachable!() };
    all.push(Geometry::Mesh { vertices: vertices.into_iter().map(|p| scale * p).collect(), faces, uvs });
    scene(all)
}

/// Rays that like to be lost: along the axes, nearly along an axis, aimed at corners and middles of edges, from surfaces.
fn rays(scene: &Scene, description: &Description, n: usize) -> Vec<Ray> {
    let primitives: Vec<Primitive> = description.shapes.iter().flat_map(|s| s.geometry.primitives()).collect();
    let origin = scene.origin();
    let corners = |p: &Primitive| match *p {
        Primitive::Triangle(p) => p.to_vec(),
        Primitive::Parallelogram { origin, edge_u, edge_v } => vec![origin, origin + edge_u, origin + edge_v],
        Primitive::Sphere { center, radius, .. } => {
            vec![center + radius * DVec3::X, center, center - radius * DVec3::Y]
        }
        Primitive::Disk { center, radius, .. } => vec![center, center + radius * DVec3::X, center],
    };
    let points: Vec<Vec<Vec3>> =
        primitives.iter().map(|p| corners(p).iter().map(|c| (*c - origin).as_vec3()).collect()).collect();
    let size = points.iter().flatten().fold(0.0f32, |m, p| m.max(p.abs().max_element()));
    let mut next = random(11);
    let mut ray = |i: usize| {
        let mut pick = |n: usize| (next() * n as f32) as usize % n;
        let (at, from) = (&points[pick(points.len())], &points[pick(points.len())]);
        let (k, m, sign) = (pick(at.len()), pick(3), [1.0, -1.0][pick(2)]);
        let target = if i.is_multiple_of(2) { at[k] } else { 0.5 * (at[k] + at[(k + 1) % at.len()]) };
        let axis = Vec3::AXES[m] * sign;
        let free = size * (2.0 * Vec3::new(next(), next(), next()) - 1.0);
        match i % 7 {
            0 => (target - 0.5 * size * axis, axis),
            1 => (target - 0.5 * size * axis, axis + 1e-20 * Vec3::AXES[(m + 1) % 3]),
            2 => (free, (target - free).with_x(0.0)),
            3 => (from.iter().sum::<Vec3>() / from.len() as f32, target - from[0]),
            4 => (free, axis),
            5 => (free, 2.0 * Vec3::new(next(), next(), next()) - 1.0),
            _ => (free, target - free),
        }
    };
    (0..n).map(&mut ray).filter(|(_, d)| *d != Vec3::ZERO).collect()
}

/// Compares all ways; returns the numbers of hits and of blocked segments.
fn compare(name: &str, description: &Description, n: usize) -> [usize; 2] {
    let scene = Scene::new(description);
    let flat = |s: &Shape| !matches!(s.geometry, Geometry::Sphere { .. } | Geometry::Disk { .. });
    let packets = description.shapes.iter().all(flat).then_some(Way::Packets);
    let mut found = [0, 0];
    for rays in rays(&scene, description, n).chunks(BATCH) {
        let [mut first, mut any, mut batch] = [(); 3].map(|()| RayBatch::new(rays));
        first.closest(&scene, Way::EveryShape);
        any.occluded(&scene, Way::EveryShape);
        for way in WAYS.into_iter().chain(packets) {
            batch.closest(&scene, way);
            for (i, ray) in rays.iter().enumerate() {
                assert_eq!(first.hit(i), batch.hit(i), "{name}, {way:?}, {ray:?}");
            }
            batch.occluded(&scene, way);
            for (i, ray) in rays.iter().enumerate() {
                assert_eq!(any.blocked(i), batch.blocked(i), "{name}, {way:?}, {ray:?}");
            }
        }
        found[0] += (0..rays.len()).filter(|i| first.hit(*i).is_some()).count();
        found[1] += (0..rays.len()).filter(|i| any.blocked(*i)).count();
    }
    found
}

#[test]
fn every_kind_of_shape_at_every_scale() {
    for scale in [1.0, 1e-9, 3e-4, 1e7] {
        let [hits, blocked] = compare(&format!("mixed, scale {scale}"), &mixed(scale), 20_000);
        assert!(hits > 10_000 && blocked > 5_000, "{hits} hits, {blocked} blocked");
    }
}

#[test]
fn meshes() {
    for (name, d, n) in [
        ("heap", scene(vec![heap(500, 1)]), 20_000),
        ("large heap", scene(vec![heap(20_000, 2)]), 1000),
        ("room", room(5000), 10_000),
    ] {
        let [hits, blocked] = compare(name, &d, n);
        assert!(hits > n / 4 && blocked > n / 8, "{name}: {hits} hits, {blocked} blocked");
    }
}

#[test]
fn one_shape_alone() {
    let (v, all) = (DVec3::new, mixed(1.0));
    for (i, shape) in all.shapes.iter().take(5).enumerate() {
        assert!(compare(&format!("shape {i}"), &scene(vec![shape.geometry.clone()]), 2000)[0] > 0);
    }
    let triangle = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    assert!(compare("triangle", &scene(vec![mesh(&[triangle])]), 2000)[0] > 0);
    let line = [v(0.0, 0.0, 0.0), v(1.0, 1.0, 1.0), v(2.0, 2.0, 2.0)];
    assert_eq!(compare("line", &scene(vec![mesh(&[line])]), 2000), [0, 0]);
}

/// Many shapes in one place, where the lowest number must win, and needles and triangles that are only lines among them.
#[test]
fn coincident_and_degenerate_shapes() {
    let v = DVec3::new;
    let triangle = [v(-1.0, -1.0, 0.0), v(1.0, -1.0, 0.0), v(0.0, 1.0, 0.1)];
    let quad = Geometry::Quad { origin: v(-1.0, -1.0, 0.0), edge_u: v(2.0, 0.0, 0.0), edge_v: v(0.0, 2.0, 0.0) };
    let flipped = [triangle[1], triangle[0], triangle[2]];
    let line = [triangle[0], triangle[1], 0.5 * (triangle[0] + triangle[1])];
    let copies: Vec<_> = (0..40).map(|i| [triangle, flipped, line, triangle][i % 4]).collect();
    let quads = (0..30).map(|_| quad.clone());
    for (name, list) in [
        ("triangles", vec![mesh(&copies)]),
        ("quads", quads.clone().collect()),
        ("quads before triangles", quads.clone().chain([mesh(&copies)]).collect()),
        ("triangles before quads", [mesh(&copies)].into_iter().chain(quads).collect()),
    ] {
        let [hits, blocked] = compare(name, &scene(list), 4000);
        assert!(hits > 1000 && blocked > 0, "{name}: {hits} hits, {blocked} blocked");
    }
}

/// Large walls are tested before the tree, and rays that do not meet its box end there. The box may be as thin as a sheet.
#[test]
fn meshes_in_a_room() {
    let size = DVec3::splat(3.0);
    let walls = Geometry::Box { min: -size, max: size, rotate_y: 0.0, inward: true };
    let mut v = vectors(5);
    let sheet: Vec<_> = (0..200).map(|_| [(); 3].map(|()| v().with_z(0.25))).collect();
    for (name, inside) in [("heap", heap(500, 1)), ("sheet", mesh(&sheet))] {
        let n = 20_000;
        let [hits, blocked] = compare(&format!("{name} in a room"), &scene(vec![walls.clone(), inside]), n);
        assert!(hits > n / 2 && blocked > n / 20, "{name}: {hits} hits, {blocked} blocked");
    }
}

/// Shells around shells make a tree so deep that single rays need more room for their stack than they hold ready.
#[test]
fn deep_trees() {
    let shell =
        |i: i32| Geometry::Sphere { center: DVec3::ZERO, radius: 1.3f64.powi(i), z: [-1.0, 0.9], inward: false };
    let [hits, blocked] = compare("shells", &scene((0..100).map(shell).collect()), 4000);
    assert!(hits > 1000 && blocked > 300, "{hits} hits, {blocked} blocked");
}
