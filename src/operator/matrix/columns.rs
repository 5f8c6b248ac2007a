//! Columns of T: the light that one patch sends to all others.
//!
//! ```text
//! T eⱼ = Σᵢ Tᵢⱼ eᵢ        Tᵢⱼ = ρᵢ Fᵢⱼ
//! ```
//!
//! The dense matrix and the stored rays both hold F by rows. A solver that sends light patch by patch makes a copy by
//! columns once.

use super::{LinearOperator, PatchOperator, Rows};
use rayon::prelude::*;

/// The columns of an operator.
pub trait Columns {
    /// Calls `visit` with i and Tᵢⱼ for every i whose Tᵢⱼ may be nonzero. An entry may arrive in several parts that sum to
    /// Tᵢⱼ.
    fn visit(&self, j: usize, visit: impl FnMut(usize, f64));

    /// Number of multiplications of [`Columns::visit`] for column j.
    fn work(&self, j: usize) -> usize;

    /// Number of multiplications of one application of T.
    fn whole(&self) -> usize;
}

/// An operator that can be copied by columns.
pub trait Transposed: Rows {
    /// The type of the copy.
    type Columns: Columns;

    /// Copies T by columns.
    fn columns(&self) -> Self::Columns;
}

/// `diag(ρ) F` by columns.
#[derive(Clone, Debug)]
pub struct PatchColumns {
    rho: Vec<f64>,
    /// Fᵢⱼ at `n·j + i`.
    f: Vec<f32>,
}

impl Transposed for PatchOperator<'_> {
    type Columns = PatchColumns;

    fn columns(&self) -> PatchColumns {
        let n = self.len();
        let mut f = vec![0.0; n * n];
        f.par_chunks_mut(n.max(1)).enumerate().for_each(|(j, column)| {
            column.iter_mut().enumerate().for_each(|(i, f)| *f = self.factors.f[n * i + j]);
        });
        PatchColumns { rho: self.rho.clone(), f }
    }
}

impl Columns for PatchColumns {
    fn visit(&self, j: usize, mut visit: impl FnMut(usize, f64)) {
        let n = self.rho.len();
        let column = &self.f[n * j..n * (j + 1)];
        self.rho.iter().zip(column).enumerate().for_each(|(i, (rho, f))| visit(i, rho * f64::from(*f)));
    }

    fn work(&self, _: usize) -> usize {
        self.rho.len()
    }

    fn whole(&self) -> usize {
        self.f.len()
    }
}
