//! What holds in every scene, tried on random ones: all numbers finite, no bounce gains energy, no direction preferred.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury};
use common::ledger;
use common::random::{albedo, cases, furnished, items, solid};
use common::sampling::{Kind, TECHNIQUES, film, plan};
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::operator::SurfaceStrip;
use fredholm::scene::description::{Description, Geometry};
use fredholm::scene::{Primitive, Scene, SurfaceSensor};
use fredholm::stats::critical;
use fredholm::terms::Estimate;
use fredholm::terms::functional::{Replicates, image_replicates};
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

const K: usize = 4;

/// Terms averaged over all surfaces: the L1 norm of T^k E in the throughput measure, over πA.
fn surface_means(d: &Description, technique: Technique, spp: u32, key: Key) -> Replicates {
    let scene = Scene::new(d);
    let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
    let film =
        film(&SceneTransport::new(&scene), &strip, Kind::Prefix, &plan(K, technique, &Roulette::Never), spp, key);
    assert_eq!(film.non_finite, 0);
    image_replicates(&film)
}

/// Mean and error of X_{k+1} − ρ X_k, which share their paths.
fn gain(r: &Replicates, k: usize, rho: DVec3) -> Estimate {
    let n = r.deviation.len() as f64;
    let squares: DVec3 = r.deviation.iter().map(|d| (d[k + 1] - rho * d[k]).powf(2.0)).sum();
    Estimate {
        mean: r.mean[k + 1] - rho * r.mean[k],
        std_error: (squares * (n / (n - 1.0))).map(f64::sqrt),
        replicates: r.deviation.len() as u64,
        events: None,
    }
}

/// The first `n` random scenes of a strategy; the same in every run.
fn draw<S: Strategy>(strategy: S, n: usize) -> impl Iterator<Item = S::Value> {
    let mut runner = TestRunner::new(cases(n as u32));
    (0..n).map(move |_| strategy.new_tree(&mut runner).unwrap().current())
}

proptest! {
    #![proptest_config(cases(96))]

    #[test]
    fn everything_is_finite_and_nothing_negative(walls in albedo(), items in items()) {
        let mut d = furnished(walls, &items);
        d.camera.size = [4, 4];
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 4 };
        for technique in TECHNIQUES {
            // white walls never absorb: the schedule that follows the throughput alone would not end there
            let plan = plan(K, technique, &Roulette::LECTURE);
            let key = Key::new(12, "finite");
            for kind in [Kind::Prefix, Kind::Single, Kind::Path] {
                let films = [film(&t, &scene.camera, kind, &plan, 256, key), film(&t, &strip, kind, &plan, 256, key)];
                for film in films {
                    prop_assert_eq!(film.non_finite, 0);
                    for p in 0..film.shape.pixels() {
                        for slot in 0..film.shape.slots {
                            let (mean, error) = film.pixel(p, slot..slot + 1);
                            prop_assert!(mean.is_finite() && error.is_finite() && mean.min_element() >= 0.0);
                        }
                    }
                }
            }
        }
    }
}

/// ‖T‖₁ ≤ max ρ: the surface mean of T^{k+1} E is at most max ρ times that of T^k E.
#[test]
fn no_bounce_gains_energy() {
    let mut account = common::open("no_bounce_gains_energy");
    let threshold = critical(ledger::share("no_bounce_gains_energy").level(), 255.0);
    for (i, (walls, items)) in draw((albedo(), items()), 32).enumerate() {
        let d = furnished(walls, &items);
        let bound = Scene::new(&d).max_albedo().as_dvec3();
        for technique in [Technique::Scatter, Technique::Mis] {
            let key = Key::new(account.seed(), &format!("{technique}")).branch(i as u32);
            let means = surface_means(&d, technique, 1024, key);
            for k in 0..K {
                account.spend(3);
                let excess = gain(&means, k, bound);
                let limit = threshold * excess.std_error + 1e-6 * means.mean[k];
                assert!(excess.mean.cmple(limit).all(), "{technique}, T{} of {d:?}: {excess:?}", k + 1);
            }
        }
    }
}

