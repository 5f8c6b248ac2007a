//! The absorption estimator: a path scores only at the vertex where it ends.
//!
//! ```text
//! X = W_N E(x_N) / q_N        W_n = Π_{v<n} weight_v / (1 − q_v),    P(N = n) = q_n Π_{v<n} (1 − q_v)
//! ```
//!
//! `E[X 1{N = k}] = (T^k E)(x_0)`. The collision estimator ([`Prefix`](super::Prefix) with `Technique::Scatter`) has the
//! same mean, but scores E at every vertex of the path. A path whose scattering step fails scores nothing: the surface
//! absorbed it, or it left the scene.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | q_v | probability to end at vertex v: the transport's own absorption probability if it has one, else roulette | [`Transport::absorption`], [`Roulette`](super::Roulette) |
//! | N | the vertex where the path ends | |
//!
//! Where E = q, every path has X = 1, so the estimator has no variance. An example is a closed room that emits 1 − ρ, with
//! roulette by albedo. No path ends at a vertex with q = 0, so its term is never scored. The schedule must therefore have
//! q > 0 wherever there is emission.
//! Reference: von Neumann and Ulam, after Forsythe and Leibler (1950); Spanier and Gelbard, *Monte Carlo Principles* (1969).

use super::{Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::{Purpose, Rng};
use crate::operator::{Sensor, Transport};

/// The absorption estimator. It ignores the technique of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Absorption(pub Plan);

impl<T: Transport> TermEstimator<T> for Absorption {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let Plan { max_bounces, ref roulette, .. } = self.0;
        let mut value = crate::math::Columns::new(1);
        for (pixel, sample) in batch.samples.clone().flat_map(|s| batch.pixels.clone().map(move |p| (p, s))) {
            let rng = |v, purpose| Rng::at(batch.key, pixel, sample, v, purpose);
            sink.rays(0, 1);
            let Some(mut x) = sensor.start(t, pixel, &mut rng(0, Purpose::Start)) else { continue };
            let mut throughput = t.lit();
            for v in 0.. {
                let here = t.absorption(&x);
                // without roulette no path would ever end, and so none would score
                if here.is_none() && !roulette.ends() && v > max_bounces {
                    break;
                }
                let slot = v.min(max_bounces + 1);
                let q = here.unwrap_or_else(|| roulette.q(t, v, throughput, &x));
                if q > 0.0 && rng(v, Purpose::Roulette).one() < q {
                    value.set(0, throughput * t.emission(&x) / q);
                    sink.add(slot, &[pixel], &[sample], &value);
                    break;
                }
                sink.rays((v + 1).min(max_bounces + 1), 1);
                let Some(step) = t.scatter(&x, &mut rng(v, Purpose::Scatter)) else { break };
                throughput *= step.weight * (1.0 / (1.0 - q));
                x = step.state;
            }
        }
    }
}
