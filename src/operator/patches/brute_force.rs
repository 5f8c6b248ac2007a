//! Rays against every primitive in turn, in `f64`: the plain twin of any acceleration structure.
//!
//! ```text
//! flat   p = o + t d,  n·(p − o₀) = 0,  u = (p − o₀)·u*,  v = (p − o₀)·v*      u*, v* dual to the edges
//! sphere |o + t d − c|² = R²
//! ```

use super::body::{Body, body};
use super::patch::SurfacePoint;
use super::{segments, segments::Segments};
use crate::scene::{Description, Primitive, description::Sides};
use glam::DVec3;

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
