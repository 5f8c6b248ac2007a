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

use super::view::Views;
use super::walk::{LIGHT_STREAM, Walk, names};
use super::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Key};
use crate::operator::{Adjoint, Role, Sensor, Wave};

/// The light tracer. It ignores [`Plan::technique`].
#[derive(Clone, Debug, PartialEq)]
pub struct LightTracer(pub Plan);

/// Particles that are followed together.
const WAVE: usize = 1024;

impl LightTracer {
    /// Follows a wave of particles until all have ended. `relative[i]` is the throughput of particle i relative to its first
    /// step, which the schedule of termination uses.
    fn follow<T: Adjoint, S: Sensor<T>>(
        &self,
        job: &Job<'_, T, S>,
        key: Key,
        walk: &mut Walk<T::Wave>,
        (relative, views): (&mut Columns, &mut Views<T::Wave>),
        sink: &mut impl TermSink,
    ) {
        let Plan { max_bounces, ref roulette, .. } = self.0;
        let t = job.t;
        relative.fill(walk.n, t.lit());
        let mut role = Role::Emission;
        for v in 0.. {
            if walk.n == 0 {
                break;
            }
            // connect vertex v to the eye: term v
            let slot = v.min(max_bounces + 1);
            sink.rays(slot, views.connect(t, job.sensor, walk, role));
            views.add(&walk.sample, slot, sink);
            if v == max_bounces && !roulette.ends() {
                break;
            }
            // roulette, once vertex v has been scored; a particle never ends at its start
            if v > 0 && !roulette.sleeps(v) {
                walk.roulette(key, v, |state, i, place| {
                    let q = roulette.termination(v, relative.get(place), t.albedo(&state.get(i)));
                    relative.set(place, relative.get(place) / (1.0 - q));
                    q
                });
            }
            // y_v → y_{v+1}
            sink.rays((v + 1).min(max_bounces + 1), walk.n);
            walk.step(t, key, role, v);
            if role == Role::Flux && roulette.ends() {
                for (i, &place) in walk.place[..walk.n].iter().enumerate() {
                    let place = place as usize;
                    relative.set(place, relative.get(place) * walk.steps.weight.get(i));
                }
            }
            role = Role::Flux;
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
        let key = job.batch.key.branch(LIGHT_STREAM);
        let (pixel, sample) = names(job.batch);
        let most = WAVE.min(pixel.len());
        let (mut walk, mut relative, mut views) = (Walk::new(most), Columns::new(most), Views::new(most));
        walk.steps.wanted = false;
        for names in pixel.chunks(WAVE).zip(sample.chunks(WAVE)) {
            walk.start_at_lights(job.t, key, names);
            self.follow(job, key, &mut walk, (&mut relative, &mut views), sink);
        }
    }
}
