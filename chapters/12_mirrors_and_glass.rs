//! Chapter 12, mirrors and glass: BSDFs with one or two directions, and light that only some estimators find.
//!
//! ```text
//! f = F δ(ω_i − r)/cos θ + (1 − F) δ(ω_i − t)/(η² |cos θ|)        T L = F L_r + (1 − F) L_t/η²
//! L (S | D)* E: a path from the lamp L to the eye E, with a letter for each reflection
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | F(θ) | part of the light that glass reflects, by Fresnel's formula and counted in samples | [`fresnel`], [`angles`] |
//! | θ_c | critical angle | [`critical`] |
//! | L = 1 | what glass shows under a sky of radiance 1 | [`furnace`] |
//! | p | probability of reflection | [`choice`] |
//! | S, D | a delta vertex; any other vertex | [`found`], [`caustic()`] |
//!
//! References: Born and Wolf, *Principles of Optics* (7th ed. 1999), section 1.5; Heckbert, *Adaptive radiosity textures
//! for bidirectional ray tracing* (1990), for the letters.
//!
//! `fredholm chapter 12`, or `cargo run --release --example 12_mirrors_and_glass -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::zoo::Right;
use std::process::ExitCode;

#[path = "mirrors_and_glass/caustic.rs"]
mod caustic;
#[path = "mirrors_and_glass/claims.rs"]
mod claims;
#[path = "mirrors_and_glass/exercises.rs"]
mod exercises;
#[path = "mirrors_and_glass/figures.rs"]
mod figures;
#[path = "mirrors_and_glass/glass.rs"]
mod glass;
#[path = "mirrors_and_glass/interface.rs"]
mod interface;

pub use caustic::{Found, Light, caustic, found};
pub use claims::claims;
pub use glass::{Choice, choice, furnace, plate};
pub use interface::{Angle, angles, critical, fresnel};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 12,
    name: "12_mirrors_and_glass",
    title: "Mirrors and glass",
    shows: "delta BSDFs, Fresnel, total reflection, glass under a white sky, light that only some estimators find",
    next: &[
        "fredholm zoo no-emission-after-mirror",
        "fredholm series caustic --estimator light",
        "fredholm chapter 13",
    ],
    program,
    exercises: exercises::EXERCISES,
};

/// Index of refraction of the glass, and of the plate.
const GLASS: f64 = 1.5;
const DIAMOND: f64 = 2.42;

/// All that claims and figures need.
#[derive(Clone)]
pub struct Measured {
    /// The part of the samples that is reflected, at several angles on both sides.
    pub angles: Vec<Angle>,
    /// The critical angle in degrees.
    pub critical: f64,
    /// What a plate transmits, with all reflections inside.
    pub plate: Number,
    /// Largest |L − 1| of a pixel under a white sky: a glass ball, a glass cube.
    pub furnace: [f64; 2],
    /// The ball with p = F, and with p = 1/2.
    pub choice: [Choice; 2],
    /// The caustic of a large lamp: by a path tracer, by a light tracer.
    pub caustic: [Number; 2],
    /// Path tracer, light tracer and bidirectional estimator: for a small lamp, for a point light.
    pub found: [[Found; 3]; 2],
    /// Part of the light of the mirror corridor that is reflected more than eight times.
    pub corridor: Number,
}

/// Measures everything. `formula(n, n', θ)` is Fresnel's reflectance.
///
/// # Errors
/// If a scene cannot be loaded, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, formula: fn(f64, f64, f64) -> f64) -> book::Result<Measured> {
    Ok(Measured {
        angles: angles(folder, formula)?,
        critical: critical(false)?,
        plate: plate(folder, 12)?,
        furnace: furnace(folder, &Right)?,
        choice: [choice(folder, "\"fresnel\"", &Right)?, choice(folder, "0.5", &Right)?],
        caustic: caustic(folder, &Right)?,
        found: [found(folder, Light::Disk(0.05))?, found(folder, Light::Point)?],
        corridor: glass::corridor(folder)?,
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, fresnel)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
