//! Means in random scenes: estimators agree, axes do not matter, no material gains energy, two patches may change places.

use super::*;
use common::sampling::difference;

/// Judges the slots of two images of what should be one.
fn same(jury: &mut Jury, what: &str, a: &Replicates, b: &Replicates) {
    let whole = a.estimate(0..K + 2).mean;
    for k in 0..K + 2 {
        let (a, b) = (a.estimate(k..k + 1), b.estimate(k..k + 1));
        // the larger, so that what one of them has not seen at all is not taken for nothing
        let size = a.mean.max(b.mean);
        let delta = 0.02 * size + 0.01 * whole;
        jury.judge(&format!("{what}, slot {k}"), &difference(&a, &b), DVec3::ZERO, delta, 0.3 * size + 0.03 * whole);
    }
}

/// Whether an estimator sees all there is; a path from a light without area through glass or a mirror it might not.
fn sees_all(scene: &Scene, kind: Kind, technique: Technique) -> bool {
    let (point, delta) = (scene.lights.any_delta(), scene.any_delta_surface());
    match kind {
        Kind::Light => !delta,
        _ => !point || !delta && (technique != Technique::Scatter || kind == Kind::Bidirectional),
    }
}

const WAYS: [(Kind, Technique, u32); 5] = [
    (Kind::Prefix, Technique::Mis, 512),
    (Kind::Path, Technique::Mis, 512),
    (Kind::Single, Technique::Power, 256),
    (Kind::Light, Technique::Mis, 512),
    (Kind::Bidirectional, Technique::Mis, 256),
];

#[test]
fn all_estimators_agree_in_any_scene() {
    let mut jury = Jury::open("all_estimators_agree_in_any_scene");
    for (i, d) in draw(world(), 24).enumerate() {
        let d = small(d);
        let scene = Scene::new(&d);
        let images: Vec<_> = WAYS
            .into_iter()
            .filter(|w| sees_all(&scene, w.0, w.1))
            .map(|(kind, technique, spp)| {
                let key = Key::new(jury.seed(), &format!("{kind:?}")).branch(i as u32);
                let plan = plan(K, technique, &Roulette::Constant { from: K, q: 0.3 });
                (kind, image_replicates(&film(&scene, &scene.camera, kind, &plan, (spp, 256), key)))
            })
            .collect();
        let Some((_, first)) = images.first() else { continue };
        for (kind, image) in &images[1..] {
            if *kind == Kind::Path {
                let (a, b) = (first.estimate(0..K + 2), image.estimate(0..1));
                let size = a.mean.max(b.mean);
                jury.judge(&format!("scene {i}, path"), &difference(&a, &b), DVec3::ZERO, 0.02 * size, 0.3 * size);
            } else {
                same(&mut jury, &format!("scene {i}, {kind:?}"), first, image);
            }
        }
    }
    jury.assert_power(0.2, 0.4);
}

#[test]
fn means_do_not_depend_on_the_axes() {
    let mut jury = Jury::open("means_do_not_depend_on_the_axes");
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.3, -2.0);
    let upright = |d: &Description| {
        let image = |l: &LightDescription| {
            matches!(l, LightDescription::Environment { sky: fredholm::scene::description::Sky::LatLong(_), .. })
        };
        !d.lights.iter().any(image)
    };
    for (i, d) in draw(world(), 24).enumerate().filter(|(_, d)| upright(d)).take(10) {
        let d = small(d);
        // the same primitives in both, so that lights are as many
        let scenes = [DQuat::IDENTITY, turn].map(|turn| Scene::new(&transformed(&d, turn, 1.7, false)));
        for (kind, technique, spp) in [
            (Kind::Prefix, Technique::Mis, 512),
            (Kind::Light, Technique::Mis, 256),
            (Kind::Bidirectional, Technique::Mis, 256),
        ] {
            let [a, b] = [0, 1].map(|j: usize| {
                let key = Key::new(jury.seed(), &format!("{kind:?} {j}")).branch(i as u32);
                let plan = plan(K, technique, &Roulette::Constant { from: K, q: 0.3 });
                image_replicates(&film(&scenes[j], &scenes[j].camera, kind, &plan, (spp, 256), key))
            });
            same(&mut jury, &format!("scene {i}, {kind:?}"), &a, &b);
        }
    }
    jury.assert_power(0.2, 0.4);
}

