//! One image after n₁ < n₂ < … paths per pixel. All stages come from one render.
//!
//! ```text
//! MSE(n) = ⟨(m_n − X)²⟩ − ⟨se_X²⟩,  unbiased       shown(m) = ⟨min(max(g m, 0), 1)⟩ / g  ≤  ⟨m⟩  where m ≥ 0
//! ```
//!
//! A screen cannot show values above white. With few paths a few pixels are very bright, and their values are cut off on the
//! screen. The noisy image therefore *looks* darker than the clean one, although its mean is the same within its error. Both
//! means are recorded.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | m_n | image after n paths per pixel | [`Stage::pixels`] |
//! | X | image of an independent, longer render | [`Grown::reference`] |
//! | g | one gain for all images | chosen by the caller that shows them |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986); Pharr, Jakob and Humphreys, *Physically Based Rendering*, on fireflies.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Estimator};
use crate::estimator::render::{Amount, render_in_passes};
use crate::estimator::{PathTracer, Plan};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::study::convergence::Reference;
use crate::terms::functional::image_replicates;
use crate::terms::scatter::Scatter;
use crate::terms::{Estimate, TermFilm, TermImage};

/// Parameters of one figure. They are plain data, so that a command, a chapter and a test make the same figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recipe {
    /// Name, used for files and the progress display.
    pub id: &'static str,
    /// Title of the figure.
    pub title: &'static str,
    /// Name of the built-in scene.
    pub scene: &'static str,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Paths per pixel of each stage, in rising order. The first number also sets the number of replicates (2 to 16).
    pub paths: &'static [u32],
    /// Estimator of the reference.
    pub reference: Estimator,
    /// Samples per pixel of the reference.
    pub reference_spp: u32,
}

/// Kajiya's series: 4, 8, …, 128 paths per pixel.
pub const KAJIYA: Recipe = Recipe {
    id: "kajiya-series",
    title: "Kajiya's series: 4 to 128 paths per pixel",
    scene: "cornell-spheres",
    size: [128, 128],
    paths: &[4, 8, 16, 32, 64, 128],
    reference: Estimator::Bidirectional,
    reference_spp: 192,
};

/// A caustic after 10, 100 and 1000 paths per pixel: light that is hard to find.
pub const NOISE: Recipe = Recipe {
    id: "noise-paths",
    title: "A caustic by 10, 100 and 1000 paths per pixel",
    scene: "caustic",
    size: [128, 128],
    paths: &[10, 100, 1000],
    reference: Estimator::Bidirectional,
    reference_spp: 256,
};

/// The image after a given number of paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Paths per pixel.
    pub paths: u32,
    /// Linear radiance, row by row.
    pub pixels: Vec<[f32; 3]>,
    /// Image mean with its error. The number of replicates is the number of paths of the first stage (2 to 16).
    pub mean: Estimate,
    /// Variance, and squared error against the reference.
    pub scatter: Scatter,
}

/// All stages of one image, with the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The stages in rising order; after an interruption only those that were finished.
    pub stages: Vec<Stage>,
    /// Image with which the stages are compared.
    pub reference: Reference,
    /// Image mean of the reference.
    pub reference_mean: Estimate,
}

/// Renders the stages of `recipe` by path tracing, and the reference from independent random numbers. None if interrupted
/// before the first stage.
pub fn render_stages(scene: &Scene, recipe: &Recipe, settings: &Settings, progress: Progress<'_>) -> Option<Grown> {
    let reference = by_rays::terms(
        scene,
        recipe.reference,
        &Settings { spp: recipe.reference_spp, seed: reference_seed(settings.seed), ..settings.clone() },
        progress,
    );
    if progress.stopped() {
        return None;
    }
    let reference_mean = reference.series.image().total;
    let reference = Reference::from(reference);
    let (first, last) = (*recipe.paths.first()?, *recipe.paths.last()?);
    let pixels = u64::from(scene.camera.size[0]) * u64::from(scene.camera.size[1]);
    progress.begin(recipe.id, pixels * u64::from(last));
    let replicates = first.clamp(2, 16);
    let amount = Amount { spp: last, replicates: replicates as usize, key: settings.key("path", replicates as usize) };
    let tracer = PathTracer(Plan { roulette: settings.path_roulette.clone(), ..settings.plan() });
    let t = SceneTransport { scene, sampling: settings.sampling };
    let mut stages = vec![];
    let mut look = |film: &TermFilm, planned: u32| {
        let paths = film.least_samples();
        if recipe.paths.contains(&paths) {
            stages.push(Stage {
                paths,
                pixels: TermImage::of(film, 0..1).mean,
                mean: image_replicates(film).estimate(0..1),
                scatter: Scatter::of(film, 0..1, Some(&reference.total)),
            });
        }
        recipe.paths.iter().copied().find(|&n| n > paths).map_or(planned, |n| planned.min(n))
    };
    render_in_passes(&t, &scene.camera, &tracer, amount, progress, &mut look);
    (!stages.is_empty()).then_some(Grown { stages, reference, reference_mean })
}

/// A seed for the reference, such that it shares no random numbers with the run of seed `seed`.
pub fn reference_seed(seed: u64) -> u64 {
    crate::math::fnv1a(b"reference".iter().copied().chain(seed.to_le_bytes()))
}
