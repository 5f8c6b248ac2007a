//! Where two surfaces coincide, differ, and are seen: there a scene has no right answer, and no verdict is given.
//!
//! ```text
//! seen(region)  ⇔  a path from the camera lands in it
//!               or the camera, or a point that such a path has come to, sees a point of it
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | region | a part of a surface where two sides compete | [`Region`] |
//! | landing | vertices of random walks from the camera | `walks` |
//! | seeing | segments from points of the region to vertices where the walks scattered, and to the camera | `connects` |
//!
//! What no such path comes to changes no image: the bottom of a block on the floor. Light paths need no walk of their own; what
//! they bring is seen along camera paths. The numbers are fixed, so the answer is always the same. A region can be missed if it
//! is small and seen in mirrors or through glass only: connections find nothing there, and walks only what is large.

use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::scene::bsdf::Bsdf;
use crate::scene::bsdf::dielectric::Dielectric;
use crate::scene::coplanar::{Region, Relation};
use crate::scene::{Scene, Vertex};
use glam::Vec3;
use std::collections::HashMap;

/// Walks from the camera, and how far they go.
const WALKS: u32 = 2048;
const LENGTH: usize = 6;
/// Vertices of walks that each point of a region is connected to.
const EACH: usize = 64;
/// Regions of two shapes in which landings are looked for, at most.
const REGIONS: usize = 1024;
/// Points of two shapes that are tried, at least and at most, and segments in all.
const POINTS: (usize, usize) = (8, 64);
const SEGMENTS: usize = 1 << 20;

/// The pairs of shapes that coincide, differ, and are seen.
pub fn seen(scene: &Scene) -> Vec<&Relation> {
    let conflicts = scene.conflicts();
    if conflicts.is_empty() {
        return vec![];
    }
    let key = Key::new(0, "surfaces that coincide");
    let walks = walks(scene, key);
    let mut landed = vec![false; conflicts.len()];
    let mut at_side: HashMap<u32, Vec<(usize, &Region)>> = HashMap::new();
    for (i, c) in conflicts.iter().enumerate() {
        for region in c.regions.iter().step_by(c.regions.len().div_ceil(REGIONS)) {
            region.sides.iter().for_each(|s| at_side.entry(*s).or_default().push((i, region)));
        }
    }
    for x in &walks {
        for (i, region) in at_side.get(&x.side).into_iter().flatten() {
            landed[*i] = landed[*i] || region.holds(x.p.as_dvec3());
        }
    }
    let scatters: Vec<Vertex> = walks.into_iter().filter(|x| connectable(scene, x)).collect();
    let points = (SEGMENTS / EACH / conflicts.len()).clamp(POINTS.0, POINTS.1);
    let pairs = conflicts.iter().zip(landed).enumerate();
    let found =
        pairs.filter(|(i, (c, landed))| *landed || connects(scene, c, &scatters, points, key.branch(*i as u32)));
    found.map(|(_, (c, _))| c).collect()
}

/// Why no comparison of images of this scene is decided, if none is.
pub fn undecided(scene: &Scene) -> Option<String> {
    let seen = seen(scene);
    let first = conflict(seen.first()?);
    Some(match seen.len() {
        1 => first,
        n => format!("{first} (and {} more)", n - 1),
    })
}

/// A conflict in words.
pub fn conflict(c: &Relation) -> String {
    let [a, b] = &c.names;
    let place = if c.regions.iter().all(Region::is_flat) { "plane" } else { "sphere" };
    if c.shapes[0] == c.shapes[1] {
        return format!("shape `{a}` lies twice in one {place}, and the two differ");
    }
    format!("shapes `{a}` and `{b}` lie in one {place} and differ")
}

/// Where walks from the camera come to, in order.
fn walks(scene: &Scene, key: Key) -> Vec<Vertex> {
    let t = SceneTransport::new(scene);
    let [w, h] = scene.camera.size;
    let pixels = u64::from(w) * u64::from(h);
    let mut all = vec![];
    for i in 0..WALKS {
        let numbers = |vertex, purpose| Rng::at(key, i, 0, vertex, purpose);
        let pixel = (u64::from(i) * pixels / u64::from(WALKS)) as u32;
        let mut next = scene.camera.start(&t, pixel, &mut numbers(0, Purpose::Start));
        for vertex in 0..LENGTH {
            let Some(x) = next.filter(Vertex::on_surface) else { break };
            all.push(x);
            next = t.scatter(&x, &mut numbers(vertex, Purpose::Scatter)).map(|s| s.state);
        }
    }
    all
}

/// Whether light from anywhere is scattered here, so that a connection means a path.
fn connectable(scene: &Scene, x: &Vertex) -> bool {
    !matches!(scene.bsdf(x), Bsdf::Black | Bsdf::Mirror(_) | Bsdf::Dielectric(Dielectric::Smooth(_)))
        && scene.albedo(x.side) != Vec3::ZERO
}

/// Whether one of `points` points where two shapes compete is seen by the camera or by some of these vertices.
fn connects(scene: &Scene, c: &Relation, scatters: &[Vertex], points: usize, key: Key) -> bool {
    let n = c.regions.len();
    (0..points).any(|i| {
        // evenly over the regions
        let region = &c.regions[if n <= points { i % n } else { i * n / points }];
        let u = Rng::at(key, i as u32, 0, 0, Purpose::Connect).four();
        let (x, n) = region.point([f64::from(u[0]), f64::from(u[1])]);
        // in front of both surfaces
        let (x, n) = ((x + 2.0 * region.gap * n).as_vec3(), n.as_vec3());
        if by_camera(scene, x, n) {
            return true;
        }
        (0..EACH).any(|k| {
            // other vertices for every point
            let Some(y) = scatters.get((i + k * points) * 7919 % scatters.len().max(1)) else { return false };
            let d = y.p - x;
            let (to, throughput) = (d.dot(n) > 0.0, d.dot(y.n) < 0.0);
            let faces = to && (throughput || scene.bsdf(y).transmits());
            faces && !scene.blocked(x, n, y.p, if throughput { y.n } else { -y.n })
        })
    })
}

fn by_camera(scene: &Scene, x: Vec3, n: Vec3) -> bool {
    let d = (x.as_dvec3() - scene.camera.origin).normalize();
    let inside = scene.camera.pixel(d).is_some_and(|(pixel, _)| pixel.is_some());
    inside && d.as_vec3().dot(n) < 0.0 && !scene.blocked(x, n, scene.camera.enter(d), Vec3::ZERO)
}
