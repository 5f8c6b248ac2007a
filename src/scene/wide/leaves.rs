//! The leaves of the tree: up to eight triangles each, which are tested against a ray at once.
//!
//! ```text
//! │ x₀ of triangles 1 … k │ y₀ of 1 … k │ z₀ of 1 … k │ x₁ of 1 … k │ … │ z₂ of 1 … k │ n of 1 … k │ h of 1 … k │ number of 1 … k │
//! ```
//!
//! The leaves follow one another without gaps, in the order in which the tree was built. So a ray reads little more than it tests, and
//! leaves that are near in space are near in memory.
//!
//! The formulas are those of [`Triangle::meet`], by the same functions of [`plucker`](super::super::plucker), so both give
//! the same bits.

use super::super::plucker::{distance, edges};
use super::super::shape::{Hit, Triangle};
use super::lanes::{Lanes, N, Pack};
use glam::Vec3;

/// Rows of a leaf: the corners, which every visit reads.
const CORNERS: usize = 9;
/// All rows: corners, n, h, and the number in the scene.
const ROWS: usize = 14;
/// Number of bits of a leaf's number that count its triangles.
const COUNT: u32 = 3;
/// Most triangles of a scene: the first triangle of a leaf has 27 bits.
pub(crate) const MOST_TRIANGLES: usize = 1 << (30 - COUNT);
/// Numbers after the last leaf: a visit takes as many as a full leaf has.
const FREE: usize = ROWS * N;

/// All leaves. A leaf of k triangles has the number 8·first + k − 1, where `first` is the place of its first triangle.
pub(crate) struct Leaves {
    /// `[leaf][row][triangle of the leaf]`, and then room for the lanes that the last leaf leaves free. The numbers of triangles are
    /// stored as bits.
    rows: Vec<f32>,
    /// Number of triangles.
    len: usize,
}

#[inline(always)]
fn splat<L: Lanes>(l: L, v: Vec3) -> [Pack<L>; 3] {
    [Pack::splat(l, v.x), Pack::splat(l, v.y), Pack::splat(l, v.z)]
}

/// One corner of the k triangles of a leaf. The lanes from k on read what follows in memory.
#[inline(always)]
fn corner<L: Lanes>(l: L, rows: &[f32; ROWS * N], corner: usize, k: usize) -> [Pack<L>; 3] {
    [row(l, rows, 3 * corner * k), row(l, rows, (3 * corner + 1) * k), row(l, rows, (3 * corner + 2) * k)]
}

#[inline(always)]
fn row<L: Lanes>(l: L, rows: &[f32; ROWS * N], at: usize) -> Pack<L> {
    Pack::load(l, rows[at..][..N].try_into().expect("this length"))
}

impl Leaves {
    /// No leaf, with room for `triangles`.
    pub(crate) fn with_capacity(triangles: usize) -> Self {
        Self { rows: Vec::with_capacity(ROWS * triangles + FREE), len: 0 }
    }

    /// Adds a leaf of 1 to 8 triangles, each with its number in the scene, and returns the number of the leaf.
    pub(crate) fn push(&mut self, triangles: &[(u32, &Triangle)]) -> u32 {
        let first = self.len;
        assert!(first < MOST_TRIANGLES, "the loader refuses larger scenes");
        self.rows.truncate(ROWS * first);
        let mut row = |number: &dyn Fn(&(u32, &Triangle)) -> f32| self.rows.extend(triangles.iter().map(number));
        for (corner, axis) in (0..3).flat_map(|corner| (0..3).map(move |axis| (corner, axis))) {
            row(&|(_, t)| t.p[corner][axis]);
        }
        for axis in 0..3 {
            row(&|(_, t)| t.n[axis]);
        }
        row(&|(_, t)| t.h);
        row(&|(prim, _)| f32::from_bits(*prim));
        self.rows.resize(self.rows.len() + FREE, f32::NAN);
        self.len += triangles.len();
        (first as u32) << COUNT | (triangles.len() as u32 - 1)
    }

    /// The triangles of a leaf whose inside the line of the ray meets, one bit each; the rows of the leaf, and their length.
    #[inline(always)]
    fn inside<L: Lanes>(&self, l: L, leaf: u32, o: Vec3, d: Vec3) -> (u32, &[f32; ROWS * N], usize) {
        let (first, k) = ((leaf >> COUNT) as usize, (leaf as usize % N) + 1);
        let rows: &[f32; ROWS * N] = self.rows[ROWS * first..][..ROWS * N].try_into().expect("this length");
        let corners = [corner(l, rows, 0, k), corner(l, rows, 1, k), corner(l, rows, 2, k)];
        let [u, v, w] = edges(corners, splat(l, o), splat(l, d));
        let (low, high, zero) = (u.min(v).min(w), u.max(v).max(w), Pack::splat(l, 0.0));
        // if both hold, all three are zero: rounding has reduced the triangle to a line or a point
        let inside = (zero.le(low) ^ high.le(zero)) & (0xff >> (N - k));
        if inside == 0 {
            return (0, rows, k);
        }
        let sum = u + v + w;
        // the sum is not a number if one of the three is not, which `min` and `max` pass over
        (inside & sum.le(sum), rows, k)
    }

