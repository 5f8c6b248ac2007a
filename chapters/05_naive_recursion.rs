//! Chapter 5, naive recursion explodes: N new rays at every hit make N^k rays for the term k.
//!
//! ```text
//! L(x) ≈ E(x) + 1/N Σ_{c<N} f cos θ_c/p · L(y_c)          V_k(N) = a_0 + a_1/N + … + a_k/N^k,   C_k(N) = Σ_{j≤k} c_j N^j
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N, c | rays that leave each hit, and the number of one of them | [`CHILDREN`] |
//! | y_c, f cos θ_c/p | the point that ray c hits, and its weight | [`radiance`] |
//! | K | the recursion stops after K reflections | [`K`] |
//! | c_j N^j | rays of depth j per path | [`Tree::rays`] |
//! | V_k | variance of one sample of T^k E, mean over pixels | [`Tree::variance`] |
//! | V_k C_k | squared error at equal rays, relative to N = 1 | [`price`] |
//!
//! Reference: Whitted (1980) and Cook, Porter, Carpenter (1984) for the tree; Kajiya, *The Rendering Equation* (1986).
//! `fredholm chapter 5`, or `cargo run --release --example 05_naive_recursion -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Branching, Plan, Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::{Scene, load::Options};
use fredholm::terms::{functional::image_replicates, scatter::Scatter};
use std::process::ExitCode;

#[path = "naive_recursion/claims.rs"]
mod claims;
#[path = "naive_recursion/exercises.rs"]
mod exercises;
#[path = "naive_recursion/figures.rs"]
mod figures;
#[path = "naive_recursion/pixels.rs"]
mod pixels;
#[path = "naive_recursion/recursion.rs"]
mod recursion;
use pixels::SomePixels;
pub use recursion::recursion;

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 5,
    name: "05_naive_recursion",
    title: "Naive recursion explodes",
    shows: "N rays at every hit make Nᵏ rays for the term k; which N has the least variance × rays?",
    next: &["fredholm sweep cornell --over branching --equal-rays --spp 16 --size 32x32", "fredholm chapter 6"],
    program,
    exercises: exercises::EXERCISES,
};
/// The values of N that are compared.
pub const CHILDREN: [u32; 4] = [1, 2, 4, 8];
/// The recursion stops after this many reflections.
pub const K: usize = 4;
/// A value and its standard error.
pub type Value = [f64; 2];

/// Trees with N rays at every hit.
#[derive(Clone, Debug)]
pub struct Tree {
    /// Rays of every depth k, per path.
    pub rays: Vec<f64>,
    /// Means of the terms T^k E over pixels and channels.
    pub mean: Vec<f64>,
    /// V_k for every k, and last the variance of Σ_{k≥1} T^k E.
    pub variance: Vec<Value>,
}

/// What the program measures. Lists have one entry for each value of [`CHILDREN`].
#[derive(Clone, Debug)]
pub struct Measured {
    /// Rays of one naive recursion in the furnace, by depth.
    pub counted: Vec<[u64; K + 1]>,
    /// T E + … + T⁴E at a point of the integrating sphere, by naive recursion.
    pub sphere: Vec<Value>,
    /// Trees in the Cornell box, for pixels of an image of 256 × 256.
    pub trees: Vec<Tree>,
    /// The same for K = 1: for pixels of that image, and for pixels of an image of 16 × 16.
    pub direct: [Vec<Tree>; 2],
}

fn load(scene: &str, side: u32) -> book::Result<Scene> {
    let size = Options { set: vec![format!("camera.size=[{side}, {side}]")], ..Options::default() };
    Ok(Scene::new(&fredholm::scene::load::scene(scene, &size)?.description))
}

// ANCHOR: tree
fn tree(scene: &Scene, k: usize, n: u32, spp: u32, folder: &Folder<'_>) -> Tree {
    let amount = Amount { spp, replicates: spp.min(64) as usize, key: Key::new(folder.seed, "tree").branch(n) };
    let (t, pixels) = (SceneTransport::new(scene), SomePixels(&scene.camera));
    let film = render(&t, &pixels, &Branching { plan: plan(k), children: n }, amount, folder.progress);
    // variance of one sample: that of the mean of all samples, times their number
    let variance = |terms| {
        let scatter = Scatter::of(&film, terms, None);
        [scatter.variance(), scatter.variance_error()].map(|v| f64::from(spp) * v)
    };
    Tree {
        rays: film.rays[..=k].iter().map(|&rays| rays as f64 / (256.0 * f64::from(spp))).collect(),
        mean: image_replicates(&film).mean.iter().map(|m| m.element_sum() / 3.0).collect(),
        variance: (0..=k).map(|j| variance(j..j + 1)).chain([variance(1..k + 1)]).collect(),
    }
}
// ANCHOR_END: tree

fn plan(k: usize) -> Plan {
    Plan { max_bounces: k, technique: Technique::Mis, roulette: Roulette::Never }
}

/// Counts, renders and compares. `share` is the weight of one of n rays.
pub fn measure(folder: &Folder<'_>, share: fn(u32) -> f32) -> book::Result<Measured> {
    let point = |scene, paths, n| recursion(scene, paths, folder.seed, n, share(n));
    let (mut counted, mut sphere) = (vec![], vec![]);
    for n in CHILDREN {
        counted.push(point("furnace", 1, n)?.0);
        sphere.push(point("sphere", folder.pick(32_768, 16_384) / (n * n), n)?.1);
    }
    let ([small, large], spp) = ([load("cornell", 256)?, load("cornell", 16)?], folder.pick(2048, 1024));
    let trees = CHILDREN.map(|n| tree(&small, K, n, spp / (n * n), folder)).to_vec();
    let direct = [&small, &large].map(|scene| CHILDREN.map(|n| tree(scene, 1, n, 2 * spp / n, folder)).to_vec());
    Ok(Measured { counted, sphere, trees, direct })
}

// ANCHOR: price
/// V C of the i-th N, relative to N = 1. C counts the rays up to depth k; for k > K, those of the whole tree.
pub fn price(trees: &[Tree], i: usize, k: usize) -> Value {
    let cost = |tree: &Tree| tree.rays.iter().take(k + 1).sum::<f64>();
    let [[v, se], [v_1, se_1]] = [i, 0].map(|i| trees[i].variance[k]);
    let ratio = v * cost(&trees[i]) / (v_1 * cost(&trees[0]));
    [ratio, ratio * (se / v).hypot(se_1 / v_1)]
}
// ANCHOR_END: price

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let measured = measure(folder, |n| 1.0 / n as f32)?;
    figures::write(folder, &measured)?;
    Ok(claims(&measured))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
