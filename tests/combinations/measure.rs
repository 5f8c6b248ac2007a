//! What a combination measures in a scene.

use super::array::Combination;
use super::rules::{Eye, Weight};
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, Branching, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm};
use fredholm::estimator::{Technique, TermEstimator};
use fredholm::math::{Key, Points};
use fredholm::operator::{Adjoint, Kernel, Sensor};
use fredholm::progress::Progress;
use fredholm::scene::description::Description;
use fredholm::scene::{Scene, Selection};
use fredholm::terms::functional::functionals;
use fredholm::terms::{Functional, TermFilm};

/// K.
pub const K: usize = 4;
/// Replicates of a combination, and of a reference.
pub const R: usize = 64;
/// Weights of pixels that are compared: the image mean, some of the regions and of the projections.
const FUNCTIONALS: [&str; 7] =
    ["image", "region 0,0", "region 1,2", "region 2,1", "region 3,3", "projection 0", "projection 1"];

/// A scene whose lights are selected that way.
pub fn scene(d: &Description, selection: Selection) -> Scene {
    Scene::new(d).select_lights(selection)
}

/// Samples per pixel that cost about the same with every estimator, as multiples of R.
fn samples(c: &Combination, effort: u32) -> u32 {
    let multiple = match c.estimator {
        Some(Estimator::Single | Estimator::Bidirectional | Estimator::Branching { .. }) => 1,
        _ => 2,
    };
    multiple * effort * R as u32
}

/// What a combination measures with an operator and a camera, which may be wrong ones.
pub fn measure<T: Adjoint + Kernel>(
    t: &T,
    camera: &impl Sensor<T>,
    c: &Combination,
    effort: u32,
    key: Key,
) -> Measurement {
    with_eye(t, camera, c, effort, key, Weight::All)
}

/// The same where emission at vertex 0 counts that much.
pub fn with_eye<T: Adjoint + Kernel>(
    t: &T,
    camera: &impl Sensor<T>,
    c: &Combination,
    effort: u32,
    key: Key,
    eye: Weight,
) -> Measurement {
    let plan = |roulette| Plan { max_bounces: K, technique: c.technique, roulette };
    // the terms keep all their samples, and the tail is analog; so is the path tracer from its third vertex on
    let (terms, path) = (plan(Roulette::Albedo { from: K }), plan(Roulette::Albedo { from: 2 }));
    let amount = Amount { spp: samples(c, effort), replicates: R, key: key.with_points(c.points, R) };
    let film = match c.estimator {
        Some(Estimator::Single) => run(t, camera, SingleTerm(terms), amount, eye),
        Some(Estimator::Prefix) => run(t, camera, Prefix(terms), amount, eye),
        Some(Estimator::Light) => run(t, camera, LightTracer(terms), amount, eye),
        Some(Estimator::Bidirectional) => run(t, camera, Bidirectional(terms), amount, eye),
        Some(Estimator::Branching { children }) => run(t, camera, Branching { plan: terms, children }, amount, eye),
        None => run(t, camera, PathTracer(path), amount, eye),
    };
    Measurement::of(&film)
}

fn run<T: Adjoint + Kernel>(
    t: &T,
    camera: &impl Sensor<T>,
    estimator: impl TermEstimator<T>,
    amount: Amount,
    eye: Weight,
) -> TermFilm {
    render(t, camera, &Eye { estimator, eye }, amount, Progress::NONE)
}

/// Terms by functional.
#[derive(Clone)]
pub struct Measurement {
    pub functionals: Vec<Functional>,
    pub non_finite: u64,
}

impl Measurement {
    pub fn of(film: &TermFilm) -> Self {
        let mut all = functionals(film);
        all.retain(|f| FUNCTIONALS.contains(&f.name.as_str()));
        Self { functionals: all, non_finite: film.non_finite }
    }
}

/// How a scene's reference is found: by the estimator that suits it best, with points and lights that suit it too.
pub fn best(name: &str) -> Combination {
    let estimator = match name {
        // walks from the eye see the sky and its mirror images at once; nothing is gained from the light
        "glass-furnace" | "env-ggx" | "furnace" | "sphere" | "shells" | "sky-bowl" => Estimator::Prefix,
        _ => Estimator::Bidirectional,
    };
    Combination {
        estimator: Some(estimator),
        technique: Technique::Mis,
        selection: Selection::Power,
        sampling: fredholm::scene::bsdf::Sampling::Bsdf,
        points: Points::Sobol,
    }
}
