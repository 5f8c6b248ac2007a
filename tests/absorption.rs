//! The absorption estimator scores once, where a path ends; the collision estimator scores all along it. One mean, two variances.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury};
use common::random::{cases, draw, furnished, items, matrix};
use common::sampling::{Start, Starts, collect, mean_of, plan};
use common::scenes::{description, room, sphere};
use common::truth::case;
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Absorption, Prefix, Roulette, Technique, TermEstimator};
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::SurfaceStrip;
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::{Scene, SurfaceSensor};
use fredholm::terms::Estimate;
use fredholm::terms::functional::{Replicates, image_replicates};
use glam::DVec3;
use proptest::prelude::*;

/// K: slots 0..=K, then the tail.
const K: usize = 4;
/// Paths are followed to this vertex: with q = 0.9 everywhere the weight of longer ones leaves the range of `f32`, once in 10²⁴ paths.
const LONG: usize = 24;

fn replicates<T: Transport>(t: &T, s: &impl Sensor<T>, e: &impl TermEstimator<T>, spp: u32, key: Key) -> Replicates {
    let amount = Amount { spp, replicates: 256, key };
    image_replicates(&render(t, s, e, amount, Progress::NONE))
}

/// Schedules that may end a path at every vertex.
fn always() -> impl Strategy<Value = Roulette> {
    prop_oneof![
        (0.05..0.9f64).prop_map(|q| Roulette::Constant { from: 0, q }),
        prop::collection::vec(0.05..0.9f64, 1..6).prop_map(Roulette::Table),
        Just(Roulette::Albedo { from: 0 }),
        Just(Roulette::Throughput { from: 0 }),
    ]
}

fn near(a: DVec3, b: DVec3) -> bool {
    (a - b).abs().cmple(1e-5 * b.abs() + 1e-12).all()
}

proptest! {
    #![proptest_config(cases(256))]

    /// Over all ways the roulette can fall, `Σ P(N = n) W_n E(x_n)/q_n` is what the collision estimator scores without roulette, wherever
    /// a path may end at all; and the sample is the way that the stream's numbers choose.
    #[test]
    fn all_the_ways_a_path_can_end(walk in matrix(), schedule in always()) {
        let key = Key::new(5, "absorption");
        let samples = 32;
        let sampled = collect(&walk, &Rows(2), &Absorption(plan(K, Technique::Scatter, &schedule)), samples, 4, key);
        let without = Prefix(plan(LONG, Technique::Scatter, &Roulette::Never));
        let without = collect(&walk, &Rows(2), &without, samples, 4, key);
        for (pixel, sample) in (0..2).flat_map(|p| (0..samples).map(move |s| (p, s))) {
            let rng = |v, purpose| Rng::at(key, pixel, sample, v, purpose);
            let (mut x, mut w, mut reach) = (pixel, Rgb::ONE, 1.0);
            let (mut mean, mut chosen) = ([DVec3::ZERO; LONG + 1], None);
            let mut ends = [false; LONG + 1];
            for v in 0..=LONG {
                let q = schedule.termination(v, w, walk.albedo(&x));
                if q > 0.0 {
                    let score = (w * walk.emission(&x) / q).as_dvec3();
                    mean[v] = reach * f64::from(q) * score;
                    ends[v] = true;
                    if chosen.is_none() && rng(v, Purpose::Roulette).one() < q {
                        chosen = Some((v, score));
                    }
                }
                if q == 1.0 {
                    // nothing is longer, and the product of weights without roulette is 0 there as well, or the throughput is
                    break;
                }
                let Some(step) = walk.scatter(&x, &mut rng(v, Purpose::Scatter)) else { break };
                reach *= 1.0 - f64::from(q);
                w *= step.weight * (1.0 / (1.0 - q));
                x = step.state;
            }
            for v in (0..=LONG).filter(|&v| ends[v]) {
                let expected = without.path(pixel, sample)[v];
                prop_assert!(near(mean[v], expected), "vertex {v}: {} for {expected}", mean[v]);
            }
            let got = sampled.path(pixel, sample);
            match chosen {
                Some((v, score)) => {
                    let slot = v.min(K + 1);
                    prop_assert!(near(got[slot], score), "slot {slot}: {} for {score}", got[slot]);
                    prop_assert!((0..K + 2).all(|s| s == slot || got[s] == DVec3::ZERO));
                }
                // absorbed or gone by itself, or longer than is followed here
                None => prop_assert!((0..=K).all(|s| got[s] == DVec3::ZERO)),
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(48))]

    /// A closed room that emits 1 − ρ has L = 1, and under roulette by albedo every path says so.
    #[test]
    fn every_path_is_right_where_emission_is_loss(rho in prop::array::uniform3(0.02..0.98f64)) {
        let surface = |geometry, rho: f64| (geometry, DVec3::splat(rho), DVec3::splat(1.0 - rho));
        let scene = Scene::new(&description(&[
            surface(room(DVec3::splat(-1.0), DVec3::ONE, 20.0), rho[0]),
            surface(sphere(DVec3::new(0.4, 0.3, -0.4), 0.3, false), rho[1]),
            surface(sphere(DVec3::new(-0.5, -0.2, -0.6), 0.2, false), rho[2]),
        ]));
        let analog = Absorption(plan(K, Technique::Scatter, &Roulette::Albedo { from: 0 }));
        let x = collect(&SceneTransport::new(&scene), &scene.camera, &analog, 4, 4, Key::new(6, "loss"));
        for path in x.paths() {
            let sum: DVec3 = path.iter().sum();
            prop_assert!((sum - DVec3::ONE).abs().max_element() < 2e-5, "{sum}");
        }
    }
}

#[test]
fn absorption_has_the_powers_of_the_matrix() {
    let mut jury = Jury::open("absorption_has_the_powers_of_the_matrix");
    for (i, walk) in draw(matrix(), 12).enumerate() {
        let end = Roulette::Constant { from: 0, q: 0.3 };
        let key = Key::new(jury.seed(), "absorption").branch(i as u32);
        let r = replicates(&walk, &Rows(2), &Absorption(plan(K, Technique::Scatter, &end)), 1 << 17, key);
        let powers = walk.powers(K);
        let mean = |k: usize| 0.5 * (powers[k][0] + powers[k][1]);
        let whole = (0..=K).map(mean).sum::<DVec3>();
        for k in 0..=K {
            // one path in 30 ends at vertex 4
            let delta = 0.02 * mean(k) + 0.005 * whole;
            jury.judge(&format!("matrix {i}, T{k}"), &r.estimate(k..k + 1), mean(k), delta, delta.max(0.5 * mean(k)));
        }
    }
    jury.assert_power(0.2, 0.2);
}

#[test]
fn absorption_and_collision_agree_in_any_scene() {
    let mut jury = Jury::open("absorption_and_collision_agree_in_any_scene");
    let end = Roulette::Constant { from: 0, q: 0.3 };
    for (i, items) in draw(items(), 4).enumerate() {
        // ρ⁴ < (1 − q)³ on the walls; and a glow on them, so that no term hangs on one small lamp
        let mut d = furnished(DVec3::new(0.7, 0.5, 0.3), &items);
        d.shapes[0].emission = DVec3::splat(0.3);
        let scene = Scene::new(&d);
        let (t, strip) = (SceneTransport::new(&scene), SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 });
        let key = |name: &str| Key::new(jury.seed(), name).branch(i as u32);
        let absorbed = Absorption(plan(K, Technique::Scatter, &end));
        let absorbed = replicates(&t, &strip, &absorbed, 1 << 14, key("absorption"));
        let collided = Prefix(plan(K, Technique::Scatter, &end));
        let collided = replicates(&t, &strip, &collided, 1 << 14, key("collision"));
        let whole = collided.estimate(0..K + 2).mean;
        for k in 0..K + 2 {
            let (a, c) = (absorbed.estimate(k..k + 1), collided.estimate(k..k + 1));
            let std_error = (a.std_error * a.std_error + c.std_error * c.std_error).map(f64::sqrt);
            let difference = Estimate { mean: a.mean - c.mean, std_error, replicates: 256, events: None };
            let delta = 0.03 * c.mean + 0.02 * whole;
            jury.judge(&format!("scene {i}, slot {k}"), &difference, DVec3::ZERO, delta, 0.5 * c.mean + 0.05 * whole);
        }
    }
    jury.assert_power(0.3, 0.2);
}

