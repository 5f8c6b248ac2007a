//! One integral per length, as in the lecture: each `T^k E` from paths of its own.
//!
//! `X_k = α_{k−1} · (one factor of T applied to E at x_{k−1})`, with k − 1 scattering steps before it and fresh paths for
//! every k. The terms are independent, at the price of `Σ k` rays where prefix reuse needs K.
//!
//! The tail has paths of its own too: K steps without scoring, then everything beyond.

use super::{Batch, Paths, Plan, TermEstimator, TermSink, prefix};
use crate::math::Columns;
use crate::operator::{Sensor, Transport};

/// The estimator of single terms.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleTerm(pub Plan);

impl SingleTerm {
    /// Fresh paths for slot `k`, walked to vertex `steps`.
    #[allow(clippy::too_many_arguments)] // what a wave needs, and which slot it is for
    fn walk<T: Transport>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        k: usize,
        steps: usize,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        paths.start(t, sensor, &Batch { key: batch.key.branch(k as u32), ..batch.clone() });
        sink.rays(k, batch.len());
        for v in 0..steps {
            paths.roulette(t, v, &self.0.roulette);
            sink.rays(k, paths.n);
            paths.scatter(t, v);
        }
    }
}

impl SingleTerm {
    /// Term k ≤ K, from paths of its own.
    fn term<T: Transport>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        k: usize,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let Plan { technique, ref roulette, .. } = self.0;
        self.walk(t, sensor, batch, k, k.saturating_sub(1), paths, sink);
        if k == 0 {
            paths.emission(t);
            paths.add(0, sink);
            return;
        }
        let v = k - 1;
        if technique.connects() {
            sink.rays(k, paths.n);
            paths.connect(t, v);
            paths.score_connections(technique, k, sink);
        }
        if technique.hits(t) {
            paths.roulette(t, v, roulette);
            sink.rays(k, paths.n);
            paths.scatter(t, v);
            paths.emission(t);
            paths.score_hits(technique, k, sink);
        }
    }

    /// Everything beyond K, from paths of its own; nothing where no roulette ends them.
    pub(super) fn tail<T: Transport>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let max_bounces = self.0.max_bounces;
        if self.0.roulette.ends() {
            self.walk(t, sensor, batch, max_bounces + 1, max_bounces, paths, sink);
            prefix::follow(t, &self.0, max_bounces, paths, sink);
        }
    }
}

impl<T: Transport> TermEstimator<T> for SingleTerm {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn sample(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        (0..=self.0.max_bounces).for_each(|k| self.term(t, sensor, batch, k, paths, sink));
        self.tail(t, sensor, batch, paths, sink);
    }
}

/// One slot of [`SingleTerm`] by itself, with the same numbers: k = 0..=K, or K + 1 for the tail. Its film has one slot, and
/// so many samples as this term is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct OneTerm {
    /// What the terms are estimated with.
    pub single: SingleTerm,
    /// The slot.
    pub slot: usize,
}

impl<T: Transport> TermEstimator<T> for OneTerm {
    fn slots(&self) -> usize {
        1
    }

    fn sample(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let sink = &mut Alone(sink);
        if self.slot <= self.single.0.max_bounces {
            self.single.term(t, sensor, batch, self.slot, paths, sink);
        } else {
            self.single.tail(t, sensor, batch, paths, sink);
        }
    }
}

/// Puts whatever slot into the only one.
struct Alone<'a, S>(&'a mut S);

impl<S: TermSink> TermSink for Alone<'_, S> {
    fn add(&mut self, _slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        self.0.add(0, pixel, sample, value);
    }
    fn rays(&mut self, _slot: usize, rays: usize) {
        self.0.rays(0, rays);
    }
}
