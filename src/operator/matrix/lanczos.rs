//! The smallest and the largest eigenvalue of T by the method of Lanczos, with error bounds.
//!
//! ```text
//! T V = V H + β v eᵀ        V: orthonormal in ⟨u, v⟩_w = Σ wᵢ uᵢ vᵢ,  H: tridiagonal
//! H s = θ s     ⇒     some eigenvalue lies within β |s_last| of θ,  and  λ_min ≤ θ ≤ λ_max
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | w | the weight in which T is self-adjoint: w = A/ρ for a matrix over patches | [`Weight`] |
//! | θ | Ritz value: approximation of an eigenvalue | [`Extremes::smallest`], [`Extremes::largest`] |
//! | β \|s_last\| | residual ‖T u − θ u‖_w of the Ritz vector u with ‖u‖_w = 1 | [`Extremes::residual`] |
//!
//! Each vector is made orthogonal to all previous ones, twice. Without this, rounding would produce spurious copies of
//! eigenvalues. The start is a fixed pseudo-random vector: an eigenvalue is missed only if its whole eigenspace is
//! orthogonal to this vector.
//!
//! Reference: Lanczos (1950); Parlett, *The Symmetric Eigenvalue Problem* (1980), chapter 13.

use super::{LinearOperator, Weight};
use nalgebra::{DMatrix, SymmetricEigen};

/// Estimates of the smallest and the largest eigenvalue, on the patches with nonzero weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// The smallest Ritz value; it is never below the smallest eigenvalue.
    pub smallest: f64,
    /// The largest Ritz value; it is never above the largest eigenvalue.
    pub largest: f64,
    /// Error bounds: some eigenvalue lies within `residual[0]` of `smallest`, and some within `residual[1]` of `largest`.
    pub residual: [f64; 2],
    /// Number of applications of T.
    pub steps: usize,
}

impl Extremes {
    /// An interval [a, b] that contains the spectrum, if the residuals bound the distance of the two ends correctly.
    pub fn bracket(&self) -> [f64; 2] {
        [self.smallest - self.residual[0], self.largest + self.residual[1]]
    }
}

/// Smallest and largest eigenvalue of an operator T that is self-adjoint in `weight`. The iteration ends when both residuals
/// are at most `tolerance`, or after `max_steps` applications.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::{PatchOperator, extremes}};
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// let t = PatchOperator::new(&plates, vec![0.9, 0.4]);
/// let ends = extremes(&t, &t.weight(), 1e-12, 10);
/// assert!((ends.largest - 0.6).abs() < 1e-14 && (ends.smallest + 0.6).abs() < 1e-14);
/// ```
pub fn extremes<T: LinearOperator + ?Sized>(t: &T, weight: &Weight, tolerance: f64, max_steps: usize) -> Extremes {
    let ends = |values: &[Ritz], steps: usize| {
        let [low, high] = [values[0], values[values.len() - 1]];
        Extremes { smallest: low.value, largest: high.value, residual: [low.residual, high.residual], steps }
    };
    let mut found = Extremes::default();
    iterate(t, weight, 1, max_steps, |values, steps| {
        found = ends(values, steps);
        found.residual.iter().all(|r| *r <= tolerance)
    });
    found
}

/// A Ritz value with its error bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ritz {
    /// The Ritz value θ.
    pub value: f64,
    /// Some eigenvalue lies within this distance of θ.
    pub residual: f64,
}

