//! Chapter 15, the spectrum, and walking with a map: what the eigenvalues of T decide, and what a known solution is worth.
//!
//! ```text
//! T u_j = λ_j u_j,  E = Σ c_j u_j  ⇒  T^k E = Σ λ_j^k c_j u_j          |λ_1| = r(T): the rate of late terms
//! steps for a factor 10^−d:  d ln 10/ln(1/λ_1) by Neumann,  d ln 10/ln(1/q) by Chebyshev,  q = (√c − 1)/(√c + 1)
//! map v:  p_ij = T_ij v_j/(T v)_i,  q_i = E_i/(E_i + (T v)_i)            v = B: every walk gives B_i
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | λ_j, u_j, c_j | eigenvalues and modes of T, parts of E | [`spectrum`] |
//! | c | (1 − λ_min)/(1 − λ_1) | [`solvers`] |
//! | v, B | the map, the solution; walks on the matrix of the closed cube | [`walks`] |
//! | v in a scene | a radiosity solution that chooses the directions of rays | [`room`] |
//!
//! All numbers of the matrix are those of the red channel.
//!
//! References: Parlett, *The Symmetric Eigenvalue Problem* (1980); Varga, *Matrix Iterative Analysis* (1962); Kalos and
//! Whitlock, *Monte Carlo Methods* (1986); Hoogenboom, *Zero-variance Monte Carlo schemes revisited* (2008).
//!
//! `fredholm chapter 15`, or `cargo run --release --example 15_spectrum_and_guiding -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::by_matrix::{self, Matrix};
use fredholm::operator::modes::Modes;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::{Scene, load};
use fredholm::solver::Radiosity;
use fredholm::solver::comparison::System;
use std::process::ExitCode;

#[path = "spectrum_and_guiding/claims.rs"]
mod claims;
#[path = "spectrum_and_guiding/exercises.rs"]
mod exercises;
#[path = "spectrum_and_guiding/figures.rs"]
mod figures;
#[path = "spectrum_and_guiding/room.rs"]
pub mod room;
#[path = "spectrum_and_guiding/solvers.rs"]
pub mod solvers;
#[path = "spectrum_and_guiding/spectrum.rs"]
pub mod spectrum;
#[path = "spectrum_and_guiding/walks.rs"]
pub mod walks;

pub use claims::claims;
use room::Seen;
use solvers::{Brighter, Errors};
use spectrum::Spectrum;
use walks::Walks;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 15,
    name: "15_spectrum_and_guiding",
    title: "The spectrum, and walking with a map",
    shows: "modes of T predict bounces and solvers; a map removes noise, and a wrong map costs only noise",
    next: &[
        "fredholm radiosity cornell --modes 8",
        "fredholm radiosity cornell --solver all",
        "fredholm walk cornell --patches 200 --estimator zero-variance",
        "fredholm chapter 16",
    ],
    program,
    exercises: exercises::EXERCISES,
};

const RED: usize = 0;

/// What can be made wrong, one at a time.
#[derive(Clone, Copy)]
pub struct Ingredients {
    /// The weight w of the inner product of the modes: A/ρ.
    pub weight: spectrum::Weigh,
    /// λ^k, the factor of a mode in the term k.
    pub power: fn(f64, usize) -> f64,
    /// The interval of eigenvalues that Chebyshev's iteration is given.
    pub interval: fn(&[f64]) -> [f64; 2],
    /// The map that is said to be exact, from B and E.
    pub map: fn(&[f64], &[f64]) -> Vec<f64>,
    /// The weight of a step of a walk.
    pub step: walks::StepWeight,
}

/// The right ones.
pub const RIGHT: Ingredients = Ingredients {
    weight: |t| t.weight(),
    power: |lambda, k| lambda.powi(k as i32),
    interval: spectrum::ends,
    map: |b, _| b.to_vec(),
    step: |_, _, step| f64::from(step.weight.x),
};

/// All that claims and figures need.
#[derive(Clone)]
pub struct Measured {
    /// The modes of the Cornell box, and the terms.
    pub spectrum: Spectrum,
    /// Errors of the solvers in the Cornell box.
    pub errors: Errors,
    /// The work of the solvers in brighter and brighter rooms.
    pub brighter: Vec<Brighter>,
    /// Walks on the matrix of the cube.
    pub walks: Walks,
    /// T²E in the room with the lamp turned up: without a map, with its map, with the map of another room.
    pub seen: [Seen; 3],
}

/// Measures everything.
///
/// # Errors
/// If a scene cannot be loaded or has no matrix, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, with: &Ingredients) -> book::Result<Measured> {
    let cornell = matrix(folder, "cornell", folder.pick(600, 200))?;
    let (t, e) = (cornell.radiosity.operator(RED), cornell.radiosity.emission(RED));
    let modes = Modes::of(&t, spectrum::SHOWN);
    let system = System::new(&t, e.clone())?;
    Ok(Measured {
        spectrum: Spectrum::measure(&t, &e, &modes, with),
        errors: Errors::measure(&system, &modes.values, with.interval),
        brighter: solvers::brighter(&matrix(folder, "cornell", 200)?)?,
        walks: Walks::measure(folder, &matrix(folder, "cube", 54)?, with)?,
        seen: room::seen(folder)?,
    })
}

/// The matrix of a built-in scene.
fn matrix(folder: &Folder<'_>, scene: &str, patches: usize) -> book::Result<Matrix<Radiosity>> {
    let room = load::scene(scene, &load::Options::default())?.description;
    Ok(by_matrix::dense_matrix(&room, &Scene::new(&room), patches, 1.0, 0, folder.progress)?)
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, &RIGHT)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
