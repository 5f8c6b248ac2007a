//! The path tracer of guided walks, which may split.
//!
//! ```text
//! α ← α · weight / (1 − q),    and for q < 0 the walk goes on as 1 − q copies in the mean: one here, the others when it has ended
//! ```
//!
//! It shares no loop with [`guide::Prefix`](super::Prefix): walks are followed one by one, each to its end, instead of wave by wave. It
//! reads the same addresses of random numbers, so that with the same stream the sum over the slots of the one is the sample of the other
//! to rounding.

use super::expected::{ByExpectation, Expecting};
use crate::estimator::branching::lineage;
use crate::estimator::path_tracer::each_path;
use crate::estimator::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::Sensor;

/// The path tracer of guided walks.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTracer {
    /// How far, how light is found, and how walks end where `end` does not say.
    pub plan: Plan,
    /// How walks end or split by what is expected of them.
    pub end: Option<ByExpectation>,
}

impl PathTracer {
    /// Radiance estimated by one path, and the rays it took.
    pub fn radiance<T: Expecting>(&self, t: &T, start: T::State, key: Key, pixel: u32, sample: u32) -> (Rgb, u64) {
        let expected = t.expected(&start).unwrap_or_default().all;
        // emission counts at the eye, whatever the technique
        let mut colour = t.emission(&start);
        let mut rays = 0;
        // the copies of a path that wait until it has ended
        let mut waiting = vec![];
        let mut next = Some(Walker { vertex: 0, x: start, throughput: t.lit(), key, siblings: 1, scored: false });
        while let Some(walker) = next {
            self.follow(t, walker, expected, [pixel, sample], &mut waiting, (&mut colour, &mut rays));
            next = waiting.pop();
        }
        (colour, rays)
    }

    /// One walk from where it stands until it ends; the copies that it leaves are added to `waiting`.
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
            // the light is sampled
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
            // roulette: q is the probability of termination, and below 0 the walk splits
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
            // the next vertex, whose emission counts if hits do
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

/// A walk that stands at a vertex.
struct Walker<S> {
    vertex: usize,
    x: S,
    throughput: Rgb,
    key: Key,
    /// Into how many its path has split.
    siblings: u32,
    /// Whether another copy has scored this vertex and gone through its roulette.
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
