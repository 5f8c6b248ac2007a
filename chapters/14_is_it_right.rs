//! Chapter 14, proof by testing: what a test of a renderer proves, how often it is wrong, and how wrong renderers show.
//!
//! ```text
//! t = (x̄ − μ)/s,  p = P(|T_ν| ≥ |t|)        alarm: p ≤ α        bias found with probability 1 − β: (z_α + z_β) σ/√n
//! m tests: P(some alarm) = 1 − (1 − α)^m      any time: E_n ≥ 1/α        r_k = wrong T^k E/right T^k E
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x̄, s, n | mean of the samples of one experiment, its standard error, number of samples | [`experiments`](mod@experiments) |
//! | μ, σ | right value, standard deviation of one sample | [`experiments`](mod@experiments) |
//! | α, β | probability of a false alarm, and of a miss | [`experiments`](mod@experiments) |
//! | p, E_n | p-value; evidence that is valid at any time | [`decisions`] |
//! | r_k | signature of a mistake | [`signatures`](mod@signatures) |
//!
//! Every pixel of a furnace (chapter 4) is an experiment of its own: the right value is the same in all of them, and their
//! random numbers are independent. One render therefore repeats a test thousands of times.
//!
//! Reference: Cohen, *Statistical Power Analysis for the Behavioral Sciences* (1988).
//!
//! `fredholm chapter 14`, or `cargo run --release --example 14_is_it_right -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::stats::holm;
use fredholm::zoo::Right;
use std::process::ExitCode;

#[path = "is_it_right/claims.rs"]
mod claims;
#[path = "is_it_right/decisions.rs"]
pub mod decisions;
#[path = "is_it_right/exercises.rs"]
mod exercises;
#[path = "is_it_right/experiments.rs"]
pub mod experiments;
#[path = "is_it_right/figures.rs"]
mod figures;
#[path = "is_it_right/signatures.rs"]
pub mod signatures;

pub use claims::claims;
use decisions::{anytime, called_equal, families, fixed, p_values, rejected, watch};
use experiments::{Darker, SHORT, SIDE, experiments, smallest};
use signatures::{MEMBERS, Scales, Signature, member, scales, signatures};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 14,
    name: "14_is_it_right",
    title: "Is it right? A bug zoo and proof by testing",
    shows: "false alarms and power of tests, tests at any time, signatures of mistakes, diagnosis",
    next: &["fredholm zoo", "fredholm zoo --quiz", "fredholm check bias --estimator single", "fredholm chapter 15"],
    program,
    exercises: exercises::EXERCISES,
};

/// What the program measures.
#[derive(Clone)]
pub struct Measured {
    /// p-values of whole experiments with the right renderer.
    pub p: Vec<f64>,
    /// Rate of at least one alarm in a family of tests of the right renderer: not corrected, and corrected by Holm.
    pub families: [Number; 2],
    /// Rate of an alarm up to each batch: the test for one look, then the test for any time. The renderer is right.
    pub watched: [Vec<Number>; 2],
    /// Rate at which the darker renderer is rejected, for growing numbers of batches.
    pub power: Vec<(usize, Number)>,
    /// Rate at which a renderer is proved to be right to ± δ: the right one, and the darker one, whose bias is δ.
    pub equal: [Number; 2],
    /// t of the first short experiments, right and darker.
    pub maps: [Vec<f64>; 2],
    /// Members of the zoo, with their ratios.
    pub zoo: Vec<Signature>,
    /// Reflected light in a sphere of radius 1 and 8: the right renderer, and the one with the wrong measure.
    pub scales: [Scales; 2],
}

/// Measures everything.
///
/// # Errors
/// If a scene cannot be loaded, which is a defect of the program.
pub fn measure(f: &Folder<'_>) -> book::Result<Measured> {
    let (right, darker) = (experiments(f, &Right, "right")?, experiments(f, &Darker(smallest()), "darker")?);
    let t = |batches: &Vec<f64>| decisions::t(&batches[..SHORT]);
    let pixels = (SIDE * SIDE) as usize;
    Ok(Measured {
        p: p_values(&right),
        families: [families(&right, <[f64]>::to_vec), families(&right, holm)],
        watched: [watch(&right, fixed()), watch(&right, anytime)],
        power: [12, 24, 48, 96, 192].map(|n| (n, rejected(&darker, n))).to_vec(),
        equal: [&right, &darker].map(|all| called_equal(all)),
        maps: [&right, &darker].map(|all| all[..pixels].iter().map(t).collect()),
        zoo: signatures(f, &MEMBERS)?,
        scales: [scales(f, &Right)?, scales(f, member("area-density")?.mistake)?],
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
