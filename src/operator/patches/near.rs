//! Search for nearby primitives with a tree of bounding boxes, so that a mesh of many triangles is not compared pair by
//! pair.
//!
//! ```text
//! near(box) ⊇ { primitives that meet the box }        first_hit(ray) = the nearest of all
//! ```
//!
//! The tree stores boxes in `f32`, enlarged by 10⁻⁵ of the scene's size. [`BruteForce`] decides in `f64` which primitive is
//! hit. The answers are therefore the same as those of a comparison with every primitive.

use super::brute_force::{BruteForce, Hit};
use super::patch::SurfacePoint;
use crate::scene::Primitive;
use glam::DVec3;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, ray::Ray};
use std::sync::Arc;

/// Boxes are enlarged by this fraction of the scene's size, which is far more than the rounding error of `f32`.
const MARGIN: f64 = 1e-5;

/// The tree over the boxes of all primitives.
#[derive(Clone)]
pub(super) struct Near {
    tree: Arc<Bvh2>,
    margin: f64,
}

impl std::fmt::Debug for Near {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Near").field("margin", &self.margin).finish_non_exhaustive()
    }
}

impl Near {
    pub(super) fn new<'a>(primitives: impl Iterator<Item = &'a Primitive>) -> Self {
        let bounds: Vec<[DVec3; 2]> = primitives.map(Primitive::bounds).collect();
        let far = bounds.iter().flatten().fold(DVec3::ZERO, |a, x| a.max(x.abs())).max_element();
        let margin = MARGIN * far;
        let boxes: Vec<Aabb> = bounds.iter().map(|b| wide(*b, margin)).collect();
        let params = BvhBuildParams::medium_build();
        let tree = obvhs::bvh2::builder::build_bvh2(&boxes, params, &mut std::time::Duration::default());
        Self { tree: Arc::new(tree), margin }
    }

    /// Calls `see` with the numbers of all primitives that meet the box, and of some close to it, until `see` returns false.
    pub(super) fn within(&self, bounds: [DVec3; 2], mut see: impl FnMut(usize) -> bool) {
        self.tree.aabb_traverse(wide(bounds, self.margin), |tree, node| {
            let node = &tree.nodes[node as usize];
            let own = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            tree.primitive_indices[own].iter().all(|i| see(*i as usize))
        });
    }

    /// The same result as [`BruteForce::first_hit`], without testing every primitive.
    pub(super) fn first_hit(&self, all: &BruteForce, from: SurfacePoint, direction: DVec3) -> Option<Hit> {
        let (o, mut best) = (all.lifted(from), None::<Hit>);
        let ray = Ray::new(o.as_vec3().into(), direction.as_vec3().into(), 0.0, f32::INFINITY);
        self.tree.ray_traverse(ray, &mut obvhs::ray::RayHit::none(), |_, i| {
            let number = self.tree.primitive_indices[i] as usize;
            let Some(hit) = all.meet(number, o, direction) else { return f32::INFINITY };
            if best.is_none_or(|b| (hit.distance, number) < (b.distance, b.primitive)) {
                best = Some(hit);
            }
            (hit.distance * (1.0 + 1e-5) + self.margin) as f32
        });
        best
    }
}

fn wide([lo, hi]: [DVec3; 2], margin: f64) -> Aabb {
    let margin = DVec3::splat(margin);
    Aabb::new((lo - margin).as_vec3().into(), (hi + margin).as_vec3().into())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::operator::patches::Patches;
    use crate::scene::description::{Geometry, Shape};
    use crate::scene::load;

    #[test]
    fn the_tree_meets_what_brute_force_meets() {
        let mut scene = load::scene("cornell", &load::Options::default()).unwrap().description;
        let all =
            scene.primitives().iter().map(|p| p.1.bounds()).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap();
        let (center, radius) = (0.5 * (all[0] + all[1]), 0.1 * (all[1] - all[0]).max_element());
        let geometry = Geometry::Sphere { center, radius, z: [-0.6, 0.9], inward: false };
        scene.shapes.push(Shape { name: "ball".into(), geometry, material: 0, emission: DVec3::ZERO });
        let (all, patches) = (BruteForce::new(&scene), Patches::new(&scene, 400).unwrap());
        let near = Near::new(scene.centred().scene.primitives().iter().map(|p| &p.1));
        let mut met = 0;
        for p in patches.iter() {
            let (u, v) = p.normal.any_orthonormal_pair();
            for k in 0..16 {
                let (s, c) = (2.4 * f64::from(k)).sin_cos();
                let (from, d) = (p.lift(p.centre), (0.8 * (c * u + s * v) + 0.6 * p.normal));
                let found = near.first_hit(&all, from, d);
                assert_eq!(found, all.first_hit(from, d));
                met += usize::from(found.is_some());
            }
            let mut list = vec![];
            near.within([p.centre, p.centre], |i| {
                list.push(i);
                true
            });
            assert!(list.contains(&p.primitive));
        }
        assert!(met > 3000, "{met}");
    }
}
