//! The Cornell box of `scenes/cornell.toml`, its camera, and the two questions a path asks of a scene.
//!
//! Every surface is a rectangle with corner o and edges a, b at right angles. A ray p + t d meets its plane at
//!
//! ```text
//! t = n·(o − p) / n·d,    n = a × b / |a × b|
//! ```
//!
//! and meets the rectangle if u = (x − o)·a / |a|² and v = (x − o)·b / |b|² both lie in [0, 1]. A surface reflects and
//! emits on the side of n only. Its back is black, and it stops light.

use super::bugs::Kind;

pub type Vec3 = [f64; 3];

/// No ray hits anything nearer than this: it would be the surface that the ray starts on.
const NEAR: f64 = 1e-7;

const LAMP_LIGHT: Vec3 = [18.387, 13.9873, 6.75357];
const WHITE: Vec3 = [0.885809, 0.698859, 0.666422];
const GREEN: Vec3 = [0.105421, 0.37798, 0.076425];
const RED: Vec3 = [0.570068, 0.0430135, 0.0443706];

/// The camera stands at (0, 0, 3.9), looks along −z, and sees this many degrees from left to right.
const EYE: Vec3 = [0.0, 0.0, 3.9];
const FIELD_OF_VIEW: f64 = 39.3077;

pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The product channel by channel, for colours.
pub fn mul(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

pub fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn unit(a: Vec3) -> Vec3 {
    scale(a, 1.0 / dot(a, a).sqrt())
}

pub struct Ray {
    pub origin: Vec3,
    pub dir: Vec3,
}

/// What a rectangle belongs to.
#[derive(Clone, Copy, PartialEq)]
pub enum Part {
    Room,
    Lamp,
    SmallBlock,
    TallBlock,
}

pub struct Quad {
    pub part: Part,
    pub normal: Vec3,
    pub albedo: Vec3,
    pub emission: Vec3,
    pub area: f64,
    corner: Vec3,
    edges: [Vec3; 2],
    /// The edges divided by their squared lengths.
    scaled_edges: [Vec3; 2],
}

impl Quad {
    fn new(part: Part, albedo: Vec3, corner: Vec3, a: Vec3, b: Vec3) -> Quad {
        let n = cross(a, b);
        Quad {
            part,
            normal: unit(n),
            albedo,
            emission: if part == Part::Lamp { LAMP_LIGHT } else { [0.0; 3] },
            area: dot(n, n).sqrt(),
            corner,
            edges: [a, b],
            scaled_edges: [scale(a, 1.0 / dot(a, a)), scale(b, 1.0 / dot(b, b))],
        }
    }

    /// The point with coordinates u and v, both from 0 to 1.
    pub fn point(&self, u: f64, v: f64) -> Vec3 {
        add(self.corner, add(scale(self.edges[0], u), scale(self.edges[1], v)))
    }

    /// The distance at which the ray meets the rectangle, if it lies between `NEAR` and `far`.
    fn meet(&self, ray: &Ray, far: f64) -> Option<f64> {
        let from_corner = sub(ray.origin, self.corner);
        let t = -dot(self.normal, from_corner) / dot(self.normal, ray.dir);
        // Not a number, if the ray lies in the plane. The comparison is false then.
        if !(t > NEAR && t < far) {
            return None;
        }
        let x = add(from_corner, scale(ray.dir, t));
        let inside = self.scaled_edges.iter().all(|&edge| (0.0..=1.0).contains(&dot(x, edge)));
        inside.then_some(t)
    }
}

pub struct Scene {
    pub quads: Vec<Quad>,
}

impl Scene {
    pub fn new(kind: Kind) -> Scene {
        let wall = |albedo, corner, a, b| Quad::new(Part::Room, albedo, corner, a, b);
        let mut quads = vec![
            Quad::new(Part::Lamp, WHITE, [-0.23, 0.99, -0.18], [0.46, 0.0, 0.0], [0.0, 0.0, 0.38]),
            wall(WHITE, [-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0]), // floor
            wall(WHITE, [-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]),  // ceiling
            wall(WHITE, [-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), // back
            wall(GREEN, [1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]),  // right
            wall(RED, [-1.0, -1.0, 1.0], [0.0, 0.0, -2.0], [0.0, 2.0, 0.0]),   // left
        ];
        block(&mut quads, Part::SmallBlock, [0.335, -0.7, 0.38], [0.3, 0.3, 0.3], -17.0);
        block(&mut quads, Part::TallBlock, [-0.33, -0.4, -0.28], [0.3, 0.61, 0.3], 18.25);
        if kind == Kind::BlocksInsideOut {
            for quad in quads.iter_mut().filter(|quad| matches!(quad.part, Part::SmallBlock | Part::TallBlock)) {
                quad.normal = scale(quad.normal, -1.0);
            }
        }
        Scene { quads }
    }

    /// The lamp comes first in the list.
    pub fn lamp(&self) -> &Quad {
        &self.quads[0]
    }

    /// The first surface on the ray, and its distance.
    pub fn first_hit(&self, ray: &Ray) -> Option<(&Quad, f64)> {
        let mut nearest = None;
        let mut far = f64::INFINITY;
        for quad in &self.quads {
            if let Some(t) = quad.meet(ray, far) {
                far = t;
                nearest = Some(quad);
            }
        }
        nearest.map(|quad| (quad, far))
    }

    /// Whether anything but the part `ignored` lies on the ray before the distance `far`.
    pub fn blocked(&self, ray: &Ray, far: f64, ignored: Option<Part>) -> bool {
        self.quads.iter().any(|quad| Some(quad.part) != ignored && quad.meet(ray, far - NEAR).is_some())
    }
}

/// Adds the six faces of a block with the given half widths, turned about the upright axis through its centre:
/// x′ = x cos φ + z sin φ, z′ = z cos φ − x sin φ. The normals point outwards.
fn block(quads: &mut Vec<Quad>, part: Part, centre: Vec3, half: Vec3, degrees: f64) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let axes = [[half[0] * cos, 0.0, -half[0] * sin], [0.0, half[1], 0.0], [half[2] * sin, 0.0, half[2] * cos]];
    for k in 0..3 {
        let (out, a, b) = (axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]);
        let back = sub(centre, add(a, b));
        quads.push(Quad::new(part, WHITE, add(back, out), scale(a, 2.0), scale(b, 2.0)));
        quads.push(Quad::new(part, WHITE, sub(back, out), scale(b, 2.0), scale(a, 2.0)));
    }
}

/// The ray through a point of a square picture. x and y run from 0 to 1, x from the left and y from the top.
pub fn camera_ray(x: f64, y: f64) -> Ray {
    let half_width = (FIELD_OF_VIEW / 2.0).to_radians().tan();
    let dir = unit([(2.0 * x - 1.0) * half_width, (1.0 - 2.0 * y) * half_width, -1.0]);
    Ray { origin: EYE, dir }
}
