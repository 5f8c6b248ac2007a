//! One factor of T with its parts apart, as the lecture writes it.
//!
//! ```text
//! rays:       (T L)(x) = E[ f cos θ / p · L(x') ]          f: BSDF, θ: angle to the normal at x, p: density of the direction
//! a matrix:   (T L)_i  = E[ T_ij / p_j · L_j ]             T_ij = ρ_i F_ij: the row's entry, p_j: its probability
//! ```
//!
//! [`Transport`] gives the product, f cos θ/p or T_ij/p_j, as one weight, which often is known in closed form (ρ, for a direction drawn
//! by the cosine). Here the factors are evaluated one by one and nothing is cancelled, so that a path tracer that multiplies them is a
//! second program. Both draw the same numbers in the same way.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | f | BSDF, sr⁻¹; the entry of a matrix | [`Factors::f`] |
//! | cos θ | at x; 1 for a matrix | [`Factors::cos`] |
//! | p | density with which x' was drawn | [`Factors::pdf`] |
//! | p, p° | densities of both techniques for the pair x, x' | [`Factors::pair`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986); for a matrix Forsythe and Leibler, *Matrix Inversion by a Monte Carlo Method*
//! (1950).

use super::transport::Transport;
use crate::math::{Rgb, Rng};

/// A sample of the kernel of T, nothing multiplied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors<S> {
    /// x'.
    pub state: S,
    /// f. After a delta vertex R/|cos θ|: what is left of f cos θ/p once the deltas of f and p are divided out is then R/p.
    pub f: Rgb,
    /// |cos θ|.
    pub cos: f32,
    /// p; after a delta vertex the probability of the choice.
    pub pdf: f32,
    /// p and p°, in one measure, as the weights of the techniques compare them. The second is 0 where the other technique cannot find x'.
    pub pair: [f32; 2],
}

/// A transport whose factors can be seen.
pub trait Kernel: Transport {
    /// x' along a direction that was drawn at x; nothing when the sample is zero. Draws as [`Transport::scatter`].
    fn sample_direction(&self, at: &Self::State, rng: &mut Rng) -> Option<Factors<Self::State>>;
    /// x' on an emitter that x sees; nothing when the sample is zero. Draws as [`Transport::connect`].
    fn sample_emitter(&self, at: &Self::State, rng: &mut Rng) -> Option<Factors<Self::State>>;
}
