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
use fredholm::scene::Scene;
use fredholm::study::equilibrium::{Balance, Judgement};
use fredholm::zoo::signature::Ratio;
use fredholm::zoo::{self, Mistake, Right, Stage};
use std::process::ExitCode;

#[path = "furnace/balance.rs"]
mod balance;
#[path = "furnace/claims.rs"]
mod claims;
#[path = "furnace/compared.rs"]
mod compared;
#[path = "furnace/exact.rs"]
mod exact;
#[path = "furnace/exercises.rs"]
mod exercises;
#[path = "furnace/figures.rs"]
mod figures;
pub use balance::balance;
pub use compared::{Compared, compare};
pub use exact::{glass, sphere};
use exact::{member, value};

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 4,
    name: "04_furnace",
    title: "The rendering equation and the furnace",
    shows: "L = E + T L at points; TᵏE = ρᵏ in a furnace; two wrong renderers, one of which the furnace cannot see",
    next: &["fredholm zoo uniform-as-cosine", "fredholm check equilibrium cube --spp 16384", "fredholm chapter 5"],
    program,
    exercises: exercises::EXERCISES,
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
