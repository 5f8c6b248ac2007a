//! Access to single rows and columns of stored rays.
//!
//! ```text
//! (T x)ᵢ = (ρᵢ/N) Σₛ x_{hit(i,s)}        T eⱼ = Σ_{(i,s): hit(i,s) = j} (ρᵢ/N) eᵢ
//! ```
//!
//! Rows are stored. Columns are their transpose, built by counting; they need another u32 per ray.

use super::{Hit, RayOperator};
use crate::operator::matrix::{Columns, LinearOperator, Rows, Transposed};

impl Rows for RayOperator<'_> {
    fn entry(&self, i: usize, j: usize) -> f64 {
        let (runs, weight) = self.runs(i);
        let count = |run: &[Hit]| run.partition_point(|h| h.patch() <= j) - run.partition_point(|h| h.patch() < j);
        self.rho[i] * weight * runs.map(count).sum::<usize>() as f64
    }

    fn row_times(&self, i: usize, x: &[f64]) -> f64 {
        let (runs, weight) = self.runs(i);
        // rays that hit nothing sort last
        let met = |run: &[Hit]| run.iter().take_while(|h| **h != Hit::NOTHING).map(|h| x[h.patch()]).sum::<f64>();
        self.rho[i] * weight * runs.map(met).sum::<f64>()
    }
}

/// `diag(ρ) F` of stored rays, by columns.
#[derive(Clone, Debug)]
pub struct RayColumns {
    /// The weight of a ray of each row: ρᵢ/N.
    weight: Vec<f64>,
    /// Column j is `rows[first[j]..first[j + 1]]`.
    first: Vec<usize>,
    /// The row of every ray that hit a patch, sorted by that patch.
    rows: Vec<u32>,
}

impl Transposed for RayOperator<'_> {
    type Columns = RayColumns;

    fn columns(&self) -> RayColumns {
        let n = self.len();
        let hits = |i: usize| self.runs(i).0.flatten().filter(|h| **h != Hit::NOTHING).map(|h| h.patch());
        let mut first = vec![0; n + 1];
        (0..n).flat_map(hits).for_each(|j| first[j + 1] += 1);
        (0..n).for_each(|j| first[j + 1] += first[j]);
        let (mut next, mut rows) = (first.clone(), vec![0; first[n]]);
        for i in 0..n {
            for j in hits(i) {
                rows[next[j]] = i as u32;
                next[j] += 1;
            }
        }
        RayColumns { weight: (0..n).map(|i| self.rho[i] * self.runs(i).1).collect(), first, rows }
    }
}

impl Columns for RayColumns {
    fn visit(&self, j: usize, mut visit: impl FnMut(usize, f64)) {
        self.rows[self.first[j]..self.first[j + 1]].iter().for_each(|i| visit(*i as usize, self.weight[*i as usize]));
    }

    fn work(&self, j: usize) -> usize {
        self.first[j + 1] - self.first[j]
    }

    fn whole(&self) -> usize {
        self.rows.len()
    }
}
