//! One integral per path length, as in the lecture: each `T^k E` from its own paths.
//!
//! `X_k = α_{k−1} · (one factor of T applied to E at x_{k−1})`, with k − 1 scattering steps before it and new paths for
//! every k. The terms are independent. The price is `Σ k` rays, where the prefix estimator needs K.
//!
//! The tail has its own paths too: K steps without scoring, then every later vertex scores.

use super::{Batch, Job, Paths, Plan, TermEstimator, TermSink, prefix};
use crate::math::Columns;
use crate::operator::{Sensor, Transport};

/// The estimator with separate paths for each term.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleTerm(pub Plan);

impl SingleTerm {
    /// Starts new paths for slot `k` and walks them to vertex `steps`.
    fn walk<T: Transport, S: Sensor<T>>(
        &self,
        job: &Job<'_, T, S>,
        k: usize,
        steps: usize,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let &Job { t, sensor, batch } = job;
        let batch = &Batch { key: batch.key.branch(k as u32), ..batch.clone() };
        paths.start(&Job { t, sensor, batch });
        sink.rays(k, batch.len());
        for v in 0..steps {
            paths.roulette(t, v, &self.0.roulette);
            sink.rays(k, paths.n);
            paths.scatter(t, v);
        }
    }
}

impl SingleTerm {
    /// Estimates term k ≤ K from its own paths.
    fn term<T: Transport, S: Sensor<T>>(
        &self,
        job: &Job<'_, T, S>,
        k: usize,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let Plan { technique, ref roulette, .. } = self.0;
        self.walk(job, k, k.saturating_sub(1), paths, sink);
        if k == 0 {
            paths.emission(job.t);
            paths.add(0, sink);
            return;
        }
        let v = k - 1;
        if technique.connects() {
            sink.rays(k, paths.n);
            paths.connect(job.t, v);
            paths.score_connections(technique, k, sink);
        }
        if technique.hits(job.t) {
            paths.roulette(job.t, v, roulette);
            sink.rays(k, paths.n);
            paths.scatter(job.t, v);
            paths.emission(job.t);
            paths.score_hits(technique, k, sink);
        }
    }

    /// Estimates everything beyond K from its own paths; nothing if no roulette ends them.
    pub(super) fn tail<T: Transport, S: Sensor<T>>(
        &self,
        job: &Job<'_, T, S>,
        paths: &mut Paths<T::Wave>,
        sink: &mut impl TermSink,
    ) {
        let max_bounces = self.0.max_bounces;
        if self.0.roulette.ends() {
            self.walk(job, max_bounces + 1, max_bounces, paths, sink);
            prefix::follow(job.t, &self.0, max_bounces, paths, sink);
        }
    }
}

impl<T: Transport> TermEstimator<T> for SingleTerm {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        (0..=self.0.max_bounces).for_each(|k| self.term(job, k, paths, sink));
        self.tail(job, paths, sink);
    }
}

/// One slot of [`SingleTerm`] as a separate estimator with the same random numbers: k = 0..=K, or K + 1 for the tail. Its
/// film has one slot, so each term can get its own number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct OneTerm {
    /// The estimator of all terms, of which one slot is used.
    pub single: SingleTerm,
    /// The slot to estimate.
    pub slot: usize,
}

impl<T: Transport> TermEstimator<T> for OneTerm {
    fn slots(&self) -> usize {
        1
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let sink = &mut Alone(sink);
        if self.slot <= self.single.0.max_bounces {
            self.single.term(job, self.slot, paths, sink);
        } else {
            self.single.tail(job, paths, sink);
        }
    }
}

/// A sink that redirects every slot to slot 0.
struct Alone<'a, S>(&'a mut S);

impl<S: TermSink> TermSink for Alone<'_, S> {
    fn add(&mut self, _slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        self.0.add(0, pixel, sample, value);
    }
    fn rays(&mut self, _slot: usize, rays: usize) {
        self.0.rays(0, rays);
    }
}
