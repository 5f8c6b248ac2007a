//! Ten short runs in place of a long one.
//!
//! ```text
//! L = Σ_j n_j L_j / Σ_j n_j        V(ten runs of n paths) = V(one run of 10 n paths) = σ²/(10 n)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_j, n_j | image of the run j, and its paths per pixel | [`run`] |
//! | L | the merged image | [`merged`] |
//! | V | variance of the pixels, from 48 replicates | [`Merged::variance`] |

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{Folder, Number};
use fredholm::scene::Scene;
use fredholm::terms::TermFilm;
use fredholm::terms::scatter::{Scatter, jackknife};
use glam::DVec3;

/// Runs, and the paths per pixel of each.
const RUNS: u64 = 10;
const PATHS: u32 = 48;
const REPLICATES: usize = 48;

/// Ten runs of n paths, compared with one run of 10 n paths.
#[derive(Clone, Copy, Debug)]
pub struct Merged {
    /// Variance of the merged image over that of the long run.
    pub variance: Number,
    /// Means of the merged image and of the long run.
    pub means: [Number; 2],
    /// Largest relative difference between the average of the ten images and all light divided by all paths.
    pub rounding: f64,
}

fn run(room: &Scene, spp: u32, key: Key, folder: &Folder<'_>) -> TermFilm {
    let plan = Plan { max_bounces: 2, technique: Technique::Connect, roulette: Roulette::Never };
    let amount = Amount { spp, replicates: REPLICATES, key };
    render(&SceneTransport::new(room), &room.camera, &Prefix(plan), amount, folder.progress)
}

fn light(film: &TermFilm, pixel: usize, replicate: usize) -> DVec3 {
    (0..film.shape.slots).map(|slot| film.sum(pixel, replicate, slot)).sum()
}

// ANCHOR: merged
/// One pixel of the image of several runs: all light divided by all paths.
pub(super) fn merged(runs: &[TermFilm], pixel: usize) -> DVec3 {
    let paths: f64 = runs.iter().map(|run| f64::from(run.samples[pixel])).sum();
    let all = |run: &TermFilm| (0..REPLICATES).map(|r| light(run, pixel, r)).sum::<DVec3>();
    runs.iter().map(all).sum::<DVec3>() / paths
}
// ANCHOR_END: merged

/// V of the merged image and its error: replicate r of all runs together is replicate r of the merged image.
fn variance(runs: &[TermFilm]) -> Number {
    let (r, pixels) = (REPLICATES as f64, runs[0].shape.pixels());
    let mut squares = [0.0; REPLICATES];
    for p in 0..pixels {
        let mean = merged(runs, p);
        for (i, square) in squares.iter_mut().enumerate() {
            let paths: f64 = runs.iter().map(|run| run.count(p, i)).sum();
            let all: DVec3 = runs.iter().map(|run| light(run, p, i)).sum();
            *square += (all / paths - mean).length_squared() / (3.0 * pixels as f64);
        }
    }
    let all: f64 = squares.iter().sum();
    let without = squares.iter().map(|q| (all - q * r / (r - 1.0)) / (r * (r - 2.0)));
    Number { value: all / (r * (r - 1.0)), std_error: jackknife(without) }
}

/// Mean over pixels and channels of the merged image, and its error.
fn mean(runs: &[TermFilm]) -> Number {
    let pixels = runs[0].shape.pixels();
    let of = |i: usize| {
        let paths: f64 = runs.iter().map(|run| run.count(0, i)).sum();
        let all: DVec3 = (0..pixels).flat_map(|p| runs.iter().map(move |run| light(run, p, i))).sum();
        all.element_sum() / (3.0 * pixels as f64 * paths)
    };
    let all: Vec<f64> = (0..REPLICATES).map(of).collect();
    let e = fredholm::stats::estimate(&all.iter().map(|&x| DVec3::splat(x)).collect::<Vec<_>>());
    Number::from(&e)
}

/// Renders ten runs with the seeds `seed(0)`, `seed(1)`, …, and a long run with another stream of random numbers.
pub(super) fn measure(room: &Scene, seed: fn(u64) -> u64, folder: &Folder<'_>) -> Merged {
    let first = folder.seed.wrapping_mul(RUNS);
    let short = |j: u64| run(room, PATHS, Key::new(first.wrapping_add(seed(j)), "short"), folder);
    let runs: Vec<TermFilm> = (0..RUNS).map(short).collect();
    let long = [run(room, RUNS as u32 * PATHS, Key::new(folder.seed, "long"), folder)];
    let apart = |p: usize| {
        let average = runs.iter().map(|run| run.pixel(p, 0..run.shape.slots).0).sum::<DVec3>() / RUNS as f64;
        let all = merged(&runs, p);
        (average - all).abs().max_element() / all.max_element()
    };
    // the library's own variance of the long run
    let scatter = Scatter::of(&long[0], 0..long[0].shape.slots, None);
    let of_long = Number { value: scatter.variance(), std_error: scatter.variance_error() };
    Merged {
        variance: variance(&runs).over(of_long),
        means: [mean(&runs), mean(&long)],
        rounding: (0..runs[0].shape.pixels()).map(apart).fold(0.0, f64::max),
    }
}
