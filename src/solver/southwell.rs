//! Southwell's relaxation, in rendering called progressive shooting: the patch with the largest unshot power sends its light
//! first.
//!
//! ```text
//! j = argmax Aᵢ rᵢ        δ = rⱼ / (1 − Tⱼⱼ)        xⱼ ← xⱼ + δ        r ← r − δ (I − T) eⱼ
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | r = E − (I − T) x | *unshot* radiance: light that has arrived at a patch and has not been sent on |
//! | Aᵢ rᵢ | unshot power divided by π |
//! | j, δ | the patch that shoots, and the radiance that it shoots |
//!
//! If E ≥ 0 and T ≥ 0, the residual stays ≥ 0, every shot only adds light, and x ≤ L throughout. The picture gets brighter
//! with every shot and is never too bright. The start is x₀ = 0, r = E, because nothing has been shot yet. A shot uses one
//! column of T and counts as a fraction of an application. For a matrix this is 1/n. For stored rays it is the fraction of
//! the rays that hit patch j. Both operators are first copied by columns.
//!
//! Reference: Southwell (1940); Cohen, Chen, Wallace, Greenberg, *A Progressive Refinement Approach to Fast Radiosity Image
//! Generation* (1988); Gortler, Cohen, Slusallek, *Radiosity and Relaxation Methods* (1994).

use super::iteration::Iteration;
use super::stationary::diagonal;
use crate::operator::matrix::{Columns, Transposed};

/// Progressive shooting.
#[derive(Clone, Debug)]
pub struct Southwell<C> {
    columns: C,
    area: Vec<f64>,
    diagonal: Vec<f64>,
    x: Vec<f64>,
    unshot: Vec<f64>,
    /// Unshot power of every patch, in a tree that finds the largest.
    power: Tournament,
    shots: usize,
    multiplications: usize,
    per_step: usize,
}

impl<C: Columns> Southwell<C> {
    /// Starts with all emission unshot. A step is n shots, about the work of one application of T.
    pub fn new<T: Transposed<Columns = C> + ?Sized>(operator: &T, emission: &[f64]) -> Self {
        Self::with_shots(operator, emission, emission.len())
    }

    /// The same with `per_step` shots per step.
    pub fn with_shots<T: Transposed<Columns = C> + ?Sized>(operator: &T, emission: &[f64], per_step: usize) -> Self {
        let (area, unshot) = (operator.area().to_vec(), emission.to_vec());
        let power = Tournament::new(unshot.iter().zip(&area).map(|(r, a)| a * r.abs()));
        Self {
            columns: operator.columns(),
            area,
            diagonal: diagonal(operator),
            x: vec![0.0; unshot.len()],
            unshot,
            power,
            shots: 0,
            multiplications: 0,
            per_step,
        }
    }

    /// The residual E − (I − T) x, which every shot updates.
    pub fn unshot(&self) -> &[f64] {
        &self.unshot
    }

    fn shoot(&mut self, j: usize) {
        let Self { columns, area, unshot, power, .. } = self;
        let sent = unshot[j] / (1.0 - self.diagonal[j]);
        self.x[j] += sent;
        columns.visit(j, |i, t| unshot[i] += t * sent);
        unshot[j] = 0.0; // r − (1 − Tⱼⱼ) δ
        let now = |i: usize| area[i] * unshot[i].abs();
        if power.is_cheaper(columns.work(j)) {
            columns.visit(j, |i, _| power.set(i, now(i)));
            power.set(j, 0.0);
        } else {
            power.set_all((0..area.len()).map(now));
        }
        self.shots += 1;
        self.multiplications += columns.work(j);
    }
}

impl<C: Columns> Iteration for Southwell<C> {
    fn advance(&mut self) -> bool {
        let before = self.shots;
        while self.shots - before < self.per_step {
            let Some(next) = self.power.first().filter(|j| self.unshot[*j] != 0.0) else { break };
            self.shoot(next);
        }
        self.shots > before
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.multiplications as f64 / self.columns.whole().max(1) as f64
    }
}

/// Finds the largest of n numbers of which a few change at a time: a binary tree of maxima over the leaves `size..`.
#[derive(Clone, Debug)]
struct Tournament {
    size: usize,
    nodes: Vec<f64>,
}

impl Tournament {
    fn new(values: impl ExactSizeIterator<Item = f64>) -> Self {
        let size = values.len().next_power_of_two();
        let mut out = Self { size, nodes: vec![0.0; 2 * size] };
        out.set_all(values);
        out
    }

    /// Returns true if setting `leaves` leaves one by one is faster than setting all leaves at once.
    fn is_cheaper(&self, leaves: usize) -> bool {
        leaves * self.size.ilog2() as usize <= self.size
    }

    fn set(&mut self, leaf: usize, value: f64) {
        let mut at = self.size + leaf;
        self.nodes[at] = value;
        while at > 1 {
            at /= 2;
            let most = self.nodes[2 * at].max(self.nodes[2 * at + 1]);
            if most == self.nodes[at] {
                break;
            }
            self.nodes[at] = most;
        }
    }

    fn set_all(&mut self, values: impl Iterator<Item = f64>) {
        self.nodes[self.size..].iter_mut().zip(values).for_each(|(n, v)| *n = v);
        for at in (1..self.size).rev() {
            self.nodes[at] = self.nodes[2 * at].max(self.nodes[2 * at + 1]);
        }
    }

    /// The index of the largest value in this binary tree of maxima, the first one if several are equal; `None` if all are 0.
    fn first(&self) -> Option<usize> {
        let most = *self.nodes.get(1).filter(|m| **m > 0.0)?;
        let mut at = 1;
        while at < self.size {
            at = 2 * at + usize::from(self.nodes[2 * at] != most);
        }
        Some(at - self.size)
    }
}
