//! Random `T^k E`: estimators, written once over [`Transport`].
//!
//! `E[X_k] = (T^k E)(x_0)` for every k, and the tail has mean `Σ_{k>K} (T^k E)(x_0)`, so that terms + tail is the whole
//! radiance: truncation is never hidden.
//!
//! | estimator | what one sample is | place |
//! |---|---|---|
//! | single | each X_k from a path of its own | [`single_term`] |
//! | prefix | all X_k from one path, by its prefixes | [`prefix`] |
//! | vertices | the same, hits and connections of every vertex apart | [`vertices`] |
//! | light | all X_k from one particle, walked from the light | [`light_tracer`] |
//! | bidirectional | every way to find each path from both ends, weighted | [`bidirectional`] |
//! | branching | a tree of paths, N children at every vertex | [`branching`] |
//! | path tracer | the sum alone, independent code | [`path_tracer`] |
//! | absorption | one term from one path: the one where it ends | [`absorption`] |
//! | equilibrium | both sides of L = E + T L, from independent paths | [`equilibrium`] |
//! | gather | the matrix solution, read through one sampled application of T | [`gather`] |
//!
//! Slots of the result: k = 0..=K for the terms, K + 1 for the tail; the path tracer has one slot.

pub mod absorption;
pub mod bidirectional;
pub mod branching;
pub mod densities;
pub mod equilibrium;
#[cfg(test)]
mod example;
pub mod gather;
pub mod light_tracer;
pub mod path_tracer;
pub mod paths;
pub mod prefix;
pub mod record;
pub mod render;
pub mod roulette;
pub mod single_term;
pub mod technique;
pub mod vertices;

pub use absorption::Absorption;
pub use bidirectional::{Bidirectional, Pyramid};
pub use branching::Branching;
pub use equilibrium::Equilibrium;
pub use gather::Gather;
pub use light_tracer::LightTracer;
pub use path_tracer::PathTracer;
pub use paths::{Batch, Paths};
pub use prefix::Prefix;
pub use roulette::Roulette;
pub use single_term::{OneTerm, SingleTerm};
pub use technique::Technique;
pub use vertices::Vertices;

use crate::math::Columns;
use crate::operator::{Sensor, Transport};

/// Where samples go: slot by slot, wave by wave.
pub trait TermSink {
    /// Adds `value[i]` to `slot` of path (`pixel[i]`, `sample[i]`). A path may add to a slot more than once.
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns);
    /// Counts rays asked for on behalf of `slot`.
    fn rays(&mut self, _slot: usize, _rays: usize) {}
}

/// How far terms are kept, how light is found, how paths end.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// K: the terms k = 0..=K are kept.
    pub max_bounces: usize,
    /// How light is found.
    pub technique: Technique,
    /// How paths end.
    pub roulette: Roulette,
}

/// What a sample is asked for: of which operator, through which sensor, which paths.
#[derive(Debug)]
pub struct Job<'a, T, S> {
    /// T.
    pub t: &'a T,
    /// Where paths start.
    pub sensor: &'a S,
    /// Which paths.
    pub batch: &'a Batch,
}

/// An estimator of the terms, over any transport.
pub trait TermEstimator<T: Transport>: Sync {
    /// Number of slots a sample has.
    fn slots(&self) -> usize;
    /// Whether samples add to pixels other than their own.
    fn splats(&self) -> bool {
        false
    }
    /// One sample per path of the batch into the sink.
    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink);
}
