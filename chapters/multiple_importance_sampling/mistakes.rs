//! Mistakes of the zoo that concern weights and densities: by which factor each changes the direct light.
//!
//! ```text
//! factor = mean of T E with the mistake / mean of T E        with the same random numbers for each pixel and sample
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s | scale: all lengths of the Cornell box are multiplied by it | [`cornell`] |
//! | factor | with its standard error, from the replicates of both renders | [`Factor`] |

use fredholm::engine::{Settings, by_rays::Sampled};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::description::Geometry;
use fredholm::scene::{Description, Scene, load};
use fredholm::zoo::{self, Mistake, Right};

/// The members of the zoo.
pub const NAMES: [&str; 4] = ["double-emission", "mixed-heuristics", "mixed-measures", "wrong-light-choice"];
/// Scales of the Cornell box.
pub const SCALES: [f64; 3] = [0.1, 1.0, 10.0];

/// The factors of one mistake.
#[derive(Clone, Debug)]
pub struct Factor {
    /// Name of the mistake.
    pub name: &'static str,
    /// In the Cornell box, at each of the [`SCALES`].
    pub cornell: [Number; 3],
    /// In the scene `many-lights`.
    pub many: Number,
}

/// How the scenes are rendered.
pub struct Run<'a> {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Width and height of the pictures.
    pub pixels: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Progress.
    pub progress: Progress<'a>,
}

impl<'a> Run<'a> {
    /// The seed and the length of a chapter.
    pub fn of(folder: &Folder<'a>) -> Self {
        let (pixels, spp) = folder.pick((96, 32), (48, 32));
        Self { seed: folder.seed, pixels, spp, progress: folder.progress }
    }
}

/// The member of the zoo of this name; `right` has no mistake.
///
/// # Errors
/// If there is none.
pub fn member(name: &str) -> book::Result<&'static dyn Mistake> {
    match name {
        "right" => Ok(&Right),
        _ => Ok(zoo::find(name).ok_or("the zoo has no such member")?.mistake),
    }
}

/// A scene with square pictures.
fn square(name: &str, pixels: u32) -> book::Result<Description> {
    let set = vec![format!("camera.size=[{pixels}, {pixels}]")];
    Ok(load::scene(name, &load::Options { set, ..load::Options::default() })?.description)
}

/// The Cornell box with all lengths multiplied by s.
///
/// # Errors
/// If it cannot be loaded.
pub fn cornell(pixels: u32, s: f64) -> book::Result<Scene> {
    let mut scene = square("cornell", pixels)?;
    [&mut scene.camera.origin, &mut scene.camera.target].into_iter().for_each(|v| *v *= s);
    for shape in &mut scene.shapes {
        match &mut shape.geometry {
            Geometry::Quad { origin, edge_u, edge_v } => [origin, edge_u, edge_v].into_iter().for_each(|v| *v *= s),
            Geometry::Box { min, max, .. } => [min, max].into_iter().for_each(|v| *v *= s),
            _ => return Err("a shape of the Cornell box cannot be scaled".into()),
        }
    }
    Ok(Scene::new(&scene))
}

// ANCHOR: render
/// T E by both strategies with the balance heuristic; `mistake` may replace a step.
pub fn direct(run: &Run<'_>, scene: &Scene, mistake: &dyn Mistake, spp: u32) -> Sampled {
    let plan = Plan { max_bounces: 1, technique: Technique::Mis, roulette: Roulette::Never };
    let settings = Settings { spp, seed: run.seed, max_bounces: 1, ..Settings::default() };
    zoo::of(&plan, mistake, "direct", scene, &settings, run.progress)
}
// ANCHOR_END: render

/// a/b for the means of T E of two renders with the same paths, and its standard error.
pub fn over(a: &Sampled, b: &Sampled) -> Number {
    let mean = |s: &Sampled| s.replicates.mean[1].element_sum() / 3.0;
    let deviations =
        |s: &Sampled| -> Vec<f64> { s.replicates.deviation.iter().map(|d| d[1].element_sum() / 3.0).collect() };
    let value = mean(a) / mean(b);
    let (a, each) = (deviations(a), deviations(b));
    let n = each.len() as f64;
    let variance = a.iter().zip(&each).map(|(a, b)| (a - value * b).powi(2)).sum::<f64>() * n / (n - 1.0);
    Number { value, std_error: variance.sqrt() / mean(b) }
}

/// The factors of these mistakes.
///
/// # Errors
/// If a scene or a mistake does not exist.
pub fn factors(run: &Run<'_>, names: &[&'static str]) -> book::Result<Vec<Factor>> {
    let &Run { pixels, spp, .. } = run;
    let rooms = [cornell(pixels, SCALES[0])?, cornell(pixels, SCALES[1])?, cornell(pixels, SCALES[2])?];
    let many = Scene::new(&square("many-lights", pixels)?);
    let right = rooms.each_ref().map(|room| direct(run, room, &Right, spp));
    let right_many = direct(run, &many, &Right, spp);
    let factor = |&name: &&'static str| {
        let wrong = member(name)?;
        // here hits count in full, and they are rare: four times the samples
        let spp = if name == "double-emission" { 4 * spp } else { spp };
        let cornell = [0, 1, 2].map(|s| over(&direct(run, &rooms[s], wrong, spp), &right[s]));
        Ok(Factor { name, cornell, many: over(&direct(run, &many, wrong, spp), &right_many) })
    };
    names.iter().map(factor).collect()
}

/// Direct light of a point light of 1 W/sr in the Cornell box, divided by that of the lamp.
///
/// # Errors
/// If the scene cannot be loaded.
pub fn point_light(run: &Run<'_>) -> book::Result<Number> {
    let point = "lights=[{ type = 'point', position = [-0.4, 0.5, 0.5], intensity = [1, 1, 1] }]";
    let dark = "shapes.5.emission=[0, 0, 0]";
    let set = vec![format!("camera.size=[{n}, {n}]", n = run.pixels), point.into(), dark.into()];
    let point = Scene::new(&load::scene("cornell", &load::Options { set, ..load::Options::default() })?.description);
    let lamp = Scene::new(&square("cornell", run.pixels)?);
    Ok(over(&direct(run, &point, &Right, run.spp), &direct(run, &lamp, &Right, run.spp)))
}

/// The part of the direct light that comes from the lamp, in a Cornell box with a point light. Light adds up, so it is
/// 1/(1 + i r) for the intensity i, with r of [`point_light`].
pub fn from_the_lamp(r: Number, intensity: f64) -> Number {
    let value = 1.0 / (1.0 + intensity * r.value);
    Number { value, std_error: value * value * intensity * r.std_error }
}
