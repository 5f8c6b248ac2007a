//! Visible surfaces that coincide and differ. The image of such a scene is undefined there, so no verdict is given.
//!
//! ```text
//! seen(region)  ⇔  a path from the camera lands in it
//!               or the camera, or a point that such a path has come to, sees a point of it
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | region | a part of a surface where two sides coincide and compete | [`Region`] |
//! | landing | vertices of random walks from the camera that lie in a region | `walks` |
//! | seeing | free segments from points of a region to the camera, or to vertices where the walks scattered | `connects` |
//!
//! A region that no such path reaches changes no image: the bottom of a block on the floor, for example. Light paths need no
//! separate walk, because the light that they bring is seen along camera paths. The random numbers are fixed, so the answer
//! is always the same. A small region that is seen only in mirrors or through glass can be missed: connections find nothing
//! there, and walks find only large regions.

use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::scene::bsdf::Bsdf;
use crate::scene::bsdf::dielectric::Dielectric;
use crate::scene::coplanar::{Region, Relation};
use crate::scene::{Scene, Vertex};
use glam::Vec3;
use std::collections::HashMap;

/// Number of walks from the camera, and their length in vertices.
const WALKS: u32 = 2048;
const LENGTH: usize = 6;
/// Number of walk vertices to which each point of a region is connected.
const EACH: usize = 64;
/// Maximum number of regions of a pair of shapes that are searched for landings.
const REGIONS: usize = 1024;
/// Minimum and maximum number of points tried for a pair of shapes, and the number of segments in all.
const POINTS: (usize, usize) = (8, 64);
const SEGMENTS: usize = 1 << 20;

/// The pairs of shapes that coincide, differ, and are visible.
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

/// Reason why no comparison of images of this scene gives a verdict; None if there is no such reason.
pub fn undecided(scene: &Scene) -> Option<String> {
    let seen = seen(scene);
    let first = conflict(seen.first()?);
    Some(match seen.len() {
        1 => first,
        n => format!("{first} (and {} more)", n - 1),
    })
}

/// A sentence that describes a conflict.
pub fn conflict(c: &Relation) -> String {
    let [a, b] = &c.names;
    let place = if c.regions.iter().all(Region::is_flat) { "plane" } else { "sphere" };
    if c.shapes[0] == c.shapes[1] {
        return format!("two parts of shape `{a}` overlap in one {place} and look different");
    }
    format!("shapes `{a}` and `{b}` overlap in one {place} and look different")
}

/// The vertices that walks from the camera reach, in order.
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

/// Returns true if light from any direction is scattered here, so that a connection is a possible path.
fn connectable(scene: &Scene, x: &Vertex) -> bool {
    !matches!(scene.bsdf(x), Bsdf::Black | Bsdf::Mirror(_) | Bsdf::Dielectric(Dielectric::Smooth(_)))
        && scene.albedo(x.side) != Vec3::ZERO
}

/// Returns true if the camera, or one of these vertices, sees one of `points` points where two shapes compete.
fn connects(scene: &Scene, c: &Relation, scatters: &[Vertex], points: usize, key: Key) -> bool {
    let n = c.regions.len();
    (0..points).any(|i| {
        // spread evenly over the regions
        let region = &c.regions[if n <= points { i % n } else { i * n / points }];
        let u = Rng::at(key, i as u32, 0, 0, Purpose::Connect).four();
        let (x, n) = region.point([f64::from(u[0]), f64::from(u[1])]);
        // in front of both surfaces
        let (x, n) = ((x + 2.0 * region.gap * n).as_vec3(), n.as_vec3());
        if by_camera(scene, x, n) {
            return true;
        }
        (0..EACH).any(|k| {
            // different vertices for every point
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
