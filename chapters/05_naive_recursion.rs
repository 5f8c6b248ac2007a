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
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::{SceneTransport, Transport};
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::report::text::number::significant;
use fredholm::scene::{Scene, load::Options};
use fredholm::terms::{functional::image_replicates, scatter::Scatter};
use glam::Vec3;
use std::process::ExitCode;

#[path = "naive_recursion/figures.rs"]
mod figures;
#[path = "naive_recursion/pixels.rs"]
mod pixels;
use figures::{percent, times};
use pixels::SomePixels;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 5,
    name: "05_naive_recursion",
    title: "Naive recursion explodes",
    shows: "N rays at every hit make Nᵏ rays for the term k; which N has the least variance × rays?",
    next: &["fredholm sweep cornell --over branching --equal-rays --spp 16 --size 32x32", "fredholm chapter 6"],
    program,
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

// ANCHOR: recursion
/// L(x) up to K reflections, with n rays from every hit, each of weight `share`. Counts the rays of every depth.
fn radiance<T: Transport>(t: &T, x: &T::State, k: usize, (n, share): (u32, f32), key: Key, rays: &mut [u64]) -> Rgb {
    let mut reflected = Rgb::ZERO;
    if k < K {
        for child in 0..n {
            let key = key.branch(child); // random numbers of its own
            rays[k + 1] += 1;
            if let Some(y) = t.scatter(x, &mut Rng::at(key, 0, 0, 0, Purpose::Scatter)) {
                reflected += share * y.weight * radiance(t, &y.state, k + 1, (n, share), key, rays);
            }
        }
    }
    t.emission(x) + reflected
}
// ANCHOR_END: recursion

/// Naive recursion from a point of the furnace or of the sphere: the rays of one recursion, and the mean of `paths`.
pub fn recursion(scene: &str, paths: u32, seed: u64, n: u32, share: f32) -> book::Result<([u64; K + 1], Value)> {
    let scene = load(scene, 16)?;
    let (t, key) = (SceneTransport::new(&scene), Key::new(seed, "recursion").branch(n));
    let x = scene.look(Vec3::ZERO, Vec3::NEG_Z).ok_or("the ray leaves the scene")?;
    let (mut rays, mut sums) = ([0; K + 1], [0.0; 2]);
    for path in 0..paths {
        rays = [1, 0, 0, 0, 0];
        let l = f64::from(radiance(&t, &x, 0, (n, share), key.branch(path), &mut rays).x);
        sums = [sums[0] + l, sums[1] + l * l];
    }
    let [mean, square] = sums.map(|s| s / f64::from(paths));
    Ok((rays, [mean, ((square - mean * mean).max(0.0) / f64::from(paths)).sqrt()]))
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

// ANCHOR: claims
/// The statements of the text. Margins are four standard errors, five for the means.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let powers = CHILDREN.map(|n| [0, 1, 2, 3, 4].map(|k| u64::from(n).pow(k)));
    let exact = 0.06 * (1.0 + 0.6 + 0.36 + 0.216); // T^k E = 0.06 · 0.6^(k−1) on the sphere
    let largest = |of: &dyn Fn(&Value) -> f64| m.sphere.iter().map(of).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    let (off, noise) = (largest(&|[l, se]| (l - exact).abs() / se), largest(&|[_, se]| se / exact));
    let rays = m.trees[3].rays[K] / m.trees[3].rays.iter().sum::<f64>();
    let light = m.trees[0].mean[K] / m.trees[0].mean[1..=K].iter().sum::<f64>();
    let whole = [1, 2, 3].map(|i| price(&m.trees, i, K + 1));
    let deep = [2, 3, 4].map(|k| price(&m.trees, 3, k));
    let small = price(&m.direct[0], 2, 1);
    let [[v_1, se_1], [v_8, se_8]] = [0, 3].map(|i| m.direct[1][i].variance[1]);
    let left = [v_8 / v_1, v_8 / v_1 * (se_8 / v_8).hypot(se_1 / v_1)];
    let above = |values: &[Value], limit: f64| values.iter().all(|[v, se]| v - 4.0 * se > limit);
    let claim = |holds, says, found| Claim { says, found, holds };
    let list = |values: [Value; 3]| values.map(times).join(", ");
    let means = format!("off by at most {} standard errors; these are at most {}", significant(off, 2), percent(noise));
    let shares = format!("{} of the rays, {} of the reflected light", percent(rays), percent(light));
    vec![
        claim(
            m.counted == powers,
            "in the furnace, depth k has exactly Nᵏ rays",
            format!("{:?} for N = 8", m.counted[3]),
        ),
        claim(off < 5.0 && noise < 0.05, "naive recursion has the right mean for every N", means),
        claim(rays > 0.8 && light < 0.15, "with N = 8, most rays go to k = 4, which holds little light", shares),
        claim(above(&whole, 1.0), "all terms in one tree: N = 2, 4, 8 need more rays than N = 1", list(whole)),
        claim(above(&deep, 1.5), "k = 2, 3, 4 alone: N = 8 needs over 1.5 times the rays of N = 1", list(deep)),
        claim(small[0] + 4.0 * small[1] < 1.0, "k = 1 alone, small pixels: N = 4 needs fewer rays", times(small)),
        claim(above(&[left], 1.0 / 3.0), "k = 1, large pixels: N = 8 leaves over ⅓ of the variance", times(left)),
    ]
}
// ANCHOR_END: claims

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
