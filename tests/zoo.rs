//! The zoo: without a mistake the walk is the prefix estimator; every member is wrong in the way it says, is rejected at the sample size
//! it declares, and is not seen where it says that it cannot be.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "zoo/closed_forms.rs"]
mod closed_forms;
mod common;
#[path = "zoo/path_by_path.rs"]
mod path_by_path;
#[path = "zoo/rejection.rs"]
mod rejection;

use common::judge::{Judged, Jury};
use common::sampling::{Collected, Start, Starts, collect, point};
use common::scenes::{bands, description, quad};
use common::truth::case;
use fredholm::engine::Settings;
use fredholm::engine::by_rays;
use fredholm::engine::by_rays::Sampled;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Plan, Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::Key;
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::description::{BsdfDescription, Choice, Geometry, LightDescription, Material, Sides, Sky};
use fredholm::scene::{Description, Scene, Selection, Vertex};
use fredholm::terms::Estimate;
use fredholm::terms::functional::{Replicates, image_replicates};
use fredholm::zoo::bookkeeping::{Clamped, Truncated};
use fredholm::zoo::judge::{Judgement, judge};
use fredholm::zoo::walk::Whole;
use fredholm::zoo::{self, Bug, Mistake, PIXELS, Right, Stage, Walk};
use glam::DVec3;
use std::collections::BTreeMap;

/// K of the tests that judge.
const K: usize = 4;
/// Chance that the right walk is rejected in one run.
const ALPHA: f64 = 1e-4;

fn stages() -> Vec<Stage> {
    let bugs = zoo::all();
    let mut all: Vec<Stage> = bugs.iter().flat_map(|b| std::iter::once(b.exposed_by).chain(b.blind)).collect();
    all.sort_by_key(|s| s.label);
    all.dedup();
    all
}

fn samples<'s>(
    t: &SceneTransport<'s>,
    sensor: &impl Sensor<SceneTransport<'s>>,
    estimator: &impl TermEstimator<SceneTransport<'s>>,
) -> Collected {
    collect(t, sensor, estimator, 4, 4, Key::new(5, "identity"))
}

/// Whether two sets of samples are the same but for rounding; a sum of `f32` may differ in its last digits.
fn same(a: &Collected, b: &Collected) -> Result<usize, String> {
    assert_eq!(a.values.len(), b.values.len());
    for (i, (p, w)) in a.values.iter().zip(&b.values).enumerate() {
        if !((*p - *w).abs().cmple(2e-4 * p.abs() + 1e-9).all()) {
            return Err(format!("value {i}: {p} {w}"));
        }
    }
    Ok(a.values.iter().filter(|v| **v != DVec3::ZERO).count())
}

fn through<'s>(
    scene: &'s Scene,
    sensor: &impl Sensor<SceneTransport<'s>>,
    (technique, roulette, max_bounces): (Technique, Roulette, usize),
    mistake: &dyn Mistake,
    spp: u32,
    seed: u64,
) -> Replicates {
    let walk = Walk { plan: Plan { max_bounces, technique, roulette }, mistake };
    let amount = Amount { spp, replicates: 256, key: Key::new(seed, "closed form") };
    let t = SceneTransport::new(scene);
    let film = if mistake.finishes() {
        render(&t, sensor, &Whole(walk), amount, Progress::NONE)
    } else {
        render(&t, sensor, &walk, amount, Progress::NONE)
    };
    assert_eq!(film.non_finite, 0);
    image_replicates(&film)
}
