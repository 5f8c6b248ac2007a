//! T = diag(ρ) F of stored rays, its halves, and its Galerkin projection on a coarser mesh.
//!
//! ```text
//! (T x)ᵢ  = ρᵢ (1/N) Σₛ x_{hit(i,s)}
//! (T* y)ⱼ = (1/Aⱼ) Σᵢ Aᵢ ρᵢ yᵢ #{s : hit(i,s) = j}/N
//! T_H = R T P       (P X)ᵢ = X_{parent(i)}      (R x)_I = Σ_{i∈I} Aᵢ xᵢ / A_I
//! ```
//!
//! T_H is what the same rays give when every patch of I has its share of the rays of I by area, so a study in h costs no
//! further ray.

use super::{Hit, Rays};
use crate::operator::matrix::{LinearOperator, Rows};
use rayon::prelude::*;

/// Which rays of every row are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// All N.
    Both,
    /// The first N/2.
    First,
    /// The last N/2.
    Second,
}

/// `diag(ρ) F` of one channel, F as sampled.
#[derive(Clone, Debug)]
pub struct RayOperator<'a> {
    /// The rows.
    pub rays: &'a Rays,
    /// Albedo per patch.
    pub rho: Vec<f64>,
    /// The rays used.
    pub half: Half,
}

impl Rays {
    /// T of these albedos.
    ///
    /// # Panics
    /// If there are not as many albedos as patches.
    pub fn operator(&self, rho: Vec<f64>) -> RayOperator<'_> {
        assert_eq!(rho.len(), self.n, "one albedo per patch");
        RayOperator { rays: self, rho, half: Half::Both }
    }
}

impl<'a> RayOperator<'a> {
    /// The same operator by other rays.
    #[must_use]
    pub fn by(self, half: Half) -> Self {
        Self { half, ..self }
    }

    /// The runs of ascending hits that are used of row i, and the weight of a ray.
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
        // a fixed number of blocks, each of which reads its part of every row: the sums have a fixed order
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

/// `R T P`: an operator on a coarser mesh whose patches are unions of fine ones.
#[derive(Clone, Debug)]
pub struct Coarse<'a, T: ?Sized> {
    fine: &'a T,
    parent: &'a [u32],
    area: &'a [f64],
    coarse_area: Vec<f64>,
}

impl<'a, T: LinearOperator + ?Sized> Coarse<'a, T> {
    /// The projection of `fine`; `parent` holds the number of the union of every patch, `area` the areas of the patches.
    ///
    /// # Panics
    /// If the three differ in length.
    pub fn new(fine: &'a T, parent: &'a [u32], area: &'a [f64]) -> Self {
        assert!(parent.len() == fine.len() && area.len() == fine.len(), "one parent and one area per patch");
        let mut coarse_area = vec![0.0; parent.iter().max().map_or(0, |m| *m as usize + 1)];
        parent.iter().zip(area).for_each(|(p, a)| coarse_area[*p as usize] += a);
        Self { fine, parent, area, coarse_area }
    }

    /// P: every patch takes the value of its union.
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