/// The `count` largest and the `count` smallest eigenvalues of an operator T that is self-adjoint in `weight`, ordered by
/// decreasing distance from 0. The first list holds only positive values, the second only negative ones. A multiple
/// eigenvalue may be listed once. The iteration ends when all residuals are at most `tolerance`, or after `max_steps`
/// applications.
///
/// ```
/// use fredholm::operator::{form_factor::FormFactors, matrix::{PatchOperator, leading}};
/// let plates = FormFactors { n: 2, f: vec![0.0, 1.0, 1.0, 0.0], area: vec![1.0, 1.0], rays: 0 };
/// let t = PatchOperator::new(&plates, vec![0.9, 0.4]);
/// let [above, below] = leading(&t, &t.weight(), 3, 1e-12, 10);
/// assert!(above.len() == 1 && (above[0].value - 0.6).abs() < 1e-14);
/// assert!(below.len() == 1 && (below[0].value + 0.6).abs() < 1e-14);
/// ```
pub fn leading<T: LinearOperator + ?Sized>(
    t: &T,
    weight: &Weight,
    count: usize,
    tolerance: f64,
    max_steps: usize,
) -> [Vec<Ritz>; 2] {
    let mut found = [vec![], vec![]];
    iterate(t, weight, 10, max_steps, |values, _| {
        found = [
            values.iter().rev().take(count).take_while(|r| r.value > 0.0).copied().collect(),
            values.iter().take(count).take_while(|r| r.value < 0.0).copied().collect(),
        ];
        let settled = |list: &Vec<Ritz>| list.len() == count && list.iter().all(|r| r.residual <= tolerance);
        found.iter().all(settled)
    });
    found
}

/// Passes the Ritz values, ascending, to `done` after every `every` steps and at the end. Stops when `done` returns true.
fn iterate<T: LinearOperator + ?Sized>(
    t: &T,
    weight: &Weight,
    every: usize,
    max_steps: usize,
    mut done: impl FnMut(&[Ritz], usize) -> bool,
) {
    // the start is A/w, times random factors; for T = diag(ρ) F this is ρ, about the first bounce in a uniformly lit room
    let rho = t.area().iter().zip(weight.values()).map(|(a, w)| if *w > 0.0 { a / w } else { 0.0 });
    let mut v: Vec<f64> = rho.enumerate().map(|(i, r)| r * scrambled(i as u64)).collect();
    let (mut basis, mut diagonal, mut below): (Vec<Vec<f64>>, Vec<f64>, Vec<f64>) = (vec![], vec![], vec![]);
    let mut length = weight.norm(&v);
    let start = length;
    if start == 0.0 {
        return;
    }
    for steps in 1..=max_steps {
        v.iter_mut().for_each(|v| *v /= length);
        basis.push(std::mem::take(&mut v));
        v = vec![0.0; t.len()];
        t.apply(&basis[steps - 1], &mut v);
        diagonal.push(weight.inner(&v, &basis[steps - 1]));
        for _ in 0..2 {
            for b in &basis {
                let part = weight.inner(&v, b);
                v.iter_mut().zip(b).for_each(|(v, b)| *v -= part * b);
            }
        }
        length = weight.norm(&v);
        // the Krylov space is exhausted: the Ritz values are eigenvalues
        let last = steps == max_steps || length <= 1e-14 * start;
        let looked = (last || steps % every == 0) && done(&ritz(&diagonal, &below, length), steps);
        if looked || last {
            return;
        }
        below.push(length);
    }
}

/// The Ritz values of a tridiagonal matrix, ascending; `next` is β, the next entry below the diagonal.
fn ritz(diagonal: &[f64], below: &[f64], next: f64) -> Vec<Ritz> {
    let m = diagonal.len();
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => below[i.min(j)],
        _ => 0.0,
    };
    let eigen = SymmetricEigen::new(DMatrix::from_fn(m, m, entry));
    let one = |i: usize| Ritz { value: eigen.eigenvalues[i], residual: next * eigen.eigenvectors[(m - 1, i)].abs() };
    let mut values: Vec<Ritz> = (0..m).map(one).collect();
    values.sort_by(|a, b| a.value.total_cmp(&b.value));
    values
}

/// A fixed pseudo-random number in [0.5, 1.5), by the finaliser of `SplitMix64`.
fn scrambled(i: u64) -> f64 {
    let z = (i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    0.5 + ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
