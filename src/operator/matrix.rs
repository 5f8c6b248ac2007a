//! The discrete operator over patches: `T_h = diag(ρ) F`, separately for each colour channel.
//!
//! ```text
//! (T u)ᵢ  = ρᵢ Σⱼ Fᵢⱼ uⱼ                            apply
//! (T* u)ⱼ = (1/Aⱼ) Σᵢ Aᵢ ρᵢ Fᵢⱼ uᵢ                  adjoint in ⟨u, v⟩_A = Σᵢ Aᵢ uᵢ vᵢ
//! ‖T‖∞ = maxᵢ (T 1)ᵢ      ‖T‖₁ = maxⱼ (T* 1)ⱼ       exact for the matrix, since all entries are ≥ 0
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u | radiance per patch | slices of length [`LinearOperator::len`] |
//! | ρ | albedo of the channel | [`PatchOperator::rho`] |
//! | F, A | form factors and areas | [`FormFactors`] |
//!
//! Every sum runs in a fixed order, so that results do not depend on the number of threads.

mod columns;
mod lanczos;
mod product;
mod reach;
mod spectrum;
mod weight;

use super::form_factor::FormFactors;
pub use columns::{Columns, PatchColumns, Transposed};
pub use lanczos::{Extremes, Ritz, extremes, leading};
use product::{dot, product};
use rayon::prelude::*;
pub use reach::reached;
pub use spectrum::{Spectral, spectral_radius};
pub use weight::Weight;

/// A linear operator that can be applied to one radiance per patch; its adjoint can be applied, too.
pub trait LinearOperator: Sync {
    /// The areas Aᵢ of the patches, m²; they define the space on which the operator acts.
    fn area(&self) -> &[f64];

    /// Number of patches.
    fn len(&self) -> usize {
        self.area().len()
    }

    /// Returns true if there are no patches.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Computes y = T x.
    fn apply(&self, x: &[f64], y: &mut [f64]);

    /// Computes y = T* x, where T* is the adjoint in the area inner product: ⟨z, T x⟩_A = ⟨T* z, x⟩_A.
    fn apply_adjoint(&self, x: &[f64], y: &mut [f64]);

    /// The area inner product ⟨u, v⟩_A = Σᵢ Aᵢ uᵢ vᵢ.
    fn inner(&self, u: &[f64], v: &[f64]) -> f64 {
        self.area().iter().zip(u).zip(v).map(|((a, u), v)| a * u * v).sum()
    }

    /// The area norm ‖u‖_A = √⟨u, u⟩_A.
    fn norm(&self, u: &[f64]) -> f64 {
        self.inner(u, u).sqrt()
    }
}

/// An operator with access to single rows and single entries.
pub trait Rows: LinearOperator {
    /// The entry Tᵢⱼ.
    fn entry(&self, i: usize, j: usize) -> f64;

    /// Entry i of T x.
    fn row_times(&self, i: usize, x: &[f64]) -> f64;
}

/// The operator `diag(ρ) F` of one colour channel.
#[derive(Clone, Debug)]
pub struct PatchOperator<'a> {
    /// The form factors F.
    pub factors: &'a FormFactors,
    /// Albedo per patch.
    pub rho: Vec<f64>,
}

impl<'a> PatchOperator<'a> {
    /// The operator `diag(ρ) F` for the albedos `rho`, one per patch.
    ///
    /// ```
    /// use fredholm::operator::{form_factor::FormFactors, matrix::{LinearOperator, PatchOperator}};
    /// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
    /// let t = PatchOperator::new(&plates, vec![0.9, 0.4]);
    /// let mut bounce = [0.0; 2];
    /// t.apply(&[1.0, 0.0], &mut bounce);
    /// assert_eq!(bounce, [0.0, 0.4]);
    /// ```
    ///
    /// # Panics
    /// If the number of albedos is not the number of patches.
    pub fn new(factors: &'a FormFactors, rho: Vec<f64>) -> Self {
        assert_eq!(rho.len(), factors.n, "one albedo per patch");
        Self { factors, rho }
    }

    /// ‖T‖∞ = maxᵢ ρᵢ Σⱼ Fᵢⱼ: one bounce multiplies the largest radiance by at most this factor.
    pub fn norm_inf(&self) -> f64 {
        let mut y = vec![0.0; self.len()];
        self.apply(&vec![1.0; self.len()], &mut y);
        y.into_iter().fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }

    /// ‖T‖₁ in the area measure, maxⱼ (1/Aⱼ) Σᵢ Aᵢ ρᵢ Fᵢⱼ: one bounce multiplies the total power by at most this factor.
    pub fn norm_1(&self) -> f64 {
        let mut y = vec![0.0; self.len()];
        self.apply_adjoint(&vec![1.0; self.len()], &mut y);
        y.into_iter().fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }

    /// The weight w = A/ρ, in which T is self-adjoint.
    pub fn weight(&self) -> Weight {
        Weight::new(&self.factors.area, &self.rho)
    }

    /// ⟨u, v⟩_w in the weight w = A/ρ.
    pub fn weighted_inner(&self, u: &[f64], v: &[f64]) -> f64 {
        self.weight().inner(u, v)
    }

    /// ‖x‖_w = √⟨x, x⟩_w.
    pub fn weighted_norm(&self, x: &[f64]) -> f64 {
        self.weight().norm(x)
    }
}

impl Rows for PatchOperator<'_> {
    fn entry(&self, i: usize, j: usize) -> f64 {
        self.rho[i] * f64::from(self.factors.row(i)[j])
    }

    fn row_times(&self, i: usize, x: &[f64]) -> f64 {
        self.rho[i] * dot(self.factors.row(i), x)
    }
}

impl LinearOperator for PatchOperator<'_> {
    fn area(&self) -> &[f64] {
        &self.factors.area
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        product(self.factors, &self.rho, x, y);
    }

    fn apply_adjoint(&self, x: &[f64], y: &mut [f64]) {
        const BLOCK: usize = 512;
        let area = &self.factors.area;
        y.par_chunks_mut(BLOCK).enumerate().for_each(|(block, y)| {
            let first = block * BLOCK;
            y.fill(0.0);
            for i in 0..self.len() {
                let weight = area[i] * self.rho[i] * x[i];
                let row = &self.factors.row(i)[first..first + y.len()];
                for (y, f) in y.iter_mut().zip(row) {
                    *y += weight * f64::from(*f);
                }
            }
            for (y, a) in y.iter_mut().zip(&area[first..]) {
                *y /= a;
            }
        });
    }
}
