//! Chapter 2, the reflection equation: light that arrives at a point, and is reflected once.
//!
//! ```text
//! L_r(x, ω_o) = ∫ f(x, ω_i, ω_o) L_i(x, ω_i) cos θ_i dω_i        E(x) = ∫ L_i cos θ_i dω_i        L_r = ρ E/π if f = ρ/π
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L_i | light that arrives: from a lamp, from a point, or from the sky | `scenes` |
//! | L_r | reflected light: the term k = 1 | `render` |
//! | E | irradiance of a white patch (ρ = 1), W/m² | `irradiance` |
//! | α | half of the angle that a lamp fills, seen from the patch | `Measured::cones` |
//!
//! Reference: Matt Pharr, Wenzel Jakob, Greg Humphreys, *Physically Based Rendering* (4th ed. 2023), ch. 4 and 12; Paul
//! Debevec, *Rendering synthetic objects into real scenes* (1998).
//!
//! `fredholm chapter 2`, or `cargo run --release --example 02_reflection_equation -- [--out DIR] [--quick]`.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::engine::Settings;
use fredholm::estimator::{Plan, Technique};
use fredholm::report::book::{self, Chapter, Claim, Folder, Number};
use fredholm::zoo::{self, Mistake, Right};
use std::{f64::consts::PI, process::ExitCode};

#[path = "reflection_equation/claims.rs"]
mod claims;
#[path = "reflection_equation/exercises.rs"]
mod exercises;
#[path = "reflection_equation/figures.rs"]
mod figures;
#[path = "reflection_equation/mirror_ball.rs"]
pub mod mirror_ball;
#[path = "reflection_equation/scenes.rs"]
mod scenes;
use mirror_ball::{Captured, capture, excess};
use scenes::{BESIDE, HOLLOW, INSIDE, ONE, PATCH, SKY, UPWARDS, ball, disc, point, scene};

pub use claims::claims;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 2,
    name: "02_reflection_equation",
    title: "The reflection equation",
    shows: "light from the sky, an area and a point, reflected once; a mirror ball as a light",
    next: &["fredholm series cornell --max-bounces 1", "fredholm chapter 3"],
    program,
    exercises: exercises::EXERCISES,
};

/// What the program measures.
#[derive(Clone, Debug)]
pub struct Measured {
    /// A lamp that fills a cone of half angle α, and its E/(π L sin²α).
    pub cones: Vec<(String, Number)>,
    /// R/h, and E_point/E_disc − 1 for a disc of radius R at height h with the power of the point light.
    pub limit: Vec<(f64, Number)>,
    /// Distance of a lamp, its radiance seen from there, and the irradiance of a patch that faces it.
    pub distance: Vec<(f64, Number, Number)>,
    /// A point light of intensity π inside a unit sphere of albedo 0.5: one reflection, and all reflections.
    pub sphere: [Number; 2],
    /// The object under a photograph of the room, and in the room.
    pub captured: Captured,
}

// ANCHOR: render
/// The terms k = 0 and k = 1, and the whole, as means over the image of a scene.
fn render(folder: &Folder<'_>, mistake: &dyn Mistake, text: [&str; 3], spp: u32) -> book::Result<[Number; 3]> {
    let settings = Settings { spp, max_bounces: 1, seed: folder.seed, ..Settings::default() };
    let plan = Plan { technique: Technique::Connect, ..settings.plan() };
    let found = zoo::of(&plan, mistake, &text.concat(), &scene(text)?, &settings, folder.progress);
    let image = found.series.image();
    Ok([&image.terms[0], &image.terms[1], &image.total].map(Number::from))
}

/// E = π L_r/ρ of a white patch under a lamp, or under a light without a surface.
fn irradiance(folder: &Folder<'_>, mistake: &dyn Mistake, lamp: &str, light: &str) -> book::Result<Number> {
    let shapes = if lamp.is_empty() { PATCH.into() } else { format!("{PATCH}, {lamp}") };
    let [_, reflected, _] = render(folder, mistake, [BESIDE, &shapes, light], folder.pick(8192, 3072))?;
    Ok(reflected.times(PI))
}
// ANCHOR_END: render

/// E/(π L sin²α) under discs, spheres and the sky.
pub fn cones(folder: &Folder<'_>, mistake: &dyn Mistake) -> book::Result<Vec<(String, Number)>> {
    let mut cones = vec![];
    for angle in [15.0f64, 30.0, 60.0] {
        let (sin, cos) = angle.to_radians().sin_cos();
        for (name, lamp) in [("disc", disc(sin / cos, 1.0, ONE)), ("sphere", ball(sin, [0.0, 1.0, 0.0], ONE))] {
            let e = irradiance(folder, mistake, &lamp, "")?;
            cones.push((format!("{name}, α = {angle}°"), e.times(1.0 / (PI * sin * sin))));
        }
    }
    cones.push(("sky, α = 90°".into(), irradiance(folder, mistake, "", SKY)?.times(1.0 / PI)));
    Ok(cones)
}

// ANCHOR: limit
/// R/h, and E_point/E_disc − 1 for a disc of radius R at h = 1 m and a point light with the same intensity along the axis.
pub fn limit(folder: &Folder<'_>, mistake: &dyn Mistake) -> book::Result<Vec<(f64, Number)>> {
    let of_point = irradiance(folder, mistake, "", &point([0.0, 1.0, 0.0], 1.0 / PI))?; // I = Φ/π with Φ = 1 W
    let differ = |radius: f64| -> book::Result<_> {
        let of_disc = irradiance(folder, mistake, &disc(radius, 1.0, "power = [1, 1, 1]"), "")?;
        Ok((radius, excess(of_point, of_disc)))
    };
    [0.8, 0.4, 0.2, 0.1].into_iter().map(differ).collect()
}
// ANCHOR_END: limit

/// Distance of a lamp, its radiance seen from the patch, and the irradiance of the patch.
pub fn distance(folder: &Folder<'_>, mistake: &dyn Mistake) -> book::Result<Vec<(f64, Number, Number)>> {
    let from = |d: f64| -> book::Result<_> {
        let lamp = disc(0.05, d, ONE);
        let [seen, ..] = render(folder, mistake, [UPWARDS, &lamp, ""], 64)?;
        Ok((d, seen, irradiance(folder, mistake, &lamp, "")?))
    };
    [1.0, 2.0, 4.0].into_iter().map(from).collect()
}

/// Pharr's sphere: a point light of intensity π in the middle of a unit sphere of albedo 0.5.
pub fn sphere(folder: &Folder<'_>, mistake: &dyn Mistake) -> book::Result<[Number; 2]> {
    let [_, once, whole] = render(folder, mistake, [INSIDE, HOLLOW, &point([0.0; 3], PI)], 256)?;
    Ok([once, whole])
}

/// Measures everything. `mistake` may replace a step of the estimator; `white` is the largest radiance in the photograph.
pub fn measure(folder: &Folder<'_>, mistake: &dyn Mistake, white: f32) -> book::Result<Measured> {
    let (cones, limit) = (cones(folder, mistake)?, limit(folder, mistake)?);
    let (distance, sphere) = (distance(folder, mistake)?, sphere(folder, mistake)?);
    Ok(Measured { cones, limit, distance, sphere, captured: capture(folder, white)? })
}

/// Measures, draws, writes and checks.
fn program(folder: &Folder<'_>) -> book::Result<Vec<Claim>> {
    let m = measure(folder, &Right, f32::INFINITY)?;
    figures::draw(folder, &m)?;
    Ok(claims(&m))
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
