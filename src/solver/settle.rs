//! Solves for L up to rounding when there is no matrix to factorise: GMRES, applied repeatedly to the remaining residual.
//!
//! ```text
//! d ≈ (I − T)⁻¹ r        x ← x + d        r ← E − (I − T) x        until ‖r‖ is at rounding level, or stops falling
//! ```
//!
//! The residual is recomputed in every round, so that rounding errors of the rounds do not add up. The error is L − x = (I −
//! T)⁻¹ r, so that max |L − x| ≤ max |r|/(1 − ‖T‖∞) if ‖T‖∞ < 1.
//!
//! Reference: Saad, *Iterative Methods for Sparse Linear Systems* (2003), section 6.5.5.

use super::direct::Singular;
use super::iteration::{Iteration, residual};
use super::krylov::Gmres;
use crate::operator::matrix::LinearOperator;

/// Maximum number of GMRES steps per round; this many vectors are stored at once.
const STEPS: usize = 30;
/// A round ends early when it has reduced the residual by this factor: half of the digits, so that two rounds find all.
const GAIN: f64 = 1e-8;
/// Maximum number of rounds; the slowest scene needs a few.
const ROUNDS: usize = 200;

/// A solution with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// The solution x of (I − T) x = E.
    pub x: Vec<f64>,
    /// The relative residual ‖E − (I − T) x‖/‖E‖ in the area inner product.
    pub residual: f64,
    /// Number of applications of T.
    pub applications: usize,
}

/// Solves (I − T) x = E until the residual is at rounding level or stops falling.
///
/// # Errors
/// [`Singular`] if the residual stays above 10⁻⁸ ‖E‖.
pub fn settle<T: LinearOperator + ?Sized>(t: &T, emission: &[f64]) -> Result<Settled, Singular> {
    let size = t.norm(emission);
    let (mut x, mut r) = (vec![0.0; emission.len()], emission.to_vec());
    let (mut now, mut applications) = (size, 0);
    for _ in 0..ROUNDS {
        if now <= f64::EPSILON * size {
            break;
        }
        let mut round = Gmres::new(t, &r);
        while round.recurrence() > GAIN * now && round.applications() < STEPS as f64 && round.advance() {}
        let next: Vec<f64> = x.iter().zip(round.iterate()).map(|(x, d)| x + d).collect();
        let left = residual(t, emission, &next);
        applications += round.applications() as usize + 1;
        let after = t.norm(&left);
        if after >= now || after.is_nan() {
            break;
        }
        let settled = after > 0.5 * now;
        (x, r, now) = (next, left, after);
        if settled {
            break;
        }
    }
    let residual = if size > 0.0 { now / size } else { 0.0 };
    if residual <= 1e-8 { Ok(Settled { x, residual, applications }) } else { Err(Singular) }
}
