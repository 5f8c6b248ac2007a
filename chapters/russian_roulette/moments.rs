//! The variance under any schedule, from paths that no roulette ends.
//!
//! ```text
//! E[S²] = Σ_jk M_jk/Q_min(j,k)          Q_v = Π_{u<v} (1 − q[u])
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | M_jk | mean of X_j X_k without roulette | [`pilot`](roulette::pilot) |
//! | Q_v | probability of reaching vertex v | [`Noise::predicted`] |
//! | V | variance of one path, mean over pixels and channels | [`Noise::indirect`] |
//!
//! Reference: `fredholm::stats::schedule`.

use super::load;
use super::schedules::{self, Row};
use fredholm::engine::Settings;
use fredholm::estimator::Roulette;
use fredholm::report::book::{self, Folder, Number};
use fredholm::stats::schedule::{Noise, Part, share};
use fredholm::study::roulette;

/// No roulette before this vertex.
const K: usize = 16;

/// What follows from the moments.
#[derive(Clone, Debug)]
pub struct Prices {
    /// Variance of indirect light with q = 0.2: predicted and measured.
    pub indirect: [Number; 2],
    /// Share of emission seen directly in the variance of the whole image, without roulette.
    pub emission: Number,
    /// The price of some schedules.
    pub schedules: Vec<Row>,
    /// How much each of the two best schedules loses for the quantity of the other.
    pub crossed: [Number; 2],
}

/// Records moments without roulette; predicts and measures the variance with q = 0.2. `ends` turns 0.2 into the q of the
/// paths that are measured.
///
/// # Errors
/// If the program is stopped.
pub fn moments(folder: &Folder<'_>, ends: fn(f64) -> f64) -> book::Result<Prices> {
    let (scene, _) = load("cornell", folder.pick(64, 32))?;
    let settings = Settings { seed: folder.seed, max_bounces: K, ..Settings::default() };
    let (spp, stopped) = (256, "stopped");
    // ANCHOR: predict
    let constant = |q| Roulette::Constant { from: 0, q }.then(K, roulette::beyond(&scene)).ok_or(stopped);
    let recorded = roulette::pilot(&scene, &settings, spp, folder.progress).ok_or(stopped)?;
    let predicted = Noise::predicted(&recorded, &constant(0.2)?).ok_or(stopped)?;
    let again = roulette::measure(&scene, &settings, &constant(ends(0.2))?, spp, folder.progress).ok_or(stopped)?;
    let measured = Noise::measured(&again);
    // ANCHOR_END: predict
    let (schedules, crossed) = schedules::compare(folder, &scene, &settings, &recorded)?;
    Ok(Prices {
        emission: share(&recorded, Part::Term(0)),
        indirect: [predicted.indirect, measured.indirect],
        schedules,
        crossed,
    })
}
