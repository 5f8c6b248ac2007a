//! Southwell's relaxation, known to rendering as progressive shooting: the brightest unshot patch sends its light first.
//!
//! ```text
//! j = argmax Aᵢ rᵢ        δ = rⱼ / (1 − Tⱼⱼ)        xⱼ ← xⱼ + δ        r ← r − δ (I − T) eⱼ
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | r = E − (I − T) x | what has arrived and has not been sent on: *unshot* radiance |
//! | Aᵢ rᵢ | unshot power, up to π |
//!
//! With E ≥ 0 and T ≥ 0 the residual stays ≥ 0, every shot only adds, and x ≤ L throughout: the picture gets brighter and is
//! never too bright. It starts at x₀ = 0, r = E, so nothing is shot yet; n shots are the work of one application.
//!
//! Reference: Southwell (1940); Cohen, Chen, Wallace, Greenberg, *A Progressive Refinement Approach to Fast Radiosity Image
//! Generation* (1988); Gortler, Cohen, Slusallek, *Radiosity and Relaxation Methods* (1994).

use super::iteration::Iteration;
use crate::operator::matrix::PatchOperator;
use rayon::prelude::*;

/// Progressive shooting.
#[derive(Clone, Debug)]
pub struct Southwell<'a> {
    operator: &'a PatchOperator<'a>,
    /// F by columns: `n·j + i` is the share that i sees of j.
    columns: Vec<f32>,
    x: Vec<f64>,
    unshot: Vec<f64>,
    /// The patch with the most unshot power.
    next: usize,
    shots: usize,
    per_step: usize,
}

impl<'a> Southwell<'a> {
    /// Starts with everything unshot; a step is n shots, the work of one application.
    pub fn new(operator: &'a PatchOperator<'a>, emission: &[f64]) -> Self {
        Self::with_shots(operator, emission, emission.len())
    }

    /// The same with `per_step` shots in a step.
    pub fn with_shots(operator: &'a PatchOperator<'a>, emission: &[f64], per_step: usize) -> Self {
        let n = emission.len();
        let mut columns = vec![0.0; n * n];
        columns.par_chunks_mut(n.max(1)).enumerate().for_each(|(j, column)| {
            column.iter_mut().enumerate().for_each(|(i, f)| *f = operator.factors.f[n * i + j]);
        });
        let (x, unshot) = (vec![0.0; n], emission.to_vec());
        let mut out = Self { operator, columns, x, unshot, next: 0, shots: 0, per_step };
        out.next = out.brightest();
        out
    }

    /// E − (I − T) x as it is kept up to date.
    pub fn unshot(&self) -> &[f64] {
        &self.unshot
    }

    fn power(&self, i: usize) -> f64 {
        self.operator.factors.area[i] * self.unshot[i].abs()
    }

    fn brightest(&self) -> usize {
        (0..self.unshot.len()).fold(0, |best, i| if self.power(i) > self.power(best) { i } else { best })
    }

    fn shoot(&mut self, j: usize) {
        let n = self.x.len();
        let column = &self.columns[n * j..n * (j + 1)];
        let rho = &self.operator.rho;
        let own = rho[j] * f64::from(column[j]);
        let sent = self.unshot[j] / (1.0 - own);
        self.x[j] += sent;
        self.unshot.iter_mut().zip(rho).zip(column).for_each(|((r, rho), f)| *r += rho * f64::from(*f) * sent);
        self.unshot[j] = 0.0; // r − (1 − Tⱼⱼ) δ
        self.shots += 1;
        self.next = self.brightest();
    }
}

impl Iteration for Southwell<'_> {
    fn advance(&mut self) -> bool {
        let before = self.shots;
        while self.shots - before < self.per_step && self.unshot.get(self.next).is_some_and(|r| *r != 0.0) {
            self.shoot(self.next);
        }
        self.shots > before
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.shots as f64 / self.x.len() as f64
    }
}
