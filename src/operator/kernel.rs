//! One step of T with its factors given separately, as in the lecture.
//!
//! ```text
//! rays:       (T L)(x) = E[ f cos θ / p · L(x') ]          f: BSDF, θ: angle to the normal at x, p: density of the direction
//! a matrix:   (T L)_i  = E[ T_ij / p_j · L_j ]             T_ij = ρ_i F_ij: the row's entry, p_j: its probability
//! ```
//!
//! [`Transport`] returns the product, f cos θ/p or T_ij/p_j, as one weight. This weight often has a closed form (ρ, for a
//! direction sampled proportionally to the cosine). Here every factor is evaluated separately and nothing is cancelled. A
//! path tracer that multiplies these factors is therefore independent of the code for the weights. Both traits use the same
//! random numbers in the same way.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | f | BSDF, sr⁻¹; the entry of a matrix | [`Factors::f`] |
//! | cos θ | cosine to the normal at x; 1 for a matrix | [`Factors::cos`] |
//! | p | density with which x' was sampled | [`Factors::pdf`] |
//! | p, p° | densities of both techniques for the pair x, x' | [`Factors::pair`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986); for a matrix Forsythe and Leibler, *Matrix Inversion by a Monte Carlo Method*
//! (1950).

use super::transport::Transport;
use crate::math::{Rgb, Rng};

/// A sample of the kernel of T with its factors not yet multiplied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors<S> {
    /// The sampled state x'.
    pub state: S,
    /// f: BSDF or matrix entry. At a delta vertex it is R/|cos θ|, where R is the reflected or transmitted share: once the
    /// delta functions of f and p are divided out, f cos θ/p is R/p.
    pub f: Rgb,
    /// |cos θ| at x.
    pub cos: f32,
    /// p: density of x'. At a delta vertex it is the probability of the discrete choice.
    pub pdf: f32,
    /// The densities p (this technique) and p° (the other technique), in the same measure, for the weights of multiple
    /// importance sampling. p° is 0 if the other technique cannot find x'.
    pub pair: [f32; 2],
}

/// A transport that returns the factors of its samples.
pub trait Kernel: Transport {
    /// Samples a direction at x and returns the point x' found along it, or `None` if the sample is zero. Uses random
    /// numbers as [`Transport::scatter`] does.
    fn sample_direction(&self, at: &Self::State, rng: &mut Rng) -> Option<Factors<Self::State>>;
    /// Samples a point x' on an emitter that is visible from x, or `None` if the sample is zero. Uses random numbers as
    /// [`Transport::connect`] does.
    fn sample_emitter(&self, at: &Self::State, rng: &mut Rng) -> Option<Factors<Self::State>>;
}
