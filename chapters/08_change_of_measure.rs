//! Chapter 8, lights by area: direct light from points on the lamp, and from directions.
//!
//! ```text
//! (T E)(x) = ∫ f E cos θ_x dω = ∫ f E V G dA      dω = (cos θ_y/d²) dA      G = cos θ_x cos θ_y/d²
//! X = f E V cos θ_x · (dω/dA)/p_A                 p_ω = p_A d²/cos θ_y
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | dω/dA | solid angle per area of the lamp, cos θ_y/d² | [`solid_angle_per_area`] |
//! | X | one sample, from a point y that is uniform on the lamp | `connect` |
//! | p_A, V | density of y per area, 1/A; visibility, 1 if nothing blocks the segment from x to y | `Scene` |
//! | F | T E = ρ E F: what part of the hemisphere the lamp covers, weighted by the cosine | [`Place::exact`] |
//!
//! Reference: Shirley, Wang, Zimmerman, *Monte Carlo Techniques for Direct Lighting Calculations* (1996).
//! `fredholm chapter 8`, or `cargo run --release --example 08_change_of_measure -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::{Settings, by_rays::Sampled};
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::math::Rng;
use fredholm::operator::{Kernel, SceneTransport, Transport};
use fredholm::report::book::{self, Chapter, Claim, Folder};
use fredholm::scene::{Description, Scene, SceneError, Selection, Side, Vertex, description::Geometry, load};
use fredholm::zoo::{self, Mistake, Right};
use std::f64::consts::PI;
use std::process::ExitCode;

#[path = "change_of_measure/claims.rs"]
mod claims;
#[path = "change_of_measure/exercises.rs"]
mod exercises;
#[path = "change_of_measure/figures.rs"]
mod figures;
#[path = "change_of_measure/wall.rs"]
pub mod wall;
use wall::{Place, wall};

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 8,
    name: "08_change_of_measure",
    title: "Lights by area: the change of measure",
    shows: "∫ f E cos θ dω = ∫ f E V G dA: the same light with less noise, at every scale; a wrong density fails this test",
    next: &["fredholm sweep cornell --over technique --max-bounces 1", "fredholm zoo area-density"],
    program,
    exercises: exercises::EXERCISES,
};

// ANCHOR: connect
/// dω/dA: the solid angle, seen from x, of a unit of area at y.
pub fn solid_angle_per_area(cos_y: f64, d2: f64) -> f64 {
    cos_y / d2
}

/// X = f E V cos θ_x (dω/dA)/p_A for a point y that is uniform on the lamp; the green channel.
fn connect(scene: &Scene, x: &Vertex, lamp: Side, jacobian: fn(f64, f64) -> f64, [u, v, ..]: [f32; 4]) -> f64 {
    let (y, n_y) = scene.point(lamp, [u, v]);
    let (to, d2) = (y - x.p, f64::from(x.p.distance_squared(y)));
    let [cos_x, cos_y] = [x.n.dot(to), -n_y.dot(to)].map(|c| f64::from(c) / d2.sqrt());
    if cos_x <= 0.0 || cos_y <= 0.0 || scene.blocked(x.p, x.n, y, n_y) {
        return 0.0; // y is below the horizon of x, or x is behind the lamp, or V = 0
    }
    let [rho, e, p_area] = [scene.albedo(x.side).y, scene.emission(lamp).y, scene.light_density(lamp)].map(f64::from);
    rho / PI * e * cos_x * jacobian(cos_y, d2) / p_area
}
// ANCHOR_END: connect

// ANCHOR: scatter
/// X = f E cos θ_x/p_ω for a direction ω; E is that of the surface found along it.
fn scatter(t: &SceneTransport<'_>, x: &Vertex, numbers: &mut Rng) -> f64 {
    t.sample_direction(x, numbers).map_or(0.0, |s| f64::from((s.f * (s.cos / s.pdf) * t.emission(&s.state)).y))
}
// ANCHOR_END: scatter

/// Renders T E with a technique; `mistake` may replace a step of the estimator.
pub fn direct(folder: &Folder<'_>, scene: &Scene, by: Technique, mistake: &dyn Mistake, spp: u32) -> Sampled {
    let plan = Plan { max_bounces: 1, technique: by, roulette: Roulette::Never };
    let settings = Settings { spp, seed: folder.seed, max_bounces: 1, ..Settings::default() };
    zoo::of(&plan, mistake, &by.to_string(), scene, &settings, folder.progress)
}

/// A scene with square pictures, and all its lengths multiplied by s.
pub fn scene(name: &str, pixels: u32, s: f64) -> Result<Scene, SceneError> {
    let set = vec![format!("camera.size=[{pixels}, {pixels}]")];
    let mut scene: Description = load::scene(name, &load::Options { set, ..Default::default() })?.description;
    [&mut scene.camera.origin, &mut scene.camera.target].into_iter().for_each(|v| *v *= s);
    for shape in &mut scene.shapes {
        match &mut shape.geometry {
            Geometry::Quad { origin, edge_u, edge_v } => [origin, edge_u, edge_v].into_iter().for_each(|v| *v *= s),
            Geometry::Box { min, max, .. } => [min, max].into_iter().for_each(|v| *v *= s),
            _ => {} // the Cornell box, the only scene that is scaled here, has no other shapes
        }
    }
    Ok(Scene::new(&scene))
}

/// What this chapter measures.
#[derive(Clone)]
pub struct Measured {
    /// The wall of the cube.
    pub wall: Vec<Place>,
    /// T E of the Cornell box: by directions, by connections, by connections without V.
    pub room: [Sampled; 3],
    /// At the scales 0.1, 1 and 10: T E by connections, and with p_A in place of p_ω.
    pub scales: Vec<[Sampled; 2]>,
    /// T E of 96 lamps, chosen uniformly and by power.
    pub lamps: [Sampled; 2],
}

const SCALES: [f64; 3] = [0.1, 1.0, 10.0];

/// Measures; `wrong` is the mistake that the scale reveals.
pub fn measure(folder: &Folder<'_>, jacobian: fn(f64, f64) -> f64, wrong: &dyn Mistake) -> book::Result<Measured> {
    let scatter = |scene: &Scene| direct(folder, scene, Technique::Scatter, &Right, 64);
    let connect = |scene: &Scene, mistake, spp| direct(folder, scene, Technique::Connect, mistake, spp);
    let blind = zoo::find("no-shadow-test").ok_or("the zoo has no such member")?.mistake;
    let room = scene("cornell", folder.pick(256, 128), 1.0)?;
    let at = |&s: &f64| {
        let scene = scene("cornell", folder.pick(240, 48), s)?;
        Ok([connect(&scene, &Right as &dyn Mistake, 4), connect(&scene, wrong, 4)])
    };
    let many = || scene("many-lights", folder.pick(96, 72), 1.0); // 96 lamps
    Ok(Measured {
        wall: wall(folder, jacobian)?,
        room: [scatter(&room), connect(&room, &Right, 64), connect(&room, blind, 64)],
        scales: SCALES.iter().map(at).collect::<book::Result<_>>()?,
        lamps: [connect(&many()?, &Right, 64), connect(&many()?.select_lights(Selection::Power), &Right, 64)],
    })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let wrong = zoo::find("area-density").ok_or("the zoo has no such member")?.mistake;
    let m = measure(folder, solid_angle_per_area, wrong)?;
    figures::write(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
