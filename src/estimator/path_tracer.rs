//! The full path tracer, as the lecture writes it: one colour, one throughput, no terms.
//!
//! ```text
//! colour ← 0, α ← 1, x ← what the eye sees
//! repeat
//!     if emission counts here:          colour ← colour + α E(x)      (at the eye; after a delta vertex; on hits under scatter, MIS)
//!     if light is sampled:              colour ← colour + α · connect
//!     if a random number is below q:    stop                         (q < 0: go on as 1 − q walks in the mean)
//!     α ← α · weight / (1 − q),         x ← next
//! ```
//!
//! Independent code on purpose: it knows nothing of waves, terms or slots, so that "sum of the terms = path tracer"
//! compares two things. It reads the same addresses of random numbers, so with the same stream, technique and schedule the
//! sum over the slots of [`Prefix`](super::Prefix) is this sample to rounding. With a schedule that never ends paths, it
//! stops after `max_bounces` applications of T. Reference: Kajiya, *The Rendering Equation* (1986).

use super::branching::lineage;
use super::{Job, Paths, Plan, Roulette, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{Sensor, Transport};

/// The path tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTracer(pub Plan);

impl PathTracer {
    /// Radiance estimated by one path, and the rays it took.
    pub fn radiance<T: Transport>(&self, t: &T, start: T::State, key: Key, pixel: u32, sample: u32) -> (Rgb, u64) {
        let expected = t.expected(&start).unwrap_or_default().all;
        // emission counts at the eye, whatever the technique
        let mut colour = t.emission(&start);
        let mut rays = 0;
        // the copies of a path that wait until it has ended
        let mut waiting = vec![];
        let mut next = Some(Walker { vertex: 0, x: start, alpha: t.lit(), key, siblings: 1, scored: false });
        while let Some(walker) = next {
            self.follow(t, walker, expected, [pixel, sample], &mut waiting, (&mut colour, &mut rays));
            next = waiting.pop();
        }
        (colour, rays)
    }

    /// One walk from where it stands until it ends; the copies that it leaves are added to `waiting`.
    fn follow<T: Transport>(
        &self,
        t: &T,
        walker: Walker<T::State>,
        expected: f32,
        [pixel, sample]: [u32; 2],
        waiting: &mut Vec<Walker<T::State>>,
        (colour, rays): (&mut Rgb, &mut u64),
    ) {
        let Plan { max_bounces, technique, ref roulette } = self.0;
        let Walker { vertex: first, mut x, mut alpha, key, mut siblings, mut scored } = walker;
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
                    *colour += alpha
                        * light.weight
                        * t.emission(&light.state)
                        * technique.connection(light.pdf, light.other_pdf);
                }
            }
            if last(vertex + 1) && !technique.hits(t) {
                break;
            }
            // roulette: q is the probability of termination, and below 0 the walk splits
            let q = if scored { 0.0 } else { roulette.q(t, vertex, alpha, &x, expected) };
            scored = false;
            if q != 0.0 {
                let (copies, weight) = Roulette::copies(q, numbers(vertex, Purpose::Roulette).one(), siblings);
                if copies == 0 {
                    break;
                }
                alpha *= weight;
                siblings *= copies;
                let copy = |c| Walker {
                    vertex,
                    x,
                    alpha,
                    key: lineage(key, vertex, c, Roulette::MOST),
                    siblings,
                    scored: true,
                };
                waiting.extend((1..copies).map(copy));
            }
            // the next vertex, whose emission counts if hits do
            *rays += 1;
            let Some(next) = t.scatter(&x, &mut numbers(vertex, Purpose::Scatter)) else { break };
            alpha *= next.weight;
            x = next.state;
            if technique.hits(t) {
                *colour += alpha * t.emission(&x) * technique.hit(next.pdf, next.other_pdf);
            }
        }
    }
}

/// A walk that stands at a vertex.
struct Walker<S> {
    vertex: usize,
    x: S,
    alpha: Rgb,
    key: Key,
    /// Into how many its path has split.
    siblings: u32,
    /// Whether another copy has scored this vertex and gone through its roulette.
    scored: bool,
}

impl<T: Transport> TermEstimator<T> for PathTracer {
    fn slots(&self) -> usize {
        1
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let mut rays = 0;
        let mut value = Columns::new(1);
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                rays += 1;
                let mut numbers = Rng::at(batch.key, pixel, sample, 0, Purpose::Start);
                if let Some(start) = sensor.start(t, pixel, &mut numbers) {
                    let (colour, more) = self.radiance(t, start, batch.key, pixel, sample);
                    rays += more;
                    value.set(0, colour);
                    sink.add(0, &[pixel], &[sample], &value);
                }
            }
        }
        sink.rays(0, rays as usize);
    }
}
