//! Objects of glass, and a corridor of mirrors: terms of the Neumann series with delta BSDFs.
//!
//! ```text
//! plate:   F + (1 − F)² F (1 + F² + …) reflected,   (1 − F)² (1 + F² + F⁴ + …) = (1 − F)/(1 + F) transmitted
//! glass under a sky of radiance 1:   L = 1        choice:   weight F/p with probability p, (1 − F)/(1 − p) otherwise
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | F | reflectance of one surface | `scene::bsdf::fresnel::Interface` |
//! | L | radiance of a pixel, all terms | [`furnace`] |
//! | p | probability of reflection | [`choice`] |
//! | – | light that passes a plate | [`plate`] |
//!
//! Reference: Pharr, Jakob and Humphreys, *Physically Based Rendering* (4th ed. 2023), section 9.5.

use super::DIAMOND;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, load};
use fredholm::zoo::{self, Mistake, Stage};
use std::path::Path;

/// Mean of an image, and the variance of one sample of a pixel, averaged over the pixels.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Mean radiance.
    pub mean: Number,
    /// Variance of one sample.
    pub variance: Number,
}

/// A plate in front of a wall that emits 1. The camera looks through the plate, along its normal.
const PLATE: &str = r#"
name = "plate"
[camera]
origin = [0, 0, 3]
target = [0, 0, 0]
up = [0, 1, 0]
fov = 1
size = [64, 64]
[materials.glass]
type = "dielectric"
ior = INDEX
[materials.lamp]
type = "diffuse"
reflectance = [0, 0, 0]
[[shapes]]
type = "box"
min = [-1, -1, -0.05]
max = [1, 1, 0.05]
material = "glass"
[[shapes]]
type = "quad"
origin = [-2, -2, -2]
edge_u = [4, 0, 0]
edge_v = [0, 4, 0]
material = "lamp"
emission = [1, 1, 1]
"#;

/// The part of the light that a plate of diamond transmits, from the terms k ≤ `last`.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn plate(folder: &Folder<'_>, last: usize) -> book::Result<Number> {
    let text = PLATE.replace("INDEX", &DIAMOND.to_string());
    let scene = load::toml(&text, Path::new("(plate)"), &load::Options::default())?.description;
    let settings = Settings { max_bounces: last, ..without_roulette(folder, 64) };
    let light = by_rays::terms(&Scene::new(&scene), Estimator::Prefix, &settings, folder.progress);
    Ok((&light.series.image().sum).into())
}

/// Settings without roulette: the terms k ≤ K, and nothing else.
pub(super) fn without_roulette(folder: &Folder<'_>, spp: u32) -> Settings {
    Settings { spp, seed: folder.seed, roulette: Roulette::Never, ..Settings::default() }
}

// ANCHOR: furnace
/// Largest |L − 1| of a pixel: of a glass ball and of a glass cube under a sky of radiance 1.
///
/// # Errors
/// If a scene cannot be loaded.
pub fn furnace(folder: &Folder<'_>, step: &dyn Mistake) -> book::Result<[f64; 2]> {
    let settings = Settings { spp: 16, seed: folder.seed, ..Settings::default() };
    let largest = |stage: Stage| -> book::Result<f64> {
        let scene = Scene::new(&stage.load([folder.pick(96, 48); 2])?);
        let light = zoo::of(&settings.plan(), step, stage.label, &scene, &settings, folder.progress);
        let errors = light.total.mean.iter().flatten().map(|&l| (f64::from(l) - 1.0).abs());
        Ok(errors.fold(0.0, |a: f64, x| if x.is_nan() || x > a { x } else { a }))
    };
    Ok([largest(Stage::GLASS_BALL)?, largest(Stage::GLASS_CUBE)?])
}
// ANCHOR_END: furnace

/// The glass ball with the given rule of choice: the sum of the terms k ≤ 4.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn choice(folder: &Folder<'_>, rule: &str, step: &dyn Mistake) -> book::Result<Choice> {
    let set = vec![format!("materials.glass.choice={rule}"), "camera.size=[64, 64]".into()];
    let scene = load::scene("glass-furnace", &load::Options { set, ..load::Options::default() })?.description;
    let spp = folder.pick(256, 128);
    let settings = without_roulette(folder, spp);
    let plan = Plan { max_bounces: 4, technique: Technique::Connect, roulette: Roulette::Never };
    let settings = Settings { max_bounces: 4, ..settings };
    let light = zoo::of(&plan, step, rule, &Scene::new(&scene), &settings, folder.progress);
    let each: Vec<f64> = light.sum.std_error.iter().map(|e| f64::from(e[0]).powi(2) * f64::from(spp)).collect();
    let n = each.len() as f64;
    let value = each.iter().sum::<f64>() / n;
    let spread = each.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (n - 1.0);
    Ok(Choice { mean: (&light.series.image().sum).into(), variance: Number { value, std_error: (spread / n).sqrt() } })
}

/// The part of the light in the picture of the mirror corridor that is reflected more than eight times.
///
/// # Errors
/// If the scene cannot be loaded.
pub(super) fn corridor(folder: &Folder<'_>) -> book::Result<Number> {
    let set = vec!["camera.size=[64, 64]".into()];
    let scene = load::scene("mirror-corridor", &load::Options { set, ..load::Options::default() })?.description;
    let settings = Settings { spp: folder.pick(64, 16), seed: folder.seed, ..Settings::default() };
    let light = by_rays::terms(&Scene::new(&scene), Estimator::Prefix, &settings, folder.progress).replicates;
    let (tail, all) = (light.mean.len() - 1, light.mean.iter().map(|m| m.x).sum::<f64>());
    let value = light.mean[tail].x / all;
    // the tail and the whole come from the same paths: the error of tail − value · whole
    let off = |d: &Vec<glam::DVec3>| d[tail].x - value * d.iter().map(|d| d.x).sum::<f64>();
    let n = light.deviation.len() as f64;
    let squares: f64 = light.deviation.iter().map(|d| off(d).powi(2)).sum();
    Ok(Number { value, std_error: (squares * n / (n - 1.0)).sqrt() / all })
}
