//! The choice of a path that shows all decisions and is easy to see: a search over pixels and samples.
//!
//! ```text
//! best path = argmax over (pixel, sample) of the smallest distance of two marks in any of the three views
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | a candidate | 4 or 5 vertices, a hidden and two seen lamp points, ended by roulette, all vertices seen by the camera | [`suits`] |
//! | marks | the vertices, and the middle of the lamp | |
//!
//! The search has no random part besides the numbers of the paths themselves, so it always finds the same path.

use super::walk::{Address, Visit, follow};
use fredholm::estimator::Roulette;
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::scene::{Camera, description::CameraDescription};
use glam::{DVec3, Vec3};

/// Projection of the camera of a scene: from points to picture coordinates in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Pixels per unit at distance 1.
    scale: f64,
    size: [f64; 2],
}

impl Projection {
    /// The projection of a camera that looks from `camera.origin` as its description says.
    pub fn new(camera: &Camera, description: &CameraDescription) -> Self {
        let forward = (description.target - description.origin).normalize();
        let right = forward.cross(description.up).normalize();
        let size = camera.size.map(f64::from);
        let scale = 0.5 * size[0] / (0.5 * description.fov).to_radians().tan();
        Self { eye: camera.origin, right, up: right.cross(forward), forward, scale, size }
    }

    /// Where a point is in the picture, from the upper left corner.
    pub fn at(&self, p: Vec3) -> [f64; 2] {
        let d = p.as_dvec3() - self.eye;
        let s = self.scale / d.dot(self.forward);
        [0.5 * self.size[0] + s * d.dot(self.right), 0.5 * self.size[1] - s * d.dot(self.up)]
    }
}

/// Returns true if a path shows every decision.
fn suits(t: &SceneTransport<'_>, visits: &[Visit]) -> bool {
    let hidden = visits.iter().filter(|v| v.shadow.adds.is_none()).count();
    let seen = visits.len() - hidden;
    let camera = &t.scene.camera;
    let faces = |v: &Visit| {
        let to = (camera.origin.as_vec3() - v.at.p).normalize();
        to.dot(v.at.n) > 0.0 && !t.scene.blocked(v.at.p, v.at.n, camera.origin.as_vec3(), -to)
    };
    (4..=5).contains(&visits.len()) && hidden >= 1 && seen >= 2 && visits.iter().all(faces)
}

/// The smallest distance between two marks, in the picture (pixels over its width), from above and from the side (metres
/// over two).
fn clearness(visits: &[Visit], projection: &Projection) -> f64 {
    let lamp = Vec3::new(0.0, 1.0, 0.0);
    let points: Vec<Vec3> = visits.iter().map(|v| v.at.p).chain([lamp]).collect();
    let views = |p: Vec3| {
        let [x, y] = projection.at(p).map(|c| c / projection.size[0]);
        let q = p.as_dvec3() * 0.5;
        [[x, y], [q.x, q.z], [q.z, q.y]]
    };
    let mut least = f64::INFINITY;
    for (i, a) in points.iter().enumerate() {
        for b in &points[..i] {
            for (p, q) in views(*a).into_iter().zip(views(*b)) {
                least = least.min((p[0] - q[0]).hypot(p[1] - q[1]));
            }
        }
    }
    least
}

/// The clearest path among every `step`-th pixel in both directions and the first `samples` samples.
pub fn search(
    t: &SceneTransport<'_>,
    roulette: &Roulette,
    key: Key,
    projection: &Projection,
    [step, samples]: [u32; 2],
) -> Option<(Address, Vec<Visit>)> {
    let [width, height] = t.scene.camera.size;
    let mut best: Option<(f64, Address, Vec<Visit>)> = None;
    for y in (step / 2..height).step_by(step as usize) {
        for pixel in (step / 2..width).step_by(step as usize).map(|x| y * width + x) {
            for sample in 0..samples {
                let path = Address { key, pixel, sample };
                let Some(visits) = follow(t, roulette, path, 5).filter(|visits| suits(t, visits)) else { continue };
                let clear = clearness(&visits, projection);
                if best.as_ref().is_none_or(|b| clear > b.0) {
                    best = Some((clear, path, visits));
                }
            }
        }
    }
    best.map(|(_, path, visits)| (path, visits))
}
