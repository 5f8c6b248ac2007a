//! Chebyshev's semi-iteration: the best method that uses only the ends of the spectrum.
//!
//! ```text
//! L − xₙ = Pₙ(T) (L − x₀)        Pₙ(λ) = Cₙ((λ − m)/h) / Cₙ((1 − m)/h)        m, h: middle and half length of [a, b]
//! ‖L − xₙ‖_w ≤ ‖L − x₀‖_w / Cₙ((1 − m)/h) = 2 qⁿ/(1 + q²ⁿ) ‖L − x₀‖_w         if all eigenvalues lie in [a, b], b < 1
//!
//! q = (√c − 1)/(√c + 1)        c = (1 − a)/(1 − b)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | [a, b] | an interval that contains every eigenvalue of T | [`Chebyshev::new`]; see [`extremes`](crate::operator::matrix::extremes) |
//! | Cₙ, Pₙ | Chebyshev polynomial, and its scaled form with Pₙ(1) = 1, so that the iteration leaves L unchanged | |
//!
//! The method needs no inner products: each step is one application of T and some sums. The price is that b must be known.
//! The bound does not hold for an eigenvalue above b; one far above makes the iteration slower than the Neumann series.
//!
//! Reference: Golub and Varga (1961); Varga, *Matrix Iterative Analysis* (1962), chapter 5.

use super::iteration::Iteration;
use crate::operator::matrix::LinearOperator;

/// Chebyshev's semi-iteration.
#[derive(Clone, Debug)]
pub struct Chebyshev<'a, T: ?Sized> {
    operator: &'a T,
    emission: Vec<f64>,
    middle: f64,
    half: f64,
    /// Cₙ₋₁(σ)/Cₙ(σ), σ = (1 − m)/h; 0 before the first step.
    ratio: f64,
    x: Vec<f64>,
    before: Vec<f64>,
    image: Vec<f64>,
    steps: usize,
}

impl<'a, T: LinearOperator + ?Sized> Chebyshev<'a, T> {
    /// Starts at x₀ = E. `[a, b]` should contain every eigenvalue of T, with a < b < 1.
    pub fn new(operator: &'a T, emission: &[f64], [a, b]: [f64; 2]) -> Self {
        let vector = || emission.to_vec();
        Self {
            operator,
            emission: vector(),
            middle: 0.5 * (a + b),
            half: 0.5 * (b - a),
            ratio: 0.0,
            x: vector(),
            before: vector(),
            image: vector(),
            steps: 0,
        }
    }

    /// The factor 2 qⁿ/(1 + q²ⁿ) by which n steps reduce the error at least, if all eigenvalues lie in [a, b].
    ///
    /// ```
    /// use fredholm::solver::Chebyshev;
    /// # use fredholm::operator::matrix::PatchOperator;
    /// let bound = Chebyshev::<PatchOperator>::bound([-0.6, 0.6], 1);
    /// assert!((bound - 0.6).abs() < 1e-15); // one step gains no more than T itself
    /// ```
    pub fn bound([a, b]: [f64; 2], n: usize) -> f64 {
        let root = ((1.0 - a) / (1.0 - b)).sqrt();
        let q = ((root - 1.0) / (root + 1.0)).powi(n as i32);
        2.0 * q / (1.0 + q * q)
    }
}

impl<T: LinearOperator + ?Sized> Iteration for Chebyshev<'_, T> {
    /// With z = (T x + E − m x)/h, τ = Cₙ(σ)/Cₙ₊₁(σ) and the recurrence Cₙ₊₁ = 2 z Cₙ − Cₙ₋₁: xₙ₊₁ = τ (2 z −
    /// (Cₙ₋₁(σ)/Cₙ(σ)) xₙ₋₁). This step leaves L unchanged.
    fn advance(&mut self) -> bool {
        let Self { operator, emission, middle, half, ratio, x, before, image, steps } = self;
        operator.apply(x, image);
        let sigma = (1.0 - *middle) / *half;
        let first = *steps == 0;
        let tau = if first { 1.0 / sigma } else { 1.0 / (2.0 * sigma - *ratio) };
        for i in 0..x.len() {
            let z = (emission[i] + image[i] - *middle * x[i]) / *half;
            let next = if first { tau * z } else { tau * (2.0 * z - *ratio * before[i]) };
            before[i] = std::mem::replace(&mut x[i], next);
        }
        *ratio = tau;
        *steps += 1;
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.steps as f64
    }
}
