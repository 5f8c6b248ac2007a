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
use fredholm::engine::by_matrix::{Discrete, MatrixError};
use fredholm::engine::by_rays::{Estimator, Sampled};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::report::figures::decay::{self, Decay, RateLine};
use fredholm::report::plot::{Curve, Look};
use fredholm::report::text::table::{average, significant};
use fredholm::report::{
    image::{contact_sheet, picture},
    text::markdown,
};
use fredholm::scene::{Scene, SceneError, load};
use fredholm::stats::{Comparison, Outcome, TermMeans};
use fredholm::study::run::{Asked, Run};
use fredholm::terms::{TermImage, functional::Replicates};
use glam::Vec3;
use std::process::ExitCode;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 1,
    name: "01_one_box_three_answers",
    title: "One box, three answers",
    shows: "Σ TᵏE, a path tracer and a matrix agree on a Cornell box; ‖TᵏE‖₁ stays below its bound",
    next: &["fredholm", "fredholm series --max-bounces 2", "fredholm chapter 2"],
    program,
};

// ANCHOR: setup
fn setup(folder: &Folder<'_>) -> Result<Run, SceneError> {
    let small = load::Options { set: vec!["camera.size=[96, 96]".into()], ..Default::default() };
    let room = load::scene("cornell", &small)?.description;
    let scene = Scene::new(&room);
    let settings = Settings { spp: folder.pick(256, 64), max_bounces: 8, patches: 600, ..Settings::default() };
    // each term has its own paths; the norms ‖T^k E‖₁ are estimated in the same way, but from all surfaces instead of the
    // camera
    let (estimators, surface) = (vec![Estimator::Single], vec![Estimator::Single]);
    Ok(Run::new(room, scene, settings, Asked { estimators, surface, ..Asked::default() }))
}
// ANCHOR_END: setup

// ANCHOR: three_answers
struct Answers<'a> {
    series: &'a Sampled,
    path: &'a Sampled,
    matrix: &'a Discrete,
    norms: &'a Replicates,
}

fn solve(mut run: Run, progress: Progress<'_>) -> Result<Run, MatrixError> {
    run.solve(progress)?;
    Ok(run)
}

fn answers(run: &Run) -> Option<Answers<'_>> {
    let [series] = run.terms.as_slice() else { return None };
    Some(Answers { series, path: run.path.as_ref()?, matrix: run.radiosity.as_ref()?, norms: run.norms()? })
}
// ANCHOR_END: three_answers

