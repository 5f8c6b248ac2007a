//! Renders with their mean, their noise and their cost.
//!
//! ```text
//! V = mean over pixels and channels of se²      efficiency = 1/(V t)      n = t/t₁ samples fit into the time t
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | se | standard error of a pixel, from replicates | [`fredholm::terms::film`] |
//! | V | variance of the image; √V is its noise | [`Shot::variance`] |
//! | t, t₁ | seconds of a render, seconds per sample of every pixel | [`Shot::seconds`], [`Shot::cost`] |
//! | n | samples per pixel | [`Shot::spp`], [`in_equal_time`] |
//!
//! Reference: Pharr, Jakob and Humphreys, *Physically Based Rendering* (4th ed. 2023), sec. 2.1 (efficiency).

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{Folder, Number, Result};
use fredholm::report::text::number::{average, plus_minus, significant};
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::{Description, Scene, load};
use fredholm::stats::half_width_95;
use fredholm::terms::functional::image_replicates;
use fredholm::terms::scatter::Scatter;
use fredholm::terms::{Estimate, TermFilm, TermImage};
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// Replicates of a film. With a multiple of it as number of samples, all replicates have the same size.
pub(crate) const REPLICATES: u32 = 16;

/// The 95 % interval of a number from the replicates.
pub(crate) trait Interval {
    /// `value ± half width`.
    fn words(self) -> String;
    /// The largest absolute value inside the interval.
    fn at_most(self) -> f64;
}

impl Interval for Number {
    fn words(self) -> String {
        plus_minus(self.value, half_width_95(self.std_error, u64::from(REPLICATES)), 2)
    }

    fn at_most(self) -> f64 {
        self.value.abs() + half_width_95(self.std_error, u64::from(REPLICATES))
    }
}

/// A film with the seconds that it took.
pub(crate) struct Shot {
    pub(crate) film: TermFilm,
    /// Wall-clock seconds of this render.
    pub(crate) seconds: f64,
    pub(crate) spp: u32,
    /// Seconds per sample of every pixel: the least of several renders, if there are several.
    pub(crate) cost: f64,
}

impl Shot {
    /// Renders the camera image of a scene. `stream` names the random numbers.
    pub(crate) fn new<'s>(
        scene: &'s Scene,
        sampling: Sampling,
        estimator: &impl TermEstimator<SceneTransport<'s>>,
        spp: u32,
        stream: &str,
        folder: &Folder<'_>,
    ) -> Self {
        let t = SceneTransport { scene, sampling };
        let start = Instant::now();
        let amount = Amount::new(spp, Key::new(folder.seed, stream));
        let film = render(&t, &scene.camera, estimator, amount, folder.progress);
        let seconds = start.elapsed().as_secs_f64();
        Self { film, seconds, spp, cost: seconds / f64::from(spp) }
    }

    /// The terms k ≤ K by prefixes of paths that no roulette ends, with MIS.
    pub(crate) fn terms(scene: &Scene, max_bounces: usize, spp: u32, stream: &str, folder: &Folder<'_>) -> Self {
        let plan = Plan { max_bounces, technique: Technique::Mis, roulette: Roulette::Never };
        Self::new(scene, Sampling::Bsdf, &Prefix(plan), spp, stream, folder)
    }

    /// The image of the sum of some slots.
    pub(crate) fn image(&self, slots: Range<usize>) -> TermImage {
        TermImage::of(&self.film, slots)
    }

    /// Mean over the image of the sum of some slots.
    pub(crate) fn estimate(&self, slots: Range<usize>) -> Estimate {
        image_replicates(&self.film).estimate(slots)
    }

    /// The same mean over the three channels.
    pub(crate) fn mean(&self, slots: Range<usize>) -> Number {
        let e = self.estimate(slots);
        Number { value: e.mean.element_sum() / 3.0, std_error: e.std_error.element_sum() / 3.0 }
    }

    /// V of the sum of some slots.
    pub(crate) fn variance(&self, slots: Range<usize>) -> Number {
        let scatter = Scatter::of(&self.film, slots, None);
        Number { value: scatter.variance(), std_error: scatter.variance_error() }
    }

    /// √V.
    pub(crate) fn noise(&self, slots: Range<usize>) -> Number {
        let v = self.variance(slots);
        Number { value: v.value.sqrt(), std_error: v.std_error / (2.0 * v.value.sqrt()) }
    }

    /// 1/(V n t₁), without the error of t₁.
    pub(crate) fn efficiency(&self, slots: Range<usize>) -> Number {
        let v = self.variance(slots);
        let value = 1.0 / (v.value * self.cost * f64::from(self.spp));
        Number { value, std_error: value * v.std_error / v.value }
    }

    /// Rays per path.
    pub(crate) fn rays_per_path(&self) -> f64 {
        let paths: f64 = self.film.samples.iter().map(|&n| f64::from(n)).sum();
        self.film.rays.iter().sum::<u64>() as f64 / paths
    }
}

/// Renders N ways in about equal time, each with a multiple of 16 samples. `render` gets the number of the way, the samples per pixel and the name of a stream.
///
/// Two pilot renders of each way, in turn, measure its time per sample. The least time counts, because other programs can
/// only make a render slower.
pub(crate) fn in_equal_time<const N: usize>(time: f64, render: impl Fn(usize, u32, &str) -> Shot) -> [Shot; N] {
    let pilot =
        |round: &str| std::array::from_fn::<f64, N, _>(|i| render(i, REPLICATES, &format!("{round}, {i}")).cost);
    let (first, second) = (pilot("first pilot"), pilot("second pilot"));
    std::array::from_fn(|i| {
        let cost = first[i].min(second[i]);
        let spp = (time / (cost * f64::from(REPLICATES))).round().clamp(1.0, 256.0) as u32 * REPLICATES;
        let shot = render(i, spp, &format!("way {i}"));
        Shot { cost: shot.cost.min(cost), ..shot }
    })
}

/// `mean ± half width of the 95 % interval`, averaged over the channels.
pub(crate) fn words(estimate: &Estimate) -> String {
    let (mean, half) = average(estimate);
    plus_minus(mean, half, 1)
}

/// Seconds in words.
pub(crate) fn seconds(shot: &Shot) -> String {
    format!("{} s", significant(shot.seconds, 2))
}

/// A built-in scene with an image of this size.
pub(crate) fn built_in(name: &str, [w, h]: [u32; 2]) -> Result<Description> {
    let set = vec![format!("camera.size=[{w},{h}]")];
    Ok(load::scene(name, &load::Options { set, ..load::Options::default() })?.description)
}

/// A scene given as text, with an image of this size.
pub(crate) fn from_text(text: &str, [w, h]: [u32; 2]) -> Result<Description> {
    let set = vec![format!("camera.size=[{w},{h}]")];
    Ok(load::toml(text, Path::new("(scene of a slide)"), &load::Options { set, ..load::Options::default() })?
        .description)
}
