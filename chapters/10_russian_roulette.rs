//! Chapter 10, Russian roulette: paths end at random, survivors weigh more, the mean stays right. What is the price?
//!
//! ```text
//! E[ X 1{alive}/Q ] = X          E[S²] = Σ_jk M_jk/Q_min(j,k)          Var < ∞  where  r(ρ²F/(1 − q)) < 1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | q, s = 1 − q | probability of **termination** after a vertex is scored; of survival | [`Roulette`] |
//! | P, S | probability of one way the roulette can fall; what the path has then scored | [`enumeration`] |
//! | M_jk, Q_v | mean products of terms without roulette; probability of reaching vertex v | [`moments`] |
//! | r(ρ²F) | factor per bounce of the squared weight of a path: from a matrix, and from paths | [`radius`], [`weights`] |
//! | V · rays | variance of one path times its rays: the price of a schedule | [`schedules`] |
//!
//! Reference: Arvo and Kirk, *Particle transport and image synthesis* (SIGGRAPH 1990).
//!
//! `fredholm chapter 10`, or `cargo run --release --example 10_russian_roulette -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::estimator::Roulette;
use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::scene::description::Description;
use fredholm::scene::{Scene, load};
use fredholm::study::enumeration::{Errors, mean};
use std::process::ExitCode;

#[path = "russian_roulette/claims.rs"]
mod claims;
#[path = "russian_roulette/enumeration.rs"]
mod enumeration;
#[path = "russian_roulette/exercises.rs"]
mod exercises;
#[path = "russian_roulette/figures.rs"]
mod figures;
#[path = "russian_roulette/furnace.rs"]
mod furnace;
#[path = "russian_roulette/moments.rs"]
mod moments;
#[path = "russian_roulette/one_pixel.rs"]
mod one_pixel;
#[path = "russian_roulette/radius.rs"]
mod radius;
#[path = "russian_roulette/schedules.rs"]
mod schedules;
#[path = "russian_roulette/weights.rs"]
mod weights;
#[path = "russian_roulette/wrong.rs"]
mod wrong;

use claims::exact;
use radius::radius;

pub use claims::claims;
pub use enumeration::enumerate;
pub use furnace::{IN_FURNACE, in_furnace};
pub use moments::{Prices, moments};
pub use one_pixel::{Paths, paths};
pub use radius::Radius;
pub use schedules::Row;
pub use weights::{Weights, weights};
pub use wrong::{Wrong, wrong};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 10,
    name: "10_russian_roulette",
    title: "Russian roulette",
    shows: "why it is unbiased, what it costs, where its variance is infinite, which schedule is best",
    next: &["fredholm roulette cornell --enumerate", "fredholm roulette cornell --optimise", "fredholm chapter 11"],
    program,
    exercises: exercises::EXERCISES,
};
/// The schedule of the student's story: paths survive with probability 0.35.
pub const STUDENT: Roulette = Roulette::Constant { from: 2, q: 0.65 };

/// What the program measures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The largest errors of the enumeration, over some schedules.
    pub enumerated: Errors,
    /// Variance of one path in the furnace, for each of [`IN_FURNACE`].
    pub furnace: Vec<Number>,
    /// What follows from moments without roulette: the variance of schedules, and their price.
    pub prices: Prices,
    /// E[W_k²] without roulette, and its factor per bounce.
    pub weights: Weights,
    /// That factor from the matrix, on two meshes; the last one is finer.
    pub radius: [Radius; 2],
    /// Paths through one pixel with roulette by albedo, with the lecture's, and with that of [`STUDENT`].
    pub seen: [Paths; 3],
    /// r_k of wrong roulette.
    pub wrong: Vec<Wrong>,
}

/// A scene with a square image.
pub(crate) fn load(name: &str, side: u32) -> book::Result<(Scene, Description)> {
    let options = load::Options { set: vec![format!("camera.size=[{side}, {side}]")], ..load::Options::default() };
    let description = load::scene(name, &options)?.description;
    Ok((Scene::new(&description), description))
}

/// Measures everything.
///
/// # Errors
/// If a scene cannot be loaded, or if the program is stopped.
pub fn measure(folder: &Folder<'_>) -> book::Result<Measured> {
    let meshes = folder.pick([300, 1200], [75, 300]);
    Ok(Measured {
        enumerated: enumerate(folder, mean)?,
        prices: moments(folder, |q| q)?,
        furnace: IN_FURNACE.into_iter().map(|q| in_furnace(folder, q)).collect::<book::Result<_>>()?,
        radius: [radius(meshes[0], folder)?, radius(meshes[1], folder)?],
        seen: [
            paths(folder, &Roulette::Albedo { from: 2 }, folder.pick(32, 4))?,
            paths(folder, &Roulette::LECTURE, folder.pick(32, 2))?,
            paths(folder, &STUDENT, folder.pick(32, 8))?,
        ],
        weights: weights(folder, 2)?,
        wrong: wrong(folder)?,
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
