//! The direct solver: LU factorisation of I − T.
//!
//! ```text
//! P (I − T) = L U        x = U⁻¹ L⁻¹ P E        residual  maxᵢ |E − (I − T) x|ᵢ
//! ```
//!
//! The LU factorisation of nalgebra is the reference. Above [`LARGE`] unknowns, the blocked LU of faer is used if that
//! feature is enabled (measured: 7 times faster at 2000 unknowns, 29 times at 5000).

use crate::operator::matrix::{LinearOperator, PatchOperator, Rows};
use nalgebra::{DMatrix, DVector};

/// Above this number of unknowns, [`solve`] uses faer.
pub const LARGE: usize = 1000;

/// A solution with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Direct {
    /// The solution x of (I − T) x = E.
    pub x: Vec<f64>,
    /// The residual max |E − (I − T) x|.
    pub residual: f64,
}

/// I − T has no inverse: 1 is an eigenvalue of T, because a part of the scene neither absorbs light nor lets it escape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("I − T is singular: a part of the scene neither absorbs light nor lets it escape")]
pub struct Singular;

/// Solves (I − T) x = E by the fastest available LU.
///
/// # Errors
/// [`Singular`] if 1 is an eigenvalue of T, up to rounding.
pub fn solve(t: &PatchOperator<'_>, emission: &[f64]) -> Result<Direct, Singular> {
    #[cfg(feature = "faer")]
    if t.len() > LARGE {
        return solve_faer(t, emission);
    }
    solve_nalgebra(t, emission)
}

/// Solves (I − T) x = E with nalgebra.
///
/// # Errors
/// [`Singular`] if 1 is an eigenvalue of T, up to rounding.
pub fn solve_nalgebra(t: &PatchOperator<'_>, emission: &[f64]) -> Result<Direct, Singular> {
    let n = t.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - t.entry(i, j));
    let x = matrix.lu().solve(&DVector::from_column_slice(emission)).ok_or(Singular)?;
    checked(t, emission, x.as_slice().to_vec())
}

/// Solves (I − T) x = E with faer. The factors take the place of the matrix, so that there is only one of it in memory.
///
/// # Errors
/// [`Singular`] if 1 is an eigenvalue of T, up to rounding.
#[cfg(feature = "faer")]
pub fn solve_faer(t: &PatchOperator<'_>, emission: &[f64]) -> Result<Direct, Singular> {
    use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
    use faer::linalg::lu::partial_pivoting::{factor, solve};
    let (n, par) = (t.len(), faer::get_global_parallelism());
    let mut lu = faer::Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - t.entry(i, j));
    let mut x = faer::Mat::from_fn(n, 1, |i, _| emission[i]);
    let memory = StackReq::any_of(&[
        factor::lu_in_place_scratch::<usize, f64>(n, n, par, Default::default()),
        solve::solve_in_place_scratch::<usize, f64>(n, 1, par),
    ]);
    let mut memory = MemBuffer::new(memory);
    let memory = MemStack::new(&mut memory);
    let (mut order, mut places) = (vec![0_usize; n], vec![0; n]);
    let (_, rows) = factor::lu_in_place(lu.as_mut(), &mut order, &mut places, par, memory, Default::default());
    solve::solve_in_place(lu.as_ref(), lu.as_ref(), rows, x.as_mut(), par, memory);
    checked(t, emission, (0..n).map(|i| x[(i, 0)]).collect())
}

fn checked(t: &PatchOperator<'_>, emission: &[f64], x: Vec<f64>) -> Result<Direct, Singular> {
    let residual = residual(t, emission, &x);
    let scale = x.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    if residual.is_finite() && residual <= 1e-8 * scale { Ok(Direct { x, residual }) } else { Err(Singular) }
}

/// The residual max |E − (I − T) x|.
pub fn residual<T: LinearOperator + ?Sized>(t: &T, emission: &[f64], x: &[f64]) -> f64 {
    let mut y = vec![0.0; x.len()];
    t.apply(x, &mut y);
    // f64::max would hide a NaN
    emission
        .iter()
        .zip(x)
        .zip(&y)
        .map(|((e, x), y)| (e - x + y).abs())
        .fold(0.0, |a, r| if r > a || r.is_nan() { r } else { a })
}
