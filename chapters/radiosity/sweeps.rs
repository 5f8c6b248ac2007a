//! An iteration next to the partial sums of the series.
//!
//! ```text
//! Jacobi: B ← E + T_h B        partial sums: S_K = Σ_{k≤K} T_h^k E        the same numbers, sweep by sweep
//! ```

use fredholm::operator::matrix::PatchOperator;
use fredholm::solver::{Iteration, PartialSums};

/// Makes the iteration that is compared with the partial sums.
pub type Sweeps = for<'a> fn(&'a PatchOperator<'a>, &[f64]) -> Box<dyn Iteration + 'a>;

// ANCHOR: sweeps
/// The largest difference of an iteration and the partial sums of the series, over `n` sweeps and all patches.
pub(super) fn apart(t: &PatchOperator<'_>, e: &[f64], mut sweeps: Box<dyn Iteration + '_>, n: usize) -> f64 {
    let mut series = PartialSums::new(t, e);
    let mut largest = 0.0f64;
    for _ in 0..n {
        sweeps.advance();
        series.advance();
        largest = sweeps.iterate().iter().zip(series.iterate()).fold(largest, |d, (x, s)| d.max((x - s).abs()));
    }
    largest / series.iterate().iter().copied().fold(0.0, f64::max)
}
// ANCHOR_END: sweeps
