//! Ray tracing with a tree of boxes: the first surface on a ray, and a test whether a segment is free.
//!
//! The module wraps the two-wide BVH of the crate `obvhs` over [`Shape`](super::shape::Shape)s. The crate's compressed wide
//! BVH is faster on large meshes but loses hits on axis-aligned boxes, so it is not used. If two primitives are hit at the
//! same distance, the one with the lower number is returned, whatever the order of traversal.

use super::rounding::{EPSILON, WIDER};
use super::shape::{Hit, Shape};
use glam::{DVec3, Vec3};
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, ray::Ray};

pub(crate) struct Accel {
    pub(crate) shapes: Vec<Shape>,
    bvh: Bvh2,
}

/// The bounding box of a primitive, enlarged so that the rounding of the box test never loses a hit. The margin is 4 ε times
/// the largest coordinate from which a ray may start, plus the distance by which hits may lie beyond the edges of the
/// primitive. `farthest` is the largest coordinate of the scene, `touch` the distance at which two corners count as one.
pub(crate) fn widened([low, high]: [DVec3; 2], farthest: f64, touch: f64) -> [Vec3; 2] {
    let most = low.abs().max(high.abs());
    // rays start at most three scene sizes away
    let by = 32.0 * EPSILON * most + 16.0 * EPSILON * farthest + touch + 2.0 * WIDER * (high - low);
    [(low - by).as_vec3(), (high + by).as_vec3()]
}

impl Accel {
    /// Builds the tree; `bounds` are the [`widened`] boxes of the shapes.
    pub(crate) fn new(shapes: Vec<Shape>, bounds: &[[Vec3; 2]]) -> Self {
        let boxes: Vec<Aabb> = bounds.iter().map(|b| Aabb::new(b[0].into(), b[1].into())).collect();
        let bvh = obvhs::bvh2::builder::build_bvh2(
            &boxes,
            BvhBuildParams::medium_build(),
            &mut std::time::Duration::default(),
        );
        Self { shapes, bvh }
    }

    /// The nearest hit with t > 0 on the ray `o + t·d`.
    #[inline(always)]
    pub(crate) fn closest(&self, o: Vec3, d: Vec3) -> Hit {
        let mut best = Hit::NONE;
        let mut scratch = obvhs::ray::RayHit::none();
        self.bvh.ray_traverse(Ray::new(o.into(), d.into(), 0.0, f32::INFINITY), &mut scratch, |_, i| {
            let prim = self.bvh.primitive_indices[i];
            let (t, met) = self.shapes[prim as usize].meet(o, d);
            if met && (t < best.t || (t == best.t && prim < best.prim)) {
                best = Hit { t, prim };
                // slightly more than t, so that a hit at the same t with a lower number is still visited
                return t * (1.0 + 1e-6);
            }
            f32::INFINITY
        });
        best
    }

    pub(crate) fn closest_wave(&self, rays: &mut super::Rays, n: usize) {
        for i in 0..n {
            let hit = self.closest(rays.o.get(i), rays.d.get(i));
            (rays.t[i], rays.prim[i]) = (hit.t, hit.prim);
        }
    }

    /// Returns true if a primitive lies on `o + t·d` with 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded(&self, o: Vec3, d: Vec3) -> bool {
        !self.bvh.ray_traverse_miss(Ray::new(o.into(), d.into(), 0.0, 1.0), |_, i| {
            let (t, met) = self.shapes[self.bvh.primitive_indices[i] as usize].meet(o, d);
            if met && t < 1.0 { t } else { f32::INFINITY }
        })
    }
}
