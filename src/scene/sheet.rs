//! Where a ray arrives on a flat primitive: one product of a matrix and a point, the same for all kinds.
//!
//! ```text
//! ⎡ δ  ⎤   ⎡ n    −h ⎤ ⎡   ⎤        q = x − δ n
//! ⎢ g₁ ⎥ = ⎢ a₁   c₁ ⎥ ⎢ x ⎥
//! ⎢ g₂ ⎥   ⎢ a₂   c₂ ⎥ ⎣ 1 ⎦        q is certainly inside the edges if |g₁|, |g₂|, |g₃| ≤ 1
//! ⎣ g₃ ⎦   ⎣ a₃   c₃ ⎦
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | the computed hit o + t d | |
//! | n, h | the plane n·p = h of the primitive | [`Sheet`] |
//! | δ, q | distance of x from the plane, and the point of the plane nearest to x | [`Sheet::settle`] |
//! | g | of a triangle, the distances from its three edges; of a parallelogram, the two coordinates across it; of a disk, 0 | [`Sheet::new`] |
//!
//! Almost all hits are far enough from the edges, and then [`Shape::settle`] does nothing but project. A sheet finds this out with 24
//! operations on four numbers at once, without asking for the kind. It has a margin, so that the few hits that it refuses include all
//! that `settle` would move. Spheres have no sheet: theirs refuses every hit.

use super::rounding::{EPSILON, UNSURE, across};
use super::shape::{Shape, Triangle};
use glam::{Vec3, Vec4};

/// The columns of the matrix.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Sheet([Vec4; 4]);

/// A function aᵢ·x + cᵢ.
type Across = (Vec3, f32);

/// Refuses every hit.
const NEVER: Across = (Vec3::NAN, f32::NAN);

impl Sheet {
    /// The sheet of a shape.
    pub(crate) fn new(shape: &Shape) -> Self {
        let nothing = (Vec3::ZERO, 0.0);
        let ((n, h), [f, g, k]) = match shape {
            Shape::Triangle(s) => ((s.n, s.h), from_edges(s)),
            Shape::Flat(s) => {
                // no hit is deep if rounding is as large as the parallelogram
                let deep = if s.deep() > 0.0 { s.deep() } else { f32::NAN };
                let [u, v] = [(s.a, s.a0), (s.b, s.b0)].map(|(a, a0)| (a / deep, a0 / deep));
                (s.plane(), [u, v, nothing])
            }
            Shape::Disc(s) => (s.plane(), [nothing; 3]),
            Shape::Ball(_) => ((Vec3::NAN, f32::NAN), [NEVER; 3]),
        };
        let column = |axis: usize| Vec4::new(n[axis], f.0[axis], g.0[axis], k.0[axis]);
        Self([column(0), column(1), column(2), Vec4::new(-h, f.1, g.1, k.1)])
    }

    /// The unit normal of the front.
    #[inline(always)]
    pub(crate) fn normal(&self) -> Vec3 {
        Vec3::new(self.0[0].x, self.0[1].x, self.0[2].x)
    }

    /// [`Shape::settle`] of a computed hit; `None` if that may do more than to project it.
    #[inline(always)]
    pub(crate) fn settle(&self, x: Vec3) -> Option<Vec3> {
        let [a, b, c, d] = self.0;
        let y = a * x.x + b * x.y + c * x.z + d;
        let deep = y.with_x(0.0).abs().cmple(Vec4::ONE).all();
        deep.then_some(x - self.normal() * y.x)
    }
}

/// Units of rounding between the distances from which a sheet and a triangle decide: four times the error of either.
const MARGIN: f64 = 2.0 * UNSURE;
/// The smallest M that is compared as a square without losing digits, m.
const LEAST_KEEP: f32 = 1e-15;

