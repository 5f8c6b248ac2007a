//! The first surface on a ray, and whether a segment is free.
//!
//! Wraps the `obvhs` crate's two-wide BVH over [`Shape`](super::shape::Shape)s. Its compressed wide BVH is faster on large
//! meshes but loses hits on axis-aligned boxes, so it is not used. Ties go to the primitive with the lower number, whatever
//! the order of traversal.

use super::rounding::{EPSILON, WIDER};
use super::shape::{Hit, Shape};
use glam::{DVec3, Vec3};
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, ray::Ray};

pub(crate) struct Accel {
    pub(crate) shapes: Vec<Shape>,
    bvh: Bvh2,
}

/// The box around a primitive, so wide that the rounding of its own test never loses a hit: 4 ε of every coordinate that a ray may
/// start from, and what hits may reach over the edges of the primitive. `farthest` is the largest coordinate of the scene.
pub(crate) fn widened([low, high]: [DVec3; 2], farthest: f64, touch: f64) -> [Vec3; 2] {
    let most = low.abs().max(high.abs());
    // rays start at most three scenes away
    let by = 32.0 * EPSILON * most + 16.0 * EPSILON * farthest + touch + 2.0 * WIDER * (high - low);
    [(low - by).as_vec3(), (high + by).as_vec3()]
}

impl Accel {
    /// `bounds` are those of the shapes, [`widened`].
    pub(crate) fn new(shapes: Vec<Shape>, bounds: &[[Vec3; 2]]) -> Self {
        let boxes: Vec<Aabb> = bounds.iter().map(|b| Aabb::new(b[0].into(), b[1].into())).collect();
        let bvh = obvhs::bvh2::builder::build_bvh2(
            &boxes,
            BvhBuildParams::medium_build(),
            &mut std::time::Duration::default(),
        );
        Self { shapes, bvh }
    }

    /// The nearest hit with t > 0.
    #[inline(always)]
    pub(crate) fn closest(&self, o: Vec3, d: Vec3) -> Hit {
        let mut best = Hit::NONE;
        let mut scratch = obvhs::ray::RayHit::none();
        self.bvh.ray_traverse(Ray::new(o.into(), d.into(), 0.0, f32::INFINITY), &mut scratch, |_, i| {
            let prim = self.bvh.primitive_indices[i];
            let (t, met) = self.shapes[prim as usize].meet(o, d);
            if met && (t < best.t || (t == best.t && prim < best.prim)) {
                best = Hit { t, prim };
                // a hair more than t, so that a tie with a lower number is still visited
                return t * (1.0 + 1e-6);
            }
            f32::INFINITY
        });
        best
    }

    /// Whether anything lies on `o + t·d`, 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded(&self, o: Vec3, d: Vec3) -> bool {
        !self.bvh.ray_traverse_miss(Ray::new(o.into(), d.into(), 0.0, 1.0), |_, i| {
            let (t, met) = self.shapes[self.bvh.primitive_indices[i] as usize].meet(o, d);
            if met && t < 1.0 { t } else { f32::INFINITY }
        })
    }
}
