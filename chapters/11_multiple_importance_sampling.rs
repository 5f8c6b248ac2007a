//! Chapter 11, multiple importance sampling: two strategies for one integral, and weights that sum to 1.
//!
//! ```text
//! T E = ∫ f E V cos θ dω = E[ Σᵢ wᵢ f E V cos θ/pᵢ ]       wᵢ: weight of strategy i, Σᵢ wᵢ = 1 wherever f E V cos θ > 0
//! balance: wᵢ = pᵢ/(p₀ + p₁)       power: wᵢ = pᵢ²/(p₀² + p₁²)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | i = 0, 1 | BSDF sampling (a direction), light sampling (a point on a lamp) | [`found`] |
//! | p, p° | densities of both strategies for one point, per solid angle; p is that of the strategy that found it | `Factors::pair` |
//! | wᵢ | weight | [`weight`] |
//! | X | one estimate from one sample of each strategy | [`estimate`] |
//! | β | exponent of the weights | [`line`] |
//!
//! Reference: Veach and Guibas, *Optimally Combining Sampling Techniques for Monte Carlo Rendering* (1995).
//! `fredholm chapter 11`, or `cargo run --release --example 11_multiple_importance_sampling -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::estimator::Technique;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{Factors, Kernel, SceneTransport, Transport};
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::Vertex;
use std::process::ExitCode;

#[path = "multiple_importance_sampling/claims.rs"]
mod claims;
#[path = "multiple_importance_sampling/exercises.rs"]
mod exercises;
#[path = "multiple_importance_sampling/figures.rs"]
mod figures;
#[path = "multiple_importance_sampling/line.rs"]
pub mod line;
#[path = "multiple_importance_sampling/mistakes.rs"]
pub mod mistakes;
#[path = "multiple_importance_sampling/pairs.rs"]
pub mod pairs;
#[path = "multiple_importance_sampling/pictures.rs"]
mod pictures;
#[path = "multiple_importance_sampling/plates.rs"]
pub mod plates;
#[path = "multiple_importance_sampling/sums.rs"]
pub mod sums;
use line::Variances;
use mistakes::{Factor, Run};
use pairs::Pair;

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 11,
    name: "11_multiple_importance_sampling",
    title: "Multiple importance sampling",
    shows: "two strategies, weights that sum to 1, what goes wrong when they do not",
    next: &["fredholm zoo mixed-measures", "fredholm sweep veach-mis --over technique", "fredholm chapter 12"],
    program,
    exercises: exercises::EXERCISES,
};

/// The weight of a point that strategy `i` found with density p, and the other strategy would find with density p°.
pub type Weight = fn(Technique, usize, [f32; 2]) -> f32;

// ANCHOR: weight
/// wᵢ of each technique; `Technique::Mis` is the balance heuristic, `Technique::Power` the power heuristic.
pub fn weight(technique: Technique, i: usize, [p, other]: [f32; 2]) -> f32 {
    if i == 0 { technique.hit(p, other) } else { technique.connection(p, other) }
}
// ANCHOR_END: weight

// ANCHOR: estimate
/// What the strategies find from x: the surface in a sampled direction, and a sampled point on a lamp.
pub fn found(t: &SceneTransport<'_>, x: &Vertex, key: Key, [a, b]: [u32; 2]) -> [Option<Factors<Vertex>>; 2] {
    let numbers = |purpose| Rng::at(key, a, b, 0, purpose);
    [t.sample_direction(x, &mut numbers(Purpose::Scatter)), t.sample_emitter(x, &mut numbers(Purpose::Connect))]
}

/// wᵢ f E V cos θ/pᵢ of both strategies; the green channel. X is their sum.
pub fn estimate(
    t: &SceneTransport<'_>,
    found: &[Option<Factors<Vertex>>; 2],
    technique: Technique,
    weight: Weight,
) -> [f64; 2] {
    [0, 1].map(|i| {
        found[i].map_or(0.0, |y| {
            let light = y.f * (y.cos / y.pdf) * t.emission(&y.state);
            f64::from(weight(technique, i, y.pair) * light.y)
        })
    })
}
// ANCHOR_END: estimate

/// What this chapter measures.
#[derive(Clone)]
pub struct Measured {
    /// The largest difference between 1 and the sum of both weights of a point; the number of points.
    pub sums: (f64, u64),
    /// Each plate with each lamp of the scene `veach-mis`.
    pub pairs: Vec<[Pair; 4]>,
    /// By which factor a mistake changes the direct light.
    pub mistakes: Vec<Factor>,
    /// Variances in one dimension.
    pub line: Variances,
}

/// Measures everything; `weight` gives the weights.
///
/// # Errors
/// If a scene cannot be loaded, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, weight: Weight) -> book::Result<Measured> {
    Ok(Measured {
        sums: sums::sums(folder, sums::per_area)?,
        pairs: pairs::pairs(folder, weight)?,
        mistakes: mistakes::factors(&Run::of(folder), &mistakes::NAMES)?,
        line: line::variances(folder, line::weight),
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, weight)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
