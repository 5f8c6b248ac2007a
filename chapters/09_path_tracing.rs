//! Chapter 9, path tracing: one path estimates all terms, and emission must count exactly once.
//!
//! ```text
//! X_0 = w_e E(x_0),   X_{v+1} = α_v w_c (f cos θ/p) E(y) + α_{v+1} w_s E(x_{v+1}),   α_{v+1} = α_v f cos θ/p
//! L = Σ_k T^k E = E[ Σ_k X_k ]        r_k = T_k^wrong / T_k^right        Var(Σ X_k) = Σ_jk C_jk
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_k, α_v | sample of the term k; throughput at the vertex v | [`one_path::follow`] |
//! | w_e, w_c, w_s | weights of emission at the eye, of a connection, of a hit | [`Rules`] |
//! | – | one path and own paths: means and rays | [`means`], [`rays`] |
//! | r_k | effect of a mistake on the term k | [`broken`] |
//! | C_jk | covariance of X_j and X_k along one path | [`reuse`] |
//! | K | the number of reflections at which paths are cut | [`LAST`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986); Veach, *Robust Monte Carlo Methods for Light Transport Simulation*
//! (1997), ch. 10.
//!
//! `fredholm chapter 9`, or `cargo run --release --example 09_path_tracing -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::scene::{Scene, load};
use fredholm::zoo::{self, Mistake};
use std::process::ExitCode;

#[path = "path_tracing/both_ways.rs"]
mod both_ways;
#[path = "path_tracing/broken.rs"]
mod broken;
#[path = "path_tracing/claims.rs"]
mod claims;
#[path = "path_tracing/exercises.rs"]
mod exercises;
#[path = "path_tracing/figures.rs"]
mod figures;
#[path = "path_tracing/one_path.rs"]
pub mod one_path;
#[path = "path_tracing/reuse.rs"]
pub mod reuse;
pub use both_ways::{means, rays};
pub use broken::{BROKEN, ratios};
pub use claims::claims;
pub use one_path::{Rules, difference};
use reuse::Noise;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 9,
    name: "09_path_tracing",
    title: "Path tracing: one path, all terms",
    shows: "one path for all terms, the rules of emission, reuse against separate paths",
    next: &["fredholm sweep cornell --over split", "fredholm zoo double-emission", "fredholm chapter 10"],
    program,
    exercises: exercises::EXERCISES,
};

/// K: paths are cut after so many reflections.
pub const LAST: usize = 8;

/// All that claims and figures need.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Largest difference between a pixel of the loop and of the library's path tracer, in units of the mean of the image,
    /// for each of the two sets of rules.
    pub difference: [f64; 2],
    /// Image means of T E, …, T^K E and of their sum: all from one path, and each from its own paths.
    pub means: [Vec<Number>; 2],
    /// Rays of one sample of T E, …, T^K E in a closed room: one path, own paths.
    pub rays: [f64; 2],
    /// r_0, r_1, … of the three broken rules of emission.
    pub ratios: [Vec<Number>; 3],
    /// Variances, covariances and rays, by repetition.
    pub noise: Vec<Noise>,
}

/// A built-in scene with a picture of `side`² pixels.
pub(crate) fn scene(name: &str, side: u32) -> book::Result<Scene> {
    let size = load::Options { set: vec![format!("camera.size=[{side}, {side}]")], ..Default::default() };
    Ok(Scene::new(&load::scene(name, &size)?.description))
}

/// Measures everything: with these rules of emission in the loop, these mistakes, and this closed room.
///
/// # Errors
/// If a scene cannot be loaded, or the program was stopped.
pub fn measure(
    folder: &Folder<'_>,
    rules: [Rules; 2],
    mistakes: [&dyn Mistake; 3],
    closed: &str,
) -> book::Result<Measured> {
    let of = |i: usize| ratios(folder, &BROKEN[i], mistakes[i]);
    Ok(Measured {
        difference: difference(folder, rules)?,
        means: means(folder)?,
        rays: rays(folder, closed)?,
        ratios: [of(0)?, of(1)?, of(2)?],
        noise: reuse::repetitions(folder)?,
    })
}

/// The mistake of a member of the zoo.
///
/// # Errors
/// If there is no such member.
pub fn mistake(name: &str) -> book::Result<&'static dyn Mistake> {
    Ok(zoo::find(name).ok_or_else(|| format!("the zoo has no member {name}"))?.mistake)
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let [double, missing, mirror] = BROKEN.map(|b| mistake(b.name));
    let m = measure(folder, [Rules::CONNECT, Rules::MIS], [double?, missing?, mirror?], "furnace")?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
