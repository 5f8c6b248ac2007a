//! A leaf of the tree: up to eight triangles that are tested against a ray at once.
//!
//! The formulas are those of [`Triangle::meet`], by the same functions of [`plucker`](super::super::plucker), so both give
//! the same bits.

use super::super::plucker::{distance, edges};
use super::super::shape::{Hit, Triangle};
use super::lanes::{Lanes, N, Pack};
use glam::Vec3;

/// The smallest distance of a hit.
const LEAST: f32 = f32::from_bits(1);
/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Up to eight triangles. The corners, which every visit reads, begin with a cache line.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// `[corner][axis][triangle]`. A free place has corners that are not a number and is never met.
    corners: [[[f32; N]; 3]; 3],
    n: [[f32; N]; 3],
    h: [f32; N],
    prim: [u32; N],
}

#[inline(always)]
fn splat<L: Lanes>(l: L, v: Vec3) -> [Pack<L>; 3] {
    [Pack::splat(l, v.x), Pack::splat(l, v.y), Pack::splat(l, v.z)]
}

#[inline(always)]
fn load<L: Lanes>(l: L, v: &[[f32; N]; 3]) -> [Pack<L>; 3] {
    [Pack::load(l, &v[0]), Pack::load(l, &v[1]), Pack::load(l, &v[2])]
}

impl Block {
    pub(crate) const EMPTY: Self =
        Self { corners: [[[f32::NAN; N]; 3]; 3], n: [[f32::NAN; N]; 3], h: [f32::NAN; N], prim: [u32::MAX; N] };

    pub(crate) fn put(&mut self, i: usize, prim: u32, t: &Triangle) {
        for a in 0..3 {
            for (corner, p) in self.corners.iter_mut().zip(t.p) {
                corner[a][i] = p[a];
            }
            self.n[a][i] = t.n[a];
        }
        (self.h[i], self.prim[i]) = (t.h, prim);
    }

    /// The triangles that the ray meets at 0 < t ≤ `most`, one bit each, and t.
    #[inline(always)]
    fn meet<L: Lanes>(&self, l: L, o: Vec3, d: Vec3, most: f32) -> (u32, [f32; N]) {
        let [a, b, c] = &self.corners;
        let (o, d) = (splat(l, o), splat(l, d));
        let [u, v, w] = edges([load(l, a), load(l, b), load(l, c)], o, d);
        let (low, high, zero) = (u.min(v).min(w), u.max(v).max(w), Pack::splat(l, 0.0));
        // if both hold, all three are zero: rounding has reduced the triangle to a line or a point
        let met = zero.le(low) ^ high.le(zero);
        if met == 0 {
            return (0, [0.0; N]);
        }
        let t = distance(load(l, &self.n), Pack::load(l, &self.h), o, d);
        let (sum, least) = (u + v + w, Pack::splat(l, LEAST));
        // the sum is not a number if one of the three is not, which `min` and `max` pass over
        (met & sum.le(sum) & least.le(t) & t.le(Pack::splat(l, most)), t.store())
    }

    /// Replaces `best` by the nearest hit if it is nearer, or as near and of a lower number.
    #[inline(always)]
    pub(crate) fn nearest<L: Lanes>(&self, l: L, o: Vec3, d: Vec3, best: &mut Hit) {
        let (mut met, t) = self.meet(l, o, d, best.t.min(f32::MAX));
        while met != 0 {
            let i = met.trailing_zeros() as usize % N;
            met &= met - 1;
            best.take(Hit { t: t[i], prim: self.prim[i] });
        }
    }

    /// Returns true if a triangle lies at 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded<L: Lanes>(&self, l: L, o: Vec3, d: Vec3) -> bool {
        self.meet(l, o, d, BELOW_ONE).0 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::Shape;
    use super::super::lanes::{InstructionSet, Task};
    use super::*;
    use crate::scene::Primitive;
    use glam::DVec3;

    struct Meet<'a>(&'a Block, Vec3, Vec3);

    impl Task for Meet<'_> {
        type Output = (u32, [f32; N]);
        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> Self::Output {
            self.0.meet(l, self.1, self.2, f32::MAX)
        }
    }

    /// Every lane gives the bits of [`Triangle::meet`], also for triangles without an inside and where volumes are too large
    /// for a number.
    #[test]
    fn lanes_give_the_bits_of_single_triangles() {
        let mut next = {
            let mut seed = 1u32;
            move || {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
            }
        };
        let mut met = [0; 3];
        for i in 0..60_000 {
            let size = [1.0, 1e-9, 1e13][i % 3];
            let mut v = || size * DVec3::new(next(), next(), next());
            let (o, d) = (v(), v());
            let mut block = Block::EMPTY;
            let triangles: Vec<Triangle> = (0..i % (N + 1))
                .map(|k| {
                    let corner = v();
                    let corners = match k {
                        0 => [corner, corner, corner],
                        1 => [corner, v(), corner],
                        // corners on the ray
                        2 => [o + 0.5 * d, o + d, v()],
                        _ => [corner, v(), v()],
                    };
                    let Shape::Triangle(t) = Shape::new(&Primitive::Triangle(corners), 0.0) else { unreachable!() };
                    block.put(k, k as u32, &t);
                    t
                })
                .collect();
            let (o, d) = (o.as_vec3(), d.as_vec3());
            for set in [InstructionSet::Plain, InstructionSet::avx2(), InstructionSet::best()] {
                let (bits, t) = set.run(Meet(&block, o, d));
                assert_eq!(bits >> triangles.len(), 0, "a free place is met");
                for (k, triangle) in triangles.iter().enumerate() {
                    let (truth, hit) = triangle.meet(o, d);
                    assert_eq!(bits >> k & 1 == 1, hit, "{triangle:?}, {o}, {d}");
                    assert!(!hit || t[k].to_bits() == truth.to_bits(), "{triangle:?}, {o}, {d}: {truth}, {}", t[k]);
                    met[i % 3] += usize::from(hit);
                }
            }
        }
        assert!(met.iter().all(|n| *n > 1000), "{met:?} hits");
    }
}
