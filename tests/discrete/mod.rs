//! Scenes for the tests of the discrete world, built without any file.
#![allow(dead_code, unreachable_pub)]

use fredholm::operator::form_factor::{FormFactors, VisibilitySampling};
use fredholm::operator::patches::{BruteForce, Patches};
use fredholm::progress::Progress;
use fredholm::scene::description::*;
use glam::DVec3;

pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A scene of (geometry, albedo, emission), all sides front only.
pub fn scene(shapes: Vec<(Geometry, DVec3, DVec3)>) -> Description {
    let camera = CameraDescription { origin: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, fov: 40.0, size: [8, 8] };
    let material = |i: usize, reflectance: DVec3| Material::diffuse(format!("m{i}"), reflectance, Sides::Front);
    let materials = shapes.iter().enumerate().map(|(i, s)| material(i, s.1)).collect();
    let shape = |(i, (geometry, _, emission))| Shape { name: format!("shapes[{i}]"), geometry, material: i, emission };
    let shapes = shapes.into_iter().enumerate().map(shape).collect();
    Description { name: "test".into(), camera, materials, shapes, lights: vec![], expect: None }
}

pub fn quad(origin: DVec3, edge_u: DVec3, edge_v: DVec3) -> Geometry {
    Geometry::Quad { origin, edge_u, edge_v }
}

/// The six faces −x, +x, −y, +y, −z, +z of [0, dims], seen from inside, grey.
pub fn room(dims: DVec3, rho: [f64; 6], e: [f64; 6]) -> Description {
    let whole = Geometry::Box { min: DVec3::ZERO, max: dims, rotate_y: 0.0, inward: true };
    let face = |(i, p): (usize, fredholm::scene::Primitive)| {
        let fredholm::scene::Primitive::Parallelogram { origin, edge_u, edge_v } = p else { unreachable!() };
        (quad(origin, edge_u, edge_v), DVec3::splat(rho[i]), DVec3::splat(e[i]))
    };
    scene(whole.primitives().into_iter().enumerate().map(face).collect())
}

pub const WHITE: DVec3 = DVec3::new(0.885809, 0.698859, 0.666422);
pub const GREEN: DVec3 = DVec3::new(0.105421, 0.37798, 0.076425);
pub const RED: DVec3 = DVec3::new(0.570068, 0.0430135, 0.0443706);
pub const LIGHT: DVec3 = DVec3::new(18.387, 13.9873, 6.75357);

/// The ±1 Cornell box with open front. The small block stands on the floor, the tall one reaches 1 cm through it.
pub fn cornell() -> Description {
    let block = |centre: DVec3, half: DVec3, rotate_y| Geometry::Box {
        min: centre - half,
        max: centre + half,
        rotate_y,
        inward: false,
    };
    let (x, y, z) = (2.0 * DVec3::X, 2.0 * DVec3::Y, 2.0 * DVec3::Z);
    let o = DVec3::ZERO;
    scene(vec![
        (quad(v(-1., -1., -1.), z, x), WHITE, o),
        (quad(v(-1., 1., -1.), x, z), WHITE, o),
        (quad(v(-1., -1., -1.), x, y), WHITE, o),
        (quad(v(1., -1., -1.), z, y), GREEN, o),
        (quad(v(-1., -1., -1.), y, z), RED, o),
        (quad(v(-0.23, 0.99, -0.18), v(0.46, 0., 0.), v(0., 0., 0.38)), o, LIGHT),
        (block(v(0.335, -0.7, 0.38), DVec3::splat(0.3), -17.0), WHITE, o),
        (block(v(-0.335, -0.4, -0.38), v(0.3, 0.61, 0.3), 18.25), WHITE, o),
    ])
}

pub fn factors(scene: &Description, patches: &Patches) -> FormFactors {
    FormFactors::new(patches, &BruteForce::new(scene), VisibilitySampling::default(), Progress::NONE).unwrap()
}

/// Mesh and form factors.
pub fn discretise(scene: &Description, n: usize) -> (Patches, FormFactors) {
    let patches = Patches::new(scene, n).unwrap();
    let factors = factors(scene, &patches);
    (patches, factors)
}

/// CPU seconds of all threads so far.
pub fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

/// Values known in closed form, by case.
pub fn truth() -> serde_json::Map<String, serde_json::Value> {
    serde_json::from_str(include_str!("../truth/discrete.json")).unwrap()
}

/// A fixed pseudo-random number in [0, 1).
pub fn uniform(seed: u64) -> f64 {
    let z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// n numbers in [lo, hi).
pub fn numbers_between(n: usize, lo: f64, hi: f64, seed: u64) -> Vec<f64> {
    (0..n as u64).map(|i| lo + (hi - lo) * uniform(seed.wrapping_mul(1_000_003).wrapping_add(i))).collect()
}

/// Form factors of no geometry at all, but with everything that makes them such: A F symmetric, rows that sum to at most
/// 0.9. `own` scales what a patch sees of itself.
pub fn random_factors(n: usize, own: f64, seed: u64) -> FormFactors {
    let area = numbers_between(n, 0.2, 2.0, seed);
    let exchange = |i: usize, j: usize| {
        let pair = uniform(seed ^ ((i.min(j) * n + i.max(j)) as u64) << 20);
        if i == j { own * pair } else { pair }
    };
    let power = |i: usize| (0..n).map(|j| exchange(i, j)).sum::<f64>() / area[i];
    let most = (0..n).map(power).fold(0.0, f64::max) / 0.9;
    let f = (0..n * n).map(|k| (exchange(k / n, k % n) / area[k / n] / most) as f32).collect();
    FormFactors { n, f, area, rays: 0 }
}
