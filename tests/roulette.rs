//! Russian roulette changes no mean, whatever the schedule: path by path, by enumeration, and in the average.
//!
//! A stream fixes a path x_0, x_1, … without roulette. With it the path ends at some vertex N after that vertex has been
//! scored, having collected S_N. Over all the ways the roulette can fall,
//!
//! ```text
//! Σ_n P(N = n) S_n = Σ_k X_k        term by term, whatever q[v] depends on along the path
//! ```
//!
//! is an equality. The numbers of the stream choose one N; the estimators must then return exactly the terms of S_N.
//! Both together are the proof that they are unbiased.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury};
use common::random::{cases, furnished, items, matrix, schedule};
use common::sampling::{Kind, TECHNIQUES, collect, film, plan};
use common::scenes::{description, quad, room, sphere};
use fredholm::estimator::{PathTracer, Prefix, Roulette, Technique};
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{Kernel, SceneTransport, Sensor};
use fredholm::scene::Scene;
use fredholm::study::enumeration::{Stop, ends, follow, mean};
use fredholm::terms::Estimate;
use fredholm::terms::functional::image_replicates;
use glam::DVec3;
use proptest::prelude::*;

/// K: slots 0..=K, then the tail.
const K: usize = 4;
/// Where paths without roulette are cut; with roulette they are cut there too.
const LONG: usize = 40;

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().cmple(1e-5 * b.abs() + 1e-12).all()
}

/// Both equalities for `samples` paths of every pixel.
fn check<T: Kernel>(t: &T, sensor: &impl Sensor<T>, schedule: &Roulette, samples: u32) -> Result<(), TestCaseError> {
    let key = Key::new(11, "roulette");
    let pixels = sensor.size()[0] * sensor.size()[1];
    for technique in TECHNIQUES {
        let plan = plan(K, technique, schedule);
        let terms = collect(t, sensor, &Prefix(plan.clone()), samples, 4, key);
        let totals = collect(t, sensor, &PathTracer(plan), samples, 4, key);
        for (pixel, sample) in (0..pixels).flat_map(|p| (0..samples).map(move |s| (p, s))) {
            let Some(start) = sensor.start(t, pixel, &mut Rng::at(key, pixel, sample, 0, Purpose::Start)) else {
                continue;
            };
            let path = follow(t, start, technique, (key, pixel, sample), LONG);
            let (without, _) = ends(&path, &Roulette::Never, K);
            let (ways, chosen) = ends(&path, schedule, K);

            let probability: f64 = ways.iter().map(|w| w.probability).sum();
            prop_assert!((probability - 1.0).abs() < 1e-6, "{technique}: probabilities sum to {probability}");
            for k in 0..K + 2 {
                let mean = mean(&ways)[k];
                let x = without.last().unwrap().scored[k];
                prop_assert!(near(mean, x), "{technique}, slot {k}: {mean} with roulette, {x} without");
            }

            // paths that would go on beyond LONG are not followed to their end
            if chosen + 1 < LONG {
                let expected = &ways[chosen].scored;
                let got = terms.path(pixel, sample);
                for k in 0..K + 2 {
                    prop_assert!(near(got[k], expected[k]), "{technique}, slot {k}: {} for {}", got[k], expected[k]);
                }
                let (total, sum) = (totals.path(pixel, sample)[0], expected.iter().sum());
                prop_assert!(near(total, sum), "{technique}, path tracer: {total} for {sum}");
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn all_the_ways_it_can_fall_on_a_matrix(walk in matrix(), schedule in schedule()) {
        check(&walk, &Rows(2), &schedule, 32)?;
    }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    // walls reflect at most 0.8: where everything is white, a schedule that follows the albedo never ends a path
    fn all_the_ways_it_can_fall_in_a_scene(walls in prop::array::uniform3(0.0..0.8f64), items in items(), schedule in schedule()) {
        let scene = Scene::new(&furnished(DVec3::from(walls), &items));
        check(&SceneTransport::new(&scene), &scene.camera, &schedule, 2)?;
    }
}

/// Two vertices, q = 0.25 at the first: with probability 1/4 the path has added 2, with 3/4 it has added 2 + 3/0.75.
#[test]
fn two_vertices_by_hand() {
    let stop =
        |hit: f32, weight| Stop { hit: Rgb::splat(hit), connect: Rgb::ZERO, albedo: Rgb::ONE, weight, number: 0.5 };
    let path = [stop(2.0, Some(Rgb::splat(0.5))), stop(6.0, None)];
    let (ways, chosen) = ends(&path, &Roulette::Constant { from: 0, q: 0.25 }, 1);
    let found: Vec<(f64, f64)> = ways.iter().map(|w| (w.probability, w.scored.iter().map(|x| x.x).sum())).collect();
    assert_eq!((found.as_slice(), chosen), ([(0.25, 2.0), (0.75, 6.0)].as_slice(), 1));
    assert_eq!(mean(&ways)[1].x, 3.0, "T1 without roulette is 0.5 · 6");
}

fn minus(a: &Estimate, b: &Estimate) -> Estimate {
    let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
    Estimate { mean: a.mean - b.mean, std_error, replicates: a.replicates, events: None }
}

/// The means of the terms of one scene with and without roulette, from different streams.
#[test]
fn no_term_moves_under_roulette() {
    let mut jury = Jury::open("no_term_moves_under_roulette");
    // albedos of at most 0.59, so that ρ⁴ < ½³ and even the lecture's schedule has a finite fourth moment
    let rho = DVec3::new(0.59, 0.45, 0.3);
    let lamp = quad(DVec3::new(-0.4, 0.9, -0.4), DVec3::X * 0.8, DVec3::Z * 0.8);
    let mut d = description(&[
        (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), rho, DVec3::ZERO),
        (sphere(DVec3::new(0.2, -0.6, -0.3), 0.4, false), rho, DVec3::ZERO),
        (lamp, rho, DVec3::ONE),
    ]);
    d.camera.origin = DVec3::new(0.0, 0.0, 0.9);
    let scene = Scene::new(&d);
    let t = SceneTransport::new(&scene);
    let run = |schedule: &Roulette, stream: &str, seed: u64| {
        let plan = plan(K, Technique::Mis, schedule);
        image_replicates(&film(&t, &scene.camera, Kind::Prefix, &plan, 1 << 13, Key::new(seed, stream)))
    };
    let seed = jury.seed();
    let without = run(&Roulette::Never, "none", seed);
    let whole = without.estimate(0..K + 1).mean;
    for text in ["lecture", "constant:0.3@0", "table:0,0.1,0.3,0.2", "albedo@0", "throughput@1"] {
        let with = run(&text.parse().unwrap(), text, seed);
        for k in 0..=K {
            let (a, b) = (with.estimate(k..k + 1), without.estimate(k..k + 1));
            let (what, delta) = (format!("{text}, T{k}"), 0.02 * b.mean + 0.002 * whole);
            let judged = jury.judge(&what, &minus(&a, &b), DVec3::ZERO, delta, 5.0 * delta);
            assert_ne!(judged, Judged::TooNoisy, "{what}: {a:?} {b:?}");
        }
    }
    jury.assert_power(0.5, 0.0);
}
