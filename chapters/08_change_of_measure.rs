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
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::scene::{Description, Scene, SceneError, Selection, Side, Vertex, description::Geometry, load};
use fredholm::zoo::{self, Mistake, Right};
use std::f64::consts::PI;
use std::process::ExitCode;

#[path = "change_of_measure/figures.rs"]
mod figures;
#[path = "change_of_measure/wall.rs"]
pub mod wall;
use wall::{Place, wall};

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 8,
    name: "08_change_of_measure",
    title: "Lights by area: the change of measure",
    shows: "∫ f E cos θ dω = ∫ f E V G dA: the same light with less noise, at every scale; a wrong density fails this test",
    next: &["fredholm sweep cornell --over technique --max-bounces 1", "fredholm zoo area-density"],
    program,
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

/// Mean of T E over pixels and channels, and its standard error (at most the mean of the errors of the channels).
pub fn mean(s: &Sampled) -> [f64; 2] {
    let e = s.series.image().terms[1];
    [e.mean, e.std_error].map(|v| v.element_sum() / 3.0)
}

/// How many times larger the variance of a pixel is in `a` than in `b`, and the standard error of this number.
pub fn variance_ratio(a: &Sampled, b: &Sampled) -> [f64; 2] {
    let [a, b] = [a, b].map(|s| s.snapshots.last().map(|last| last.slots[1]).unwrap_or_default());
    let ratio = a.value / b.value;
    [ratio, ratio * (a.std_error / a.value).hypot(b.std_error / b.value)]
}

/// The claims of the text. "Equal" means: at most five standard errors apart, and these are below the number behind it.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let off = |[estimate, error]: [f64; 2], exact: f64| [estimate / exact - 1.0, error / exact]; // relative to `exact`
    let equal = |[d, error]: [f64; 2], most: f64| d.abs() <= 5.0 * error && 5.0 * error <= most;
    let by_place = |p: &Place| p.by.each_ref().map(|x| off([x.mean()[0], x.std_error(0)], p.exact));
    let lambert: Vec<_> = m.wall.iter().flat_map(by_place).collect();
    let worst = lambert.iter().map(|[d, error]| d.abs() / error).fold(0.0, f64::max);
    let square = |p: &Place| off([p.by[0].mean()[1], p.by[0].std_error(1)], 1.0 / (24.0 * PI * p.h * p.h));
    let edge = m.wall.last().map_or([f64::NAN; 2], square);
    let same = |[a, b]: [&Sampled; 2]| {
        let ([a, ea], [b, eb]) = (mean(a), mean(b));
        off([a, ea.hypot(eb)], b)
    };
    let (techniques, choices) = (same([&m.room[0], &m.room[1]]), same([&m.lamps[0], &m.lamps[1]]));
    let (noise, power) = (variance_ratio(&m.room[0], &m.room[1]), variance_ratio(&m.lamps[0], &m.lamps[1]));
    // every scale has the same random numbers: ratios differ by rounding only
    let scale = |which: usize| [0, 2].map(|s| mean(&m.scales[s][which])[0] / mean(&m.scales[1][which])[0]);
    let ([small, large], [dark, bright]) = (scale(0), scale(1));
    let near = |ratio: f64, exact: f64| (ratio / exact - 1.0).abs() < 1e-3;
    let percent = |[d, error]: [f64; 2]| format!("difference {} %", plus_minus(100.0 * d, 100.0 * error, 1));
    let times = |[r, error]: [f64; 2]| format!("{} times", plus_minus(r, error, 1));
    let claim = |holds: bool, says, found: String| Claim { says, found, holds };
    vec![
        claim(
            lambert.iter().all(|&d| equal(d, 0.1)),
            "on the wall, points on the lamp and directions give Lambert's closed form",
            format!("{} means, at most {} standard errors away", lambert.len(), significant(worst, 2)),
        ),
        claim(equal(edge, 0.3), "next to the lamp, the mean square of X is ρ²E²A/(24π h²)", percent(edge)),
        claim(equal(techniques, 0.1), "directions and connections give the same direct light", percent(techniques)),
        claim(noise[0] - 5.0 * noise[1] > 500.0, "directions have at least 500 times the variance", times(noise)),
        claim(
            near(small, 1.0) && near(large, 1.0),
            "at the scales 0.1 and 10 the radiance is the same",
            format!("{small:.6} and {large:.6} times that at scale 1"),
        ),
        claim(
            near(dark, 0.01) && near(bright, 100.0),
            "with p_A in place of p_ω, radiance grows as the square of the scale",
            format!("{dark:.6} and {bright:.3} times that at scale 1"),
        ),
        claim(equal(choices, 0.1), "lamps chosen by power give the same light as uniform ones", percent(choices)),
        claim(power[0] - 5.0 * power[1] > 1.5, "a uniform choice has at least 1.5 times the variance", times(power)),
    ]
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
