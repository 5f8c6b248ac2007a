//! Members of the zoo: their ratios r_k in the Cornell box, and a mistake that depends on the unit of length.
//!
//! ```text
//! r_k = wrong T^k E / right T^k E          c: once per path      c^(k−1): at every bounce      c^k: at every reflection
//! right: T^k E(s × scene) = T^k E(scene)   density per area in place of per solid angle: s² times as much
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r_k | ratio of the means over the image | [`Signature::ratios`] |
//! | law | r_k in closed form | [`Bug::ratio`] |
//! | s | factor of all lengths, 8 | [`scales`] |

use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Folder};
use fredholm::scene::Scene;
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Bug, Mistake, Stage, find};

/// K.
pub const LAST: usize = 6;
/// The members whose ratios are shown, and one that the mean of the whole image does not show.
pub const MEMBERS: [&str; 7] = [
    "double-emission",
    "roulette-before-light",
    "missing-pi",
    "roulette-weighted-twice",
    "half-bounce",
    "area-density",
    "off-by-one",
];

/// One member with its ratios.
#[derive(Clone)]
pub struct Signature {
    /// The member.
    pub bug: &'static Bug,
    /// r_0, …, r_K.
    pub ratios: Vec<Ratio>,
    /// The ratio of the whole images.
    pub whole: Ratio,
}

/// A member by name.
///
/// # Errors
/// If there is none, which is a defect of the program.
pub fn member(name: &str) -> book::Result<&'static Bug> {
    Ok(find(name).ok_or_else(|| format!("the zoo has no {name}"))?)
}

// ANCHOR: signatures
/// The ratios of some members in the Cornell box. The right terms come from another estimator and other random numbers.
pub fn signatures(f: &Folder<'_>, names: &[&str]) -> book::Result<Vec<Signature>> {
    let side = f.pick(32, 24);
    let scene = Scene::new(&Stage::CORNELL.load([side; 2])?);
    let roulette = Roulette::Albedo { from: 2 }.after(LAST);
    let few = Settings { spp: f.pick(256, 64), seed: f.seed, max_bounces: LAST, roulette, ..Settings::default() };
    let many = Settings { spp: 8 * few.spp, ..few.clone() };
    let right = by_rays::terms(&scene, Estimator::Prefix, &many, f.progress);
    let signature = |&name: &&str| {
        let bug = member(name)?;
        // a lamp that is also found by chance makes more noise
        let settings = if bug.technique == Technique::Mis { &many } else { &few };
        let wrong = zoo::render(bug, &scene, settings, f.progress);
        let (wrong, right) = (wrong.series.image(), right.series.image());
        Ok(Signature { bug, ratios: measured(wrong, right), whole: Ratio::of(&wrong.total, &right.total) })
    };
    names.iter().map(signature).collect()
}
// ANCHOR_END: signatures

/// The pixels of T E and of T² E in a sphere of radius 1, and in the same sphere with radius 8.
pub type Scales = [Vec<[f32; 3]>; 2];

// ANCHOR: scales
/// The integrating sphere, and the same sphere 8 times as large. The camera is at its centre.
const SPHERES: [Stage; 2] =
    [Stage::SPHERE, Stage { label: "sphere-r8", scene: "sphere", set: &["shapes.0.radius=8", "shapes.1.radius=8"] }];

/// Renders both spheres with the same random numbers.
pub fn scales(f: &Folder<'_>, step: &dyn Mistake) -> book::Result<Scales> {
    let one = |stage: Stage| {
        let scene = Scene::new(&stage.load([16; 2])?);
        let settings = Settings { spp: 16, seed: f.seed, max_bounces: 2, ..Settings::default() };
        let plan = Plan { max_bounces: 2, technique: Technique::Connect, roulette: Roulette::Never };
        let light = zoo::of(&plan, step, "scales", &scene, &settings, f.progress);
        book::Result::Ok([light.terms[1].mean.clone(), light.terms[2].mean.clone()].concat())
    };
    Ok([one(SPHERES[0])?, one(SPHERES[1])?])
}
// ANCHOR_END: scales

/// r_0, …, r_4 of one member and the ratio of the whole images, each with its standard error: a short measurement.
///
/// # Errors
/// If there is no such member.
pub fn signature_of(name: &str, seed: u64) -> book::Result<Vec<(f64, f64)>> {
    let bug = member(name)?;
    let scene = Scene::new(&Stage::CORNELL.load([24; 2])?);
    let roulette = Roulette::Albedo { from: 2 }.after(LAST);
    let spp = if bug.technique == Technique::Mis { 256 } else { 64 };
    let settings = Settings { spp, seed, max_bounces: LAST, roulette, ..Settings::default() };
    let right = by_rays::terms(&scene, Estimator::Prefix, &Settings { spp: 128, ..settings.clone() }, Progress::NONE);
    let wrong = zoo::render(bug, &scene, &settings, Progress::NONE);
    let (wrong, right) = (wrong.series.image(), right.series.image());
    let all = measured(wrong, right).into_iter().take(5).chain([Ratio::of(&wrong.total, &right.total)]);
    Ok(all.map(|r| (r.value, r.std_error)).collect())
}

/// What is wrong with a member, and its signature.
pub fn words_of(name: &str) -> [&'static str; 2] {
    find(name).map_or(["", ""], |bug| [bug.what, bug.signature])
}
