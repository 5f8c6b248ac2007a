//! The zoo: without a mistake the walk is the prefix estimator; every member is wrong in the way it says, is rejected at the sample size
//! it declares, and is not seen where it says that it cannot be.
#![allow(clippy::unwrap_used)]

mod common;

use fredholm::estimator::{Batch, Paths, Plan, Prefix, Roulette, Technique, TermEstimator, TermSink};
use fredholm::math::{Columns, Key};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::{Scene, VertexWave};
use fredholm::zoo::{Right, Stage, Walk};
use std::collections::BTreeMap;

/// Keeps every sample of every slot apart.
#[derive(Default)]
struct Apart {
    values: BTreeMap<(u32, u32, usize), [f64; 3]>,
    rays: BTreeMap<usize, usize>,
}

impl TermSink for Apart {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            let v = value.get(i).to_array();
            let sum = self.values.entry((pixel[i], sample[i], slot)).or_default();
            (0..3).for_each(|c| sum[c] += f64::from(v[c]));
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        *self.rays.entry(slot).or_default() += rays;
    }
}

fn apart<'s>(
    t: &SceneTransport<'s>,
    sensor: &impl Sensor<SceneTransport<'s>>,
    estimator: &impl TermEstimator<SceneTransport<'s>>,
) -> Apart {
    let mut kept = Apart::default();
    let batch = Batch { key: Key::new(5, "identity"), pixels: 0..64, samples: 0..4 };
    estimator.sample(t, sensor, &batch, &mut Paths::<VertexWave>::default(), &mut kept);
    kept
}

/// Independent code, equal samples: every term of every path, and the rays it took.
#[test]
fn without_a_mistake_the_walk_is_the_prefix_estimator_path_by_path() {
    let mut stages = vec![];
    for bug in fredholm::zoo::all() {
        stages.push(bug.exposed_by);
        stages.extend(bug.blind);
    }
    stages.sort_by_key(|s| s.label);
    stages.dedup();
    stages.extend([
        Stage { label: "ggx", scene: "env-ggx", set: &[] },
        Stage { label: "ajar", scene: "veach-ajar", set: &[] },
    ]);
    let mut compared = 0;
    for stage in stages {
        let scene = Scene::new(&stage.load([8, 8]).unwrap());
        for sampling in [Sampling::Bsdf, Sampling::Uniform] {
            let t = SceneTransport { scene: &scene, sampling };
            for technique in Technique::ALL {
                for roulette in [Roulette::Never, Roulette::LECTURE, Roulette::Albedo { from: 1 }] {
                    let plan = Plan { max_bounces: 4, technique, roulette };
                    let prefix = apart(&t, &scene.camera, &Prefix(plan.clone()));
                    let walk = apart(&t, &scene.camera, &Walk { plan: plan.clone(), mistake: &Right });
                    assert_eq!(prefix.rays, walk.rays, "{} {plan:?}", stage.label);
                    let at: std::collections::BTreeSet<_> = prefix.values.keys().chain(walk.values.keys()).collect();
                    for key in at {
                        let of = |a: &Apart| a.values.get(key).copied().unwrap_or_default();
                        let (p, w) = (of(&prefix), of(&walk));
                        for c in 0..3 {
                            let close = (p[c] - w[c]).abs() <= 2e-4 * p[c].abs() + 1e-9;
                            assert!(close, "{} {plan:?} {sampling:?} {key:?}: {p:?} {w:?}", stage.label);
                            compared += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(compared > 100_000, "{compared}");
}
