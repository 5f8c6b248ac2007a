//! The full path tracer, as the lecture writes it: one colour, one throughput, no separate terms.
//!
//! ```text
//! colour ← 0, α ← 1, x ← what the eye sees
//! colour ← colour + α E(x)                                              emission counts at the eye
//! repeat
//!     draw y on an emitter with density p                               where the technique connects
//!         colour ← colour + α · f(x, y) cos θ / p · E(y) · w_c
//!     stop with probability q,   α ← α / (1 − q)                        Russian roulette
//!     draw the direction to x' with density p
//!     α ← α · f(x, x') cos θ / p,   x ← x'
//!     colour ← colour + α E(x) · w_s                                    where emission counts on hits: after a delta vertex, scatter, MIS
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | α | throughput: the factor on all radiance that is found from here on | `throughput` |
//! | f, cos θ, p | factors of T; on a matrix: the row's entry, 1, and its probability | [`Factors`](crate::operator::Factors) |
//! | q | probability of termination | [`Roulette::q`](super::Roulette::q) |
//! | w_c, w_s | weights of the techniques | [`Technique`](super::Technique) |
//!
//! **Invariants**, before every round. α is an unbiased sample of the product of all f cos θ so far, so `E[α · L(x)]` is the
//! part of the pixel's value that comes from paths of this length and longer. The mean of colour is Σ T^k E over all shorter
//! paths. So E\[colour + α · (T L)(x)\] is the pixel's value before every round.
//!
//! **Shared with [`Prefix`](super::Prefix)**: the random numbers, by their addresses; the rays and connections, and the
//! lights and directions that are drawn; E; the albedo that q depends on; the table of technique weights. **Not shared**:
//! the weights of the steps. `Prefix` multiplies the finished product f cos θ/p of [`Transport`], often in packets and SIMD
//! lanes. The path tracer takes the separate factors from [`Kernel`] and multiplies them itself. It has no waves, terms or
//! slots. So the test "sum of the terms = path tracer" compares two programs. With the same stream, technique and schedule
//! they agree sample by sample, up to rounding.
//!
//! With a schedule that never ends paths, the path tracer stops after `max_bounces` applications of T. Reference: Kajiya,
//! *The Rendering Equation* (1986).

use super::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{Kernel, Sensor, Transport};

/// The path tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTracer(pub Plan);

impl PathTracer {
    /// Follows one path from the state that the eye sees. Returns the radiance that it estimates there, and its number of
    /// rays.
    pub fn radiance<T: Kernel>(&self, t: &T, eye: T::State, key: Key, pixel: u32, sample: u32) -> (Rgb, u64) {
        let Plan { max_bounces, technique, ref roulette } = self.0;
        let numbers = |v: usize, purpose: Purpose| Rng::at(key, pixel, sample, v, purpose);
        let longest = if roulette.ends() { usize::MAX } else { max_bounces };

        let (mut x, mut throughput, mut rays) = (eye, t.lit(), 0);
        // emission counts at the eye, whatever the technique
        let mut colour = t.emission(&x);

        for v in 0..longest {
            // next-event estimation: a point y on an emitter
            if technique.connects() {
                rays += 1;
                if let Some(y) = t.sample_emitter(&x, &mut numbers(v, Purpose::Connect)) {
                    let [p, other] = y.pair;
                    colour +=
                        throughput * y.f * (y.cos / y.pdf) * t.emission(&y.state) * technique.connection(p, other);
                }
            }
            // after the last connection nothing is left to score if hits do not count
            if v + 1 == longest && !technique.hits(t) {
                break;
            }
            // Russian roulette: q is the probability of termination
            let q = roulette.q(t, v, throughput, &x);
            if q > 0.0 {
                if numbers(v, Purpose::Roulette).one() < q {
                    break;
                }
                throughput *= 1.0 / (1.0 - q);
            }
            // the next vertex x', along a direction from the BSDF
            rays += 1;
            let Some(next) = t.sample_direction(&x, &mut numbers(v, Purpose::Scatter)) else { break };
            throughput *= next.f * (next.cos / next.pdf);
            x = next.state;
            // emission counts on hits, weighted by the technique
            if technique.hits(t) {
                let [p, other] = next.pair;
                colour += throughput * t.emission(&x) * technique.hit(p, other);
            }
        }
        (colour, rays)
    }
}

impl<T: Kernel> TermEstimator<T> for PathTracer {
    fn slots(&self) -> usize {
        1
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        each_path(job, sink, |start, pixel, sample| self.radiance(job.t, start, job.batch.key, pixel, sample));
    }
}

/// Calls `radiance` for the start of every path of a job. Adds the value and the rays to the only slot of the sink.
pub(crate) fn each_path<T: Transport, S: Sensor<T>>(
    job: &Job<'_, T, S>,
    sink: &mut impl TermSink,
    radiance: impl Fn(T::State, u32, u32) -> (Rgb, u64),
) {
    let &Job { t, sensor, batch } = job;
    let (mut rays, mut value) = (0, Columns::new(1));
    for sample in batch.samples.clone() {
        for pixel in batch.pixels.clone() {
            rays += 1;
            let mut numbers = Rng::at(batch.key, pixel, sample, 0, Purpose::Start);
            if let Some(start) = sensor.start(t, pixel, &mut numbers) {
                let (colour, more) = radiance(start, pixel, sample);
                rays += more;
                value.set(0, colour);
                sink.add(0, &[pixel], &[sample], &value);
            }
        }
    }
    sink.rays(0, rays as usize);
}
