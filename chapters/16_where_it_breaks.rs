//! Chapter 16, where it breaks: what the equation leaves out, and where its estimators and tests fail.
//!
//! ```text
//! T^k E = an integral over 2k numbers          P(no event in N samples) = (1 − p)^N          G(x, y) ∝ 1/|x − y|²
//! mirrors: T^k E never becomes smooth          polarisation: T acts on four numbers          L' = E + T' L' for a wrong T'
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | 2k, N | dimension of the integral; samples | [`dimension`] |
//! | p | probability of a rare event | [`rare`] |
//! | G | kernel of T, near a corner | [`corner`] |
//! | T³E | a caustic | [`caustic`] |
//! | T^k E | between mirrors and between diffuse walls | [`mirrors`] |
//! | M | Mueller matrix of a reflection | [`polarisation`] |
//! | T' | a wrong operator | [`own_equation`] |
//!
//! Reference: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997).
//!
//! `fredholm chapter 16`, or `cargo run --release --example 16_where_it_breaks -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::math::Points;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "where_it_breaks/caustic.rs"]
pub mod caustic;
#[path = "where_it_breaks/claims.rs"]
mod claims;
#[path = "where_it_breaks/corner.rs"]
pub mod corner;
#[path = "where_it_breaks/dimension.rs"]
pub mod dimension;
#[path = "where_it_breaks/exercises.rs"]
mod exercises;
#[path = "where_it_breaks/figures.rs"]
mod figures;
#[path = "where_it_breaks/mirrors.rs"]
pub mod mirrors;
#[path = "where_it_breaks/own_equation.rs"]
pub mod own_equation;
#[path = "where_it_breaks/polarisation.rs"]
pub mod polarisation;
#[path = "where_it_breaks/rare.rs"]
pub mod rare;

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 16,
    name: "16_where_it_breaks",
    title: "Where it breaks",
    shows: "high dimension, rare events, corners, caustics, mirrors, polarisation, what a passed test does not say",
    next: &["fredholm sweep cube --over points", "fredholm check equilibrium cornell"],
    program,
    exercises: exercises::EXERCISES,
};

/// Index of the glass.
const GLASS: f64 = 1.5;
/// Factor of the standard error for a 95 % interval.
const CONFIDENCE: f64 = 1.96;
/// Factor of all albedos in the wrong room.
const DARKER: f64 = 0.8;

/// All that claims and figures need.
#[derive(Clone)]
pub struct Measured {
    /// Noise of the terms by two kinds of points.
    pub dimension: dimension::Dimension,
    /// Runs that look for a small lamp.
    pub rare: Vec<rare::Row>,
    /// The wall below its lamp.
    pub corner: corner::Corner,
    /// The caustic of a point light.
    pub caustic: caustic::Caustic,
    /// The cube with mirrors and with diffuse walls.
    pub mirrors: mirrors::Room,
    /// See `mirrors`.
    pub diffuse: mirrors::Room,
    /// Two reflections at Brewster's angle.
    pub brewster: polarisation::Twice,
    /// A wrong solution that fulfils its own equation.
    pub own: own_equation::OwnEquation,
}

/// What [`measure`] is made of.
#[derive(Clone, Copy)]
pub struct Ingredients {
    /// The points that are compared with independent numbers.
    pub points: Points,
    /// The light above the glass ball.
    pub lamp: caustic::Lamp,
    /// The albedo of the mirrors.
    pub mirror: f64,
    /// The techniques near the corner.
    pub techniques: [corner::Technique; 2],
    /// The Mueller matrix of a reflection.
    pub reflection: fn([f64; 2]) -> polarisation::Mueller,
}

impl Ingredients {
    /// Those of the text.
    pub const RIGHT: Self = Self {
        points: Points::Sobol,
        lamp: caustic::Lamp::Point,
        mirror: 1.0,
        techniques: [corner::connect, corner::both],
        reflection: polarisation::reflection,
    };
}

/// Measures everything.
///
/// # Errors
/// If a scene cannot be loaded or has no matrix, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, with: &Ingredients) -> book::Result<Measured> {
    let noise = |points| dimension::noise(folder, points);
    Ok(Measured {
        dimension: dimension::Dimension { independent: noise(Points::Independent)?, even: noise(with.points)? },
        rare: rare::runs(folder, CONFIDENCE)?,
        corner: corner::corner(folder, with.techniques)?,
        caustic: caustic::caustic(folder, with.lamp)?,
        mirrors: mirrors::mirrors(folder, with.mirror)?,
        diffuse: mirrors::diffuse(folder)?,
        brewster: polarisation::twice(GLASS, polarisation::brewster(GLASS), with.reflection),
        own: own_equation::own_equation(folder, DARKER)?,
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, &Ingredients::RIGHT)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
