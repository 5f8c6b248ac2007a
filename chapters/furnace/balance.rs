//! Both sides of the rendering equation at points.
//!
//! ```text
//! L(x) and E(x) + (T L)(x), each from paths of its own        a wrong step: 1.02 T in place of T
//! ```

use fredholm::engine::Settings;
use fredholm::report::book::{self, Folder};
use fredholm::scene::Scene;
use fredholm::study::equilibrium::{Balance, Judgement, Origin, at_points, judge, points};
use fredholm::zoo::Stage;

// ANCHOR: balance
/// Estimates L and E + T L at 64 points of the cube, from independent paths. `factor` multiplies the weight of the step.
pub fn balance(f: &Folder<'_>, factor: f32) -> book::Result<(Vec<Balance>, Judgement)> {
    let scene = Scene::new(&Stage { label: "cube", scene: "cube", set: &[] }.load([16; 2])?);
    let settings = Settings { spp: f.pick(8192, 2048), seed: f.seed, ..Settings::default() };
    let at = points(&scene, Origin::Surface, 64, f.seed);
    let sides = at_points(&scene, &at, &settings, factor, f.progress);
    let judgement = judge(&[("surface", &sides)], 1e-3, 0.02); // chance of a false alarm; margin
    Ok((sides, judgement))
}
// ANCHOR_END: balance