/// One function for each edge of a triangle: 1 at the distance M and a margin, 0 at about the height.
fn from_edges(triangle: &Triangle) -> [Across; 3] {
    let (p, n) = (triangle.p.map(|p| p.as_dvec3()), triangle.n.as_dvec3());
    [0, 1, 2].map(|i| {
        let (a, b, c) = (p[(i + 1) % 3], p[(i + 2) % 3], p[i]);
        let inwards = n.cross(b - a) / (b - a).length();
        let height = inwards.dot(c - a);
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        let away = f64::from(triangle.keep[i]) + MARGIN * (across(inwards, &p) + EPSILON * longest);
        if triangle.keep[i] >= LEAST_KEEP && height > 0.0 {
            // 1 − (distance − away)/height
            ((-inwards / height).as_vec3(), (1.0 + (away + inwards.dot(a)) / height) as f32)
        } else {
            NEVER
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Primitive;
    use crate::scene::rounding::onto;
    use glam::DVec3;

    /// Hits everywhere on random shapes, most of them as near to an edge as `settle` begins to move them: a sheet gives the bits of
    /// `settle`, or none. Far from the edges it always gives them.
    #[test]
    fn a_sheet_settles_like_its_shape() {
        let mut next = crate::math::chance::numbers();
        let (mut settled, mut moved) = (0, 0);
        for i in 0..200_000 {
            let size = [1.0, 1e-7, 1e12][i % 3];
            // far from the middle of the scene, rounding is larger than on a shape near it
            let away = [0.0, 1.0, 300.0][i / 3 % 3];
            let mut v = |by: f64| by * size * DVec3::new(next(), next(), next());
            let (origin, edge_u, mut edge_v) = (v(away), v(1.0), v(1.0));
            if i % 5 == 0 {
                // a sliver
                edge_v = 0.7 * edge_u + 1e-3 * edge_v;
            }
            let triangle = i / 9 % 2 == 0;
            let primitive = if triangle {
                Primitive::Triangle([origin, origin + edge_u, origin + edge_v])
            } else {
                Primitive::Parallelogram { origin, edge_u, edge_v }
            };
            let shape = Shape::new(&primitive, 0.0);
            // coordinates along the edges; near an edge in three cases of four
            let near = 10f64.powf(16.0 * next() - 8.0).min(0.3);
            let (mut a, mut b) = (next() + 0.5, next() + 0.5);
            if triangle && a + b > 1.0 {
                (a, b) = (1.0 - a, 1.0 - b);
            }
            match i / 18 % 4 {
                0 => {}
                1 => a = near,
                2 => b = near,
                _ => a = 1.0 - near - if triangle { b } else { 0.0 },
            }
            let off = edge_u.cross(edge_v).normalize() * (1e-7 * size * next());
            let x = (origin + edge_u * a + edge_v * b + off).as_vec3();
            let truth = shape.settle(x);
            let sheet = Sheet::new(&shape);
            moved += usize::from(onto(x, sheet.normal(), -sheet.0[3].x) != truth);
            if let Some(p) = sheet.settle(x) {
                settled += 1;
                assert_eq!(p.to_array().map(f32::to_bits), truth.to_array().map(f32::to_bits), "{i}: {shape:?} at {x}");
                assert_eq!(sheet.normal(), shape.normal(p));
            } else {
                let inside = a.min(b).min(1.0 - a).min(1.0 - b).min(if triangle { 1.0 - a - b } else { 1.0 });
                assert!(inside < 0.01 || i % 5 == 0 || away > 1.0, "{i}: refused {inside} inside the edges");
            }
        }
        assert!(settled > 60_000 && moved > 10_000, "{settled} settled, {moved} moved");
    }

    /// A disk moves no hit inside its edge, and a sphere decides for itself.
    #[test]
    fn sheets_of_disks_and_spheres() {
        let disk = Primitive::Disk { center: DVec3::ONE, normal: DVec3::Y, radius: 2.0 };
        let disk = Shape::new(&disk, 0.0);
        let x = Vec3::new(2.5, 1.000_001, 0.3);
        assert_eq!(Sheet::new(&disk).settle(x), Some(disk.settle(x)));
        let sphere = Primitive::Sphere { center: DVec3::ZERO, radius: 1.0, z: [-1.0, 1.0], inward: false };
        assert_eq!(Sheet::new(&Shape::new(&sphere, 0.0)).settle(Vec3::X), None);
    }
}
