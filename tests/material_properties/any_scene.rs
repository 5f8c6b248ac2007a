//! What holds sample by sample in any scene: finite, not negative, the same bits however a scene is scaled or paths are batched.

use super::*;
use fredholm::scene::description::{ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface};

const AMOUNT: (u32, usize) = (8, 8);

proptest! {
    #![proptest_config(cases(160))]

    #[test]
    fn every_sample_is_finite_and_none_negative(d in world()) {
        let d = small(d);
        let scene = Scene::new(&d);
        for (kind, technique) in ways() {
            let plan = plan(K, technique, &Roulette::LECTURE);
            let film = film(&scene, &scene.camera, kind, &plan, AMOUNT, Key::new(1, "finite"));
            prop_assert_eq!(film.non_finite, 0, "{:?} {}", kind, technique);
            for p in 0..film.shape.pixels() {
                for slot in 0..film.shape.slots {
                    let (mean, _) = film.pixel(p, slot..slot + 1);
                    prop_assert!(mean.is_finite() && mean.min_element() >= 0.0, "{:?} {}: {}", kind, technique, mean);
                }
            }
        }
        // and from everywhere, where that sensor is known
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        for technique in Technique::ALL {
            let plan = plan(K, technique, &Roulette::LECTURE);
            prop_assert_eq!(film(&scene, &strip, Kind::Prefix, &plan, AMOUNT, Key::new(2, "finite")).non_finite, 0);
        }
    }

    /// Σ X_k + tail is the path tracer's sample.
    #[test]
    fn terms_and_tail_are_the_path_tracer_in_any_scene(d in world(), roulette in schedule()) {
        let d = small(d);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let key = Key::new(3, "identity");
        // white surfaces must not keep a path for ever
        let ends = match roulette {
            Roulette::Albedo { from } | Roulette::Throughput { from } => Roulette::Constant { from, q: 0.4 },
            other => other,
        };
        for technique in Technique::ALL {
            let plan = plan(2, technique, &ends);
            let terms = collect(&t, &scene.camera, &Prefix(plan.clone()), 8, 8, key);
            let paths = collect(&t, &scene.camera, &PathTracer(plan), 8, 8, key);
            for (terms, path) in terms.paths().zip(paths.paths()) {
                let sum: DVec3 = terms.iter().sum();
                let scale = 2e-5 * path[0].abs().max(DVec3::splat(1e-6));
                prop_assert!((sum - path[0]).abs().cmple(scale).all(), "{}, {}: {} {}", technique, ends, sum, path[0]);
            }
        }
    }

    /// Lengths times s, intensities of points times s²: s a power of two, so not one bit changes.
    #[test]
    fn a_scaled_scene_has_the_same_bits(d in world()) {
        let d = small(d);
        let (one, eight) = (Scene::new(&d), Scene::new(&scaled(&d, 8.0)));
        let quarter = Scene::new(&scaled(&d, 0.25));
        for (kind, technique) in ways() {
            let plan = plan(3, technique, &Roulette::LECTURE);
            let of = |scene: &Scene| bits(&film(scene, &scene.camera, kind, &plan, (4, 4), Key::new(4, "scale")));
            let bits = of(&one);
            prop_assert!(of(&eight) == bits && of(&quarter) == bits, "{:?} {}", kind, technique);
        }
    }

    /// Batched and one by one, in waves of any size.
    #[test]
    fn waves_have_the_bits_of_single_paths(d in world()) {
        let d = small(d);
        let (packets, single) = (Scene::new(&d), Scene::new(&d).one_by_one());
        for (kind, technique) in ways() {
            let plan = plan(3, technique, &Roulette::LECTURE);
            let of = |scene: &Scene| bits(&film(scene, &scene.camera, kind, &plan, (4, 4), Key::new(5, "waves")));
            prop_assert!(of(&packets) == of(&single), "{:?} {}", kind, technique);
        }
        let t = SceneTransport::new(&packets);
        for technique in Technique::ALL {
            let estimator = Prefix(plan(3, technique, &Roulette::LECTURE));
            let of = |wave| collect(&t, &packets.camera, &estimator, 8, wave, Key::new(6, "waves")).values;
            prop_assert!(of(8) == of(1), "{}", technique);
        }
    }

    /// A particle among surfaces that lose nothing keeps its power: E π A/P, 4π I/P, step by step.
    #[test]
    fn a_particle_keeps_its_power(things in prop::collection::vec(lossless(), 1..5), items in items(), point in any::<bool>()) {
        let mut d = common::random::furnished(DVec3::ONE, &items);
        for (m, bsdf) in d.materials.iter_mut().zip(things.iter().cycle()) {
            (m.bsdf, m.sides) = (bsdf.clone(), Sides::Both);
        }
        if point {
            d.shapes.iter_mut().for_each(|s| s.emission = DVec3::ZERO);
            d.lights = vec![LightDescription::Point { position: DVec3::new(0.7, 0.8, -0.9), intensity: DVec3::new(1.0, 2.0, 3.0) }];
        }
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let powers: Vec<DVec3> = match point {
            true => vec![4.0 * PI * DVec3::new(1.0, 2.0, 3.0)],
            false => {
                let area = |i: usize| d.primitives().iter().filter(|(s, _)| *s == i).map(|(_, p)| p.area()).sum::<f64>();
                let glow = (0..d.shapes.len()).filter(|&i| d.shapes[i].emission != DVec3::ZERO);
                glow.map(|i| PI * area(i) * d.shapes[i].emission).collect()
            }
        };
        for sample in 0..64 {
            let rng = |v: usize, purpose| Rng::at(Key::new(7, "power"), 0, sample, v, purpose);
            let (mut y, density) = t.emit(&mut rng(0, Purpose::Start)).unwrap();
            let (mut through, mut role) = (1.0 / f64::from(density) * DVec3::ONE, Role::Emission);
            for v in 0..12 {
                let Some(step) = t.walk(&y, role, &mut rng(v, Purpose::Scatter)) else { break };
                through *= step.weight.as_dvec3();
                (y, role) = (step.state, Role::Flux);
                let kept = powers.iter().any(|p| (through / (p * powers.len() as f64) - 1.0).abs().max_element() < 1e-4);
                prop_assert!(kept, "{} after {} steps, powers {:?}", through, v + 1, powers);
            }
        }
    }
}

/// What loses nothing whatever happens: weights are exactly 1.
fn lossless() -> impl Strategy<Value = BsdfDescription> {
    use fredholm::scene::description::{Choice, Colour, Metal};
    prop_oneof![
        Just(BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(DVec3::ONE) })),
        Just(BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::ONE })),
        Just(BsdfDescription::Conductor(ConductorSurface { metal: Metal::Reflectance(DVec3::ONE), rough: None })),
        (1.1..2.5f64).prop_map(|ior| BsdfDescription::Dielectric(DielectricSurface {
            ior,
            ior_outside: 1.0,
            choice: Choice::Fresnel,
            rough: None
        })),
    ]
}
