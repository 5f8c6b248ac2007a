//! Ray tracing against every primitive in turn, in `f64`: the simple reference for every acceleration structure.
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

/// The first surface that a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the direction's length.
    pub distance: f64,
    /// Number of the primitive.
    pub primitive: usize,
    /// True if the ray hits the front.
    pub front: bool,
    /// True if this side reflects; otherwise it is the black back of a one-sided surface.
    pub reflects: bool,
}

/// All primitives of a scene, tested one after the other.
#[derive(Clone, Debug)]
pub struct BruteForce {
    bodies: Vec<(Body, Sides)>,
    offset: f64,
}

impl BruteForce {
    /// The primitives of `scene`, with coordinates relative to its middle, as in [`Patches`](super::Patches). Rays start
    /// 10⁻⁷ of the scene's size above the surface.
    pub fn new(scene: &Description) -> Self {
        let scene = scene.centred().scene;
        let sides = |shape: usize| scene.materials.get(scene.shapes[shape].material).map_or(Sides::Both, |m| m.sides);
        Self::of(scene.surfaces().list.into_iter().map(|(s, p)| (p, sides(s))))
    }

    /// A ray tracer for the primitives in `list`.
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

    /// Room for a batch of segments that start and end just above their surfaces.
    pub(crate) fn segments(&self) -> Segments {
        Segments::new(self.offset)
    }

    /// Marks the segments that primitive `i` blocks.
    pub(crate) fn block(&self, i: usize, segments: &mut Segments) {
        segments::block(&self.bodies[i].0, segments);
    }

    /// Returns true if primitive `i` certainly hides the two convex polygons from each other; `false` proves nothing.
    pub(crate) fn hides(&self, i: usize, a: &[DVec3], b: &[DVec3]) -> bool {
        segments::hides(&self.bodies[i].0, a, b)
    }

    /// The nearest surface along a ray that starts just above `from`.
    pub fn first_hit(&self, from: SurfacePoint, direction: DVec3) -> Option<Hit> {
        let origin = self.lifted(from);
        let hits = (0..self.bodies.len()).filter_map(|i| self.meet(i, origin, direction));
        hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// The origin of a ray that starts just above `from`.
    pub(super) fn lifted(&self, from: SurfacePoint) -> DVec3 {
        from.position + self.offset * from.normal
    }

    /// The hit of a ray on primitive `i`, if there is one.
    pub(super) fn meet(&self, i: usize, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let (body, sides) = &self.bodies[i];
        let (distance, front) = body.crossing(origin, direction, f64::INFINITY)?;
        Some(Hit { distance, primitive: i, front, reflects: front || *sides == Sides::Both })
    }

    /// Returns true if no primitive of `among` crosses the segment between two points, which are first moved just above
    /// their surfaces.
    pub(crate) fn free(&self, a: SurfacePoint, b: SurfacePoint, mut among: impl Iterator<Item = usize>) -> bool {
        let origin = a.position + self.offset * a.normal;
        let direction = b.position + self.offset * b.normal - origin;
        !among.any(|i| self.bodies[i].0.crossing(origin, direction, 1.0).is_some())
    }

    /// Number of primitives.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Returns true if there are no primitives.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }
}
