//! Two reflections at glass, with and without polarisation.
//!
//! ```text
//! (I, Q, U, V)ᵀ → M R(φ) M (I, Q, U, V)ᵀ        unpolarised light: (1, 0, 0, 0)        Brewster's angle: tan θ_B = n
//! M = ½ ⎡ R_s + R_p  R_s − R_p ⎤ for I, Q;      √(R_s R_p) (with a sign) for U, V
//!       ⎣ R_s − R_p  R_s + R_p ⎦
//! scalar: F²,  F = ½ (R_s + R_p)                same plane: ½ (R_s² + R_p²)            crossed planes: R_s R_p
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | I, Q, U, V | Stokes vector: the radiance and three numbers for its polarisation | |
//! | M | Mueller matrix of one reflection | [`reflection`] |
//! | R(φ) | rotation to the second plane of incidence, at the angle φ to the first | [`rotation`] |
//! | R_s, R_p | reflectance for light that oscillates across, and in, the plane of incidence | [`amplitudes`] |
//! | F | the library's reflectance | [`Interface::reflectance`] |
//!
//! Reference: Born and Wolf, *Principles of Optics* (7th ed. 1999), sections 1.5 and 10.9.

use fredholm::scene::bsdf::fresnel::Interface;
use std::f64::consts::PI;

/// A matrix that acts on Stokes vectors.
pub type Mueller = [[f64; 4]; 4];

/// The part of the light that two reflections leave.
#[derive(Clone, Copy, Debug)]
pub struct Twice {
    /// F², with the F of the library.
    pub scalar: f64,
    /// Both reflections in one plane.
    pub same: f64,
    /// The planes are perpendicular to each other.
    pub crossed: f64,
    /// The mean over all angles between the planes.
    pub mean: f64,
}

/// r_s and r_p, the factors of the electric field, for the cosine c of the angle of incidence.
fn amplitudes(c: f64, n: f64) -> [f64; 2] {
    let g = (n * n - 1.0 + c * c).sqrt(); // n times the cosine of the angle of refraction
    [(c - g) / (c + g), (n * n * c - g) / (n * n * c + g)]
}

// ANCHOR: mueller
/// M of a reflection with the factors r_s and r_p of the electric field.
pub fn reflection([s, p]: [f64; 2]) -> Mueller {
    let (sum, difference, mixed) = (0.5 * (s * s + p * p), 0.5 * (s * s - p * p), s * p);
    [[sum, difference, 0.0, 0.0], [difference, sum, 0.0, 0.0], [0.0, 0.0, mixed, 0.0], [0.0, 0.0, 0.0, mixed]]
}

/// R(φ): the same light, described with axes that are turned by φ.
pub fn rotation(phi: f64) -> Mueller {
    let (s, c) = (2.0 * phi).sin_cos();
    [[1.0, 0.0, 0.0, 0.0], [0.0, c, s, 0.0], [0.0, -s, c, 0.0], [0.0, 0.0, 0.0, 1.0]]
}

/// The radiance that remains of unpolarised light of radiance 1 after two reflections.
pub fn remains(m: &Mueller, phi: f64) -> f64 {
    let unpolarised = [1.0, 0.0, 0.0, 0.0];
    apply(m, apply(&rotation(phi), apply(m, unpolarised)))[0]
}
// ANCHOR_END: mueller

fn apply(m: &Mueller, x: [f64; 4]) -> [f64; 4] {
    m.map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
}

/// Brewster's angle.
pub fn brewster(n: f64) -> f64 {
    n.atan()
}

/// Two reflections at glass of index n, at the angle of incidence θ. `single` gives M from r_s and r_p.
pub fn twice(n: f64, theta: f64, single: fn([f64; 2]) -> Mueller) -> Twice {
    let m = single(amplitudes(theta.cos(), n));
    let f = f64::from(Interface::new(1.0, n).reflectance(theta.cos() as f32));
    let turns = 360;
    let mean = (0..turns).map(|i| remains(&m, PI * f64::from(i) / f64::from(turns))).sum::<f64>() / f64::from(turns);
    Twice { scalar: f * f, same: remains(&m, 0.0), crossed: remains(&m, 0.5 * PI), mean }
}
