//! Direct light on a wall of the cube, towards the edge that it shares with its lamp, the ceiling.
//!
//! ```text
//! X = ρE A G(x, y),   G = cos θ_x cos θ_y/(π |x − y|²)          G(s x, s y) = G(x, y)/s²
//! E[X²] ∝ d⁻² as d → 0          P(X > t) ∝ t^(−3/2) for x uniform on the wall:  k = 2/3 > 1/2, the variance is infinite
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | d | distance of x from the edge | [`Place::d`] |
//! | y | uniform point on the ceiling, of area A = 1 m² | [`connect`] |
//! | G | kernel, unbounded where two faces meet | |
//! | X_MIS | one connection and one direction, each with the weight p/(p + p°) of the balance heuristic | [`both`] |
//! | k̂ | Hill's estimate of k from the q largest X, ± k̂/√q | [`hill`] |
//!
//! All X are in units of ρE. Reference: Hill, *Annals of Statistics* 3 (1975).

use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Transport, transport::Step};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, Vertex, load};
use fredholm::stats::Moments;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Samples on which k̂ rests.
const LARGEST: usize = 1000;

/// A point of the wall.
#[derive(Clone)]
pub struct Place {
    /// Distance from the edge, m.
    pub d: f64,
    /// E[X²] by connections and by MIS.
    pub square: [Number; 2],
}

/// The wall.
#[derive(Clone)]
pub struct Corner {
    /// Towards the edge.
    pub places: Vec<Place>,
    /// k̂ of connections from points that are uniform on the wall.
    pub tail: Number,
}

/// A technique: one sample of (T E)(x), in units of ρE.
pub type Technique = fn(&SceneTransport<'_>, &Vertex, &mut [Rng; 2]) -> f64;

// ANCHOR: techniques
/// X by a point on the lamp.
pub fn connect(t: &SceneTransport<'_>, x: &Vertex, [at, _]: &mut [Rng; 2]) -> f64 {
    t.connect(x, at).map_or(0.0, |step| light(t, &step))
}

/// X by a point on the lamp and by a direction, with the balance heuristic.
pub fn both(t: &SceneTransport<'_>, x: &Vertex, [at, towards]: &mut [Rng; 2]) -> f64 {
    let weight = |s: Step<Vertex>| s.pdf / (s.pdf + s.other_pdf);
    let part = |step: Option<Step<Vertex>>| step.map_or(0.0, |s| f64::from(weight(s)) * light(t, &s));
    part(t.connect(x, at)) + part(t.scatter(x, towards))
}
// ANCHOR_END: techniques

/// The sampled light. The walls do not emit, so a direction that hits a wall gives zero.
fn light(t: &SceneTransport<'_>, step: &Step<Vertex>) -> f64 {
    f64::from((step.weight * t.emission(&step.state)).y)
}

/// The point of the back wall at this distance from the left wall and from the ceiling.
fn wall(scene: &Scene, across: f64, d: f64) -> Option<Vertex> {
    let p = DVec3::new(across, 1.0 - d, 0.5) - scene.origin();
    scene.trace(p.as_vec3(), Vec3::NEG_Z)
}

/// Measures the wall.
pub fn corner(folder: &Folder<'_>, techniques: [Technique; 2]) -> book::Result<Corner> {
    let scene = Scene::new(&load::scene("cube", &load::Options::default())?.description);
    let t = SceneTransport::new(&scene);
    let rho = f64::from(wall(&scene, 0.5, 0.5).map_or(0.0, |x| scene.albedo(x.side).y));
    let numbers =
        |key: Key, pixel: u32, i: u32| [Purpose::Connect, Purpose::Scatter].map(|p| Rng::at(key, pixel, i, 0, p));
    let (batches, each) = (64u32, folder.pick(1 << 14, 1 << 13));
    let square = |d: f64, technique: Technique| {
        let x = wall(&scene, 0.5, d).ok_or("there is no wall")?;
        let key = Key::new(folder.seed, &format!("corner {d}"));
        let one = |b, i| (technique(&t, &x, &mut numbers(key, b, i)) / rho).powi(2);
        let means = (0..batches).into_par_iter().map(|b| (0..each).map(|i| one(b, i)).sum::<f64>() / f64::from(each));
        let mut all = Moments::new(1);
        means.collect::<Vec<_>>().iter().for_each(|&mean| all.push(&[mean]));
        Ok::<_, Box<dyn std::error::Error>>(Number { value: all.mean()[0], std_error: all.std_error(0) })
    };
    let place = |i: i32| {
        let d = 0.5f64.powi(i);
        Ok(Place { d, square: [square(d, techniques[0])?, square(d, techniques[1])?] })
    };
    let key = Key::new(folder.seed, "wall");
    let anywhere = |i: u32| {
        let [across, d, ..] = Rng::at(key, 0, i, 0, Purpose::Start).four().map(f64::from);
        wall(&scene, across, d).map_or(0.0, |x| techniques[0](&t, &x, &mut numbers(key, 0, i)))
    };
    let mut all: Vec<f64> = (0..folder.pick(1 << 22, 1 << 19)).into_par_iter().map(anywhere).collect();
    Ok(Corner { places: (1..=6).map(place).collect::<book::Result<_>>()?, tail: hill(&mut all) })
}

// ANCHOR: hill
/// k̂: the mean of ln(x/x_q) over the q largest x, where x_q is the next one.
fn hill(x: &mut [f64]) -> Number {
    x.sort_by(|a, b| b.total_cmp(a));
    let value = x[..LARGEST].iter().map(|v| (v / x[LARGEST]).ln()).sum::<f64>() / LARGEST as f64;
    Number { value, std_error: value / (LARGEST as f64).sqrt() }
}
// ANCHOR_END: hill
