//! Large shapes in front of the tree: every ray is tested against them first, sixteen rays at once, and the tree holds the rest.
//!
//! ```text
//! in front if  A > A₀/1024      first hit = the nearer of (in front, tree)      blocked = in front or tree
//! ```
//!
//! Most rays meet the box of a wall, and every shadow ray the box of a lamp. In the tree, each ray would visit them alone.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | A | surface area of the box of a shape: how likely a ray meets it | [`Front::of`] |
//! | A₀ | the same of the box of the scene | [`Front::of`] |
//!
//! Triangles stay in the tree. Of the other shapes, at most 16 parallelograms and 4 spheres or disks are in front, the largest ones. For
//! a single ray, [`few`](super::few) tests them. All use the formulas of the shapes, so hits have the same bits as through the tree
//! (tested).

use super::few::Few;
use super::shape::{Hit, Shape};
use super::sixteen::LANES;
use super::vertex::Rays;
use super::{few, packets};
use glam::Vec3;

/// Smallest part of the surface area of the scene's box.
const LARGE: f32 = 1.0 / 1024.0;

/// The shapes in front.
pub(crate) struct Front {
    /// For single rays.
    few: Few,
    /// For packets: copies, side by side.
    shapes: Vec<Shape>,
    /// Their numbers in the scene, in ascending order.
    prims: Vec<u32>,
}

fn half_area([low, high]: [Vec3; 2]) -> f32 {
    let d = high - low;
    d.x * d.y + d.y * d.z + d.z * d.x
}

impl Front {
    /// Chooses the shapes; None if there is no large one. `bounds` are the boxes of all shapes.
    pub(crate) fn of(shapes: &[Shape], bounds: &[[Vec3; 2]]) -> Option<Self> {
        let all = bounds.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let least = LARGE * half_area(all);
        let (mut flats, mut others) = (vec![], vec![]);
        for (prim, (shape, area)) in (0u32..).zip(shapes.iter().zip(bounds.iter().map(|b| half_area(*b)))) {
            match shape {
                Shape::Triangle(_) => {}
                _ if area <= least => {}
                Shape::Flat(_) => flats.push((area, prim)),
                Shape::Ball(_) | Shape::Disc(_) => others.push((area, prim)),
            }
        }
        let mut prims = vec![];
        for (mut list, most) in [(flats, LANES), (others, few::MOST_OTHERS)] {
            list.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            prims.extend(list.into_iter().take(most).map(|(_, prim)| prim));
        }
        prims.sort_unstable();
        let copies = prims.iter().map(|&prim| shapes[prim as usize].clone()).collect();
        (!prims.is_empty()).then(|| Self { few: Few::of(shapes, prims.iter().copied()), shapes: copies, prims })
    }

    /// The numbers of the shapes, in ascending order.
    pub(crate) fn prims(&self) -> &[u32] {
        &self.prims
    }

    /// The nearest hit with t > 0; of two at the same distance the one with the lower number. `shapes` are those of the scene.
    #[inline(always)]
    pub(crate) fn closest(&self, shapes: &[Shape], o: Vec3, d: Vec3) -> Hit {
        self.few.closest(shapes, o, d)
    }

    /// Returns true if a shape lies at 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded(&self, shapes: &[Shape], o: Vec3, d: Vec3) -> bool {
        self.few.occluded(shapes, o, d)
    }

    /// The nearest hits of the first `n` rays: writes `rays.t` and `rays.prim`, which is `u32::MAX` if there is none.
    pub(crate) fn closest_wave(&self, rays: &mut Rays, n: usize) {
        packets::closest(&self.shapes, rays, n);
        for prim in &mut rays.prim[..n] {
            *prim = self.prims.get(*prim as usize).copied().unwrap_or(u32::MAX);
        }
    }

    /// For each ray in the first `n` entries of `rays.list`: sets `rays.prim[ray]` to 1 if a shape lies at 0 < t < 1, else to 0.
    pub(crate) fn occluded_wave(&self, rays: &mut Rays, n: usize) {
        packets::occluded(&self.shapes, rays, n);
    }
}
