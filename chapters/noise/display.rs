//! Images of N paths, as they are and as a screen shows them.
//!
//! ```text
//! mean of L_N = mean of L for every N        shown: min(L_N, c), so E[min(L_N, c)] ≤ min(L, c)      c = 1/gain
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_N | reflected light: everything but the lamp that the camera sees directly | [`image`] |
//! | c | the brightest radiance that a screen shows | [`GAIN`] |
//! | RMSE(N) | standard deviation of a pixel among independent images, root mean square over the image | [`spread`] |
//!
//! One film of 1024 paths per pixel is divided into 256 images of 4 paths, 128 images of 8 paths, …, 8 images of 128 paths.
//! Errors come from leaving out one of eight parts of the film (the jackknife), because all of these images share paths.

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::picture::{develop, mean};
use fredholm::scene::Scene;
use fredholm::terms::TermFilm;
use fredholm::terms::scatter::jackknife;
use std::ops::Range;

/// The gain of the pictures, that of the figure `kajiya-series`: a radiance above 1/3 is shown as white.
pub(super) const GAIN: f64 = 3.0;
/// Numbers of paths of an image.
pub(super) const PATHS: [u32; 6] = [4, 8, 16, 32, 64, 128];
/// Independent parts of the film, each of 128 paths.
const PARTS: usize = 8;
/// Images of 4 paths in a part.
const LEAST: usize = 32;

/// Statistics of the images of N paths.
#[derive(Clone, Copy, Debug)]
pub struct Images {
    /// N.
    pub paths: u32,
    /// Mean of the images.
    pub mean: Number,
    /// Mean of what a screen shows.
    pub shown: Number,
    /// Part of the pixels that a screen cannot show.
    pub clipped: Number,
    /// RMSE of an image of N paths.
    pub rmse: Number,
}

/// What screens show.
#[derive(Clone, Debug)]
pub struct Display {
    /// One entry for each of [`PATHS`].
    pub images: Vec<Images>,
    /// Mean of an independent reference.
    pub reference: Number,
    /// RMSE with 128 paths over that with 4 paths.
    pub ratio: Number,
    /// Mean shown with 4 paths over that with 128 paths.
    pub darker: Number,
}

fn film(scene: &Scene, spp: u32, stream: &str, folder: &Folder<'_>) -> TermFilm {
    let plan = Plan { max_bounces: 0, technique: Technique::Mis, roulette: Roulette::Albedo { from: 2 } };
    let amount = Amount { spp, replicates: PARTS * LEAST, key: Key::new(folder.seed, stream) };
    render(&SceneTransport::new(scene), &scene.camera, &Prefix(plan), amount, folder.progress)
}

// ANCHOR: image
/// The image of the paths of some replicates of a film. Slot 1 holds all paths with at least one reflection.
pub(super) fn image(film: &TermFilm, replicates: Range<usize>) -> Vec<[f32; 3]> {
    let pixel = |p: usize| {
        let paths: f64 = replicates.clone().map(|r| film.count(p, r)).sum();
        let light: glam::DVec3 = replicates.clone().map(|r| film.sum(p, r, 1)).sum();
        (light / paths).as_vec3().to_array()
    };
    (0..film.shape.pixels()).map(pixel).collect()
}
// ANCHOR_END: image

/// ⟨Σ (L − mean of the images)²⟩/(number − 1), the square of the RMSE.
fn spread(images: &[&Vec<[f32; 3]>]) -> f64 {
    let (n, values) = (images.len() as f64, images[0].len() * 3);
    let of = |i: usize| {
        let at = |image: &&Vec<[f32; 3]>| f64::from(image[i / 3][i % 3]);
        let mean = images.iter().map(at).sum::<f64>() / n;
        images.iter().map(|image| (at(image) - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..values).map(of).sum::<f64>() / values as f64
}

/// Mean, mean shown, part that is clipped and RMSE, with and without each part of the film.
struct Row {
    paths: u32,
    /// The four numbers of the whole film, then of the film without part 0, 1, ….
    all: Vec<[f64; 4]>,
}

impl Row {
    fn new(film: &TermFilm, paths: u32, shown: fn(&[[f32; 3]], f64) -> f64) -> Self {
        let step = (paths / PATHS[0]) as usize;
        let images: Vec<_> = (0..PARTS * LEAST).step_by(step).map(|r| image(film, r..r + step)).collect();
        let clipped = |image: &Vec<[f32; 3]>| develop(image.len(), 1, image, GAIN).clipped as f64 / image.len() as f64;
        let found: Vec<[f64; 3]> = images.iter().map(|i| [mean(i), shown(i, GAIN), clipped(i)]).collect();
        let per_part = LEAST / step;
        let without = |part: usize| {
            let kept: Vec<usize> = (0..images.len()).filter(|i| i / per_part != part).collect();
            let average = |q: usize| kept.iter().map(|&i| found[i][q]).sum::<f64>() / kept.len() as f64;
            let kept: Vec<_> = kept.iter().map(|&i| &images[i]).collect();
            [average(0), average(1), average(2), spread(&kept).sqrt()]
        };
        Self { paths, all: [PARTS].into_iter().chain(0..PARTS).map(without).collect() }
    }

    fn number(&self, q: usize) -> Number {
        number(|i| self.all[i][q])
    }

    fn images(&self) -> Images {
        let [mean, shown, clipped, rmse] = [0, 1, 2, 3].map(|q| self.number(q));
        Images { paths: self.paths, mean, shown, clipped, rmse }
    }
}

/// A number of the whole film (i = 0), with its error from the films without a part.
fn number(of: impl Fn(usize) -> f64) -> Number {
    Number { value: of(0), std_error: jackknife((1..=PARTS).map(&of)) }
}

/// Renders, divides and compares. `shown` is the mean of what a screen shows.
pub(super) fn measure(shown: fn(&[[f32; 3]], f64) -> f64, folder: &Folder<'_>) -> book::Result<Display> {
    let size = folder.pick(64, 32);
    let scene = super::load("cornell-spheres", &[format!("camera.size=[{size}, {size}]")])?;
    let paths = PARTS as u32 * PATHS[5];
    let (images, other) = (film(&scene, paths, "images", folder), film(&scene, paths / 2, "reference", folder));
    let rows = PATHS.map(|n| Row::new(&images, n, shown));
    let reference = Row::new(&other, PATHS[0], shown).number(0);
    let [few, .., many] = &rows;
    Ok(Display {
        images: rows.iter().map(Row::images).collect(),
        reference,
        ratio: number(|i| many.all[i][3] / few.all[i][3]),
        darker: number(|i| few.all[i][1] / many.all[i][1]),
    })
}
