//! A closed room of triangles, and rays in it, for measurements of ray tracing.
//!
//! | rays | how |
//! |---|---|
//! | primary | a pinhole camera, row by row |
//! | bounce | cosine-distributed directions from the primary hits, in the order of the pixels: the second ray of a wave of paths |
//! | incoherent | the same rays, shuffled |
//! | any-hit | segments from where the incoherent rays arrive to points of a square below the ceiling |

use fredholm::scene::batch::{RayBatch, Way, triangles};
use fredholm::scene::description::*;
use fredholm::scene::{Description, Scene};
use glam::{DVec3, Vec3};

/// A ray: origin and direction.
pub(crate) type Ray = (Vec3, Vec3);

/// Rays per batch: as many as a wave of paths has.
pub(crate) const BATCH: usize = 1024;

/// A reproducible stream of numbers in [0, 1).
pub(crate) fn random(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 24) as f32
    }
}

/// The surface of a cube in m × m squares per face, each as two triangles, with every point moved by `to`. Points that two
/// faces share are computed from the same numbers, so the surface is closed.
fn cube(m: usize, to: impl Fn(DVec3) -> DVec3) -> Geometry {
    let (mut vertices, mut faces) = (vec![], vec![]);
    for side in 0..6 {
        let first = vertices.len() as u32;
        let sign = if side < 3 { 1.0 } else { -1.0 };
        let at = |i: usize| if i == m { 1.0 } else { 2.0 * i as f64 / m as f64 - 1.0 };
        for i in 0..(m + 1) * (m + 1) {
            let (u, v) = (at(i % (m + 1)), at(i / (m + 1)));
            let mut p = [0.0; 3];
            (p[side % 3], p[(side + 1) % 3], p[(side + 2) % 3]) = (sign, u, v);
            vertices.push(to(DVec3::from_array(p)));
        }
        let row = m as u32 + 1;
        for i in 0..(m * m) as u32 {
            let a = first + i / m as u32 * row + i % m as u32;
            let [b, c, d] = [a + 1, a + row + 1, a + row];
            faces.extend(if sign > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    Geometry::Mesh { vertices, faces, uvs: vec![] }
}

/// A cube with three dented balls in it, of about this many triangles: a tenth in the walls.
pub(crate) fn room(triangles: usize) -> Description {
    let m = |share: f64| (share * triangles as f64 / 12.0).sqrt().round().max(1.0) as usize;
    let ball = |centre: DVec3, radius: f64, waves: f64| {
        cube(m(0.3), move |p| {
            // equal angles make triangles of about equal size
            let d = DVec3::from_array(p.to_array().map(|x| (x * std::f64::consts::FRAC_PI_4).tan())).normalize();
            let dent = (waves * d.x).sin() * (waves * d.y).sin() * (waves * d.z).cos();
            centre + d * radius * (1.0 + 0.15 * dent)
        })
    };
    let shape = |name: &str, geometry| Shape { name: name.into(), geometry, material: 0, emission: DVec3::ONE };
    Description {
        name: "room".into(),
        camera: CameraDescription {
            origin: DVec3::new(0.0, 0.0, 0.95),
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov: 70.0,
            size: [8, 8],
        },
        materials: vec![Material::diffuse("grey", DVec3::splat(0.5), Sides::Both)],
        shapes: vec![
            shape("walls", cube(m(0.1), |p| p)),
            shape("left", ball(DVec3::new(-0.45, -0.4, -0.3), 0.4, 9.0)),
            shape("right", ball(DVec3::new(0.5, -0.55, 0.1), 0.3, 14.0)),
            shape("above", ball(DVec3::new(0.2, 0.3, -0.4), 0.35, 20.0)),
        ],
        lights: vec![],
        expect: None,
    }
}

/// Rays of one kind.
pub(crate) struct Set {
    /// Their name.
    pub(crate) name: &'static str,
    /// True if any hit before t = 1 is asked for, not the first.
    pub(crate) any: bool,
    /// The rays.
    pub(crate) rays: Vec<Ray>,
}

/// About `n` rays of every kind.
pub(crate) fn sets(scene: &Scene, n: usize) -> [Set; 4] {
    let corners = triangles(scene);
    let mut next = random(1);
    let side = (n as f64).sqrt() as usize;
    let at = |i: usize| ((i as f32 + 0.5) / side as f32 * 2.0 - 1.0) * 0.7;
    let camera = Vec3::new(0.0, 0.0, 0.95);
    let primary: Vec<Ray> =
        (0..side * side).map(|i| (camera, Vec3::new(at(i % side), -at(i / side), -1.0).normalize())).collect();
    let bounce = bounces(scene, &corners, &primary, &mut next);
    let mut incoherent = bounce.clone();
    for i in (1..incoherent.len()).rev() {
        incoherent.swap(i, (next() * (i + 1) as f32) as usize % (i + 1));
    }
    let arrived = bounces(scene, &corners, &incoherent, &mut next);
    let lamp = |(o, _): &Ray| (*o, Vec3::new(next() - 0.5, 0.98, next() - 0.5) - *o);
    let shadow = arrived.iter().map(lamp).collect();
    [
        Set { name: "primary", any: false, rays: primary },
        Set { name: "bounce", any: false, rays: bounce },
        Set { name: "incoherent", any: false, rays: incoherent },
        Set { name: "any-hit", any: true, rays: shadow },
    ]
}

/// Cosine-distributed rays from where these rays arrive, in the same order.
pub(crate) fn bounces(scene: &Scene, corners: &[[Vec3; 3]], rays: &[Ray], next: &mut impl FnMut() -> f32) -> Vec<Ray> {
    let mut out = vec![];
    for rays in rays.chunks(BATCH) {
        let mut batch = RayBatch::new(rays);
        batch.closest(scene, Way::Tree);
        for (i, (o, d)) in rays.iter().enumerate() {
            let Some((t, prim)) = batch.hit(i) else { continue };
            let [a, b, c] = corners[prim as usize];
            let n = (b - a).cross(c - a).normalize();
            let n = n * -n.dot(*d).signum();
            let (z, phi) = (1.0 - 2.0 * next(), std::f32::consts::TAU * next());
            let r = (1.0 - z * z).sqrt();
            out.push((o + d * t + n * 1e-5, (n + Vec3::new(r * phi.cos(), r * phi.sin(), z)).normalize()));
        }
    }
    out
}

/// Something to measure, with its name.
pub(crate) type Work<'a> = (String, Box<dyn FnMut() + 'a>);

/// Median CPU seconds of every work, in interleaved rounds, and the median ratio of the first to each.
pub(crate) fn medians(rounds: usize, works: &mut [Work<'_>]) -> Vec<[f64; 2]> {
    let mut times = vec![vec![]; works.len()];
    for _ in 0..rounds {
        for (times, (_, work)) in times.iter_mut().zip(works.iter_mut()) {
            let start = cpu_seconds();
            work();
            times.push(cpu_seconds() - start);
        }
    }
    let median = |mut v: Vec<f64>| {
        v.sort_by(f64::total_cmp);
        v[v.len() / 2]
    };
    let ratios = |v: &[f64]| median(times[0].iter().zip(v).map(|(a, b)| a / b).collect());
    times.iter().map(|v| [median(v.clone()), ratios(v)]).collect()
}

/// CPU seconds of this thread so far. The system counts in steps of some ms, so a round should take 0.1 s or more.
pub(crate) fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux counts CPU time");
    let ns = text.split_whitespace().next().and_then(|w| w.parse::<f64>().ok());
    ns.expect("the first number of schedstat is CPU time in ns") * 1e-9
}
