//! How far a computed point may be off its surface, and how rays allow for it.
//!
//! ```text
//! ε = 2⁻²⁴      fl(a ∘ b) = (a ∘ b)(1 + δ), |δ| ≤ ε
//! e(x, n) = 16 ε Σᵢ |nᵢ xᵢ|
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x, n | a point of a surface and the unit normal there | `Vertex` |
//! | e(x, n) | bound on the distance of x from the surface along n, and how far a ray starts off it, m | [`error`], [`lift`] |
//! | R | how near to an edge the coordinates of a hit no longer tell on which side it is, m | [`UNSURE`], [`across`] |
//! | M | how far from an edge the next ray starts at least, m | [`KEEP`], [`across`] |
//!
//! **Why 16.** A hit is projected onto the plane n·x = h. The product n·x has an error of at most 3 ε Σ|nᵢ xᵢ|, the difference
//! one of ε Σ|nᵢ xᵢ| and the sum again one of ε Σ|nᵢ xᵢ|: together 5. A ray that starts there evaluates n·x − h once more, on
//! this primitive or on its neighbour in the same plane, whose n and h were rounded on their own: 5 again. 16 exceeds 10.
//! The bound looks at each coordinate by itself: on the plane y = 0 it is 0, and nothing is off there.
//!
//! All bounds come from coordinates about the middle of the scene ([`centre`](super::centre)), none from the scene's size: a
//! scene scaled by a power of two gives the same bits.
//!
//! Reference: Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 6.8 *Managing Rounding Error*;
//! Higham, *Accuracy and Stability of Numerical Algorithms* (2002), ch. 3.

use glam::{DVec3, Vec3};

/// Unit roundoff of `f32`.
pub(crate) const EPSILON: f64 = 1.0 / 16_777_216.0;
/// e in units of ε Σ|nᵢ xᵢ|.
const OFF: f32 = 16.0 * EPSILON as f32;
/// R in units of ε Σ|âᵢ| max|xᵢ|: twice the error of a coordinate.
pub(crate) const UNSURE: f64 = 16.0;
/// M in the same units, four times that of e: a ray that starts e off one wall is still before the next one where they meet at
/// 15° or more.
pub(crate) const KEEP: f64 = 64.0;
/// The box around a primitive is wider than the primitive by this part of its extent.
pub(crate) const WIDER: f64 = 1.0 / 262_144.0;
/// M is at most this part of half the width.
pub(crate) const MOST_KEEP: f64 = 1.0 / 1024.0;

/// e(x, n), m.
#[inline(always)]
pub(crate) fn error(x: Vec3, n: Vec3) -> f32 {
    OFF * ((n.x * x.x).abs() + (n.y * x.y).abs() + (n.z * x.z).abs())
}

/// Where a ray that leaves x on the side of n starts.
#[inline(always)]
pub(crate) fn offset_origin(x: Vec3, n: Vec3) -> Vec3 {
    x + n * error(x, n)
}

/// Origin and displacement of the segment from x to y, both ends off their surfaces. The far end allows for what the plane of y
/// costs when it is evaluated at x.
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

/// ε Σ|âᵢ| max|xᵢ|: the rounding of a coordinate measured along â over these points, m.
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

    /// Points of random planes, projected and lifted in `f32`: in exact arithmetic they lie off the plane by e, give or take
    /// the ten units that e allows for.
    #[test]
    fn a_lifted_point_lies_off_its_plane() {
        let mut seed = 1u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        for i in 0..20_000 {
            let size = [1.0, 1e-3, 1e4][i % 3];
            // normals along the axes, nearly so, and any
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
