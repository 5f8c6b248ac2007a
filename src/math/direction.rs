//! Random directions about a normal: maps from two uniform numbers to a direction, with their densities in solid angle
//! (sr⁻¹).
//!
//! | map | density p(ω) |
//! |---|---|
//! | [`cosine_hemisphere`] | cos θ / π |
//! | [`uniform_hemisphere`] | 1 / 2π |
//!
//! θ is the angle between the direction and the normal. The cosine map is Malley's: a uniform point of the disk, lifted to
//! the hemisphere. The frame is that of Duff et al., *Building an Orthonormal Basis, Revisited* (JCGT 6(1), 2017).

use glam::Vec3;

/// (cos, sin) of 2πx for x in [0, 1), by polynomials. A call into the maths library would not vectorise, and its bits differ
/// between machines. The absolute error is below 4·10⁻⁷.
#[inline(always)]
pub fn cos_sin_turn(x: f32) -> (f32, f32) {
    // nearest quarter turn, and the remaining angle in [−π/4, π/4]
    let quarter = (4.0 * x + 0.5) as i32;
    let a = (4.0 * x - quarter as f32) * std::f32::consts::FRAC_PI_2;
    let b = a * a;
    let sin = a * (1.0 + b * (-1.0 / 6.0 + b * (1.0 / 120.0 - b * (1.0 / 5040.0))));
    let cos = 1.0 + b * (-0.5 + b * (1.0 / 24.0 + b * (-1.0 / 720.0 + b * (1.0 / 40320.0))));
    let odd = quarter & 1 != 0;
    let (c, s) = (if odd { sin } else { cos }, if odd { cos } else { sin });
    (if (quarter + 1) & 2 == 0 { c } else { -c }, if quarter & 2 == 0 { s } else { -s })
}

/// `x·t + y·b + z·n` for an orthonormal frame (t, b, n) about the unit vector n.
#[inline(always)]
pub fn about(n: Vec3, x: f32, y: f32, z: f32) -> Vec3 {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    Vec3::new(
        x * (1.0 + sign * (n.x * n.x * a)) + y * b + z * n.x,
        x * (sign * b) + y * (sign + n.y * n.y * a) + z * n.y,
        z * n.z - x * (sign * n.x) - y * n.y,
    )
}

/// The frame of [`about`] with conversions in both directions: to local and to world coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    t: Vec3,
    b: Vec3,
    n: Vec3,
}

impl Frame {
    /// The frame about a unit vector.
    #[inline(always)]
    pub fn new(n: Vec3) -> Self {
        Self { t: about(n, 1.0, 0.0, 0.0), b: about(n, 0.0, 1.0, 0.0), n }
    }
    /// Local coordinates of the world direction `d`; z is along the normal.
    #[inline(always)]
    pub fn local(&self, d: Vec3) -> Vec3 {
        Vec3::new(d.dot(self.t), d.dot(self.b), d.dot(self.n))
    }
    /// World direction with the local coordinates `d`.
    #[inline(always)]
    pub fn world(&self, d: Vec3) -> Vec3 {
        self.t * d.x + self.b * d.y + self.n * d.z
    }
}

/// A random direction with density cos θ/π about `n`, and its cosine cos θ (never 0).
#[inline(always)]
pub fn cosine_hemisphere(n: Vec3, u: [f32; 2]) -> (Vec3, f32) {
    let (c, s) = cos_sin_turn(u[1]);
    let (r, z) = (u[0].sqrt(), (1.0 - u[0]).sqrt());
    (about(n, r * c, r * s, z), z)
}

/// A random direction with density 1/4π on the whole sphere.
#[inline(always)]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    let (c, s) = cos_sin_turn(u[1]);
    let z = 1.0 - 2.0 * u[0];
    let r = 2.0 * (u[0] * (1.0 - u[0])).sqrt();
    Vec3::new(r * c, r * s, z)
}

/// A random direction with density 1/2π in the hemisphere about `n`, and its cosine cos θ (never 0).
#[inline(always)]
pub fn uniform_hemisphere(n: Vec3, u: [f32; 2]) -> (Vec3, f32) {
    let (c, s) = cos_sin_turn(u[1]);
    let z = 1.0 - u[0];
    let r = (u[0] * (1.0 + z)).sqrt();
    (about(n, r * c, r * s, z), z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_and_errors() {
        for i in 0..1 << 16 {
            let x = i as f32 / 65536.0;
            let (c, s) = cos_sin_turn(x);
            let a = f64::from(x) * std::f64::consts::TAU;
            assert!((f64::from(c) - a.cos()).abs() < 4e-7 && (f64::from(s) - a.sin()).abs() < 4e-7, "{x}");
        }
    }

    #[test]
    fn frames_are_orthonormal_and_keep_the_cosine() {
        for i in 0..1000 {
            let u = [(i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877).fract()];
            let n = uniform_hemisphere(Vec3::Z, u).0 * if i % 2 == 0 { 1.0 } else { -1.0 };
            for (d, z) in [cosine_hemisphere(n, [u[1], u[0]]), uniform_hemisphere(n, [u[1], u[0]])] {
                assert!((d.length() - 1.0).abs() < 1e-6 && (d.dot(n) - z).abs() < 1e-6 && z > 0.0);
            }
        }
        for n in [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_Y] {
            let (d, z) = cosine_hemisphere(n, [1.0 - f32::EPSILON / 2.0, 0.3]);
            assert!(z > 0.0 && (d.length() - 1.0).abs() < 1e-6);
        }
    }
}
