//! Iterations for `(I − T) x = E` that can be stopped and inspected after every step.
//!
//! ```text
//! x₀ = E,  x₁, x₂, … → L        residual  r = E − (I − T) x        error  L − x = (I − T)⁻¹ r
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x | the iterate | [`Iteration::iterate`] |
//! | applications | products with T so far, n² multiplications each | [`Iteration::applications`] |
//! | ‖x‖, ‖r‖ | norms in the area inner product | [`IterationStep`] |
//!
//! Every iteration starts at x₀ = E, so that patches that reflect nothing are right from the start. [`Watched`] runs an
//! iteration and measures it independently. It computes the residual of each step from the iterate with a separate product
//! with T. This product counts neither as an application nor as time. A wrong residual inside an iteration can therefore not
//! hide its error.

use crate::operator::matrix::LinearOperator;
use std::time::{Duration, Instant};

/// An iterative solver for (I − T) x = E.
pub trait Iteration {
    /// Performs one step. Returns false if there is nothing left to improve; then nothing has changed.
    fn advance(&mut self) -> bool;

    /// The iterate x, one value per patch.
    fn iterate(&self) -> &[f64];

    /// Number of products with T so far. Other work counts as a fraction: its multiplications divided by n².
    fn applications(&self) -> f64;
}

/// Measurements after one step of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IterationStep {
    /// Number of steps so far; 0 is the start.
    pub step: usize,
    /// Products with T so far.
    pub applications: f64,
    /// ‖x‖ in the area inner product.
    pub norm: f64,
    /// ‖E − (I − T) x‖ in the area inner product, computed independently of the iteration.
    pub residual: f64,
    /// Seconds spent in the steps, without the measurements.
    pub seconds: f64,
}

/// An iteration with measurements: an iterator over its steps, beginning with the start x₀.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::PatchOperator};
/// use fredholm::solver::{Iteration, PartialSums, Watched};
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// let (t, light) = (PatchOperator::new(&plates, vec![0.5, 0.5]), [1.0, 0.0]);
/// let mut watched = Watched::new(&t, &light, || PartialSums::new(&t, &light));
/// let last = watched.by_ref().take(60).take_while(|s| s.residual > 1e-12).last();
/// assert!(last.is_some_and(|s| s.step == 38)); // ‖T^{n+1} E‖ = 2^−(n+1)
/// assert!((watched.iteration().iterate()[0] - 4.0 / 3.0).abs() < 1e-11);
/// ```
#[derive(Debug)]
pub struct Watched<'a, T: ?Sized, I> {
    operator: &'a T,
    emission: &'a [f64],
    iteration: I,
    steps: usize,
    spent: Duration,
    started: bool,
}

impl<'a, T: LinearOperator + ?Sized, I: Iteration> Watched<'a, T, I> {
    /// Measures the iteration that `make` returns; the time of `make` is included.
    pub fn new(operator: &'a T, emission: &'a [f64], make: impl FnOnce() -> I) -> Self {
        let start = Instant::now();
        let iteration = make();
        Self { operator, emission, iteration, steps: 0, spent: start.elapsed(), started: false }
    }

    /// The current state of the iteration: after [`Iterator::next`] has returned a step, the iterate of that step.
    pub fn iteration(&self) -> &I {
        &self.iteration
    }

    fn measure(&self) -> IterationStep {
        let x = self.iteration.iterate();
        let r = residual(self.operator, self.emission, x);
        IterationStep {
            step: self.steps,
            applications: self.iteration.applications(),
            norm: self.operator.norm(x),
            residual: self.operator.norm(&r),
            seconds: self.spent.as_secs_f64(),
        }
    }
}

impl<T: LinearOperator + ?Sized, I: Iteration> Iterator for Watched<'_, T, I> {
    type Item = IterationStep;

    fn next(&mut self) -> Option<IterationStep> {
        // the first call returns the start; a step is taken only when it is requested, so that `iteration` shows the last
        // step returned
        if std::mem::replace(&mut self.started, true) {
            let clock = Instant::now();
            let moved = self.iteration.advance();
            self.spent += clock.elapsed();
            if !moved {
                return None;
            }
            self.steps += 1;
        }
        Some(self.measure())
    }
}

/// The residual E − (I − T) x.
pub fn residual<T: LinearOperator + ?Sized>(t: &T, emission: &[f64], x: &[f64]) -> Vec<f64> {
    let mut r = vec![0.0; x.len()];
    t.apply(x, &mut r);
    r.iter_mut().zip(emission).zip(x).for_each(|((r, e), x)| *r += e - x);
    r
}
