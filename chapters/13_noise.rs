//! Chapter 13, noise: how the error of an image falls with the number of paths, and what an error bar can promise.
//!
//! ```text
//! L_N = (X_1 + … + X_N)/N      E[L_N] = L      Var L_N = σ²/N      RMSE = σ/√N        E[min(L_N, c)] ≤ min(L, c)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_i, L_N | light of one path; a pixel of an image of N paths | [`display::image`] |
//! | σ²/N, b | variance of the pixels, and its slope against N on logarithmic axes | [`convergence::curve`] |
//! | c | the brightest radiance that a screen shows | [`display::GAIN`] |
//! | Σ n_j L_j / Σ n_j | the image of several runs of n_j paths | [`merging::merged`] |
//! | m ± t se | mean and 95 % interval from replicates | [`intervals::intervals`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997), chapter 2.
//!
//! `fredholm chapter 13`, or `cargo run --release --example 13_noise -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::math::Points;
use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::report::image::picture::shown_mean;
use fredholm::scene::{Scene, load};
use fredholm::stats::half_width_95;
use fredholm::zoo::{Mistake, Right, bookkeeping::Clamped, find};
use std::process::ExitCode;

#[path = "noise/claims.rs"]
mod claims;
#[path = "noise/convergence.rs"]
mod convergence;
#[path = "noise/display.rs"]
mod display;
#[path = "noise/exercises.rs"]
mod exercises;
#[path = "noise/figures.rs"]
mod figures;
#[path = "noise/intervals.rs"]
mod intervals;
#[path = "noise/merging.rs"]
mod merging;

pub use claims::claims;
use convergence::Curve;
use display::Display;
use intervals::{Covered, TINY};
use merging::Merged;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 13,
    name: "13_noise",
    title: "Noise",
    shows: "1/√N from 4 to 128 paths, why few paths look darker, what an error bar promises, merging, clamping",
    next: &["fredholm figure kajiya-series", "fredholm figure noise-paths", "fredholm chapter 14"],
    program,
    exercises: exercises::EXERCISES,
};

/// What a test can make wrong.
pub struct With {
    /// Mean of what a screen shows of an image at a gain.
    pub shown: fn(&[[f32; 3]], f64) -> f64,
    /// The better points of the second curve.
    pub points: Points,
    /// The mistakes of the third and the fourth curve.
    pub mistakes: [&'static dyn Mistake; 2],
    /// Seed of the run j.
    pub seed: fn(u64) -> u64,
    /// Half width of an interval, from the standard error and the number of replicates.
    pub half_width: fn(f64, u64) -> f64,
    /// Part of the sphere that the small lamp covers.
    pub lamp: f64,
}

impl Default for With {
    fn default() -> Self {
        Self {
            shown: shown_mean,
            points: Points::Sobol,
            mistakes: [find("same-numbers").map_or(&Right, |bug| bug.mistake), &Clamped(convergence::CLAMP)],
            seed: |j| j,
            half_width: half_width_95,
            lamp: TINY,
        }
    }
}

/// What the program measures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Images of 4 to 128 paths, as they are and as a screen shows them.
    pub display: Display,
    /// Error against N: independent paths, Sobol points, numbers that repeat, clamped paths.
    pub curves: [Curve; 4],
    /// The same numbers in all pixels, relative to independent pixels: noise of a pixel, error of the mean of the image.
    pub same: [Number; 2],
    /// Ten short runs in place of a long one.
    pub merged: Merged,
    /// How often the interval of a pixel covers the truth, with a large and a small lamp.
    pub covered: [Covered; 2],
}

/// A scene by its name, with changes.
fn load(name: &str, changes: &[String]) -> book::Result<Scene> {
    let options = load::Options { set: changes.to_vec(), ..load::Options::default() };
    Ok(Scene::new(&load::scene(name, &options)?.description))
}

/// Measures everything.
///
/// # Errors
/// If a scene cannot be loaded or a slope cannot be fitted, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, with: &With) -> book::Result<Measured> {
    let room = convergence::room(folder)?;
    let reference = convergence::reference(&room, folder);
    let independent: (&dyn Mistake, Points) = (&Right, Points::Independent);
    let curve = |(mistake, points)| convergence::curve(&room, mistake, points, &reference, folder);
    let [repeated, clamped] = with.mistakes.map(|mistake| (mistake, Points::Independent));
    Ok(Measured {
        display: display::measure(with.shown, folder)?,
        curves: [curve(independent)?, curve((&Right, with.points))?, curve(repeated)?, curve(clamped)?],
        same: convergence::same_in_all_pixels(&room, folder),
        merged: merging::measure(&room, with.seed, folder),
        covered: [
            intervals::measure(intervals::LARGE, with.half_width, folder)?,
            intervals::measure(with.lamp, with.half_width, folder)?,
        ],
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, &With::default())?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