    /// Replaces `best` by the nearest hit of a leaf if it is nearer, or as near and of a lower number.
    #[inline(always)]
    pub(crate) fn nearest<L: Lanes>(&self, l: L, leaf: u32, o: Vec3, d: Vec3, best: &mut Hit) {
        let (mut inside, rows, k) = self.inside(l, leaf, o, d);
        while inside != 0 {
            let i = inside.trailing_zeros() as usize % N;
            inside &= inside - 1;
            let t = reached(rows, k, i, o, d);
            if t > 0.0 && t < f32::INFINITY {
                best.take(Hit { t, prim: rows[(ROWS - 1) * k + i].to_bits() });
            }
        }
    }

    /// Returns true if a triangle of a leaf lies at 0 < t < 1.
    #[inline(always)]
    pub(crate) fn occluded<L: Lanes>(&self, l: L, leaf: u32, o: Vec3, d: Vec3) -> bool {
        let (mut inside, rows, k) = self.inside(l, leaf, o, d);
        while inside != 0 {
            let i = inside.trailing_zeros() as usize % N;
            inside &= inside - 1;
            let t = reached(rows, k, i, o, d);
            if t > 0.0 && t < 1.0 {
                return true;
            }
        }
        false
    }
}

/// Where the ray meets the plane of triangle i.
#[inline(always)]
fn reached(rows: &[f32; ROWS * N], k: usize, i: usize, o: Vec3, d: Vec3) -> f32 {
    let number = |row: usize| rows[(CORNERS + row) * k + i];
    distance([number(0), number(1), number(2)], number(3), o.to_array(), d.to_array())
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::Shape;
    use super::super::lanes::{InstructionSet, Task};
    use super::*;
    use crate::scene::Primitive;
    use glam::DVec3;

    struct Meet<'a>(&'a Leaves, u32, Vec3, Vec3);

    impl Task for Meet<'_> {
        type Output = (Hit, bool);
        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> Self::Output {
            let Self(leaves, leaf, o, d) = self;
            let mut best = Hit::NONE;
            leaves.nearest(l, leaf, o, d, &mut best);
            (best, leaves.occluded(l, leaf, o, d))
        }
    }

    /// Every leaf gives the bits of [`Triangle::meet`], whatever follows it in memory, also for triangles without an inside and where
    /// volumes are too large for a number.
    #[test]
    fn leaves_give_the_bits_of_single_triangles() {
        let mut next = crate::math::chance::numbers();
        let mut met = [0; 3];
        for i in 0..60_000 {
            let size = [1.0, 1e-9, 1e13][i % 3];
            let mut v = || size * DVec3::new(next(), next(), next());
            let (o, d) = (v(), v());
            let mut triangles = |n: usize| -> Vec<Triangle> {
                (0..n)
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
                        t
                    })
                    .collect()
            };
            let groups = [i % N + 1, i / N % N + 1, N].map(&mut triangles);
            let mut leaves = Leaves::with_capacity(0);
            let numbers = groups.each_ref().map(|group| leaves.push(&(0..).zip(group).collect::<Vec<_>>()));
            let (o, d) = (o.as_vec3(), d.as_vec3());
            for (group, leaf) in groups.iter().zip(numbers) {
                let (mut nearest, mut occluded) = (Hit::NONE, false);
                for (prim, triangle) in (0..).zip(group) {
                    let (t, hit) = triangle.meet(o, d);
                    if hit {
                        nearest.take(Hit { t, prim });
                        occluded |= t < 1.0;
                        met[i % 3] += 1;
                    }
                }
                for set in [InstructionSet::Plain, InstructionSet::avx2(), InstructionSet::best()] {
                    let (hit, blocked) = set.run(Meet(&leaves, leaf, o, d));
                    assert_eq!((hit.prim, hit.t.to_bits()), (nearest.prim, nearest.t.to_bits()), "{group:?}, {o}, {d}");
                    assert_eq!(blocked, occluded, "{group:?}, {o}, {d}");
                }
            }
        }
        assert!(met.iter().all(|n| *n > 1000), "{met:?} hits");
    }
}
