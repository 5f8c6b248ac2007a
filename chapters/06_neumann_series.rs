//! Chapter 6, the Neumann series and its decay: how fast the terms get smaller, and how many of them are enough.
//!
//! ```text
//! L = Σ T^k E,  m_k = ‖T^k E‖₁,  γ_k = m_{k+1}/m_k → r(T)          L(s) = Σ s^k T^k E: all albedos times s
//! ‖Σ_{k>K} T^k E‖₁ ≤ g/(1 − g) m_K ≤ g^(K+1)/(1 − g) m_0            g = ρ_max ≥ ‖T‖₁
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | m_k, γ_k | mean of T^k E over all surfaces, from random paths; ratio of consecutive terms | [`terms`], [`ratios`] |
//! | r(T), g | spectral radius, from two meshes; the largest albedo | [`Measured`] |
//! | s | factor of all albedos | [`scaled`] |
//!
//! All numbers are those of the red channel, in which the terms decay most slowly; the tables average the channels.
//!
//! Reference: Arvo, *The role of functional analysis in global illumination* (1995).
//!
//! `fredholm chapter 6`, or `cargo run --release --example 06_neumann_series -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::{Settings, by_matrix, by_rays::Estimator, radius::radius_limit};
use fredholm::estimator::{Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::{Scene, load};
use fredholm::stats::{TermMeans, observed_rate, ratio};
use fredholm::study::{bounces, surface};
use fredholm::terms::functional::Replicates;
use std::process::ExitCode;

#[path = "neumann_series/claims.rs"]
mod claims;
#[path = "neumann_series/exercises.rs"]
mod exercises;
#[path = "neumann_series/figures.rs"]
mod figures;
#[path = "neumann_series/scaled.rs"]
mod scaled;
use scaled::DARKER;

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 6,
    name: "06_neumann_series",
    title: "The Neumann series and its decay",
    shows: "ratios of the terms, bounds of the remainder, enough bounces, the series for other albedos",
    next: &["fredholm", "fredholm series cornell --max-bounces 16", "fredholm chapter 7"],
    program,
    exercises: exercises::EXERCISES,
};

/// K: longer paths are counted together.
const LAST: usize = 24;
const RED: usize = 0;
/// The parts of the light that may be missing.
const PARTS: [f64; 3] = [0.1, 0.01, 0.001];

/// An estimate with its standard error, or a limit with half the width of its interval.
pub type Value = (f64, f64);

/// All that claims and figures need.
#[derive(Clone)]
pub struct Measured {
    /// g, the largest albedo.
    pub albedo: f64,
    /// m_k by paths, and by the matrix.
    pub terms: TermMeans,
    /// See `terms`.
    pub matrix: Vec<f64>,
    /// Σ_{k>K} m_k for K = 0, 1, ….
    pub remainder: Vec<Value>,
    /// r(T) for h → 0.
    pub radius: Value,
    /// γ_k of the furnace, and of the Cornell box.
    pub furnace: Vec<Value>,
    /// See `furnace`.
    pub ratios: Vec<Value>,
    /// The rates fitted to the terms up to k = 6, and up to K.
    pub rates: [Value; 2],
    /// Bounces that are enough, measured (none if not decided) and guaranteed: for all light, then for indirect light.
    pub enough: Vec<[Option<usize>; 2]>,
    /// Reflected light of a darker room, from the terms and rendered anew.
    pub scaled: [Value; 2],
    /// s, and the reflected light of the matrix with all albedos times s.
    pub towards_pole: Vec<(f64, f64)>,
}

// ANCHOR: terms
/// The means of T^k E over all surfaces for k = 0, …, K, and of everything longer.
fn terms(scene: &Scene, paths: u32, seed: u64, technique: Technique, progress: Progress<'_>) -> Replicates {
    let roulette = Roulette::Albedo { from: 2 }.after(LAST);
    let settings = Settings { seed, technique, max_bounces: LAST, roulette, ..Settings::default() };
    surface::norms(scene, Estimator::Prefix, paths, &settings, progress)
}

/// γ_k = m_{k+1}/m_k. Both terms come from the same paths, so the error uses their covariance.
fn ratios(terms: &TermMeans) -> Vec<Value> {
    (0..LAST).filter_map(|k| ratio(terms, k)).collect()
}
// ANCHOR_END: terms

/// Measures everything. `closed` names the scene of the furnace; `weight(s, k)` is s^k.
///
/// # Errors
/// If a scene cannot be loaded, or has no matrix or no rate, which is a defect of the program.
pub fn measure(folder: &Folder<'_>, closed: &str, weight: fn(f64, usize) -> f64) -> book::Result<Measured> {
    let (seed, progress) = (folder.seed, folder.progress);
    let load = |name: &str| load::scene(name, &load::Options::default()).map(|s| s.description);
    let (furnace, room) = (Scene::new(&load(closed)?), load("cornell")?);
    let scene = Scene::new(&room);
    let (paths, meshes) = folder.pick((1 << 20, [300, 1200]), (1 << 18, [75, 300]));
    let [coarse, fine] = meshes.map(|n| by_matrix::dense_matrix(&room, &scene, n, 1.0, LAST, progress));
    let (coarse, fine) = (coarse?, fine?);
    let radius = radius_limit(&[coarse.radii[0], fine.radii[0]]).ok_or("the meshes are too coarse")?[RED];
    let all = terms(&scene, paths, seed, Technique::Mis, progress);
    let again = terms(&Scene::new(&scaled::darker(&room, DARKER)), paths, seed + 1, Technique::Mis, progress);
    let mut m = TermMeans::channel(&all, RED);
    m.mean[0] = fine.surface[0][RED]; // E is known, so m_0 needs no paths
    m.covariance.fill_row(0, 0.0);
    m.covariance.fill_column(0, 0.0);
    let rest = |k: usize| all.estimate(k + 1..LAST + 2);
    let six = TermMeans { mean: m.mean[..=6].to_vec(), ..m.clone() };
    let g = f64::from(scene.max_albedo()[RED]);
    let enough = |from, part| [bounces::enough(&all, from, part).most, bounces::guaranteed(g, from, part)];
    Ok(Measured {
        albedo: g,
        remainder: (0..=LAST).map(|k| (rest(k).mean[RED], rest(k).std_error[RED])).collect(),
        matrix: fine.surface.iter().map(|m| m[RED]).collect(),
        radius: (radius.value, radius.half_width),
        furnace: ratios(&TermMeans::channel(&terms(&furnace, 1 << 12, seed, Technique::Scatter, progress), RED)),
        ratios: ratios(&m),
        rates: [observed_rate(&six)?, observed_rate(&m)?].map(|fit| (fit.rate, fit.std_error)),
        enough: [0, 2].into_iter().flat_map(|from| PARTS.map(|part| enough(from, part))).collect(),
        scaled: [scaled::sum(&all, DARKER, weight), scaled::sum(&again, 1.0, |_, _| 1.0)],
        towards_pole: scaled::towards_pole(&fine)?,
        terms: m,
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, "furnace", |s, k| s.powi(k as i32))?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
