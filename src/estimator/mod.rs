//! Estimators of the terms `T^k E` by random paths, written once over the trait [`Transport`].
//!
//! The sample X_k of term k has the mean `E[X_k] = (T^k E)(x_0)`, and the sample of the tail has the mean
//! `Σ_{k>K} (T^k E)(x_0)`. So terms plus tail give the whole radiance: no part of it is cut off silently.
//!
//! | estimator | one sample | place |
//! |---|---|---|
//! | single | each X_k from its own path | [`single_term`] |
//! | prefix | all X_k from one path, by its prefixes | [`prefix`] |
//! | vertices | as prefix, with separate slots for the hit and the connection of each vertex | [`vertices`] |
//! | light | all X_k from one particle that starts at a light | [`light_tracer`] |
//! | bidirectional | every strategy that finds a path from both ends, weighted | [`bidirectional`] |
//! | pyramid | as bidirectional, with separate slots for each strategy | [`pyramid`] |
//! | branching | a tree of paths, N children at every vertex | [`branching`] |
//! | path tracer | only the sum of all terms, by independent code | [`path_tracer`] |
//! | absorption | one term per path: term k, if the path ends at vertex k | [`absorption`] |
//! | equilibrium | both sides of L = E + T L, from independent paths | [`equilibrium`] |
//! | gather | the matrix solution, seen through one sampled application of T | [`gather`] |
//!
//! A result has one slot for each term k = 0..=K and slot K + 1 for the tail. The path tracer has a single slot.

pub mod absorption;
pub mod bidirectional;
pub mod branching;
mod densities;
pub mod equilibrium;
#[cfg(test)]
mod example;
pub mod gather;
pub mod light_tracer;
mod pass;
pub mod path_tracer;
pub mod paths;
pub mod prefix;
pub mod pyramid;
pub mod record;
pub mod render;
pub mod roulette;
pub mod single_term;
mod splats;
pub mod technique;
mod totals;
pub mod vertices;
mod view;
mod walk;

pub use absorption::Absorption;
pub use bidirectional::Bidirectional;
pub use branching::Branching;
pub use equilibrium::Equilibrium;
pub use gather::Gather;
pub use light_tracer::LightTracer;
pub use path_tracer::PathTracer;
pub use paths::{Batch, Paths};
pub use prefix::Prefix;
pub use pyramid::Pyramid;
pub use roulette::Roulette;
pub use single_term::{OneTerm, SingleTerm};
pub use technique::Technique;
pub use vertices::Vertices;

use crate::math::Columns;
use crate::operator::{Sensor, Transport};

/// Receiver of the samples. An estimator adds the values of many paths (a wave) to one slot at a time.
pub trait TermSink {
    /// Adds `value[i]` to `slot` of path (`pixel[i]`, `sample[i]`). A path may add to a slot more than once.
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns);
    /// Counts rays that were requested for `slot`.
    fn rays(&mut self, _slot: usize, _rays: usize) {}
}

/// Plan of an estimator: the number of terms, the technique that finds light, and the schedule that ends paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// K: the terms k = 0..=K are estimated separately, everything longer is the tail.
    pub max_bounces: usize,
    /// Technique that finds light: hits, connections, or both.
    pub technique: Technique,
    /// Schedule of termination probabilities.
    pub roulette: Roulette,
}

/// Input of an estimator: the operator, the sensor, and the paths to sample.
#[derive(Debug)]
pub struct Job<'a, T, S> {
    /// The transport operator T.
    pub t: &'a T,
    /// The sensor at which paths start.
    pub sensor: &'a S,
    /// The paths to sample.
    pub batch: &'a Batch,
}

/// An estimator of the terms, over any transport.
pub trait TermEstimator<T: Transport>: Sync {
    /// Number of slots a sample has.
    fn slots(&self) -> usize;
    /// Returns true if samples may add to pixels other than their own.
    fn splats(&self) -> bool {
        false
    }
    /// Takes one sample of each path of the batch and adds it to the sink.
    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink);
}
