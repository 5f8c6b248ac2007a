//! Intersection of a ray with a sphere, or with a band of it: a quadratic, in `f64`.
//!
//! ```text
//! f = o − c       b = −f·d       Δ = r² − |f + d b/|d|²|²       q = b ± √(|d|² Δ)        t = (|f|² − r²)/q  and  q/|d|²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | c, r | centre and radius, m | `center`, `radius` |
//! | o, d, t | the ray `o + t·d` | arguments and result of [`Ball::meet`] |
//! | Δ | r² minus the squared distance of the line from the centre, from the foot of the perpendicular, so that a small sphere far away keeps its digits | |
//! | q | with the sign of b, so that nothing cancels | |
//!
//! The radius may be far larger than the distances that matter on the sphere: therefore `f64`.
//! Reference: Eric Haines, Johannes Günther and Tomas Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection*, Ray
//! Tracing Gems (2019), ch. 7.

use super::rounding::{EPSILON, dot};
use crate::math::direction::cos_sin_turn;
use glam::{DVec3, Vec3};

/// A band of a sphere, ready for rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    center: DVec3,
    radius: f64,
    /// Heights of the band over the centre, relative to the radius.
    z: [f64; 2],
    /// The same in metres; infinite at a pole, which is kept in spite of rounding.
    heights: [f64; 2],
    /// 1/radius if the front is outside, −1/radius if it is inside.
    curvature: f64,
    /// The centre in single precision, and the square of a radius that also covers its rounding.
    about: Vec3,
    wide2: f32,
}

/// 32 units of rounding of `f64`, relative to the radius.
const SELF: f64 = 1.0 / 281_474_976_710_656.0;

impl Ball {
    pub(super) fn new(center: DVec3, radius: f64, z: [f64; 2], inward: bool) -> Self {
        let low = if z[0] <= -1.0 { f64::NEG_INFINITY } else { z[0] * radius };
        let high = if z[1] >= 1.0 { f64::INFINITY } else { z[1] * radius };
        Self {
            center,
            radius,
            z,
            heights: [low, high],
            curvature: if inward { -1.0 } else { 1.0 } / radius,
            about: center.as_vec3(),
            wide2: (1.001 * radius + 8.0 * EPSILON * center.length()).powi(2) as f32,
        }
    }

    /// Returns true only if the line of the ray certainly passes beside the sphere: |f|² − (f·d)²/|d|² > r², with a margin of
    /// a hundred times the rounding of |f|², f being the vector from the centre to o. It costs much less than [`Self::meet`].
    #[inline(always)]
    pub(crate) fn passes(&self, o: Vec3, d: Vec3) -> bool {
        let f = o - self.about;
        let (a, b) = (dot(d, d), dot(f, d));
        let most = dot(f, f) * a;
        // numbers that overflow or underflow decide nothing
        (most < 1e38) & (most * (1.0 - 1e-5) - b * b > self.wide2 * a + 1e-30)
    }

    /// The distance at which a ray meets the sphere, and whether it does.
    #[inline(always)]
    pub(crate) fn meet(&self, o: Vec3, d: Vec3) -> (f32, bool) {
        let (f, d) = (o.as_dvec3() - self.center, d.as_dvec3());
        let (a, b, r2) = (d.dot(d), -f.dot(d), self.radius * self.radius);
        // one quotient for two: sixteen of them take as long as everything else here
        let per_a = 1.0 / a;
        let foot = f + d * (b * per_a);
        let disc = r2 - foot.dot(foot);
        if disc < 0.0 {
            return (f32::INFINITY, false);
        }
        let q = b + (a * disc).sqrt().copysign(b);
        let (t0, t1) = ((f.dot(f) - r2) / q, q * per_a);
        let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
        // a root nearer than this rounding is the surface that the ray leaves
        let least = self.radius * SELF;
        let on_band = |t: f64| {
            let z = f.z + d.z * t;
            (t > 0.0) & (t * t * a > least * least) & (z >= self.heights[0]) & (z <= self.heights[1])
        };
        if on_band(near) { (near as f32, true) } else { (far as f32, on_band(far)) }
    }

    #[inline(always)]
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    #[inline(always)]
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// How many numbers describe where a hit lies: centre, radius and curvature.
    pub(crate) const NUMBERS: usize = 5;

