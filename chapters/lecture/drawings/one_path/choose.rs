//! The choice of a path that shows all decisions and is easy to see: a search over pixels and samples.
//!
//! ```text
//! best path = argmax over (pixel, sample) of the smallest distance of a vertex from the lines that do not end there
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | a candidate | 4 or 5 vertices, a hidden and two seen lamp points, ended by roulette, all vertices seen by the camera | [`suits`] |
//! | distance | the smallest in all three views: picture, from above, from the side | [`clearness`] |
//!
//! The search has no random part besides the numbers of the paths themselves, so it always finds the same path.

use super::walk::{Address, Visit, follow};
use fredholm::estimator::Roulette;
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::scene::{Camera, description::CameraDescription};
use glam::{DVec2, DVec3, Vec3};

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

/// Distance of a point from a segment.
fn apart(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a + along * (b - a))
}

/// The smallest distance between a vertex and a line that does not end there, in the picture (pixels over its width), from
/// above and from the side (metres over two).
fn clearness(visits: &[Visit], projection: &Projection) -> f64 {
    let views = |p: Vec3| {
        let q = 0.5 * p.as_dvec3();
        [DVec2::from(projection.at(p)) / projection.size[0], DVec2::new(q.x, q.z), DVec2::new(q.z, q.y)]
    };
    let vertices: Vec<[DVec2; 3]> = visits.iter().map(|v| views(v.at.p)).collect();
    let ends: Vec<[DVec2; 3]> = visits.iter().map(|v| views(v.shadow.end)).collect();
    let n = vertices.len();
    let mut least = f64::INFINITY;
    for view in 0..3 {
        for (i, p) in vertices.iter().map(|p| p[view]).enumerate() {
            for j in (0..n).filter(|&j| j != i) {
                least = least.min(apart(p, [vertices[j][view], ends[j][view]]));
                if j + 1 < n && j + 1 != i {
                    least = least.min(apart(p, [vertices[j][view], vertices[j + 1][view]]));
                }
            }
            // the point on the lamp, or the end at the blocker
            least = least.min(p.distance(ends[i][view]));
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
