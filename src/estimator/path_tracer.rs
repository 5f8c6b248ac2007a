//! The full path tracer, as the lecture writes it: one colour, one throughput, no terms.
//!
//! ```text
//! colour ← 0, α ← 1, x ← what the eye sees
//! repeat
//!     if emission counts here:          colour ← colour + α E(x)      (at the eye; after a delta vertex; on hits under scatter, MIS)
//!     if light is sampled:              colour ← colour + α · connect
//!     if a random number is below q:    stop
//!     α ← α · weight / (1 − q),         x ← next
//! ```
//!
//! Independent code on purpose: it knows nothing of waves, terms or slots, so that "sum of the terms = path tracer"
//! compares two things. It reads the same addresses of random numbers, so with the same stream, technique and schedule the
//! sum over the slots of [`Prefix`](super::Prefix) is this sample to rounding. With a schedule that never ends paths, it
//! stops after `max_bounces` applications of T. Reference: Kajiya, *The Rendering Equation* (1986).

use super::{Batch, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{Sensor, Transport};

/// The path tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTracer(pub Plan);

impl PathTracer {
    /// Radiance estimated by one path, and the rays it took.
    pub fn radiance<T: Transport>(&self, t: &T, start: T::State, key: Key, pixel: u32, sample: u32) -> (Rgb, u64) {
        let Plan { max_bounces, technique, ref roulette } = self.0;
        let numbers = |vertex: usize, purpose: Purpose| Rng::at(key, pixel, sample, vertex, purpose);
        let last = |applications: usize| !roulette.ends() && applications >= max_bounces;

        // emission counts at the eye, whatever the technique
        let mut colour = t.emission(&start);
        let (mut alpha, mut x) = (Rgb::ONE, start);
        let expected = t.expected(&start).unwrap_or(0.0);
        let mut rays = 0;
        for vertex in 0.. {
            if last(vertex) {
                break;
            }
            // the light is sampled
            if technique.connects() {
                rays += 1;
                if let Some(light) = t.connect(&x, &mut numbers(vertex, Purpose::Connect)) {
                    colour += alpha
                        * light.weight
                        * t.emission(&light.state)
                        * technique.connection(light.pdf, light.other_pdf);
                }
            }
            if last(vertex + 1) && !technique.hits(t) {
                break;
            }
            // roulette: q is the probability of termination
            let q = roulette.q(t, vertex, alpha, &x, expected);
            if q > 0.0 {
                if numbers(vertex, Purpose::Roulette).one() < q {
                    break;
                }
                alpha *= 1.0 / (1.0 - q);
            }
            // the next vertex, whose emission counts if hits do
            rays += 1;
            let Some(next) = t.scatter(&x, &mut numbers(vertex, Purpose::Scatter)) else { break };
            alpha *= next.weight;
            x = next.state;
            if technique.hits(t) {
                colour += alpha * t.emission(&x) * technique.hit(next.pdf, next.other_pdf);
            }
        }
        (colour, rays)
    }
}

impl<T: Transport> TermEstimator<T> for PathTracer {
    fn slots(&self) -> usize {
        1
    }

    fn sample(&self, t: &T, sensor: &impl Sensor<T>, batch: &Batch, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
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