/// Where nothing is black and nothing escapes, one bounce keeps exactly the share ρ: a uniform room around a convex thing.
#[test]
fn a_uniform_room_keeps_the_share_of_its_albedo() {
    let mut jury = Jury::open("a_uniform_room_keeps_the_share_of_its_albedo");
    let rho = DVec3::new(0.3, 0.6, 0.9);
    for (i, item) in draw(solid(), 6).enumerate() {
        let mut d = furnished(rho, &[item.with_albedo(rho)]);
        d.shapes[0].emission = DVec3::new(0.1, 0.5, 1.0);
        for technique in [Technique::Scatter, Technique::Mis] {
            let key = Key::new(jury.seed(), &format!("{technique}")).branch(i as u32);
            let means = surface_means(&d, technique, 1 << 14, key);
            for k in 0..K {
                let scale = rho * means.mean[k];
                let judged = jury.judge(
                    &format!("{technique}, T{k}, scene {i}"),
                    &gain(&means, k, rho),
                    DVec3::ZERO,
                    0.05 * scale,
                    0.3 * scale,
                );
                assert_ne!(judged, Judged::TooNoisy, "{technique}, T{k} of {d:?}: {:?}", gain(&means, k, rho));
            }
        }
    }
    jury.assert_power(0.35, 0.0);
}

/// Every primitive by itself, turned about the origin.
fn turned(d: &Description, turn: DQuat) -> Description {
    let mut all = d.clone();
    all.shapes.clear();
    for (shape, primitive) in d.primitives() {
        let geometry = match primitive {
            Primitive::Triangle(p) => {
                Geometry::Mesh { vertices: p.map(|p| turn * p).to_vec(), faces: vec![[0, 1, 2]], uvs: vec![] }
            }
            Primitive::Parallelogram { origin, edge_u, edge_v } => {
                Geometry::Quad { origin: turn * origin, edge_u: turn * edge_u, edge_v: turn * edge_v }
            }
            Primitive::Sphere { center, radius, z, inward } => {
                Geometry::Sphere { center: turn * center, radius, z, inward }
            }
            Primitive::Disk { center, normal, radius } => {
                Geometry::Disk { center: turn * center, normal: turn * normal, radius }
            }
        };
        all.shapes.push(fredholm::scene::description::Shape { geometry, ..d.shapes[shape].clone() });
    }
    all
}

/// A scene taken apart into its primitives and turned has the same terms.
#[test]
fn terms_do_not_depend_on_the_axes() {
    let mut jury = Jury::open("terms_do_not_depend_on_the_axes");
    let seed = jury.seed();
    let turns = [(0.4, 1.3, -2.0), (std::f64::consts::FRAC_PI_2, 0.0, 0.0), (3.0, -0.2, 0.9)];
    for (i, (items, (x, y, z))) in draw(items(), 3).zip(turns).enumerate() {
        let mut d = furnished(DVec3::new(0.7, 0.5, 0.3), &items);
        // a glow on the walls, so that no term hangs on one small lamp
        d.shapes[0].emission = DVec3::splat(0.1);
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, x, y, z);
        let mean = |d: &Description, name: &str| {
            surface_means(d, Technique::Mis, 1 << 14, Key::new(seed, name).branch(i as u32))
        };
        let (a, b) = (mean(&d, "as is"), mean(&turned(&d, turn), "turned"));
        let whole = a.estimate(0..K + 1).mean;
        for k in 0..=K {
            let (a, b) = (a.estimate(k..k + 1), b.estimate(k..k + 1));
            let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
            let difference = Estimate { mean: a.mean - b.mean, std_error, replicates: 256, events: None };
            let (what, delta) = (format!("scene {i}, T{k}"), 0.02 * a.mean + 0.005 * whole);
            let judged = jury.judge(&what, &difference, DVec3::ZERO, delta, 0.3 * a.mean + 0.03 * whole);
            assert_ne!(judged, Judged::TooNoisy, "{what}: {a:?} {b:?}");
        }
    }
    jury.assert_power(0.3, 0.0);
}
