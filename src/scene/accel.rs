//! The first surface on a ray, and whether a segment is free.
//!
//! Wraps the `obvhs` crate's two-wide BVH over [`Shape`](super::shape::Shape)s. Its compressed wide BVH is faster on large
//! meshes but loses hits on axis-aligned boxes, so it is not used. Ties go to the primitive with the lower number, whatever
//! the order of traversal.

use super::shape::{Hit, Shape};
use glam::Vec3;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, ray::Ray};

pub(crate) struct Accel {
    pub(crate) shapes: Vec<Shape>,
    bvh: Bvh2,
}

impl Accel {
    /// `bounds` are those of the shapes, already widened by the margin that hits may reach over.
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
