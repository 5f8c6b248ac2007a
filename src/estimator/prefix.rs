//! All terms from one path: its prefix of length k estimates `T^k E`.
//!
//! ```text
//! X_0 = E(x_0)
//! X_k = α_{k−1} · w_c · (sample of T E at x_{k−1})  +  α_k · w_s · E(x_k)        α_k = Π_{v<k} weight_v / (1 − q_v)
//! ```
//!
//! The weights w_c of the connection and w_s of the hit come from the [`Technique`]; q_v is the probability of termination
//! at vertex v. Loop invariant: before the step at vertex v, every term k ≤ v has been scored, and `throughput` is α_v.
//!
//! The terms of one path share its prefixes, so they are correlated. Fits over k must use their covariance.
//! Reference: Kajiya, *The Rendering Equation* (1986); Veach (1997), ch. 10.

use super::{Job, Paths, Plan, Technique, TermEstimator, TermSink};
use crate::operator::{Sensor, Transport};

/// The prefix estimator.
#[derive(Clone, Debug, PartialEq)]
pub struct Prefix(pub Plan);

impl<T: Transport> TermEstimator<T> for Prefix {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        start(job, paths, sink);
        follow(job.t, &self.0, 0, paths, sink);
    }
}

/// Starts the paths of a batch and scores term 0.
pub(crate) fn start<T: Transport, S: Sensor<T>>(
    job: &Job<'_, T, S>,
    paths: &mut Paths<T::Wave>,
    sink: &mut impl TermSink,
) {
    paths.start(job);
    paths.emission(job.t);
    paths.add(0, sink);
    sink.rays(0, job.batch.len());
}

/// Follows paths from vertex `first` on and scores every later term. Terms beyond K go to the slot of the tail.
pub(super) fn follow<T: Transport>(
    t: &T,
    plan: &Plan,
    first: usize,
    paths: &mut Paths<T::Wave>,
    sink: &mut impl TermSink,
) {
    let tail = plan.max_bounces + 1;
    for v in first.. {
        // the next term, or the tail; without roulette the tail would never end, so it is left out
        let slot = (v + 1).min(tail);
        if paths.n == 0 || slot == tail && !plan.roulette.ends() {
            break;
        }
        if !step(t, plan, v, [slot; 2], paths, sink) {
            break;
        }
    }
}

/// Scores term v + 1 from paths at vertex v and moves the paths to vertex v + 1. The connection goes to one slot, the hit to
/// another. If nothing is left to find after the last connection, the paths stay and the function returns false.
pub(super) fn step<T: Transport>(
    t: &T,
    plan: &Plan,
    v: usize,
    [connection, hit]: [usize; 2],
    paths: &mut Paths<T::Wave>,
    sink: &mut impl TermSink,
) -> bool {
    connect(t, plan.technique, v, connection, paths, sink);
    let more = v + 1 != plan.max_bounces || plan.technique.hits(t) || plan.roulette.ends();
    if more {
        // roulette, once vertex v has been scored
        paths.roulette(t, v, &plan.roulette);
        scatter(t, plan.technique, v, hit, paths, sink);
    }
    more
}

/// Scores term v + 1 by next-event estimation from vertex v.
pub(crate) fn connect<T: Transport>(
    t: &T,
    technique: Technique,
    v: usize,
    slot: usize,
    paths: &mut Paths<T::Wave>,
    sink: &mut impl TermSink,
) {
    if technique.connects() {
        sink.rays(slot, paths.n);
        paths.connect(t, v);
        paths.score_connections(technique, slot, sink);
    }
}

/// Moves the paths from x_v to x_{v+1}, and scores the emission there if hits count.
pub(crate) fn scatter<T: Transport>(
    t: &T,
    technique: Technique,
    v: usize,
    slot: usize,
    paths: &mut Paths<T::Wave>,
    sink: &mut impl TermSink,
) {
    sink.rays(slot, paths.n);
    paths.scatter(t, v);
    if technique.hits(t) {
        paths.emission(t);
        paths.score_hits(technique, slot, sink);
    }
}
