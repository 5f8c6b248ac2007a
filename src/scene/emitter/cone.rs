//! Sampling of a sphere light from a point outside: directions uniform in the cone that the sphere fills.
//!
//! ```text
//! p(ω) = 1 / 2πm      m = 1 − cos θ_max = sin²θ_max / (1 + cos θ_max)      sin θ_max = r/d
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | r, d | radius; distance from the point to the centre |
//! | θ | angle at the point, between ω and the direction to the centre: 1 − cos θ = um, with u uniform |
//! | θ_max | half the opening angle of the cone: ω is tangent to the sphere there |
//! | β | angle at the near point of the sphere on the ray, between its normal and −ω: sin β = sin θ / sin θ_max |
//! | α = β − θ | angle at the centre, between the normal and the direction to the point |
//!
//! With sin²θ = um(2 − um) and sin²θ_max = m(2 − m), the factor that vanishes cancels from numerator and denominator:
//!
//! ```text
//! sin²β = u (2 − um)/(2 − m)      cos²β = (1 − u)(2 − m(1 + u))/(2 − m)
//! ```
//!
//! So no digits are lost, neither far away (m → 0) nor at the surface (m → 1, where d² − r² = (d − r)(d + r)). All this is
//! computed in `f64`, like the intersection of rays with spheres.
//!
//! References: Changyaw Wang, *Physically correct direct lighting for distribution ray tracing*, Graphics Gems III
//! (1992); Matt Pharr, Wenzel Jakob and Greg Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 6.2.4.

use crate::math::direction::{about, cos_sin_turn};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Unit vector from the centre to the point `from`, m, and whether the point is outside the sphere. If it is not, the others
/// mean nothing.
#[inline(always)]
fn cone(from: Vec3, center: DVec3, r: f64) -> (Vec3, f64, bool) {
    let away = from.as_dvec3() - center;
    let d = away.length();
    let (sin, cos) = (r / d, ((d - r) * (d + r)).sqrt() / d);
    ((away / d).as_vec3(), sin * sin / (1.0 + cos), (d > r) & (r > 0.0))
}

/// A point on the near side of the sphere, with its direction uniform in solid angle, and the density (sr⁻¹). `None` if the
/// point `from` is inside the sphere or on it.
pub fn sample(from: Vec3, center: DVec3, radius: f64, u: [f32; 2]) -> Option<(Vec3, f32)> {
    let (point, density, outside) = point(from, center, radius, u);
    outside.then_some((point, density))
}

/// The same with a flag, for SIMD lanes.
#[inline(always)]
pub(crate) fn point(from: Vec3, center: DVec3, radius: f64, u: [f32; 2]) -> (Vec3, f32, bool) {
    let (axis, m, outside) = cone(from, center, radius);
    let v = f64::from(u[0]);
    let (x, rest) = (v * m, 2.0 - m);
    let (cos_theta, sin_theta) = (1.0 - x, (x * (2.0 - x)).sqrt());
    let (cos_beta, sin_beta) = (((1.0 - v) * (2.0 - m * (1.0 + v)) / rest).sqrt(), (v * (2.0 - x) / rest).sqrt());
    let cos_alpha = cos_beta * cos_theta + sin_beta * sin_theta;
    let sin_alpha = sin_beta * cos_theta - cos_beta * sin_theta;
    let (c, s) = cos_sin_turn(u[1]);
    let normal = about(axis, sin_alpha as f32 * c, sin_alpha as f32 * s, cos_alpha as f32);
    // normalised again in `f64`, so that the point lies on the sphere whatever its size
    ((center + radius * normal.as_dvec3().normalize()).as_vec3(), density(m), outside)
}

/// Density (sr⁻¹) of every direction that hits the sphere under [`sample`]; 0 if the point `from` is inside the sphere or on
/// it.
pub fn pdf(from: Vec3, center: DVec3, radius: f64) -> f32 {
    let (_, m, outside) = cone(from, center, radius);
    if outside { density(m) } else { 0.0 }
}

#[inline(always)]
fn density(m: f64) -> f32 {
    (1.0 / (TAU * m)) as f32
}
