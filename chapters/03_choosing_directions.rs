//! Chapter 3, choosing directions: one integral, estimated with three densities.
//!
//! ```text
//! L_r(x, ω_o) = ∫ f L_i cos θ dω = E[X]      X = f cos θ/p · L_i(ω)      ω with density p
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p | density: 1/2π, cos θ/π, or one that follows f | `Sampling` |
//! | f cos θ/p | weight of a direction | `Weight`, `right` |
//! | X | one sample | `sample` |
//! | V | variance of X divided by the squared mean | `Spread` |
//! | ρ, α | albedo 0.5 of the matt surface, half angle 20° of the small lamp | `situations` |
//!
//! Reference: Shirley and Wang, *Direct lighting calculation by Monte Carlo integration* (1991); Pharr, Jakob, Humphreys,
//! *Physically Based Rendering* (4th ed. 2023), ch. 2, 9 and 13.
//!
//! `fredholm chapter 3`, or `cargo run --release --example 03_choosing_directions -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::{Kernel, SceneTransport, Transport};
use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::scene::{Vertex, bsdf::Sampling};
use fredholm::zoo::Right;
use std::process::ExitCode;

#[path = "choosing_directions/claims.rs"]
mod claims;
#[path = "choosing_directions/exercises.rs"]
mod exercises;
#[path = "choosing_directions/figures.rs"]
mod figures;
#[path = "choosing_directions/mistakes.rs"]
pub mod mistakes;
#[path = "choosing_directions/situations.rs"]
pub mod situations;
#[path = "choosing_directions/spread.rs"]
pub mod spread;
use mistakes::{distance, member, with};
use situations::{SITUATIONS, situation};
use spread::{Spread, spread};

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 3,
    name: "03_choosing_directions",
    title: "Choosing directions",
    shows: "E[f cos θ L/p] is the same for every density p; its variance is not",
    next: &["fredholm sweep cornell --over sampling", "fredholm zoo cosine-as-uniform", "fredholm chapter 4"],
    program,
    exercises: exercises::EXERCISES,
};

/// The weight of a direction from f, cos θ and p.
pub type Weight = fn(Rgb, f32, f32) -> Rgb;

// ANCHOR: sample
/// f cos θ/p.
pub fn right(f: Rgb, cos: f32, p: f32) -> Rgb {
    f * (cos / p)
}

/// X = f cos θ/p · L_i: a direction ω with density p, and the light that arrives from there.
fn sample(t: &SceneTransport<'_>, x: &Vertex, weight: Weight, numbers: &mut Rng) -> Rgb {
    match t.sample_direction(x, numbers) {
        Some(d) => weight(d.f, d.cos, d.pdf) * t.emission(&d.state),
        None => Rgb::ZERO, // f = 0, or nothing is there
    }
}
// ANCHOR_END: sample

/// What the program measures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Mean and variance of X for each situation and each density.
    pub spreads: Vec<[Spread; 3]>,
    /// Weights under a sky of radiance 1, where X is the weight: matt by uniform directions and by the cosine, glossy by the
    /// cosine and by f.
    pub weights: [Vec<f64>; 4],
    /// Mean of a member of the zoo divided by the correct mean: `cosine-as-uniform` under the sky, `uniform-as-cosine` under
    /// the sky and under the small lamp.
    pub wrong: [Number; 3],
    /// Distance of sin²θ from its uniform law: directions by the cosine, and those of `malley-without-root`.
    pub distance: [f64; 2],
}

// ANCHOR: spreads
/// Mean and variance of X for each situation (rows) and each density (columns).
pub fn spreads(folder: &Folder<'_>, weight: Weight) -> book::Result<Vec<[Spread; 3]>> {
    let row = |i: usize| -> book::Result<_> {
        let (scene, x) = situation(i)?;
        Ok(Sampling::ALL.map(|sampling| {
            let t = SceneTransport { scene: &scene, sampling };
            let each = folder.pick(1 << 15, 1 << 14);
            spread(folder.seed, &format!("{i} {sampling}"), each, |u| f64::from(sample(&t, &x, weight, u).x))
        }))
    };
    (0..SITUATIONS.len()).map(row).collect()
}
// ANCHOR_END: spreads

/// 65 536 samples of X.
pub fn samples(folder: &Folder<'_>, i: usize, sampling: Sampling, weight: Weight) -> book::Result<Vec<f64>> {
    let (scene, x) = situation(i)?;
    let (t, key) = (SceneTransport { scene: &scene, sampling }, Key::new(folder.seed, "samples"));
    let of = |n| sample(&t, &x, weight, &mut Rng::at(key, 0, n, 0, Purpose::Scatter)).x;
    Ok((0..1 << 16).map(|n| f64::from(of(n))).collect())
}

/// Measures everything; `weight` is the weight of a direction.
pub fn measure(folder: &Folder<'_>, weight: Weight) -> book::Result<Measured> {
    let [uniform, cosine, bsdf] = Sampling::ALL;
    let of = |i, sampling| samples(folder, i, sampling, weight);
    let weights = [of(0, uniform)?, of(0, cosine)?, of(2, cosine)?, of(2, bsdf)?];
    let (narrow, wide) = (member("cosine-as-uniform")?, member("uniform-as-cosine")?);
    let wrong = [with(folder, narrow, 0)?, with(folder, wide, 0)?, with(folder, wide, 1)?];
    let distance = [distance(folder, &Right), distance(folder, member("malley-without-root")?)];
    Ok(Measured { spreads: spreads(folder, weight)?, weights, wrong, distance })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, right)?;
    figures::draw(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
