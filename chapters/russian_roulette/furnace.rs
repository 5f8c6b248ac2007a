//! The furnace, where the variance has a closed form.
//!
//! ```text
//! X_k = ρ^k,  Q_k = s^k:    E[S²] = (1 + ρ)/((1 − ρ)(1 − ρ²/s)),    Var = ρ²q/((1 − ρ)²(1 − q − ρ²)),    q < 1 − ρ²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ρ | albedo of the furnace, which emits E = 1 | [`RHO`] |
//! | q, s = 1 − q | probability of termination, of survival, at every vertex | [`IN_FURNACE`] |
//! | Var | variance of one path | [`in_furnace`] measured, [`variance_in_furnace`] closed form |
//!
//! Derived in the text of chapter 10.

use super::load;
use fredholm::engine::Settings;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::stats::schedule::Noise;
use fredholm::study::roulette;

/// Albedo of the furnace.
pub(super) const RHO: f64 = 0.5;
/// The probabilities of termination that are measured in the furnace.
pub const IN_FURNACE: [f64; 3] = [0.1, 0.3, 0.5];

// ANCHOR: furnace
/// Variance of one path in the furnace, in closed form.
pub(super) fn variance_in_furnace(q: f64) -> f64 {
    RHO * RHO * q / ((1.0 - RHO).powi(2) * (1.0 - q - RHO * RHO))
}

/// The same, measured: every path finds light only by hitting the walls, and ends with probability `q` at every vertex.
pub fn in_furnace(folder: &Folder<'_>, q: f64) -> book::Result<Number> {
    let (scene, _) = load("furnace", 32)?;
    let settings = Settings { seed: folder.seed, technique: Technique::Scatter, ..Settings::default() };
    let schedule = Roulette::Constant { from: 0, q };
    let recorded = roulette::measure(&scene, &settings, &schedule, folder.pick(1024, 128), folder.progress);
    Ok(Noise::measured(&recorded.ok_or("stopped")?).all)
}
// ANCHOR_END: furnace