    /// The numbers that [`Self::settle`] and [`Self::normal`] use.
    pub(crate) fn numbers(&self) -> [f64; Self::NUMBERS] {
        [self.center.x, self.center.y, self.center.z, self.radius, self.curvature]
    }

    /// The sphere with these numbers. It has no band, so no ray can meet it.
    #[inline(always)]
    pub(crate) fn around([x, y, z, radius, curvature]: [f64; Self::NUMBERS]) -> Self {
        let center = DVec3::new(x, y, z);
        Self { center, radius, curvature, z: [0.0; 2], heights: [0.0; 2], about: Vec3::ZERO, wide2: 0.0 }
    }

    /// A uniformly distributed point of the band, chosen by `u`.
    #[inline(always)]
    pub(super) fn point(&self, u: [f32; 2]) -> Vec3 {
        let (low, high) = (self.z[0].max(-1.0), self.z[1].min(1.0));
        let z = low + (high - low) * f64::from(u[0]);
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (cos, sin) = cos_sin_turn(u[1]);
        (self.center + self.radius * DVec3::new(r * f64::from(cos), r * f64::from(sin), z)).as_vec3()
    }

    /// The point of the sphere nearest to `p`.
    #[inline(always)]
    pub(crate) fn settle(&self, p: Vec3) -> Vec3 {
        let f = p.as_dvec3() - self.center;
        (self.center + f * (self.radius / f.length())).as_vec3()
    }

    /// Unit normal of the front at a point of the surface.
    #[inline(always)]
    pub(crate) fn normal(&self, p: Vec3) -> Vec3 {
        ((p.as_dvec3() - self.center) * self.curvature).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both roots by the quadratic formula from |f| − r, with nothing shared and nothing left out.
    fn plainly(s: &Ball, o: Vec3, d: Vec3) -> Option<f64> {
        let (f, d) = (o.as_dvec3() - s.center, d.as_dvec3());
        let foot = f - d * (f.dot(d) / d.dot(d));
        let disc = (s.radius - foot.length()) * (s.radius + foot.length());
        let q = (d.dot(d) * disc).sqrt().copysign(-f.dot(d)) - f.dot(d);
        let c = (f.length() - s.radius) * (f.length() + s.radius);
        let mut roots = [c / q, q / d.dot(d)];
        roots.sort_by(f64::total_cmp);
        let on_band = |t: &f64| {
            let z = (f.z + d.z * t) / s.radius;
            let band = (s.z[0] <= -1.0 || z >= s.z[0]) && (s.z[1] >= 1.0 || z <= s.z[1]);
            *t * d.length() > s.radius * SELF && band
        };
        roots.into_iter().find(on_band)
    }

    /// Small and huge spheres, whole and cut, seen from far away and from a point just beside the surface. The distance differs from the
    /// plain one by its rounding to `f32` and by that of |f|² − r², a few units of r² divided by |f·d|.
    #[test]
    fn a_sphere_is_met_where_the_plain_formula_says() {
        let mut next = crate::math::chance::numbers();
        let (mut hits, mut misses) = (0, 0);
        for i in 0..40_000 {
            let radius = [1.0, 0.03, 1e3, 1e6][i % 4];
            let z = [[-1.0, 1.0], [-0.3, 1.0], [-0.5, 0.7]][i / 4 % 3];
            let center = DVec3::new(next(), next(), next()) - [DVec3::ZERO, DVec3::Y * radius][i / 12 % 2];
            let mut v = || DVec3::new(next(), next(), next());
            let away = [3.0, 1.0 + 1e-6, 1.0 + 1e-3, 0.5][i / 24 % 4];
            let o = (center + v().normalize() * radius * away).as_vec3();
            let d = (v() * radius).as_vec3();
            let ball = Ball::new(center, radius, z, i % 2 == 0);
            let (t, met) = ball.meet(o, d);
            let truth = plainly(&ball, o, d);
            assert_eq!(met, truth.is_some(), "{i}");
            if let Some(truth) = truth {
                let b = (o.as_dvec3() - center).dot(d.as_dvec3()).abs();
                let allowed = 1e-15 * radius * radius / b + 1.2e-7 * truth;
                assert!((f64::from(t) - truth).abs() <= allowed, "{i}: {t} in place of {truth}");
            }
            hits += u32::from(met);
            misses += u32::from(!met);
        }
        assert!(hits > 10_000 && misses > 5000, "{hits} hits, {misses} misses");
    }
}
