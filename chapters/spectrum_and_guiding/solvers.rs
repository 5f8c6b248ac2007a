//! The steps of three solvers, and what the ends of the spectrum say about them.
//!
//! ```text
//! error after n steps        Neumann ~ λ_1^n        Chebyshev ≤ 2 q^n/(1 + q^{2n})        q = (√c − 1)/(√c + 1)
//! c = (1 − λ_min)/(1 − λ_1)        λ_1 → 1:  ln(1/λ_1) ≈ 1 − λ_1,  ln(1/q) ≈ 2 √((1 − λ_1)/(1 − λ_min))
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | error | ‖x − L‖_w/‖L‖_w, with L by LU factorisation | `System::error` |
//! | λ_min, λ_1 | ends of the spectrum | [`Errors::interval`] |
//! | q | factor per step that Chebyshev's iteration guarantees | [`rate`] |
//! | s | factor of all albedos: s T has the largest eigenvalue s λ_1 | [`brighter`] |
//!
//! Reference: Varga, *Matrix Iterative Analysis* (1962), chapter 5.

use super::RED;
use super::spectrum::ends;
use fredholm::engine::by_matrix::Matrix;
use fredholm::operator::matrix::PatchOperator;
use fredholm::operator::modes::Modes;
use fredholm::solver::comparison::System;
use fredholm::solver::direct::Singular;
use fredholm::solver::{Chebyshev, ConjugateGradients, Iteration, PartialSums, Radiosity};

/// The names of the solvers, in the order of all lists.
pub const NAMES: [&str; 3] = ["Neumann", "Chebyshev", "conjugate gradients"];
/// Errors between which steps are counted: after the first steps, and before rounding matters.
pub const FROM_TO: [f64; 2] = [1e-4, 1e-10];
/// 1 − λ_1 of the rooms of [`brighter`].
pub const GAPS: [f64; 5] = [0.3, 0.1, 0.03, 0.01, 0.003];
/// More steps than any solver takes here.
const MOST: usize = 20_000;

/// The errors of the solvers by step.
#[derive(Clone)]
pub struct Errors {
    /// One list for each solver.
    pub by_step: [Vec<f64>; 3],
    /// λ_min and λ_1 of the matrix.
    pub interval: [f64; 2],
}

/// A room with brighter walls.
#[derive(Clone)]
pub struct Brighter {
    /// 1 − λ_1.
    pub gap: f64,
    /// λ_min and λ_1.
    pub interval: [f64; 2],
    /// Steps of each solver from the first to the second error of [`FROM_TO`].
    pub steps: [usize; 3],
}

// ANCHOR: rate
/// q = (√c − 1)/(√c + 1).
pub fn rate([a, b]: [f64; 2]) -> f64 {
    let c = (1.0 - a) / (1.0 - b);
    (c.sqrt() - 1.0) / (c.sqrt() + 1.0)
}

/// The errors of an iteration, until one is small enough.
fn errors(system: &System<'_, PatchOperator<'_>>, mut x: impl Iteration) -> Vec<f64> {
    let mut errors = vec![system.error(x.iterate())];
    while errors.len() < MOST && errors[errors.len() - 1] > FROM_TO[1] && x.advance() {
        errors.push(system.error(x.iterate()));
    }
    errors
}
// ANCHOR_END: rate

/// The errors of all solvers.
fn all(system: &System<'_, PatchOperator<'_>>, interval: [f64; 2]) -> [Vec<f64>; 3] {
    let (t, e) = (system.operator, &system.emission);
    [
        errors(system, PartialSums::new(t, e)),
        errors(system, Chebyshev::new(t, e, interval)),
        errors(system, ConjugateGradients::new(t, t.weight(), e)),
    ]
}

/// The number of steps from the first to the second error of [`FROM_TO`]; none if an error is not reached.
pub fn steps(errors: &[f64]) -> Option<usize> {
    let [from, to] = FROM_TO.map(|error| errors.iter().position(|&x| x <= error));
    Some(to? - from?)
}

impl Errors {
    /// Runs the solvers. Chebyshev's iteration is told the interval that `interval` makes of all eigenvalues.
    pub(super) fn measure(
        system: &System<'_, PatchOperator<'_>>,
        values: &[f64],
        interval: fn(&[f64]) -> [f64; 2],
    ) -> Self {
        Self { by_step: all(system, interval(values)), interval: ends(values) }
    }
}

/// Multiplies all albedos by s, so that λ_1 comes closer and closer to 1, and counts the steps.
pub(super) fn brighter(room: &Matrix<Radiosity>) -> Result<Vec<Brighter>, Singular> {
    let (t, e) = (room.radiosity.operator(RED), room.radiosity.emission(RED));
    let [a, b] = ends(&Modes::of(&t, 0).values);
    let one = |gap: f64| {
        let s = (1.0 - gap) / b;
        let scaled = PatchOperator::new(t.factors, t.rho.iter().map(|rho| s * rho).collect());
        let interval = [s * a, s * b];
        let errors = all(&System::new(&scaled, e.clone())?, interval);
        Ok(Brighter { gap, interval, steps: errors.map(|errors| steps(&errors).unwrap_or(MOST)) })
    };
    GAPS.into_iter().map(one).collect()
}
