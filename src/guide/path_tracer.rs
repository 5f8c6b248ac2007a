//! A path tracer for guided walks, which may split.
//!
//! ```text
//! α ← α · weight / (1 − q),    and for q < 0 the walk goes on as 1 − q copies on average: one at once, the others after it has ended
//! ```
//!
//! α is the throughput and q the probability of termination. This program shares no loop with
//! [`guide::Prefix`](super::Prefix): it follows walks one by one, each to its end, instead of wave by wave. It uses the same
//! addresses of random numbers. With the same stream, the sum over the slots of the prefix estimator therefore equals the
//! sample of the path tracer, up to rounding.

use super::expected::{ByExpectation, Expecting};
use crate::estimator::branching::lineage;
use crate::estimator::path_tracer::each_path;
use crate::estimator::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::Sensor;

/// A path tracer whose walks may be guided and may split.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTracer {
    /// Number of bounces, technique, and the roulette used if `end` is `None`.
    pub plan: Plan,
    /// Rule by which walks end or split according to the light expected of them.
    pub end: Option<ByExpectation>,
}

impl PathTracer {
    /// The radiance estimated by one path, and the number of rays it took.
    pub fn radiance<T: Expecting>(&self, t: &T, start: T::State, key: Key, pixel: u32, sample: u32) -> (Rgb, u64) {
        let expected = t.expected(&start).unwrap_or_default().all;
        // emission seen directly counts in full for every technique
        let mut colour = t.emission(&start);
        let mut rays = 0;
        // the copies of a path that wait until the current walk has ended
        let mut waiting = vec![];
        let mut next = Some(Walker { vertex: 0, x: start, throughput: t.lit(), key, siblings: 1, scored: false });
        while let Some(walker) = next {
            self.follow(t, walker, expected, [pixel, sample], &mut waiting, (&mut colour, &mut rays));
            next = waiting.pop();
        }
        (colour, rays)
    }

    /// Follows one walk from its current vertex until it ends, and adds the copies that split off to `waiting`.
    fn follow<T: Expecting>(
        &self,
        t: &T,
        walker: Walker<T::State>,
        expected: f32,
        [pixel, sample]: [u32; 2],
        waiting: &mut Vec<Walker<T::State>>,
        (colour, rays): (&mut Rgb, &mut u64),
    ) {
        let Plan { max_bounces, technique, ref roulette } = self.plan;
        let Walker { vertex: first, mut x, mut throughput, key, mut siblings, mut scored } = walker;
        let numbers = |vertex: usize, purpose: Purpose| Rng::at(key, pixel, sample, vertex, purpose);
        let last = |applications: usize| !roulette.ends() && applications >= max_bounces;

        for vertex in first.. {
            if last(vertex) {
                break;
            }
            // next-event estimation
            if technique.connects() && !scored {
                *rays += 1;
                if let Some(light) = t.connect(&x, &mut numbers(vertex, Purpose::Connect)) {
                    *colour += throughput
                        * light.weight
                        * t.emission(&light.state)
                        * technique.connection(light.pdf, light.other_pdf);
                }
            }
            if last(vertex + 1) && !technique.hits(t) {
                break;
            }
            // roulette: q is the probability of termination; if q < 0 the walk splits
            let q = match self.end {
                _ if scored => 0.0,
                Some(end) => end.q(t, vertex, throughput, &x, expected),
                None => roulette.q(t, vertex, throughput, &x),
            };
            scored = false;
            if q != 0.0 {
                let (copies, weight) = ByExpectation::copies(q, numbers(vertex, Purpose::Roulette).one(), siblings);
                if copies == 0 {
                    break;
                }
                throughput *= weight;
                siblings *= copies;
                let copy = |c| Walker {
                    vertex,
                    x,
                    throughput,
                    key: lineage(key, vertex, c, ByExpectation::MOST),
                    siblings,
                    scored: true,
                };
                waiting.extend((1..copies).map(copy));
            }
            // the next vertex; its emission counts if the technique uses hits
            *rays += 1;
            let Some(next) = t.scatter(&x, &mut numbers(vertex, Purpose::Scatter)) else { break };
            throughput *= next.weight;
            x = next.state;
            if technique.hits(t) {
                *colour += throughput * t.emission(&x) * technique.hit(next.pdf, next.other_pdf);
            }
        }
    }
}

/// A walk at one of its vertices.
struct Walker<S> {
    vertex: usize,
    x: S,
    throughput: Rgb,
    key: Key,
    /// Number of copies into which its path has split.
    siblings: u32,
    /// True if another copy has already added this vertex's contribution and played its roulette.
    scored: bool,
}

impl<T: Expecting> TermEstimator<T> for PathTracer {
    fn slots(&self) -> usize {
        1
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        each_path(job, sink, |start, pixel, sample| self.radiance(job.t, start, job.batch.key, pixel, sample));
    }
}
