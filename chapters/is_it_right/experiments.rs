//! Many experiments with one renderer.
//!
//! ```text
//! T E = ρ at every point of a furnace with E = 1          one sample: X = 2 ρ cos θ, cos θ uniform between 0 and 1
//! μ = ρ,  σ = μ/√3          darker renderer: X' = c X,  (1 − c)/c = (z_α + z_β) σ/(μ √n)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | μ, σ | right value, standard deviation of one sample | [`RHO`], [`CV`] times μ |
//! | n | samples of one experiment | [`SAMPLES`] |
//! | α, β | probability of a false alarm, and of a miss | [`ALPHA`], [`BETA`] |
//! | c | factor of the darker renderer | [`smallest`] |
//!
//! Reference: Cohen, *Statistical Power Analysis for the Behavioral Sciences* (1988).

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::math::{Key, Rgb};
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder};
use fredholm::scene::{Scene, bsdf::Sampling};
use fredholm::stats::min_detectable;
use fredholm::zoo::{Mistake, Stage, Walk};

/// μ: in a furnace with E = 1 and albedo ρ, T E = ρ.
pub const RHO: f64 = 0.5;
/// σ/μ: with uniform directions a sample is 2 ρ cos θ, and cos θ is uniform between 0 and 1.
pub const CV: f64 = 0.577_350_269_189_625_8;
/// α.
pub const ALPHA: f64 = 0.05;
/// β.
pub const BETA: f64 = 0.1;
/// Batches of an experiment.
pub const BATCHES: usize = 192;
/// Samples of a batch.
pub const BATCH: usize = 2;
/// n: samples of a whole experiment.
pub const SAMPLES: usize = BATCHES * BATCH;
/// Batches of a short experiment, with a sixteenth of the samples.
pub const SHORT: usize = BATCHES / 16;
/// m: tests of a family.
pub const TESTS: usize = 20;
/// Pixels along one side of a render; each pixel is an experiment.
pub const SIDE: u32 = 64;

/// The means of the batches of one experiment.
pub type Experiment = Vec<f64>;

// ANCHOR: experiments
/// Many experiments with one renderer: every pixel of the furnace measures T E = ρ by itself, in batches of samples.
pub fn experiments(f: &Folder<'_>, step: &dyn Mistake, stream: &str) -> book::Result<Vec<Experiment>> {
    let scene = Scene::new(&Stage::FURNACE.load([SIDE; 2])?);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    let plan = Plan { max_bounces: 1, technique: Technique::Scatter, roulette: Roulette::Never };
    let renderer = Walk { plan, mistake: step };
    let mut all = vec![];
    for run in 0..f.pick(4, 1) {
        let key = Key::new(f.seed, stream).branch(run);
        let amount = Amount { spp: SAMPLES as u32, replicates: BATCHES, key };
        let film = render(&t, &scene.camera, &renderer, amount, f.progress);
        let batch = |pixel: usize, b: usize| film.sum(pixel, b, 1).x / film.count(pixel, b);
        all.extend((0..film.shape.pixels()).map(|pixel| (0..BATCHES).map(|b| batch(pixel, b)).collect()));
    }
    Ok(all)
}

/// A renderer whose bounce reflects c times the right amount.
pub struct Darker(pub f64);
impl Mistake for Darker {
    fn bounce(&self, f: Rgb, cosine: f32, p: f32) -> Rgb {
        f * (cosine / p * self.0 as f32)
    }
}

/// c of the smallest mistake that `SAMPLES` samples find with probability 1 − β: (1 − c)/c = (z_α + z_β) σ/(μ √n).
pub fn smallest() -> f64 {
    1.0 / (1.0 + min_detectable(CV / (SAMPLES as f64).sqrt(), f64::INFINITY, ALPHA, BETA))
}
// ANCHOR_END: experiments
