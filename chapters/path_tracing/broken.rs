//! Three ways to break the rules of emission, and what each of them does to the terms.
//!
//! ```text
//! r_k = T_k^wrong / T_k^right
//! ```
//!
//! | the mistake | r_k | place |
//! |---|---|---|
//! | w_c = w_s = 1: every path counts twice | 1, 2, 2, 2, … in a room without mirrors | [`BROKEN`] 0 |
//! | w_e = 0: the lamp is black | 0, 1, 1, 1, … | [`BROKEN`] 1 |
//! | w_s = 0 after a mirror or glass | 1, then less than 1: caustics and reflected lamps are lost | [`BROKEN`] 2 |
//!
//! Reference: Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed. 2023), ch. 13.

use super::scene;
use fredholm::engine::Settings;
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Mistake, Right};

/// K of these pictures.
pub(super) const TERMS: usize = 4;

/// A broken rule, and the room in which it is measured.
#[derive(Clone, Copy, Debug)]
pub struct Broken {
    /// Member of the zoo.
    pub name: &'static str,
    pub(super) scene: &'static str,
    technique: Technique,
}

/// The three broken rules.
pub const BROKEN: [Broken; 3] = [
    Broken { name: "double-emission", scene: "sphere", technique: Technique::Mis },
    Broken { name: "emission-missing", scene: "sphere", technique: Technique::Mis },
    Broken { name: "no-emission-after-mirror", scene: "cornell-spheres", technique: Technique::Connect },
];

// ANCHOR: ratios
/// r_0, r_1, … of a broken rule: the mean of every wrong term over that of the right one. The two pictures have independent
/// random numbers.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn ratios(folder: &Folder<'_>, broken: &Broken, mistake: &dyn Mistake) -> book::Result<Vec<Number>> {
    let spp = folder.pick(256, 48);
    let settings = Settings { spp, seed: folder.seed, max_bounces: TERMS, ..Settings::default() };
    let plan = Plan { max_bounces: TERMS, technique: broken.technique, roulette: Roulette::Never };
    let room = scene(broken.scene, 48)?;
    let render = |mistake: &dyn Mistake, stream: &str| {
        zoo::of(&plan, mistake, stream, &room, &settings, folder.progress).series.image().clone()
    };
    let (wrong, right) = (render(mistake, broken.name), render(&Right, "right"));
    Ok(measured(&wrong, &right).iter().map(|r| Number { value: r.value, std_error: r.std_error }).collect())
}
// ANCHOR_END: ratios
