//! An estimator of both sides of the rendering equation, from independent paths.
//!
//! ```text
//! X_0 = L(x)                             the path tracer from x
//! X_1 = E(x) + weight · L(x')            one scattering step taken here, then the path tracer from x' with other numbers
//! ```
//!
//! The equation `L = E + T L` at x means that X_0 and X_1 have the same mean. They are different estimators, because only L
//! uses next-event estimation at x. Light that L finds by a connection from x is found by X_1 when the step hits the light.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x → x', weight | one factor of T | [`Transport::scatter`](crate::operator::Transport::scatter) |
//! | L | the path tracer, roulette included | [`PathTracer`] |
//! | c | factor on the weight of the step: 1, or another value to break the equation on purpose | [`Equilibrium::factor`] |
//!
//! **Not detected:** an error in T that both sides share. If every step of the path tracer weighs 2 % too much, the path
//! tracer solves another equation, `L' = E + 1.02 T L'`, and both sides still agree. An error is visible only in the step
//! taken here, or in the roulette or the connections inside L. The estimator needs a schedule that ends paths, and lights
//! with area, because a step never hits a point.

use super::{Job, PathTracer, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Purpose, Rgb, Rng};
use crate::operator::{Kernel, Sensor};

/// Estimates L in slot 0 and E + T L in slot 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Plan of the path tracer that estimates L.
    pub plan: Plan,
    /// Factor c on the weight of the step: 1 for the correct equation.
    pub factor: f32,
}

impl<T: Kernel> TermEstimator<T> for Equilibrium {
    fn slots(&self) -> usize {
        2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let tracer = PathTracer(self.plan.clone());
        let [left, step, onward] = [0, 1, 2].map(|i| batch.key.branch(i));
        let mut value = Columns::new(1);
        let mut rays = [0; 2];
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                let Some(x) = sensor.start(t, pixel, &mut Rng::at(batch.key, pixel, sample, 0, Purpose::Start)) else {
                    continue;
                };
                let (l, n) = tracer.radiance(t, x, left, pixel, sample);
                rays[0] += n;
                let mut r: Rgb = t.emission(&x);
                rays[1] += 1;
                if let Some(s) = t.scatter(&x, &mut Rng::at(step, pixel, sample, 0, Purpose::Scatter)) {
                    let (next, n) = tracer.radiance(t, s.state, onward, pixel, sample);
                    r += s.weight * self.factor * next;
                    rays[1] += n;
                }
                for (slot, x) in [l, r].into_iter().enumerate() {
                    value.set(0, x);
                    sink.add(slot, &[pixel], &[sample], &value);
                }
            }
        }
        (0..2).for_each(|slot| sink.rays(slot, rays[slot] as usize));
    }
}
