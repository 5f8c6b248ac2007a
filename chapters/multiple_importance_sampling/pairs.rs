//! Each plate with each lamp: mean and variance of four techniques, from the same samples.
//!
//! ```text
//! V = mean over x of Var X(x),  estimated by (X − X')²/2        rays for the same error ∝ c V
//! Veach's bound:  V ≤ V_best + ½ M,   M = mean over x of μ(x)²,  estimated by X X'
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X, X' | two independent estimates at the same point x of a plate | [`estimate`] |
//! | c | rays of one estimate: 1 for one strategy, 2 for both | [`RAYS`] |
//! | best | the strategy alone that needs fewer rays | [`Pair::best`] |
//!
//! Ratios of two techniques use their covariance, because they have the same samples.

use super::plates::{PLATES, only, points, veach};
use super::{Weight, estimate, found};
use fredholm::estimator::Technique;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, Vertex};
use fredholm::stats::Moments;
use rayon::prelude::*;

/// Rays of one estimate by each technique, in the order of [`Technique::ALL`].
pub const RAYS: [f64; 4] = [1.0, 1.0, 2.0, 2.0];
/// Number of batches.
const BATCHES: u32 = 64;

/// What was measured for one plate and one lamp.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Rays for the same error, relative to the better strategy alone, in the order of [`Technique::ALL`].
    pub rays: [Number; 4],
    /// The better strategy: 0 is BSDF sampling, 1 is light sampling.
    pub best: usize,
    /// Means of the balance and of the power heuristic, relative to the mean of the better strategy.
    pub means: [Number; 2],
    /// (V − V_best)/M for the balance heuristic.
    pub excess: Number,
}

/// Σ kᵢ mᵢ/m_b for the means mᵢ of some components, with its standard error.
fn ratio(m: &Moments, terms: &[(f64, usize)], b: usize) -> Number {
    let (mean, c) = (m.mean(), m.covariance_of_mean());
    let r = terms.iter().map(|&(k, i)| k * mean[i]).sum::<f64>() / mean[b];
    let gradient: Vec<(f64, usize)> = terms.iter().copied().chain([(-r, b)]).collect();
    let product = |&(k, i): &(f64, usize)| gradient.iter().map(|&(l, j)| k * l * c[(i, j)]).sum::<f64>();
    let variance: f64 = gradient.iter().map(product).sum();
    Number { value: r, std_error: variance.max(0.0).sqrt() / mean[b] }
}

/// The moments of one plate and one lamp: components 0 to 3 are X, 4 to 7 are (X − X')²/2, 8 is X X' of MIS.
fn moments(folder: &Folder<'_>, scene: &Scene, points: &[Vertex], name: &str, weight: Weight) -> Moments {
    let (t, key) = (SceneTransport::new(scene), Key::new(folder.seed, name));
    let each = folder.pick(2048, 896);
    let batch = |b: u32| {
        let mut sums = [0.0; 9];
        for n in 0..each {
            let u = Rng::at(key, b, n, 0, Purpose::Start).one();
            let x = &points[((u * points.len() as f32) as usize).min(points.len() - 1)];
            let both = [0, 1].map(|j| found(&t, x, key, [b, 2 * n + j]));
            for (i, technique) in Technique::ALL.into_iter().enumerate() {
                let [a, b] = both.each_ref().map(|y| estimate(&t, y, technique, weight).iter().sum::<f64>());
                sums[i] += 0.5 * (a + b);
                sums[4 + i] += 0.5 * (a - b).powi(2);
                if technique == Technique::Mis {
                    sums[8] += a * b;
                }
            }
        }
        sums.map(|s| s / f64::from(each))
    };
    let mut all = Moments::new(9);
    (0..BATCHES).into_par_iter().map(batch).collect::<Vec<_>>().iter().for_each(|b| all.push(b));
    all
}

/// Plates in rows, lamps in columns.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn pairs(folder: &Folder<'_>, weight: Weight) -> book::Result<Vec<[Pair; 4]>> {
    let description = veach([96, 64])?;
    let plates = points(&description, &Scene::new(&description))?;
    let lamps = [0, 1, 2, 3].map(|lamp| only(lamp, &description));
    let pair = |plate: usize, lamp: usize| {
        let m = moments(folder, &lamps[lamp], &plates[plate], &format!("plate {plate}, lamp {lamp}"), weight);
        let best = usize::from(m.mean()[5] < m.mean()[4]);
        let rays = [0, 1, 2, 3].map(|i| ratio(&m, &[(RAYS[i], 4 + i)], 4 + best));
        let means = [2, 3].map(|i| ratio(&m, &[(1.0, i)], best));
        Pair { rays, best, means, excess: ratio(&m, &[(1.0, 6), (-1.0, 4 + best)], 8) }
    };
    Ok((0..PLATES).map(|plate| [0, 1, 2, 3].map(|lamp| pair(plate, lamp))).collect())
}
