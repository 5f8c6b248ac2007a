//! A node of the tree: eight boxes that are tested against a ray at once.
//!
//! ```text
//! near = max(0, max_a (p_a − o_a)/d_a)      far = min(t_max, min_a (q_a − o_a)/d_a)
//! the box is met if near ≤ far
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | o, d | origin and direction of the ray | [`Slabs`] |
//! | p_a, q_a | the planes of the box that the ray meets first and last on axis a | [`Node::planes`] |
//! | t_max | how far to look | [`FARTHEST`] at first |
//!
//! **No hit is lost.** The boxes are enlarged (`accel::widened`), and `far` is enlarged by more than the rounding of both
//! sides: each quotient is rounded three times. A component of d that is almost zero is replaced by [`LEAST`]. Then no
//! quotient is 0 · ∞, and the ray moves by less than the margin of a box.
//!
//! Reference: Ize, *Robust BVH Ray Traversal* (2013).

use super::lanes::{Lanes, N, Pack};
use glam::Vec3;

/// Marks a child that is no node: the rest of its number is a leaf of triangles.
pub(crate) const LEAF: u32 = 1 << 31;
/// Marks a leaf of one shape that is no triangle: the rest of its number is that primitive.
pub(crate) const SINGLE: u32 = 1 << 30;

/// The largest distance that can be met. Just below the largest number, so that it can be enlarged, and less than the
/// distance of a box that a ray along an axis never meets.
pub(crate) const FARTHEST: f32 = 3e38;
/// The smallest component of a direction.
const LEAST: f32 = 1e-37;

/// By how much the distance at which a ray leaves a box is enlarged: more than the rounding of the distances.
pub(crate) const ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// 1/d for a component of a direction.
#[inline(always)]
pub(crate) fn reciprocal(d: f32) -> f32 {
    1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d }
}

/// A node.
#[derive(Clone)]
#[repr(C, align(32))]
pub(crate) struct Node {
    /// `[axis][low, high][child]`. A free place has low = ∞ and high = −∞ and is never met.
    pub(crate) planes: [[[f32; N]; 2]; 3],
    /// A node; or [`LEAF`] and a leaf of triangles; or [`LEAF`], [`SINGLE`] and a primitive.
    pub(crate) child: [u32; N],
}

/// What the test of a box needs of a ray.
pub(crate) struct Slabs {
    o: Vec3,
    /// 1/d.
    inverse: Vec3,
    /// For each axis, 0 if the low plane is met first, else 1.
    first: [usize; 3],
}

impl Slabs {
    #[inline(always)]
    pub(crate) fn new(o: Vec3, d: Vec3) -> Self {
        let inverse = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        let first = [usize::from(inverse.x < 0.0), usize::from(inverse.y < 0.0), usize::from(inverse.z < 0.0)];
        Self { o, inverse, first }
    }
}

impl Node {
    pub(crate) const EMPTY: Self = Self { planes: [[[f32::INFINITY; N], [f32::NEG_INFINITY; N]]; 3], child: [0; N] };

    /// The children whose boxes the ray meets up to `most`, one bit each, and the distances at which it enters them.
    #[inline(always)]
    pub(crate) fn meet<L: Lanes>(&self, l: L, ray: &Slabs, most: f32) -> (u32, [f32; N]) {
        let (mut near, mut far) = (Pack::splat(l, 0.0), Pack::splat(l, most));
        for a in 0..3 {
            let (o, inverse) = (Pack::splat(l, ray.o[a]), Pack::splat(l, ray.inverse[a]));
            // the compiler sees that this is 0 or 1
            let first = ray.first[a] & 1;
            near = ((Pack::load(l, &self.planes[a][first]) - o) * inverse).max(near);
            far = ((Pack::load(l, &self.planes[a][first ^ 1]) - o) * inverse).min(far);
        }
        (near.le(far * Pack::splat(l, ROUNDING)), near.store())
    }
}
