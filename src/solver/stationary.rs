//! Stationary iterations: every step uses the same formula.
//!
//! ```text
//! partial sums   x ← E + T x                                        x_n = S_n = Σ_{k≤n} T^k E,  residual T^{n+1} E
//! Jacobi         xᵢ ← (E + T x − Tᵢᵢ xᵢ)ᵢ / (1 − Tᵢᵢ)                all i at once
//! SOR            xᵢ ← xᵢ + ω ((E + T x − Tᵢᵢ xᵢ)ᵢ / (1 − Tᵢᵢ) − xᵢ)  one i after the other, new values at once
//! ```
//!
//! Jacobi's iteration is exactly the Neumann series if no patch sees itself (Tᵢᵢ = 0, as on flat patches). On curved patches
//! it sums the light that a patch sends to itself in one step, so its iterates are not partial sums.
//!
//! Gauss–Seidel is SOR with ω = 1. If T ≥ 0 and the start is below L, its iterate is on every patch at least as close to L
//! as Jacobi's. Its asymptotic rate is at least as good (Stein and Rosenberg 1948). Its iterates are not sums of bounces.
//!
//! Reference: Varga, *Matrix Iterative Analysis* (1962), chapters 3 and 4.

use super::iteration::Iteration;
use crate::operator::matrix::{LinearOperator, Rows};

/// The Neumann series as an iteration: x_n = Σ_{k≤n} T^k E, with one application per step.
#[derive(Clone, Debug)]
pub struct PartialSums<'a, T: ?Sized> {
    operator: &'a T,
    /// The last term, T^n E.
    term: Vec<f64>,
    image: Vec<f64>,
    sum: Vec<f64>,
    steps: usize,
}

impl<'a, T: LinearOperator + ?Sized> PartialSums<'a, T> {
    /// Starts at S₀ = E.
    pub fn new(operator: &'a T, emission: &[f64]) -> Self {
        let [term, sum] = [emission.to_vec(), emission.to_vec()];
        Self { operator, image: vec![0.0; term.len()], term, sum, steps: 0 }
    }
}

impl<T: LinearOperator + ?Sized> Iteration for PartialSums<'_, T> {
    fn advance(&mut self) -> bool {
        self.operator.apply(&self.term, &mut self.image);
        std::mem::swap(&mut self.term, &mut self.image);
        self.sum.iter_mut().zip(&self.term).for_each(|(s, t)| *s += t);
        self.steps += 1;
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.sum
    }

    fn applications(&self) -> f64 {
        self.steps as f64
    }
}

/// Jacobi's iteration: updates all patches at once and sums the light that each sends to itself exactly.
#[derive(Clone, Debug)]
pub struct Jacobi<'a, T: ?Sized> {
    operator: &'a T,
    emission: Vec<f64>,
    diagonal: Vec<f64>,
    x: Vec<f64>,
    image: Vec<f64>,
    steps: usize,
}

impl<'a, T: Rows + ?Sized> Jacobi<'a, T> {
    /// Starts at x₀ = E.
    pub fn new(operator: &'a T, emission: &[f64]) -> Self {
        let [emission, x] = [emission.to_vec(), emission.to_vec()];
        Self { operator, diagonal: diagonal(operator), image: vec![0.0; x.len()], emission, x, steps: 0 }
    }
}

impl<T: Rows + ?Sized> Iteration for Jacobi<'_, T> {
    fn advance(&mut self) -> bool {
        self.operator.apply(&self.x, &mut self.image);
        for (i, x) in self.x.iter_mut().enumerate() {
            *x = (self.emission[i] + self.image[i] - self.diagonal[i] * *x) / (1.0 - self.diagonal[i]);
        }
        self.steps += 1;
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.steps as f64
    }
}

/// Successive over-relaxation (SOR); with ω = 1 it is Gauss–Seidel.
#[derive(Clone, Debug)]
pub struct Sor<'a, T: ?Sized> {
    operator: &'a T,
    emission: Vec<f64>,
    diagonal: Vec<f64>,
    omega: f64,
    x: Vec<f64>,
    steps: usize,
}

impl<'a, T: Rows + ?Sized> Sor<'a, T> {
    /// Gauss–Seidel (ω = 1), starting at x₀ = E.
    pub fn gauss_seidel(operator: &'a T, emission: &[f64]) -> Self {
        Self::new(operator, emission, 1.0)
    }

    /// Starts at x₀ = E; the iteration can converge only for 0 < ω < 2.
    pub fn new(operator: &'a T, emission: &[f64], omega: f64) -> Self {
        let [emission, x] = [emission.to_vec(), emission.to_vec()];
        Self { operator, diagonal: diagonal(operator), emission, omega, x, steps: 0 }
    }

    /// Young's ω = 2 / (1 + √(1 − r²)) for the spectral radius r. It is optimal for matrices whose graph can be coloured
    /// with two colours. The matrix of a room cannot, so there it is only a fair guess.
    pub fn young(radius: f64) -> f64 {
        2.0 / (1.0 + (1.0 - radius * radius).sqrt())
    }
}

impl<T: Rows + ?Sized> Iteration for Sor<'_, T> {
    fn advance(&mut self) -> bool {
        for i in 0..self.x.len() {
            let gathered = self.emission[i] + self.operator.row_times(i, &self.x) - self.diagonal[i] * self.x[i];
            self.x[i] += self.omega * (gathered / (1.0 - self.diagonal[i]) - self.x[i]);
        }
        self.steps += 1;
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.steps as f64
    }
}

/// The diagonal entries Tᵢᵢ.
pub(super) fn diagonal<T: Rows + ?Sized>(t: &T) -> Vec<f64> {
    (0..t.len()).map(|i| t.entry(i, i)).collect()
}
