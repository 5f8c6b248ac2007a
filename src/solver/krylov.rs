//! Krylov iterations: they find the best x in E + span{T E, T² E, …}.
//!
//! ```text
//! CG          self-adjoint in ⟨u, v⟩_w = Σ wᵢ uᵢ vᵢ:      ‖L − xₙ‖_e ≤ 2 qⁿ/(1 + q²ⁿ) ‖L − x₀‖_e,  ‖u‖_e² = ⟨u, (I − T) u⟩_w
//! GMRES       any T:   ‖E − (I − T) xₙ‖_A is least, so never above that of the Neumann sum, ‖T^{n+1} E‖_A
//!
//! q = (√c − 1)/(√c + 1)        c = (1 − λ_min)/(1 − λ_max)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | D^½ A^½ F A^−½ D^½ | the symmetrised T, with D = diag(ρ); it corresponds to T in the inner product ⟨·,·⟩_w | [`ConjugateGradients`] |
//! | V, H | orthonormal basis of the Krylov space, and I − T in this basis, by Arnoldi | [`Gmres`] |
//!
//! The weight w = A/ρ leaves out black patches (ρ = 0). There L = E, which the start x₀ = E already contains, and every
//! direction T p is zero. The first residual, T E, costs one application of T.
//!
//! Reference: Hestenes and Stiefel (1952); Saad and Schultz (1986); Saad, *Iterative Methods for Sparse Linear Systems*
//! (2003), chapter 6.

use super::iteration::Iteration;
use crate::operator::matrix::{LinearOperator, Weight};

/// Conjugate gradients for I − T, in the inner product in which T is self-adjoint.
///
/// Requires a spectral radius r(T) < 1 and a weight in which T is self-adjoint. For dense form factors, and for sums and
/// powers of their T, this weight is A/ρ. Sampled rows are self-adjoint only within their noise; use [`Gmres`] for them.
#[derive(Clone, Debug)]
pub struct ConjugateGradients<'a, T: ?Sized> {
    operator: &'a T,
    weight: Weight,
    x: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    /// ⟨r, r⟩_w.
    square: f64,
    applications: usize,
}

impl<'a, T: LinearOperator + ?Sized> ConjugateGradients<'a, T> {
    /// Starts at x₀ = E.
    pub fn new(operator: &'a T, weight: Weight, emission: &[f64]) -> Self {
        let mut residual = vec![0.0; emission.len()];
        operator.apply(emission, &mut residual);
        let square = weight.inner(&residual, &residual);
        let direction = residual.clone();
        let image = vec![0.0; emission.len()];
        Self { operator, weight, x: emission.to_vec(), residual, direction, image, square, applications: 1 }
    }
}

impl<T: LinearOperator + ?Sized> Iteration for ConjugateGradients<'_, T> {
    fn advance(&mut self) -> bool {
        if self.square == 0.0 {
            return false;
        }
        let Self { operator, weight, x, residual, direction, image, square, applications } = self;
        operator.apply(direction, image);
        *applications += 1;
        image.iter_mut().zip(&*direction).for_each(|(y, p)| *y = p - *y); // (I − T) p
        let step = *square / weight.inner(direction, image);
        x.iter_mut().zip(&*direction).for_each(|(x, p)| *x += step * p);
        residual.iter_mut().zip(&*image).for_each(|(r, y)| *r -= step * y);
        let next = weight.inner(residual, residual);
        let turn = next / *square;
        direction.iter_mut().zip(&*residual).for_each(|(p, r)| *p = r + turn * *p);
        *square = next;
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.applications as f64
    }
}

/// Generalised minimal residuals (GMRES), without restarts, in the area inner product.
#[derive(Clone, Debug)]
pub struct Gmres<'a, T: ?Sized> {
    operator: &'a T,
    start: Vec<f64>,
    x: Vec<f64>,
    /// V: v₀ = T E/‖T E‖, v₁, ….
    basis: Vec<Vec<f64>>,
    /// H, made triangular by the rotations, column by column.
    triangle: Vec<Vec<f64>>,
    rotations: Vec<[f64; 2]>,
    /// The rotated right-hand side; the magnitude of its last entry is the norm of the residual.
    right: Vec<f64>,
    applications: usize,
    over: bool,
}

impl<'a, T: LinearOperator + ?Sized> Gmres<'a, T> {
    /// Starts at x₀ = E.
    pub fn new(operator: &'a T, emission: &[f64]) -> Self {
        let mut first = vec![0.0; emission.len()];
        operator.apply(emission, &mut first);
        let norm = operator.norm(&first);
        first.iter_mut().for_each(|v| *v /= norm);
        Self {
            operator,
            start: emission.to_vec(),
            x: emission.to_vec(),
            basis: vec![first],
            triangle: vec![],
            rotations: vec![],
            right: vec![norm],
            applications: 1,
            over: norm == 0.0,
        }
    }

    /// The norm of the residual ‖E − (I − T) x‖_A, as the recurrence gives it.
    pub fn recurrence(&self) -> f64 {
        self.right.last().map_or(0.0, |r| r.abs())
    }

    /// Computes x = E + V y, where y solves the triangular system.
    fn assemble(&mut self) {
        let m = self.triangle.len();
        let mut y = self.right[..m].to_vec();
        for i in (0..m).rev() {
            y[i] = (y[i] - (i + 1..m).map(|j| self.triangle[j][i] * y[j]).sum::<f64>()) / self.triangle[i][i];
        }
        self.x.copy_from_slice(&self.start);
        for (v, y) in self.basis.iter().zip(y) {
            self.x.iter_mut().zip(v).for_each(|(x, v)| *x += y * v);
        }
    }
}

impl<T: LinearOperator + ?Sized> Iteration for Gmres<'_, T> {
    fn advance(&mut self) -> bool {
        let m = self.triangle.len();
        if self.over {
            return false;
        }
        // Arnoldi: w = (I − T) v_m is made orthogonal to the basis, twice because of rounding
        let mut w = vec![0.0; self.x.len()];
        self.operator.apply(&self.basis[m], &mut w);
        self.applications += 1;
        w.iter_mut().zip(&self.basis[m]).for_each(|(w, v)| *w = v - *w);
        let whole = self.operator.norm(&w);
        let mut h = vec![0.0; m + 1];
        for _ in 0..2 {
            for (h, v) in h.iter_mut().zip(&self.basis) {
                let part = self.operator.inner(&w, v);
                *h += part;
                w.iter_mut().zip(v).for_each(|(w, v)| *w -= part * v);
            }
        }
        let below = self.operator.norm(&w);
        // Givens: apply the previous rotations, then a new one that sets the entry below the diagonal to zero
        for (i, [c, s]) in self.rotations.iter().enumerate() {
            (h[i], h[i + 1]) = (c * h[i] + s * h[i + 1], c * h[i + 1] - s * h[i]);
        }
        let length = h[m].hypot(below);
        let [c, s] = [h[m] / length, below / length];
        h[m] = length;
        let last = self.right[m];
        self.right[m] = c * last;
        self.right.push(-s * last);
        self.rotations.push([c, s]);
        self.triangle.push(h);
        self.assemble();
        // if only rounding remains, the space is exhausted: then x is L
        self.over = below <= 1e-14 * whole;
        w.iter_mut().for_each(|w| *w /= below);
        self.basis.push(w);
        true
    }

    fn iterate(&self) -> &[f64] {
        &self.x
    }

    fn applications(&self) -> f64 {
        self.applications as f64
    }
}
