//! Which moments of a path are finite, from the matrix of the Cornell box.
//!
//! ```text
//! E[α_k^a 1{alive}] changes per bounce by r(ρ^a F)/s^(a−1):    variance finite: a = 2    P(S > x) ∝ x^{−a} where it is 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r(ρ²F) | spectral radius for q = 0; with a constant q it is divided by 1 − q | [`Radius::second`] |
//! | a | exponent of the tail that the matrix predicts | [`exponent`] |
//! | s = 1 − q | probability of survival | |
//!
//! Red is the channel in which the walls reflect most. Reference for the exponent: Kesten, *Random difference equations and
//! renewal theory for products of random matrices*, Acta Mathematica 131 (1973).

use super::load;
use fredholm::engine::by_matrix;
use fredholm::operator::matrix::spectral_radius;
use fredholm::report::book::{self, Folder};
use fredholm::solver::Radiosity;
use fredholm::study::roulette::Radii;

const RED: usize = 0;

/// What one mesh tells.
#[derive(Clone, Copy, Debug)]
pub struct Radius {
    /// r(ρ²F).
    pub second: f64,
    /// Exponents of the tail for s = 0.5 and s = 0.35.
    pub exponents: [f64; 2],
}

// ANCHOR: radius
/// r(ρ²F) is the radius of ρ²F/(1 − q) for q = 0.
pub(super) fn radius(patches: usize, folder: &Folder<'_>) -> book::Result<Radius> {
    let (scene, room) = load("cornell", 64)?;
    let matrix = by_matrix::dense_matrix(&room, &scene, patches, 1.0, 1, folder.progress)?.radiosity;
    let second = Radii::new(Some(&matrix), &scene, 0.0).second;
    Ok(Radius { second, exponents: [0.5, 0.35].map(|s| exponent(&matrix, s)) })
}
// ANCHOR_END: radius

/// a > 1 with r(ρ^a F) = s^(a−1), by bisection. At a = 1 the left side is r(T) < 1, and the right side is 1.
fn exponent(matrix: &Radiosity, s: f64) -> f64 {
    let grows = |a: f64| {
        let w: Vec<f64> = matrix.reflectance(RED).iter().map(|rho| rho.powf(a) / s.powf(a - 1.0)).collect();
        spectral_radius(&matrix.factors, &w, 1e-9, 2000).radius > 1.0
    };
    let (mut low, mut high) = (1.0, 8.0);
    for _ in 0..16 {
        let a = 0.5 * (low + high);
        (low, high) = if grows(a) { (low, a) } else { (a, high) };
    }
    0.5 * (low + high)
}
