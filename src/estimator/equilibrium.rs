//! Both sides of the rendering equation, from independent paths.
//!
//! ```text
//! X_0 = L(x)                             the path tracer from x
//! X_1 = E(x) + weight · L(x')            one step of the walk by hand, then the path tracer from x' with other numbers
//! ```
//!
//! `L = E + T L` at x says that the two have one mean. They are different estimators: next-event estimation stands inside
//! L only, so that light which L finds by connecting from x is found by X_1 where the step hits it.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x → x', weight | one factor of T | [`Transport::scatter`](crate::operator::Transport::scatter) |
//! | L | the path tracer, roulette included | [`PathTracer`] |
//! | c | factor on the weight; 1, or the equation is broken on purpose | [`Equilibrium::factor`] |
//!
//! **Blind to:** an error in T that both sides share. A path tracer whose every step weighs 2 % too much solves an equation
//! of its own, `L' = E + 1.02 T L'`; it is the step by hand, or the roulette or the connections inside L, that must be wrong to be seen.
//! Needs a schedule that ends paths, and lights that have area: a step never hits a point.

use super::{Job, PathTracer, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Columns, Purpose, Rgb, Rng};
use crate::operator::{Kernel, Sensor};

/// Estimates L in slot 0 and E + T L in slot 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// How L is estimated.
    pub plan: Plan,
    /// On the weight of the step: 1 for the equation as it is.
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
