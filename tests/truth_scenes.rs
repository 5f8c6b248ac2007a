//! Scenes whose terms are known in closed form, or to seven digits by spectral collocation: `tests/truth/`.
//!
//! The estimators start at fixed points or spread over one surface, so there is no camera between them and the truth.
//! Where three cases differ in numbers only, they are the three channels of one scene.
//!
//! **Power.** t* ≈ 7 at 255 degrees of freedom, so 1 % is proved from n = (2 t* cv/0.01)² = 2·10⁶ cv² samples on, and an
//! error of half a term is seen from 800 cv² on. 2¹⁵ to 2¹⁷ samples per pixel prove 1 % for cv ≤ 0.25, which connections
//! and MIS reach here for low k, and the mean over pixels for higher k; the rest is judged for consistency, and
//! `assert_power` keeps count.
//!
//! Not here: plates and coaxial cylinders are infinite and need mirrors to be closed (they are tested as matrices in
//! `matrix_walk.rs`); point lights and environments do not exist yet. The sky over a bowl is a glowing lid without
//! reflection, which is the same thing seen from inside.
#![allow(clippy::unwrap_used)]

mod common;
#[path = "truth_scenes/cube.rs"]
mod cube;
#[path = "truth_scenes/direct_light.rs"]
mod direct_light;
#[path = "truth_scenes/rooms.rs"]
mod rooms;
#[path = "truth_scenes/second_moments.rs"]
mod second_moments;

use common::judge::{Judged, Jury, at};
use common::sampling::{Kind, Start, Starts, TECHNIQUES, collect, film, mean_of, plan, point};
use common::scenes::{Surface, bands, cube_faces, description, quad, room, sphere};
use common::truth::{Case, case};
use fredholm::estimator::{PathTracer, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::description::Geometry;
use fredholm::terms::Estimate;
use fredholm::terms::functional::image_replicates;
use glam::DVec3;

const K: usize = 8;
/// No roulette for the terms, then the analog walk: its variance is finite whatever the scene.
const TAIL: Roulette = Roulette::Albedo { from: K };

/// Where paths start, and what they must find there: `T^k E` for k = 0.. and L.
struct Pixel {
    what: String,
    start: Start,
    terms: Vec<DVec3>,
    total: DVec3,
}

/// Judges terms and total of every pixel, and of their mean, which has the samples of all.
fn check(jury: &mut Jury, scene: &Scene, pixels: &[Pixel], kind: Kind, technique: Technique, spp: u32) {
    let t = SceneTransport::new(scene);
    let starts = Starts(pixels.iter().map(|p| p.start).collect());
    let key = Key::new(jury.seed(), &format!("{kind:?} {technique}"));
    let film = film(&t, &starts, kind, &plan(K, technique, &TAIL), spp, key);
    assert_eq!(film.non_finite, 0);
    let (mean, n) = (image_replicates(&film), pixels.len() as f64);
    let whole = pixels.iter().map(|p| p.total).sum::<DVec3>() / n;
    for k in (0..=K).filter(|_| kind != Kind::Path) {
        let (e, truth) = (mean.estimate(k..k + 1), pixels.iter().map(|p| p.terms[k]).sum::<DVec3>() / n);
        let (delta, label) = (0.01 * truth + 1e-4 * whole, format!("{kind:?}, {technique}, mean of pixels, T{k}"));
        let judged = jury.judge(&label, &e, truth, delta, 0.5 * truth + 0.005 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{label}: {e:?}, truth {truth}");
    }
    for (i, p) in pixels.iter().enumerate() {
        let label = format!("{kind:?}, {technique}, {}", p.what);
        let slots = film.shape.slots;
        jury.part(&format!("{label}, L"), &at(&film, i, 0..slots), p.total, p.total);
        if kind != Kind::Path {
            for (k, &truth) in p.terms.iter().enumerate().take(K + 1) {
                jury.part(&format!("{label}, T{k}"), &at(&film, i, k..k + 1), truth, p.total);
            }
        }
    }
}

/// One number per channel from three cases.
fn three(cases: &[Case; 3], x: impl Fn(&Case) -> f64) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|c: usize| x(&cases[c])))
}