#[test]
fn absorption_in_a_furnace_has_its_variance() {
    let mut jury = Jury::open("absorption_in_a_furnace_has_its_variance");
    for id in ["rr_furnace_rho0.5_q0.1", "rr_furnace_rho0.8_q0.1", "rr_furnace_rho0.7_q0.2"] {
        let case = case("variance", id);
        let (rho, q, mean) = (case.number("rho"), case.number("q"), case.number("mean"));
        let s = 1.0 - q;
        let truth = s / (q * (s - rho * rho)) - 1.0 / (1.0 - rho).powi(2);
        assert!((truth - case.number("var_absorption")).abs() < 1e-9 * truth);
        let cube = room(DVec3::splat(-1.0), DVec3::ONE, 0.0);
        let scene = Scene::new(&description(&[(cube, DVec3::splat(rho), DVec3::ONE)]));
        let estimator = Absorption(plan(0, Technique::Scatter, &Roulette::Constant { from: 0, q }));
        let key = Key::new(jury.seed(), id);
        let x = collect(&SceneTransport::new(&scene), &Starts(vec![Start::On(0)]), &estimator, 1 << 18, 1024, key);
        let total = |p: &[DVec3]| p.iter().sum::<DVec3>();
        let all: Vec<DVec3> = x.paths().map(total).collect();
        let mut judge = |what: &str, e: Estimate, truth: f64| {
            let truth = DVec3::splat(truth);
            let judged = jury.judge(&format!("{id}, {what}"), &e, truth, 0.05 * truth, 0.3 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{id}, {what}: {e:?}, truth {truth}");
        };
        judge("mean", mean_of(all.iter().copied()), mean);
        judge("variance", mean_of(all.iter().map(|x| (*x - mean).powf(2.0))), truth);
    }
    jury.assert_power(0.6, 0.0);
}
