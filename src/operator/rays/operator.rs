//! T = diag(ρ) F of stored rays, the same operator with half of the rays, and its Galerkin projection on a coarser mesh.
//!
//! ```text
//! (T x)ᵢ  = ρᵢ (1/N) Σₛ x_{hit(i,s)}
//! (T* y)ⱼ = (1/Aⱼ) Σᵢ Aᵢ ρᵢ yᵢ #{s : hit(i,s) = j}/N
//! T_H = R T P       (P X)ᵢ = X_{parent(i)}      (R x)_I = Σ_{i∈I} Aᵢ xᵢ / A_I
//! ```
//!
//! T_H is the operator on the coarse patches I, built from the same rays: each fine patch contributes its rays in proportion
//! to its area. A study of the mesh size h therefore needs no further rays.

use super::{Hit, Rays};
use crate::operator::matrix::{LinearOperator, Rows};
use rayon::prelude::*;

/// The part of the rays of every row that is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// All N rays.
    Both,
    /// The first N/2 rays.
    First,
    /// The last N/2 rays.
    Second,
}

/// `diag(ρ) F` of one colour channel, where F is sampled.
#[derive(Clone, Debug)]
pub struct RayOperator<'a> {
    /// The stored rays.
    pub rays: &'a Rays,
    /// Albedo per patch.
    pub rho: Vec<f64>,
    /// The part of the rays that is used.
    pub half: Half,
}

impl Rays {
    /// The operator T for the albedos `rho`, one per patch.
    ///
    /// # Panics
    /// If the number of albedos is not the number of patches.
    pub fn operator(&self, rho: Vec<f64>) -> RayOperator<'_> {
        assert_eq!(rho.len(), self.n, "one albedo per patch");
        RayOperator { rays: self, rho, half: Half::Both }
    }
}

impl<'a> RayOperator<'a> {
    /// The same operator with another part of the rays.
    #[must_use]
    pub fn by(self, half: Half) -> Self {
        Self { half, ..self }
    }

    /// The used hits of row i as runs in ascending order, and the weight of one ray.
    pub(super) fn runs(&self, i: usize) -> (impl Iterator<Item = &'a [Hit]> + use<'a>, f64) {
        let [a, b] = self.rays.row(i);
        let (runs, rays) = match self.half {
            Half::Both => ([a, b], self.rays.per_row),
            Half::First => ([a, &b[..0]], a.len()),
            Half::Second => ([&a[..0], b], b.len()),
        };
        (runs.into_iter(), 1.0 / rays as f64)
    }
}

impl LinearOperator for RayOperator<'_> {
    fn area(&self) -> &[f64] {
        &self.rays.area
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        y.par_iter_mut().with_min_len(64).enumerate().for_each(|(i, y)| *y = self.row_times(i, x));
    }

    fn apply_adjoint(&self, x: &[f64], y: &mut [f64]) {
        // a fixed number of blocks, each of which reads its part of every row, so that sums have a fixed order
        let block = self.len().div_ceil(32).max(1);
        y.par_chunks_mut(block).enumerate().for_each(|(number, y)| {
            let first = number * block;
            let end = first + y.len();
            y.fill(0.0);
            for (i, x) in x.iter().enumerate() {
                let (runs, weight) = self.runs(i);
                let weight = self.rays.area[i] * self.rho[i] * x * weight;
                if weight == 0.0 {
                    continue;
                }
                for run in runs {
                    let from = run.partition_point(|h| h.patch() < first);
                    let own = run[from..].iter().map(|h| h.patch()).take_while(|j| *j < end);
                    own.for_each(|j| y[j - first] += weight);
                }
            }
            y.iter_mut().zip(&self.rays.area[first..]).for_each(|(y, a)| *y /= a);
        });
    }
}

/// `R T P`: the operator on a coarser mesh whose patches are unions of fine patches.
#[derive(Clone, Debug)]
pub struct Coarse<'a, T: ?Sized> {
    fine: &'a T,
    parent: &'a [u32],
    area: &'a [f64],
    coarse_area: Vec<f64>,
}

impl<'a, T: LinearOperator + ?Sized> Coarse<'a, T> {
    /// The projection of `fine`. For every fine patch, `parent` holds the number of its union and `area` its area.
    ///
    /// # Panics
    /// If `parent` and `area` do not have one entry per patch of `fine`.
    pub fn new(fine: &'a T, parent: &'a [u32], area: &'a [f64]) -> Self {
        assert!(parent.len() == fine.len() && area.len() == fine.len(), "one parent and one area per patch");
        let mut coarse_area = vec![0.0; parent.iter().max().map_or(0, |m| *m as usize + 1)];
        parent.iter().zip(area).for_each(|(p, a)| coarse_area[*p as usize] += a);
        Self { fine, parent, area, coarse_area }
    }

    /// P: gives every fine patch the value of its union.
    pub fn prolong(&self, coarse: &[f64]) -> Vec<f64> {
        self.parent.iter().map(|p| coarse[*p as usize]).collect()
    }

    /// R: the area-weighted mean of each union.
    pub fn restrict(&self, fine: &[f64], coarse: &mut [f64]) {
        coarse.fill(0.0);
        for ((p, a), x) in self.parent.iter().zip(self.area).zip(fine) {
            coarse[*p as usize] += a * x;
        }
        coarse.iter_mut().zip(&self.coarse_area).for_each(|(c, a)| *c /= a);
    }
}

impl<T: LinearOperator + ?Sized> LinearOperator for Coarse<'_, T> {
    fn area(&self) -> &[f64] {
        &self.coarse_area
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let mut fine = vec![0.0; self.fine.len()];
        self.fine.apply(&self.prolong(x), &mut fine);
        self.restrict(&fine, y);
    }

    fn apply_adjoint(&self, x: &[f64], y: &mut [f64]) {
        // R and P are each other's adjoint in the area inner products
        let mut fine = vec![0.0; self.fine.len()];
        self.fine.apply_adjoint(&self.prolong(x), &mut fine);
        self.restrict(&fine, y);
    }
}
