//! Terms of whole scenes, held against another renderer: `tests/truth/other_renderer.json`.
//!
//! ```text
//! z = (ours − theirs) / √(s² + s'²)        judged per term, channel, and part of the image
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | ours, s | mean and standard error of the image or of a quadrant of it, from replicates |
//! | theirs, s' | the same from Mitsuba 3 (Jakob et al. 2022), from batches with seeds of their own |
//!
//! The references are made by `tests/truth/other_renderer.py`, which hands the numbers of the same scene file to the other
//! renderer and shares no code with this one: intersections, BSDFs, lights, their sampling and the camera are its own.
//! Both have noise, so both errors are counted.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::Jury;
use common::truth::case;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, Plan, Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::description::PlasticSurface;
use fredholm::scene::description::{BsdfDescription, Description, Geometry, LightDescription};
use fredholm::scene::load::{self, Options};
use fredholm::terms::{Estimate, TermFilm};
use glam::DVec3;

const K: usize = 6;
const PARTS: [&str; 5] = ["image", "top left", "top right", "bottom left", "bottom right"];
const REPLICATES: usize = 64;

fn film<'a>(
    t: &SceneTransport<'a>,
    scene: &Scene,
    e: &impl TermEstimator<SceneTransport<'a>>,
    spp: u32,
    seed: u64,
) -> TermFilm {
    let amount = Amount { spp, replicates: REPLICATES, key: Key::new(seed, "other renderer") };
    render(t, &scene.camera, e, amount, Progress::NONE)
}

fn plan(technique: Technique) -> Plan {
    Plan { max_bounces: K, technique, roulette: Roulette::Never }
}

/// The image (`part` 0), or one of its four quadrants, row by row.
fn part(film: &TermFilm, part: usize, k: usize) -> Estimate {
    let [w, h] = film.shape.size.map(|n| n as usize);
    let inside = |p: usize| part == 0 || 2 * (p / w * 2 / h) + p % w * 2 / w == part - 1;
    let pixels: Vec<usize> = (0..w * h).filter(|&p| inside(p)).collect();
    let replicate =
        |r| pixels.iter().map(|&p| film.sum(p, r, k) / film.count(p, r)).sum::<DVec3>() / pixels.len() as f64;
    fredholm::stats::estimate(&(0..film.shape.replicates).map(replicate).collect::<Vec<_>>())
}

/// A term of the reference, with its error.
fn reference(id: &str, k: usize, part: usize) -> (DVec3, DVec3) {
    let case = case("other_renderer", id);
    let at = |key| DVec3::from_slice(&case.tables(key)[k][part]);
    (at("mean"), at("std_error"))
}

/// Both errors together.
fn with_error(ours: Estimate, error: DVec3) -> Estimate {
    let sum = ours.std_error * ours.std_error + error * error;
    Estimate { std_error: DVec3::new(sum.x.sqrt(), sum.y.sqrt(), sum.z.sqrt()), ..ours }
}

/// Judges every term of the image and of its quadrants.
fn judge(jury: &mut Jury, id: &str, what: &str, film: &TermFilm) {
    let whole = (0..=K).map(|k| reference(id, k, 0).0).sum::<DVec3>();
    for (k, (p, name)) in (0..=K).flat_map(|k| PARTS.iter().enumerate().map(move |p| (k, p))) {
        let (truth, error) = reference(id, k, p);
        let ours = part(film, p, k);
        if truth == DVec3::ZERO && ours.mean == DVec3::ZERO {
            continue;
        }
        let delta = 0.02 * truth + 0.002 * whole;
        let label = format!("{id}, {what}, T{k}, {name}");
        jury.judge(&label, &with_error(ours, error), truth, delta, delta.max(0.5 * truth));
    }
}

fn description(path: &str) -> Description {
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    let mut d = load::scene(&path, &Options::default()).unwrap().description;
    d.camera.size = [32, 32];
    d
}

const SCENES: [(&str, &str); 5] = [
    ("cornell-spheres", "scenes/cornell-spheres.toml"),
    ("metals", "tests/scenes/metals.toml"),
    ("coats", "tests/scenes/coats.toml"),
    ("lamps", "tests/scenes/lamps.toml"),
    ("tiles", "tests/scenes/tiles.toml"),
];

#[test]
fn terms_are_those_of_another_renderer() {
    let mut jury = Jury::open("terms_are_those_of_another_renderer");
    for (id, path) in SCENES {
        let scene = Scene::new(&description(path));
        let t = SceneTransport::new(&scene);
        let seed = jury.seed();
        judge(&mut jury, id, "prefix", &film(&t, &scene, &Prefix(plan(Technique::Mis)), 2048, seed));
        judge(&mut jury, id, "bidirectional", &film(&t, &scene, &Bidirectional(plan(Technique::Mis)), 512, seed ^ 1));
    }
    jury.assert_power(0.4, 0.18);
}

#[test]
fn a_scene_that_is_a_little_wrong_is_told_apart() {
    let mut account = common::open("a_scene_that_is_a_little_wrong_is_told_apart");
    let mut differs = |id: &str, d: &Description, k: usize, what: &str| {
        let scene = Scene::new(d);
        let t = SceneTransport::new(&scene);
        let film = film(&t, &scene, &Prefix(Plan { max_bounces: k, ..plan(Technique::Mis) }), 1024, account.seed());
        let (truth, error) = reference(id, k, 0);
        account.assert_differs(what, &with_error(part(&film, 0, k), error), truth);
    };
    let mut d = description("tests/scenes/metals.toml");
    d.camera.fov *= 1.01;
    differs("metals", &d, 0, "a field of view 1 % too wide");
    let mut d = description("tests/scenes/lamps.toml");
    d.lights.iter_mut().for_each(|l| {
        if let LightDescription::Directional { irradiance, .. } = l {
            *irradiance *= 1.03;
        }
    });
    differs("lamps", &d, 1, "a sun 3 % too bright");
    let mut d = description("tests/scenes/coats.toml");
    d.materials.iter_mut().for_each(|m| {
        if let BsdfDescription::Plastic(PlasticSurface { ior, .. }) = &mut m.bsdf {
            *ior *= 1.2;
        }
    });
    differs("coats", &d, 1, "plastic under a denser coat");
}

/// No point of a ball sees the ball, though rounding puts many of them a little above it.
#[test]
fn a_ball_that_glows_does_not_light_itself() {
    for (at, radius) in [(DVec3::ZERO, 1.0), (DVec3::new(-1.2, 1.4, -0.5), 0.3), (DVec3::new(3.0, -7.0, 0.1), 2.7)] {
        let ball = Geometry::Sphere { center: at, radius, z: [-1.0, 1.0], inward: false };
        let mut d = common::scenes::description(&[(ball, DVec3::splat(0.8), DVec3::ONE)]);
        d.camera.origin = at + DVec3::new(0.0, 0.0, 3.0 * radius);
        d.camera.target = at;
        d.camera.size = [16, 16];
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        for technique in [Technique::Scatter, Technique::Connect, Technique::Mis] {
            let plan = Plan { max_bounces: 1, ..plan(technique) };
            for film in [film(&t, &scene, &Prefix(plan.clone()), 64, 1), film(&t, &scene, &Bidirectional(plan), 64, 1)]
            {
                assert!(part(&film, 0, 0).mean.x > 0.05);
                assert_eq!(part(&film, 0, 1).mean, DVec3::ZERO, "{at}, {technique}");
            }
        }
    }
}
