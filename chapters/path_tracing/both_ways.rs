//! All terms from one path, and each term from its own paths: the same means, different numbers of rays.
//!
//! ```text
//! own paths:  Σ_k (k + 1) = K (K + 3)/2 rays        one path: 2 K rays        in a closed room, k = 1, …, K
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | one path | term k from the first k vertices of a path | [`Estimator::Prefix`] |
//! | own paths | term k from paths of its own | [`Estimator::Single`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::{LAST, scene};
use fredholm::engine::{Settings, by_rays, by_rays::Estimator};
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::Scene;
use fredholm::terms::Estimate;

// ANCHOR: render
/// Renders T E, …, T^K E of a scene: all from one path, or each from its own paths.
fn render(folder: &Folder<'_>, scene: &Scene, estimator: Estimator, spp: u32) -> by_rays::Sampled {
    let (technique, roulette) = (Technique::Connect, Roulette::Never);
    let settings = Settings { spp, seed: folder.seed, max_bounces: LAST, technique, roulette, ..Settings::default() };
    by_rays::terms(scene, estimator, &settings, folder.progress)
}
// ANCHOR_END: render

/// The image means of T E, …, T^K E in the Cornell box and of their sum: one path, own paths.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn means(folder: &Folder<'_>) -> book::Result<[Vec<Number>; 2]> {
    let room = scene("cornell", 64)?;
    // mean of the channels; the sum of their errors is an upper bound of its error
    let grey = |e: Estimate| Number { value: e.mean.element_sum() / 3.0, std_error: e.std_error.element_sum() / 3.0 };
    Ok([Estimator::Prefix, Estimator::Single].map(|estimator| {
        let found = render(folder, &room, estimator, folder.pick(256, 64)).replicates;
        let of = |k: std::ops::Range<usize>| grey(found.estimate(k));
        (1..=LAST).map(|k| of(k..k + 1)).chain([of(1..LAST + 1)]).collect()
    }))
}

/// Rays of one sample of T E, …, T^K E: of one path, and of K own paths. The ray of the term 0 belongs to the one path.
///
/// # Errors
/// If there is no such scene.
pub fn rays(folder: &Folder<'_>, name: &str) -> book::Result<[f64; 2]> {
    const SPP: u32 = 4;
    let room = scene(name, 32)?;
    let count = |estimator, first: usize| {
        let rays = render(folder, &room, estimator, SPP).rays;
        rays[first..].iter().sum::<u64>() as f64 / f64::from(32 * 32 * SPP)
    };
    Ok([count(Estimator::Prefix, 0), count(Estimator::Single, 1)])
}
