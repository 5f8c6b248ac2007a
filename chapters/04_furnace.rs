//! Chapter 4, the rendering equation and the furnace: an exact solution tests a renderer, and what it cannot see.
//!
//! ```text
//! L = E + T L,   T = K G          E = 1, ρ constant, closed:   T^k E = ρ^k,   L = 1/(1 − ρ)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | ρ | albedo of all walls | [`FURNACES`] |
//! | T^k E, L | a term, and the sum of all terms with the tail | [`Furnace`] |
//! | r_k | T^k E of a wrong renderer, divided by the right T^k E | [`compare`] |
//! | L, E + T L | both sides of the equation at points | [`balance`] |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986), for the equation; Veach, *Robust Monte Carlo Methods for Light
//! Transport Simulation* (1997), for T = K G. `fredholm chapter 4`, or
//! `cargo run --release --example 04_furnace -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::{Settings, by_rays::Sampled};
use fredholm::estimator::{Plan, Technique};
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::report::text::number::significant;
use fredholm::scene::Scene;
use fredholm::stats::Outcome;
use fredholm::study::equilibrium::{Balance, Judgement, Origin, at_points, judge, points};
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Mistake, Right, Stage};
use std::error::Error;
use std::process::ExitCode;

#[path = "furnace/exact.rs"]
mod exact;
#[path = "furnace/figures.rs"]
mod figures;
pub use exact::{glass, sphere};
use exact::{largest, member, value};
use figures::{percent, pm};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 4,
    name: "04_furnace",
    title: "The rendering equation and the furnace",
    shows: "L = E + T L at points; TᵏE = ρᵏ in a furnace; two wrong renderers, one of which the furnace cannot see",
    next: &["fredholm zoo uniform-as-cosine", "fredholm check equilibrium cube --spp 16384", "fredholm chapter 5"],
    program,
};
/// A value and its standard error.
pub type Value = [f64; 2];
/// Pixels of an image.
pub type Pixels = Vec<[f32; 3]>;
type Rendered = book::Result<Sampled>;

// ANCHOR: furnaces
const fn furnace(label: &'static str, set: &'static [&'static str]) -> Stage {
    Stage { label, scene: "furnace", set }
}
/// Closed boxes whose walls all emit E = 1 and reflect ρ.
pub const FURNACES: [(f64, Stage); 3] = [
    (0.5, furnace("furnace, ρ = 0.5", &["materials.wall.reflectance=[0.5,0.5,0.5]"])),
    (0.8, furnace("furnace, ρ = 0.8", &["materials.wall.reflectance=[0.8,0.8,0.8]"])),
    (0.9, furnace("furnace, ρ = 0.9", &["materials.wall.reflectance=[0.9,0.9,0.9]"])),
];
// ANCHOR_END: furnaces

/// The light in a furnace.
#[derive(Clone, Debug)]
pub struct Furnace {
    /// Albedo.
    pub rho: f64,
    /// T^k E for k = 0 … 8, mean over the image.
    pub terms: Vec<Value>,
    /// L: all terms and the tail.
    pub whole: Value,
}

/// Two wrong renderers next to the right one, in one scene.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The right image.
    pub right: Pixels,
    /// r_k and the image of `uniform-as-cosine`, then of `cosine-twice`.
    pub wrong: [(Vec<Ratio>, Pixels); 2],
}

/// What the program measures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Furnaces with ρ = 0.5, 0.8, 0.9.
    pub furnaces: Vec<Furnace>,
    /// A glass ball in a sky of radiance 1: T E, T²E, T³E, and the whole image.
    pub glass: Vec<Pixels>,
    /// Reflected light in the integrating sphere: mean over the pixels of the lit cap, and over the other pixels.
    pub sphere: [Value; 2],
    /// Wrong renderers in the furnace (ρ = 0.5), and in the Cornell box.
    pub compared: [Compared; 2],
    /// Both sides of the equation at points of the cube, and the same with 1.02 times the right weight of a step.
    pub balance: [(Vec<Balance>, Judgement); 2],
}

// ANCHOR: render
/// Renders with a path tracer in which one step may be wrong; [`Right`] is no mistake.
fn render(f: &Folder<'_>, scene: Stage, side: u32, by: Technique, step: &dyn Mistake, name: &str) -> Rendered {
    let settings = Settings { spp: 32, seed: f.seed, ..Settings::default() };
    let scene = Scene::new(&scene.load([side; 2])?);
    Ok(zoo::of(&Plan { technique: by, ..settings.plan() }, step, name, &scene, &settings, f.progress))
}

/// The furnaces: every term T^k E, and the whole light.
pub fn furnaces(f: &Folder<'_>, step: &dyn Mistake) -> book::Result<Vec<Furnace>> {
    let one = |(rho, stage)| {
        let light = render(f, stage, f.pick(64, 32), Technique::Mis, step, stage.label)?;
        let terms = light.series.image().terms.iter().map(value).collect();
        Ok(Furnace { rho, terms, whole: value(&light.series.image().total) })
    };
    FURNACES.into_iter().map(one).collect()
}
// ANCHOR_END: render

