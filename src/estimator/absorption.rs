//! The absorption estimator: nothing is scored on the way, everything where the walk ends.
//!
//! ```text
//! X_N = W_N E(x_N) / q(x_N),     X_k = 0 for k ≠ N        W_k = Π_{v<k} weight_v / (1 − q(x_v)),  N: where the walk is absorbed
//! ```
//!
//! `E[X_k] = E[ W_k 1{k reached} · q · E/q ] = (T^k E)(x_0)`, if q > 0 wherever light is emitted. One walk scores one term. The prefix
//! estimator, which scores on the way, is the collision estimator of the literature. Absorbed with probability 1 − albedo
//! this is the analog walk; it is exact where E = q, as in a room that radiates like a black body.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | q(x) | probability of termination, a property of the place | [`Absorbing::absorption`] |
//! | K | terms k ≤ K have a slot, longer walks share one | [`Absorption::max_bounces`] |
//!
//! Reference: Forsythe and Leibler, *Matrix inversion by a Monte Carlo method* (1950); Spanier and Gelbard, *Monte Carlo
//! Principles and Neutron Transport Problems* (1969), ch. 2.

use super::{Batch, Paths, TermEstimator, TermSink};
use crate::math::{Columns, Purpose, Rgb, Rng};
use crate::operator::{Absorbing, Sensor};

/// The absorption estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Absorption {
    /// K.
    pub max_bounces: usize,
}

impl<T: Absorbing> TermEstimator<T> for Absorption {
    fn slots(&self) -> usize {
        self.max_bounces + 2
    }

    fn sample(&self, t: &T, sensor: &impl Sensor<T>, batch: &Batch, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let mut value = Columns::new(1);
        let names = batch.samples.clone().flat_map(|s| batch.pixels.clone().map(move |p| (p, s)));
        for (pixel, sample) in names {
            let numbers = |v: usize, purpose: Purpose| Rng::at(batch.key, pixel, sample, v, purpose);
            sink.rays(0, 1);
            let Some(mut x) = sensor.start(t, pixel, &mut numbers(0, Purpose::Start)) else { continue };
            let mut through = Rgb::ONE;
            for v in 0.. {
                let slot = v.min(self.max_bounces + 1);
                // absorbed here: the only place that counts
                let q = t.absorption(&x);
                if numbers(v, Purpose::Roulette).one() < q {
                    value.set(0, through * t.emission(&x) * (1.0 / q));
                    sink.add(slot, &[pixel], &[sample], &value);
                    break;
                }
                sink.rays((v + 1).min(self.max_bounces + 1), 1);
                let Some(next) = t.scatter(&x, &mut numbers(v, Purpose::Scatter)) else { break };
                through *= next.weight * (1.0 / (1.0 - q));
                x = next.state;
            }
        }
    }
}