/// ‖T‖₁ ≤ the largest albedo, for surfaces that let nothing through.
#[test]
fn no_material_gains_energy() {
    let mut account = common::open("no_material_gains_energy");
    let threshold = critical(ledger::share("no_material_gains_energy").level(), 255.0);
    let scenes = (items(), prop::collection::vec(opaque(0.8), 6), prop::collection::vec(opaque(1.0), 6));
    for (i, (items, dim, bright)) in draw(scenes, 40).enumerate() {
        let mut d = common::random::furnished(DVec3::ONE, &items);
        let materials = if i % 2 == 0 { dim } else { bright };
        d.materials.iter_mut().zip(materials).for_each(|(m, bsdf)| m.bsdf = bsdf);
        let scene = Scene::new(&d);
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        let bound = scene.max_albedo().as_dvec3();
        let key = Key::new(account.seed(), "gain").branch(i as u32);
        let means = image_replicates(&film(
            &scene,
            &strip,
            Kind::Prefix,
            &plan(K, Technique::Mis, &Roulette::Never),
            (512, 256),
            key,
        ));
        for k in 0..K {
            account.spend(3);
            let n = means.deviation.len() as f64;
            let squares: DVec3 = means.deviation.iter().map(|d| (d[k + 1] - bound * d[k]).powf(2.0)).sum();
            let excess = means.mean[k + 1] - bound * means.mean[k];
            let limit = threshold * (squares * (n / (n - 1.0))).map(f64::sqrt) + 1e-6 * means.mean[k];
            assert!(excess.cmple(limit).all(), "scene {i}, T{}: {excess} above {limit}", k + 1);
        }
    }
}

/// Two patches of the same albedo in one room with anything between: light from A seen at B is light from B seen at A.
#[test]
fn two_patches_may_change_places() {
    let mut jury = Jury::open("two_patches_may_change_places");
    let between = (prop::collection::vec((prop_oneof![opaque(1.0), glass()], any::<bool>()), 3), 0.2..0.45f64);
    for (i, (materials, size)) in draw(between, 10).enumerate() {
        // A on the floor, B on the wall, of different areas
        let a = quad(DVec3::new(-0.9, -0.99, 0.6), DVec3::X * 0.7, DVec3::NEG_Z * 0.9);
        let b = quad(DVec3::new(0.99, -0.2, -0.5), DVec3::Z * 0.6, DVec3::Y * 0.5);
        let area = [0.7 * 0.9, 0.6 * 0.5];
        let ball = sphere(DVec3::new(0.1, -0.3, 0.1), size, false);
        let block = Geometry::Box {
            min: DVec3::new(-0.6, 0.2, -0.7),
            max: DVec3::new(-0.1, 0.8, -0.2),
            rotate_y: 30.0,
            inward: false,
        };
        let rho = DVec3::new(0.9, 0.7, 0.5);
        let mut d = description(&[
            (a, rho, DVec3::ZERO),
            (b, rho, DVec3::ZERO),
            (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), rho, DVec3::ZERO),
            (ball, rho, DVec3::ZERO),
            (block, rho, DVec3::ZERO),
        ]);
        for (j, (bsdf, both)) in materials.into_iter().enumerate() {
            // the room itself does not let light out
            let bsdf = if j == 0 && matches!(bsdf, BsdfDescription::Dielectric(_)) {
                d.materials[0].bsdf.clone()
            } else {
                bsdf
            };
            d.materials[j + 2].bsdf = bsdf;
            d.materials[j + 2].sides = if both { Sides::Both } else { Sides::Front };
        }
        let [to_b, to_a] = [0, 1].map(|lit: usize| {
            let mut d = d.clone();
            d.shapes[lit].emission = DVec3::ONE;
            let scene = Scene::new(&d);
            let at = Starts(vec![Start::On(2 * (1 - lit as u32)); 16]);
            let key = Key::new(jury.seed(), ["a", "b"][lit]).branch(i as u32);
            let plan = plan(K, Technique::Mis, &Roulette::Constant { from: K, q: 0.3 });
            let mut r = image_replicates(&film(&scene, &at, Kind::Prefix, &plan, (6144, 256), key));
            let scale = area[1 - lit];
            r.mean.iter_mut().for_each(|m| *m *= scale);
            r.deviation.iter_mut().flatten().for_each(|m| *m *= scale);
            r
        });
        same(&mut jury, &format!("scene {i}"), &to_b, &to_a);
    }
    jury.assert_power(0.25, 0.4);
}