// ANCHOR: compare
fn verdicts(run: &Run) -> Option<[(&'static str, &Comparison); 2]> {
    // the run has compared its first result with each of the others
    let [path, matrix] = run.verdicts.as_slice() else { return None };
    Some([("series − path tracer", &path.comparison), ("series − matrix", &matrix.comparison)])
}
// ANCHOR_END: compare

// ANCHOR: claim
fn claims(scene: &Scene, a: &Answers<'_>, [(_, path), (_, matrix)]: [(&str, &Comparison); 2]) -> Vec<Claim> {
    let k = a.norms.mean.len() - 2; // K, because the last entry is the tail
    let proved = |c: &Comparison| {
        let rows = c.rows.iter().filter(|row| row.outcome == Outcome::Agrees);
        format!("agree: {}", rows.map(|row| row.name.as_str()).collect::<Vec<_>>().join(", "))
    };
    let (same_as_path, same_as_matrix) = (proved(path), proved(matrix));

    // norms and bounds in every channel, with a margin of five standard errors
    let g = scene.max_albedo().as_dvec3();
    let emission = a.matrix.matrix.surface[0]; // without noise
    let seen = |n: usize| a.norms.estimate(n..n + 1).mean + 5.0 * a.norms.estimate(n..n + 1).std_error;
    let of_bound = |n: usize| (seen(n) / (emission * g.powf(n as f64))).max_element();
    let term = (1..=k).map(of_bound).fold(0.0, f64::max);
    let tail = (seen(k + 1) / (a.norms.mean[k] * g / (1.0 - g))).max_element();

    let lit = (1..=k).find(|&n| on_ceiling(scene, &a.series.terms[n]) > 0.0).unwrap_or(0);
    let left = average(&a.series.series.image().tail).0 / average(&a.series.series.image().total).0;
    let claim = |holds: bool, says, found: String| Claim { says, found, holds };
    vec![
        claim(same_as_path.contains("total"), "terms and tail add up to the path tracer's image", same_as_path),
        // T1 through the camera is read from E, so that T2 is the first term that tests the matrix
        claim(same_as_matrix.contains("T2"), "the term k = 2 agrees with the matrix", same_as_matrix.clone()),
        claim(same_as_matrix.contains("total"), "the whole image agrees with the matrix", same_as_matrix),
        claim(
            matrix.outcome != Outcome::Differs,
            "no term differs significantly from the matrix",
            format!("{:?}", matrix.outcome),
        ),
        claim(term < 1.0, "no term exceeds its bound", format!("at most {} of the bound", percent(term))),
        claim(tail < 1.0, "the tail does not exceed its bound", format!("at most {} of the bound", percent(tail))),
        claim(lit == 2, "k = 2 is the first term that lights the ceiling", format!("k = {lit}")),
        claim(left.log10().round() == -2.0, "about a hundredth of the light is left after k = 8", percent(left)),
    ]
}
// ANCHOR_END: claim

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

const NORM: &str = "all surfaces, $\\norm{\\T^k E}_1$";

/// Solves, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let solved = solve(setup(folder)?, folder.progress)?;
    let answers = answers(&solved).ok_or("an answer is missing: the run was interrupted")?;
    let verdicts = verdicts(&solved).ok_or("a comparison is missing: the run was interrupted")?;
    let claims = claims(&solved.scene, &answers, verdicts);

    let surface = answers.norms.functional("surface");
    let images = [&answers.series.series, &answers.matrix.fine.series, &answers.path.series].map(|s| s.image());
    let columns = [("series", images[0]), ("matrix", images[1]), ("path tracer", images[2]), (NORM, &surface)];
    folder.text("terms.md", &markdown::terms(&columns))?;
    folder.text("verdicts.md", &verdicts.map(|(name, c)| markdown::verdicts(name, c)).join("\n"))?;
    figures(folder, &solved, &answers)?;
    Ok(claims)
}

fn figures(folder: &Folder<'_>, run: &Run, a: &Answers<'_>) -> book::Result<()> {
    let (scene, settings) = (&run.scene, &run.settings);
    let caption = folder.caption("cornell");
    let [w, h] = scene.camera.size.map(|n| n as usize);
    let images: Vec<&[[f32; 3]]> = a.series.terms.iter().map(|t| t.mean.as_slice()).collect();
    let note = format!("{} paths per pixel and term", settings.spp);
    folder.picture(
        "terms.png",
        &contact_sheet::terms(w, h, &images, Some(&a.series.total.mean), &note, &caption)?.picture,
    )?;

    let matrix = run.norms_of_matrix().unwrap_or_default();
    let (series, k) = (TermMeans::from(a.norms), settings.max_bounces);
    let g = run.guaranteed_rate().max_element();
    let curve = |label: &str, terms: &TermMeans, look| Curve { label: label.into(), points: decay::norms(terms), look };
    let surface =
        vec![curve("series", &series, Look::SINGLE), curve("matrix", &TermMeans::exact(&matrix), Look::MATRIX)];
    let lines = [Some(RateLine::guaranteed(g, matrix[0])), RateLine::tail_bound(g, k, series.mean[k])];
    let lines = lines.into_iter().flatten().collect();
    let figure = Decay { title: "How the terms decay".into(), surface, lines, ..Decay::default() };
    folder.figure("decay", &decay::draw(&figure, &caption)?)?;
    Ok(())
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
