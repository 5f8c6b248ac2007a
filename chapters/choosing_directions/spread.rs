//! Mean and variance of an estimator from many samples, with the errors of both.
//!
//! ```text
//! E[X] = m      V = Var X/m²      N = V/ε²: samples for a relative error ε
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X | one sample, from its own random numbers | argument of [`spread`] |
//! | m | mean, with its standard error | [`Spread::mean`] |
//! | V | variance of one sample divided by the squared mean, with a bound on its standard error | [`Spread::variance`] |
//!
//! Both come from 64 independent batches, so that every number has an error. The error of V adds those of Var X and of m²:
//! the two may be correlated, and the sum is right in every case.

use fredholm::math::{Key, Purpose, Rng};
use fredholm::report::book::Number;
use fredholm::stats::Moments;
use rayon::prelude::*;

const BATCHES: u32 = 64;

/// Mean and relative variance of an estimator.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// m, the mean.
    pub mean: Number,
    /// V = Var X/m², of one sample.
    pub variance: Number,
}

/// Takes 64 × `each` samples of X. `name` names the random numbers.
pub fn spread(seed: u64, name: &str, each: u32, x: impl Fn(&mut Rng) -> f64 + Sync) -> Spread {
    let key = Key::new(seed, name);
    let batch = |b: u32| {
        let mut samples = Moments::new(1);
        (0..each).for_each(|i| samples.push(&[x(&mut Rng::at(key, b, i, 0, Purpose::Scatter))]));
        [samples.mean()[0], samples.variance(0)]
    };
    let mut all = Moments::new(2);
    (0..BATCHES).into_par_iter().map(batch).collect::<Vec<_>>().iter().for_each(|of_batch| all.push(of_batch));
    let mean = Number { value: all.mean()[0], std_error: all.std_error(0) };
    let v = all.mean()[1] / (mean.value * mean.value);
    let error = all.std_error(1) / (mean.value * mean.value) + 2.0 * v * mean.std_error / mean.value;
    Spread { mean, variance: Number { value: v, std_error: error } }
}
