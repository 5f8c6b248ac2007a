//! Rays against every primitive in turn, in `f64`: the plain twin of any acceleration structure.
//!
//! ```text
//! flat   p = o + t d,  n·(p − o₀) = 0,  u = (p − o₀)·u*,  v = (p − o₀)·v*      u*, v* dual to the edges
//! sphere |o + t d − c|² = R²
//! ```

use super::{SurfacePoint, segments, segments::Segments};
use crate::scene::{Description, Primitive, description::Sides};
use glam::DVec3;

/// Outlines reach this far over their edge, in lengths of the edge, so that neighbours leave no gap.
pub(super) const SLACK: f64 = 1e-12;

/// Outline of a flat primitive in its own coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outline {
    Triangle,
    Parallelogram,
    Disk { radius_squared: f64 },
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    Flat { origin: DVec3, normal: DVec3, u: DVec3, v: DVec3, outline: Outline },
    Sphere { center: DVec3, radius: f64, z: [f64; 2], inward: bool },
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the direction's length.
    pub distance: f64,
    /// Number of the primitive.
    pub primitive: usize,
    /// The side met.
    pub front: bool,
    /// That side reflects; otherwise it is the black back of a one-sided surface.
    pub reflects: bool,
}

/// All primitives of a description, tested one after the other.
#[derive(Clone, Debug)]
pub struct BruteForce {
    bodies: Vec<(Body, Sides)>,
    offset: f64,
}

impl BruteForce {
    /// The primitives of `scene` about its middle, as [`Patches`](super::Patches) have them. Rays start 10⁻⁷ of the scene's size off the
    /// surface.
    pub fn new(scene: &Description) -> Self {
        let scene = scene.centred().scene;
        let sides = |shape: usize| scene.materials.get(scene.shapes[shape].material).map_or(Sides::Both, |m| m.sides);
        Self::of(scene.surfaces().list.into_iter().map(|(s, p)| (p, sides(s))))
    }

    /// These primitives.
    pub(crate) fn of(list: impl Iterator<Item = (Primitive, Sides)>) -> Self {
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bodies = list.map(|(p, sides)| {
            let [a, b] = p.bounds();
            (lo, hi) = (lo.min(a), hi.max(b));
            (body(p), sides)
        });
        let bodies: Vec<_> = bodies.collect();
        Self { bodies, offset: 1e-7 * (hi - lo).max_element() }
    }

    /// Room for segments that start and end just off their surfaces.
    pub(crate) fn segments(&self) -> Segments {
        Segments::new(self.offset)
    }

    /// Marks the segments that primitive `i` blocks.
    pub(crate) fn block(&self, i: usize, segments: &mut Segments) {
        segments::block(&self.bodies[i].0, segments);
    }

    /// Is it certain that primitive `i` hides the two convex polygons from each other? `true` is a proof.
    pub(crate) fn hides(&self, i: usize, a: &[DVec3], b: &[DVec3]) -> bool {
        segments::hides(&self.bodies[i].0, a, b)
    }

    /// The nearest surface along a ray that starts just in front of `from`.
    pub fn first_hit(&self, from: SurfacePoint, direction: DVec3) -> Option<Hit> {
        let origin = self.lifted(from);
        let hits = (0..self.bodies.len()).filter_map(|i| self.meet(i, origin, direction));
        hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Where a ray that starts just in front of `from` starts.
    pub(super) fn lifted(&self, from: SurfacePoint) -> DVec3 {
        from.position + self.offset * from.normal
    }

    /// Where a ray meets primitive `i`.
    pub(super) fn meet(&self, i: usize, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let (body, sides) = &self.bodies[i];
        let (distance, front) = body.crossing(origin, direction, f64::INFINITY)?;
        Some(Hit { distance, primitive: i, front, reflects: front || *sides == Sides::Both })
    }

    /// No primitive of `among` crosses the segment between two points moved just off their surfaces.
    pub(crate) fn free(&self, a: SurfacePoint, b: SurfacePoint, mut among: impl Iterator<Item = usize>) -> bool {
        let origin = a.position + self.offset * a.normal;
        let direction = b.position + self.offset * b.normal - origin;
        !among.any(|i| self.bodies[i].0.crossing(origin, direction, 1.0).is_some())
    }

    /// How many primitives there are.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// There is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }
}

fn body(p: Primitive) -> Body {
    let flat = |origin: DVec3, u: DVec3, v: DVec3, outline| {
        let n = u.cross(v);
        let k = 1.0 / n.length_squared();
        Body::Flat { origin, normal: n.normalize(), u: v.cross(n) * k, v: n.cross(u) * k, outline }
    };
    match p {
        Primitive::Triangle([a, b, c]) => flat(a, b - a, c - a, Outline::Triangle),
        Primitive::Parallelogram { origin, edge_u, edge_v } => flat(origin, edge_u, edge_v, Outline::Parallelogram),
        Primitive::Disk { center, normal, radius } => {
            let (u, v) = normal.any_orthonormal_pair();
            Body::Flat { origin: center, normal, u, v, outline: Outline::Disk { radius_squared: radius * radius } }
        }
        Primitive::Sphere { center, radius, z, inward } => Body::Sphere { center, radius, z, inward },
    }
}

impl Body {
    /// The first crossing with 0 < t < `limit`, and whether the ray comes from the front.
    #[inline]
    pub(super) fn crossing(&self, o: DVec3, d: DVec3, limit: f64) -> Option<(f64, bool)> {
        match *self {
            Self::Flat { origin, normal, u, v, outline } => {
                let (height, slope) = (normal.dot(o - origin), normal.dot(d));
                if height * slope >= 0.0 || height.abs() >= limit * slope.abs() {
                    return None;
                }
                let t = -height / slope;
                let p = o + t * d - origin;
                let (u, v) = (p.dot(u), p.dot(v));
                let inside = match outline {
                    Outline::Parallelogram => (u - 0.5).abs() <= 0.5 + SLACK && (v - 0.5).abs() <= 0.5 + SLACK,
                    Outline::Triangle => u >= -SLACK && v >= -SLACK && u + v <= 1.0 + SLACK,
                    Outline::Disk { radius_squared } => u * u + v * v <= radius_squared,
                };
                inside.then_some((t, height > 0.0))
            }
            Self::Sphere { center, radius, z, inward } => {
                let m = o - center;
                let (a, b, c) = (d.length_squared(), m.dot(d), m.length_squared() - radius * radius);
                let root = b * b - a * c;
                if root <= 0.0 {
                    return None;
                }
                let root = root.sqrt();
                // the stable pair of roots: no subtraction of nearly equal numbers
                let q = if b > 0.0 { -b - root } else { -b + root };
                let (s, t) = (q / a, c / q);
                let kept = |t: f64| {
                    let height = (m.z + t * d.z) / radius;
                    t > 0.0 && t < limit && height >= z[0] - SLACK && height <= z[1] + SLACK
                };
                let (near, far) = (s.min(t), s.max(t));
                // entering meets the outside, leaving the inside
                if kept(near) {
                    Some((near, !inward))
                } else if kept(far) {
                    Some((far, inward))
                } else {
                    None
                }
            }
        }
    }
}
