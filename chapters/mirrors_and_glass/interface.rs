//! One surface of glass: which part of the samples of its BSDF is reflected.
//!
//! ```text
//! n sin θ = n' sin θ'        r_s = (n cos θ − n' cos θ')/(n cos θ + n' cos θ')        F = (r_s² + r_p²)/2
//!                            r_p = (n' cos θ − n cos θ')/(n' cos θ + n cos θ')        θ_c = asin(n'/n)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n, n' | index of refraction on the side of the ray, and beyond the surface | arguments |
//! | θ, θ' | angles of the ray and of the refracted ray with the normal | – |
//! | F | reflectance for unpolarised light | [`fresnel`] |
//! | θ_c | critical angle: all light is reflected beyond it | [`critical`] |
//!
//! Reference: Born and Wolf, *Principles of Optics* (7th ed. 1999), section 1.5.

use super::GLASS;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::bsdf::{Bsdf, BsdfSample, Sampling, TransportMode};
use fredholm::scene::load;
use glam::Vec3;

/// Angles in degrees: for a ray outside the glass, for a ray inside.
const DEGREES: [&[f64]; 2] =
    [&[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0], &[0.0, 10.0, 20.0, 30.0, 36.0, 40.0, 50.0, 70.0]];
/// The largest random number below 1.
const LARGEST: f32 = 1.0 - f32::EPSILON / 2.0;

/// One angle of the ray.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    /// True if the ray is inside the glass.
    pub inside: bool,
    /// θ in degrees.
    pub degrees: f64,
    /// Number of samples.
    pub samples: u32,
    /// The part of the samples that is reflected.
    pub reflected: Number,
    /// F by the formula.
    pub formula: f64,
}

// ANCHOR: fresnel
/// F for a ray in a medium of index n that meets a medium of index n' at the angle θ (radians).
pub fn fresnel(n: f64, beyond: f64, theta: f64) -> f64 {
    let sine = n * theta.sin() / beyond; // Snell's law
    if sine >= 1.0 {
        return 1.0; // total reflection
    }
    let (c, t) = (theta.cos(), (1.0 - sine * sine).sqrt());
    let s = (n * c - beyond * t) / (n * c + beyond * t);
    let p = (beyond * c - n * t) / (beyond * c + n * t);
    (s * s + p * p) / 2.0
}
// ANCHOR_END: fresnel

// ANCHOR: count
/// One sample of the BSDF for a ray at the angle θ.
fn sample(glass: &Bsdf, theta: f64, u: [f32; 3]) -> Option<BsdfSample> {
    let out = Vec3::new(theta.sin() as f32, 0.0, theta.cos() as f32);
    glass.sample(out, Sampling::Bsdf, TransportMode::Radiance, u)
}

/// The part of N samples that is reflected. z is the direction of the normal.
fn reflected(glass: &Bsdf, theta: f64, samples: u32, key: Key) -> Number {
    let up = |i: u32| {
        let [u, v, w, _] = Rng::at(key, 0, i, 0, Purpose::Scatter).four();
        sample(glass, theta, [u, v, w]).is_some_and(|s| s.wi.z > 0.0)
    };
    let n = f64::from(samples);
    let part = (0..samples).filter(|&i| up(i)).count() as f64 / n;
    Number { value: part, std_error: (part * (1.0 - part) / n).sqrt() }
}
// ANCHOR_END: count

/// The glass of the scene `glass-furnace`, seen from outside or from inside.
fn glass(inside: bool) -> book::Result<Bsdf> {
    let scene = load::scene("glass-furnace", &load::Options::default())?.description;
    Ok(Bsdf::new(&scene.materials[0].bsdf, inside))
}

/// Counts at all angles.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn angles(folder: &Folder<'_>, formula: fn(f64, f64, f64) -> f64) -> book::Result<Vec<Angle>> {
    let samples = folder.pick(1 << 20, 1 << 17);
    let mut all = vec![];
    for (inside, list) in [false, true].into_iter().zip(DEGREES) {
        let (glass, [n, beyond]) = (glass(inside)?, if inside { [GLASS, 1.0] } else { [1.0, GLASS] });
        all.extend(list.iter().map(|&degrees| {
            let (theta, key) = (degrees.to_radians(), Key::new(folder.seed, &format!("glass {inside} {degrees}")));
            let (reflected, formula) = (reflected(&glass, theta, samples, key), formula(n, beyond, theta));
            Angle { inside, degrees, samples, reflected, formula }
        }));
    }
    Ok(all)
}

/// The least angle, in degrees, at which even the largest random number does not choose refraction, by bisection. `outside`
/// is true for a ray outside the glass, for which there is no such angle below 90°.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn critical(outside: bool) -> book::Result<f64> {
    let glass = glass(!outside)?;
    let refracted = |degrees: f64| sample(&glass, degrees.to_radians(), [LARGEST; 3]).is_some_and(|s| s.wi.z < 0.0);
    let halve = |[low, high]: [f64; 2]| {
        let middle = (low + high) / 2.0;
        if refracted(middle) { [middle, high] } else { [low, middle] }
    };
    Ok((0..40).fold([0.0, 90.0], |interval, _| halve(interval))[1])
}
