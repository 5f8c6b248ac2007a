//! Chapter 1, one box, three answers: the light in a Cornell box from the series, a path tracer and a matrix.
//!
//! ```text
//! L = E + T L = Σ T^k E,   k = 0, 1, …, K, and the tail
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T^k E | the term of k reflections, an image with errors | `Answers::series` |
//! | L | the whole image, by one path for all terms | `Answers::path` |
//! | T_h^k E | the terms of the matrix on patches of width h | `Answers::matrix` |
//! | ‖T^k E‖₁ | mean of a term over all surfaces | `Answers::norms` |
//!
//! `fredholm chapter 1`, or `cargo run --release --example 01_one_box_three_answers -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::Settings;
use fredholm::engine::by_matrix::Discrete;
use fredholm::engine::by_rays::{Estimator, Sampled};
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::report::image::picture;
use fredholm::report::text::number::significant;
use fredholm::scene::{Scene, SceneError, load};
use fredholm::stats::{Comparison, Criterion, compare, discretisation};
use fredholm::study::run::{Asked, Run};
use fredholm::terms::{TermImage, functional::Replicates};
use glam::Vec3;
use std::process::ExitCode;

#[path = "one_box_three_answers/claims.rs"]
mod claims;
#[path = "one_box_three_answers/exercises.rs"]
mod exercises;
#[path = "one_box_three_answers/figures.rs"]
mod figures;

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 1,
    name: "01_one_box_three_answers",
    title: "One box, three answers",
    shows: "Σ TᵏE, a path tracer and a matrix agree on a Cornell box; ‖TᵏE‖₁ stays below its bound",
    next: &["fredholm", "fredholm series --max-bounces 2", "fredholm chapter 2"],
    program,
    exercises: exercises::EXERCISES,
};

// ANCHOR: setup
fn setup(folder: &Folder<'_>) -> Result<Run, SceneError> {
    let [pixels, spp] = folder.pick([168, 128], [96, 64]);
    let small = load::Options { set: vec![format!("camera.size=[{pixels}, {pixels}]")], ..Default::default() };
    let room = load::scene("cornell", &small)?.description;
    let scene = Scene::new(&room);
    let settings = Settings { spp, seed: folder.seed, max_bounces: 8, patches: 600, ..Settings::default() };
    // each term has its own paths; the norms ‖T^k E‖₁ are estimated in the same way, but from all surfaces instead of the
    // camera
    let (estimators, surface) = (vec![Estimator::Single], vec![Estimator::Single]);
    let asked = Asked { estimators, surface, bounces: false, moments: false, ..Asked::default() };
    Ok(Run::new(room, scene, settings, asked))
}
// ANCHOR_END: setup

// ANCHOR: three_answers
/// The solved room, and the margin δ of a comparison as a fraction of the term.
pub struct Measured {
    /// The room with its results.
    pub run: Run,
    /// δ: an answer agrees if its difference is proved to be smaller than this fraction of the term.
    pub margin: f64,
}

struct Answers<'a> {
    series: &'a Sampled,
    path: &'a Sampled,
    matrix: &'a Discrete,
    norms: &'a Replicates,
}

/// Solves the room three times.
pub fn measure(folder: &Folder<'_>) -> book::Result<Measured> {
    let mut run = setup(folder)?;
    run.solve(folder.progress)?;
    Ok(Measured { run, margin: folder.pick(0.02, 0.05) })
}

fn answers(run: &Run) -> Option<Answers<'_>> {
    let [series] = run.terms.as_slice() else { return None };
    Some(Answers { series, path: run.path.as_ref()?, matrix: run.radiosity.as_ref()?, norms: run.norms()? })
}
// ANCHOR_END: three_answers

// ANCHOR: compare
fn comparisons(a: &Answers<'_>, margin: f64) -> [(&'static str, Comparison); 2] {
    let criterion = Criterion { of_term: margin, ..Criterion::default() };
    let (fine, coarse) = (&a.matrix.fine.series, &a.matrix.coarse.series);
    let mesh = discretisation(fine, coarse); // what the mesh can explain: patches − patches of twice the width
    let path = compare(&a.series.series, &a.path.series, &criterion, &[]);
    let matrix = compare(&a.series.series, fine, &criterion, &mesh);
    [("series − path tracer", path), ("series − matrix", matrix)]
}
// ANCHOR_END: compare

/// The mean of an image over the pixels that show only the ceiling.
fn on_ceiling(scene: &Scene, image: &TermImage) -> f64 {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let ceiling = |p: Vec3| scene.origin().y + f64::from(p.y) > 0.999; // the lamp hangs a centimetre lower
    let seen = |pixel: u32, u: [f32; 2]| {
        let (start, direction) = scene.camera.ray(pixel, u);
        scene.trace(start, direction)
    };
    let inside = |pixel: &usize| corners.iter().all(|&u| seen(*pixel as u32, u).is_some_and(|hit| ceiling(hit.p)));
    let pixels: Vec<[f32; 3]> = (0..image.mean.len()).filter(inside).map(|p| image.mean[p]).collect();
    picture::mean(&pixels)
}

fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

/// Solves, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder)?;
    let interrupted = "an answer is missing: the run was interrupted";
    let a = answers(&m.run).ok_or(interrupted)?;
    figures::write(folder, &m, &a)?;
    Ok(claims(&m).ok_or(interrupted)?)
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