// ANCHOR: compare
/// r_k = T_k of each wrong renderer / the right T_k.
pub fn compare(f: &Folder<'_>, scene: Stage, by: Technique, steps: [&dyn Mistake; 2]) -> book::Result<Compared> {
    let side = if by == Technique::Scatter { 32 } else { f.pick(96, 64) }; // the furnace has hardly any noise
    let right = render(f, scene, side, by, &Right, "right")?;
    let one = |step, name| {
        let wrong = render(f, scene, side, by, step, name)?;
        Ok::<_, Box<dyn Error>>((measured(wrong.series.image(), right.series.image()), wrong.total.mean))
    };
    let wrong = [one(steps[0], "wrong 1")?, one(steps[1], "wrong 2")?];
    Ok(Compared { right: right.total.mean, wrong })
}
// ANCHOR_END: compare

// ANCHOR: balance
/// Estimates L and E + T L at 64 points of the cube, from independent paths. `factor` multiplies the weight of the step.
pub fn balance(f: &Folder<'_>, factor: f32) -> book::Result<(Vec<Balance>, Judgement)> {
    let scene = Scene::new(&Stage { label: "cube", scene: "cube", set: &[] }.load([16; 2])?);
    let settings = Settings { spp: f.pick(8192, 2048), seed: f.seed, ..Settings::default() };
    let at = points(&scene, Origin::Surface, 64, f.seed);
    let sides = at_points(&scene, &at, &settings, factor, f.progress);
    let judgement = judge(&[("surface", &sides)], 1e-3, 0.02); // chance of a false alarm; margin
    Ok((sides, judgement))
}
// ANCHOR_END: balance

/// Renders and compares.
pub fn measure(f: &Folder<'_>) -> book::Result<Measured> {
    let steps = [member("uniform-as-cosine")?, member("cosine-twice")?];
    Ok(Measured {
        furnaces: furnaces(f, &Right)?,
        glass: glass(f, &Right)?,
        sphere: sphere(f, &Right)?,
        compared: [
            compare(f, FURNACES[0].1, Technique::Scatter, steps)?,
            compare(f, Stage::CORNELL, Technique::Connect, steps)?,
        ],
        balance: [balance(f, 1.0)?, balance(f, 1.02)?],
    })
}

// ANCHOR: claims
/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let off = |[mean, error]: Value, truth: f64| ((mean - truth) / error).abs();
    // largest deviation in standard errors, and largest relative standard error
    let test = |all: &[(Value, f64)]| {
        let (z, noise) = (largest(all.iter().map(|&(v, x)| off(v, x))), largest(all.iter().map(|(v, x)| v[1] / x)));
        let found =
            format!("off by at most {} standard errors; these are at most {}", significant(z, 2), percent(noise));
        (z < 5.0 && noise < 0.01, found)
    };
    let whole: Vec<_> = m.furnaces.iter().map(|f| (f.whole, 1.0 / (1.0 - f.rho))).collect();
    let term = |f: &Furnace| (1..=8).map(|k| (f.terms[k as usize], f.rho.powi(k))).collect::<Vec<_>>();
    let terms = test(&m.furnaces.iter().flat_map(term).collect::<Vec<_>>());
    let sphere = test(&m.sphere.map(|v| (v, 0.06 / (1.0 - 0.6))));
    let [furnace, cornell] = &m.compared;
    let r = |r: &Ratio| [r.value, r.std_error];
    let passes = largest(furnace.wrong[0].0[1..=4].iter().map(|r| (r.value - 1.0).abs()));
    let r_2 = r(&cornell.wrong[0].0[2]);
    let fails = off(r_2, 1.0) > 5.0 && (r_2[0] - 1.0).abs() > 0.03;
    let seen = test(&(1..=4).map(|k| (r(&furnace.wrong[1].0[k]), (2.0f64 / 3.0).powi(k as i32))).collect::<Vec<_>>());
    let spread = largest(m.glass[3].as_flattened().iter().map(|&l| f64::from(l - 1.0).abs()));
    let [(_, right), (_, broken)] = &m.balance;
    let holds = right.outcome == Outcome::Agrees && broken.outcome == Outcome::Differs;
    let found = format!("{} of T L; with 1.02: {}", figures::gap(right), figures::gap(broken));
    let claim = |holds, says, found| Claim { says, found, holds };
    vec![
        claim(test(&whole).0, "furnace: L = 1/(1 − ρ) for ρ = 0.5, 0.8, 0.9", list(m.furnaces.iter().map(|f| f.whole))),
        claim(terms.0, "furnace: TᵏE = ρᵏ for k = 1 to 8", terms.1),
        claim(
            spread < 1e-5,
            "a glass ball in a sky of radiance 1 has radiance 1",
            format!("largest difference of a pixel: {}", significant(spread, 2)),
        ),
        claim(sphere.0, "integrating sphere: lit cap and wall reflect the same 0.15", list(m.sphere)),
        claim(
            passes < 1e-5,
            "`uniform-as-cosine` passes the furnace: r_k = 1",
            format!("largest difference: {}", significant(passes, 1)),
        ),
        claim(fails, "`uniform-as-cosine` fails in the Cornell box: r₂ is not 1", pm(r_2)),
        claim(seen.0, "`cosine-twice` fails in the furnace: r_k = (2/3)ᵏ", seen.1),
        claim(holds, "cube: L = E + T L to ± 2 % of T L; 1.02 T is found", found),
    ]
}
// ANCHOR_END: claims

fn list(values: impl IntoIterator<Item = Value>) -> String {
    values.into_iter().map(pm).collect::<Vec<_>>().join(", ")
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let measured = measure(folder)?;
    figures::write(folder, &measured)?;
    Ok(claims(&measured))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
