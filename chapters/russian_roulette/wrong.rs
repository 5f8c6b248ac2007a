//! Four mistakes with the weight of survivors, and the factors that they leave in the terms.
//!
//! ```text
//! E[ X 1{alive} w ] = s w X          term k has passed k − 1 tests, so r_k = (s w)^(k−1)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | w | weight of a survivor; 1/s is right | [`Mistake::survivor`](fredholm::zoo::Mistake::survivor) |
//! | r_k | wrong T^k E / right T^k E, means over the image | [`Wrong::ratios`] |
//!
//! Reference: `fredholm::zoo::roulette`.

use super::load;
use fredholm::engine::Settings;
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::report::book::{self, Folder};
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Bug, Right};

/// Terms k = 0 to K.
const K: usize = 4;
/// Names of the mistakes.
const NAMES: [&str; 4] =
    ["roulette-unweighted", "roulette-divides-by-q", "roulette-weighted-twice", "roulette-before-light"];

/// One mistake.
#[derive(Clone, Debug)]
pub struct Wrong {
    /// Name of the mistake.
    pub name: &'static str,
    /// (s w)^(k−1) for k = 0, …, K; 1 for k = 0.
    pub expected: Vec<f64>,
    /// r_0, …, r_K.
    pub ratios: Vec<Ratio>,
}

/// Renders each of them in the Cornell box, next to a renderer without roulette.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn wrong(folder: &Folder<'_>) -> book::Result<Vec<Wrong>> {
    let (scene, _) = load("cornell", 32)?;
    let settings = Settings { seed: folder.seed, max_bounces: K, spp: folder.pick(1024, 320), ..Settings::default() };
    let plan = Plan { max_bounces: K, technique: Technique::Connect, roulette: Roulette::Never };
    let right = zoo::of(&plan, &Right, "right", &scene, &settings, folder.progress);
    let compare = |bug: &'static Bug| {
        let wrong = zoo::render(bug, &scene, &settings, folder.progress);
        let expected = (0..=K).filter_map(bug.ratio).collect();
        Wrong { name: bug.name, expected, ratios: measured(wrong.series.image(), right.series.image()) }
    };
    NAMES.iter().map(|name| Ok(compare(zoo::find(name).ok_or("no such mistake")?))).collect()
}
