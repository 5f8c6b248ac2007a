//! Bound on the distance of a computed point from its surface, and the offset of rays that follows from it.
//!
//! ```text
//! ε = 2⁻²⁴      fl(a ∘ b) = (a ∘ b)(1 + δ), |δ| ≤ ε
//! e(x, n) = 16 ε Σᵢ |nᵢ xᵢ|
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x, n | a point of a surface and its unit normal | `Vertex` |
//! | e(x, n) | bound on the distance of x from the surface along n, and the offset of the start of a ray, m | [`error`], [`offset_origin`] |
//! | R | distance from an edge below which the coordinates of a hit do not decide on which side of the edge it lies, m | [`UNSURE`], [`across`] |
//! | M | smallest distance from an edge at which the next ray may start, m | [`KEEP`], [`across`] |
//!
//! **Why 16.** A hit is projected onto the plane n·x = h. The product n·x has an error of at most 3 ε Σ|nᵢ xᵢ|, the
//! difference one of ε Σ|nᵢ xᵢ|, and the sum another one of ε Σ|nᵢ xᵢ|: together 5. A ray that starts at this point
//! evaluates n·x − h once more. It does so on this primitive or on a neighbour in the same plane, whose n and h were rounded
//! separately: another 5. 16 exceeds 10. The bound treats each coordinate separately: on the plane y = 0 it is 0, and there
//! points have no error.
//!
//! All bounds are computed from coordinates about the middle of the scene ([`centre`](super::centre)) and not from the
//! scene's size. So a scene that is scaled by a power of two gives the same bits.
//!
//! Reference: Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 6.8 *Managing Rounding Error*;
//! Higham, *Accuracy and Stability of Numerical Algorithms* (2002), ch. 3.

use glam::{DVec3, Vec3};

/// Unit roundoff of `f32`.
pub(crate) const EPSILON: f64 = 1.0 / 16_777_216.0;
/// The bound e in units of ε Σ|nᵢ xᵢ|.
const OFF: f32 = 16.0 * EPSILON as f32;
/// R in units of ε Σ|âᵢ| max|xᵢ|, with â the unit vector across the edge: twice the error of a coordinate.
pub(crate) const UNSURE: f64 = 16.0;
/// M in units of ε Σ|âᵢ| max|xᵢ|: four times the factor of e. A ray that starts at distance e from one wall then starts in
/// front of the adjoining wall too, if the two meet at 15° or more.
pub(crate) const KEEP: f64 = 64.0;
/// Fraction of its extent by which the bounding box of a primitive is enlarged.
pub(crate) const WIDER: f64 = 1.0 / 262_144.0;
/// Upper bound of M, as a fraction of half the primitive's width.
pub(crate) const MOST_KEEP: f64 = 1.0 / 1024.0;

/// e(x, n): bound on the distance of x from its surface, m.
#[inline(always)]
pub(crate) fn error(x: Vec3, n: Vec3) -> f32 {
    OFF * ((n.x * x.x).abs() + (n.y * x.y).abs() + (n.z * x.z).abs())
}

/// Start of a ray that leaves x on the side of n.
#[inline(always)]
pub(crate) fn offset_origin(x: Vec3, n: Vec3) -> Vec3 {
    x + n * error(x, n)
}

/// Origin and displacement of the segment from x to y, with both ends moved off their surfaces. The offset at y is larger: it
/// also covers the rounding error of testing, from x, on which side of the plane through y a point lies.
#[inline(always)]
pub(crate) fn segment(x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> (Vec3, Vec3) {
    let o = offset_origin(x, n);
    let both = Vec3::new(x.x.abs() + y.x.abs(), x.y.abs() + y.y.abs(), x.z.abs() + y.z.abs());
    (o, y + m * error(both, m) - o)
}

/// The point nearest to x on the plane n·x = h.
#[inline(always)]
pub(crate) fn onto(x: Vec3, n: Vec3, h: f32) -> Vec3 {
    x - n * (dot(n, x) - h)
}

/// ε Σ|âᵢ| max|xᵢ|: the rounding error of a coordinate along `a` = â over these points, m.
pub(crate) fn across(a: DVec3, points: &[DVec3]) -> f64 {
    let most = points.iter().fold(DVec3::ZERO, |m, p| m.max(p.abs()));
    EPSILON * a.abs().dot(most)
}

#[inline(always)]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of random planes, projected and moved off the plane in `f32`. In exact arithmetic their distance from the
    /// plane must be e, with an error of at most the ten units that e allows for.
    #[test]
    fn a_lifted_point_lies_off_its_plane() {
        let mut next = crate::math::chance::numbers();
        for i in 0..20_000 {
            let size = [1.0, 1e-3, 1e4][i % 3];
            // normals exactly along an axis, nearly along an axis, and in general directions
            let tilt = [0.0, 1e-4, 1.0][(i / 3) % 3];
            let n = (DVec3::Y + tilt * DVec3::new(next(), next(), next())).normalize();
            let q = size * DVec3::new(next(), next(), next());
            let (n32, h) = (n.as_vec3(), n.dot(q) as f32);
            let (u, v) = n.any_orthonormal_pair();
            let x = (q + size * (next() * u + next() * v)).as_vec3();
            let on = onto(x, n32, h);
            let height = |p: Vec3| n32.as_dvec3().dot(p.as_dvec3()) - f64::from(h);
            let unit = f64::from(error(on, n32)) / 16.0;
            assert!(height(on).abs() <= 5.0 * unit, "{i}: {} units off", height(on) / unit);
            let lifted = height(offset_origin(on, n32));
            assert!((lifted - 16.0 * unit).abs() <= 6.0 * unit, "{i}: {} units", lifted / unit);
        }
    }
}
