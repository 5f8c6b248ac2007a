//! The strategies of the bidirectional estimator, one by one: the contribution of each to each term, with and without its
//! MIS weight.
//!
//! `T^k E = Σ_s (w_s-weighted strategy s)`: the weighted images of all strategies of a term add up to the term, up to
//! rounding. This holds because the paths are the same as those of the estimator itself.

use crate::engine::Settings;
use crate::engine::by_rays::Estimator;
use crate::engine::by_rays::amount;
use crate::estimator::Pyramid;
use crate::estimator::render::{Amount, render};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::functional::image_replicates;
use crate::terms::{Estimate, TermImage, variance};

/// One strategy of one term.
#[derive(Clone, Debug)]
pub struct Strategy {
    /// The term k.
    pub k: usize,
    /// Vertices sampled from the light; the other k + 1 − s are sampled from the eye.
    pub s: usize,
    /// The contribution to the term, with the MIS weight w_s.
    pub weighted: TermImage,
    /// The estimate by this strategy without a weight. It is unbiased for the light that this strategy can find.
    pub alone: TermImage,
    /// Image means of `weighted` and `alone`.
    pub means: [Estimate; 2],
    /// Variance of one sample of `weighted` and of `alone`, averaged over pixels and channels.
    pub variances: [f64; 2],
}

/// Number of replicates: enough to estimate errors, few enough to hold this many images in memory.
const REPLICATES: u32 = 4;

/// Renders every strategy of every term k ≤ K.
pub fn strategies(scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Vec<Strategy> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let usual = amount(settings, &Estimator::Bidirectional.to_string());
    let amount = Amount { replicates: settings.spp.min(REPLICATES) as usize, ..usual };
    let [w, h] = scene.camera.size;
    progress.begin("strategies", u64::from(w) * u64::from(h) * u64::from(settings.spp));
    let film = render(&t, &scene.camera, &Pyramid(settings.plan()), amount, progress);
    let (replicates, spp) = (image_replicates(&film), f64::from(film.least_samples()));
    let variances = variance::snapshot(&film).slots;
    let behind = Pyramid::len(settings.max_bounces);
    let strategy = |(k, s)| {
        let slots = [Pyramid::slot(k, s), behind + Pyramid::slot(k, s)];
        let [weighted, alone] = slots.map(|i| TermImage::of(&film, i..i + 1));
        let means = slots.map(|i| replicates.estimate(i..i + 1));
        Strategy { k, s, weighted, alone, means, variances: slots.map(|i| variances[i].value * spp) }
    };
    Pyramid::strategies(settings.max_bounces).map(strategy).collect()
}
