//! L to rounding where there is no matrix to factorise: GMRES, and again on what it left.
//!
//! ```text
//! d ≈ (I − T)⁻¹ r        x ← x + d        r ← E − (I − T) x        until ‖r‖ is rounding, or falls no more
//! ```
//!
//! The residual is recomputed in every round, so that rounding within a round does not add up. L − x = (I − T)⁻¹ r, so that
//! max |L − x| ≤ max |r|/(1 − ‖T‖∞) where ‖T‖∞ < 1.
//!
//! Reference: Saad, *Iterative Methods for Sparse Linear Systems* (2003), section 6.5.5.

use super::direct::Singular;
use super::iteration::{Iteration, residual};
use super::krylov::Gmres;
use crate::operator::matrix::LinearOperator;

/// Steps of a round: so many vectors are held at once.
const STEPS: usize = 30;
/// What a round gains, if its steps allow: half the digits, so that two rounds find all.
const GAIN: f64 = 1e-8;
/// Rounds at most; the slowest scene takes a few.
const ROUNDS: usize = 200;

/// A solution with its own check.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// x with (I − T) x = E.
    pub x: Vec<f64>,
    /// ‖E − (I − T) x‖/‖E‖ in the area inner product.
    pub residual: f64,
    /// Applications of T.
    pub applications: usize,
}

/// Solves (I − T) x = E until the residual is rounding, or falls no more.
///
/// # Errors
/// [`Singular`] if it stays above 10⁻⁸ ‖E‖.
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
