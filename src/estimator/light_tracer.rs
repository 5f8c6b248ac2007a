//! Light tracing: estimates `⟨W, T^k E⟩ = ⟨(T*)^k W, E⟩` for all k from one particle that starts at a light.
//!
//! ```text
//! β_0 = 1/p(y_0)        β_{v+1} = β_v · weight_v / (1 − q_v)
//! X_k = β_k · S(y_k → eye) · W(y_k)                        in the pixel that sees y_k
//! ```
//!
//! The particle starts at y_0, drawn with density p. S is the scattering at y_k towards the eye, and W the importance of the
//! pixel. At y_0, S is the emission, so term 0 is the light seen directly. q is the probability of termination, and T* the
//! adjoint of T. Loop invariant: before the step at vertex v, every term k ≤ v has been splatted, and `throughput` is β_v.
//!
//! There are as many particles as camera paths: one for each (pixel, sample). A particle may add to any pixel, so each splat
//! is divided by the number of pixels, and errors come from whole replicates. No particle contributes to what the eye sees
//! in a mirror or through glass, because a delta vertex cannot be connected to the eye: see `engine::known::unsampled`.
//! Reference: Arvo, *Backward Ray Tracing* (1986); Dutré, Lafortune, Willems, *Monte Carlo Light Tracing* (1993).

use super::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{Adjoint, Role, Sensor};

/// The light tracer. It ignores [`Plan::technique`].
#[derive(Clone, Debug, PartialEq)]
pub struct LightTracer(pub Plan);

/// Index of the random stream for walks from the light.
pub(super) const LIGHT_STREAM: u32 = 0x4c49_4748;

impl LightTracer {
    /// Follows one particle. Calls `splat` with the slot, pixel and value of each splat, and `rays` with the slot of each
    /// ray.
    fn particle<T: Adjoint>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        (key, pixel, sample): (Key, u32, u32),
        mut splat: impl FnMut(usize, u32, Rgb),
        mut rays: impl FnMut(usize),
    ) {
        let Plan { max_bounces, ref roulette, .. } = self.0;
        let numbers = |vertex: usize, purpose: Purpose| Rng::at(key, pixel, sample, vertex, purpose);
        let Some((mut y, density)) = t.emit(&mut numbers(0, Purpose::Start)) else { return };
        let (mut throughput, mut relative, mut role) = (Rgb::splat(1.0 / density), t.lit(), Role::Emission);
        for v in 0.. {
            // connect vertex v to the eye: term v
            let slot = v.min(max_bounces + 1);
            if let Some(seen) = sensor.project(t, &y) {
                let value = t.toward(&y, &seen.eye, role).value;
                if value != Rgb::ZERO {
                    rays(slot);
                    if sensor.sees(t, &y) {
                        splat(slot, seen.pixel, throughput * value * seen.importance);
                    }
                }
            }
            if v == max_bounces && !roulette.ends() {
                break;
            }
            // roulette, once vertex v has been scored; a particle never ends at its start
            let q = if v == 0 { 0.0 } else { roulette.termination(v, relative, t.albedo(&y)) };
            if q > 0.0 {
                if numbers(v, Purpose::Roulette).one() < q {
                    break;
                }
                (throughput, relative) = (throughput / (1.0 - q), relative / (1.0 - q));
            }
            // y_v → y_{v+1}
            rays((v + 1).min(max_bounces + 1));
            let Some(step) = t.walk(&y, role, &mut numbers(v, Purpose::Scatter)) else { break };
            if role == Role::Flux {
                relative *= step.weight;
            }
            (throughput, y, role) = (throughput * step.weight, step.state, Role::Flux);
        }
    }
}

impl<T: Adjoint> TermEstimator<T> for LightTracer {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn splats(&self) -> bool {
        true
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let [w, h] = sensor.size();
        let share = 1.0 / (w * h) as f32;
        let key = batch.key.branch(LIGHT_STREAM);
        let mut value = Columns::new(1);
        let mut count = vec![0; self.0.max_bounces + 2];
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                let splat = |slot: usize, seen: u32, v: Rgb| {
                    value.set(0, v * share);
                    sink.add(slot, &[seen], &[sample], &value);
                };
                self.particle(t, sensor, (key, pixel, sample), splat, |slot| count[slot] += 1);
            }
        }
        count.iter().enumerate().for_each(|(slot, &n)| sink.rays(slot, n));
    }
}
