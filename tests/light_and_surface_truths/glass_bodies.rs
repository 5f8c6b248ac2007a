//! Glass in a white furnace and in a slab: its terms, both ends of a path, and no gain of energy.

use super::*;

fn slab() -> Vec<Geometry> {
    let side = |z: f64, u: DVec3, v: DVec3| quad(DVec3::new(-40.0, -40.0, z), u * 80.0, v * 80.0);
    vec![side(0.0, DVec3::X, DVec3::Y), side(-1.0, DVec3::Y, DVec3::X)]
}

/// A slab and a ball of lossless glass: X_k is 1 for one k, of probability T^k, and 0 for the others; under a constant choice
/// the sample is T^k over the probability.
#[test]
fn glass_in_a_white_furnace_has_its_terms() {
    let mut account = open("glass_in_a_white_furnace_has_its_terms");
    const LAST: usize = 8;
    const N: u32 = 1 << 15;
    let truth = case("specular", "glass_in_white_furnace");
    for row in truth.rows("rows") {
        let number = |key: &str| row[key].as_f64().unwrap();
        let (eta, degrees, r) = (number("eta"), number("deg"), number("R"));
        let terms: Vec<f64> = row["terms"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        let ball = vec![sphere(DVec3::NEG_Z, 1.0, false)];
        for (name, shapes) in [("slab", slab()), ("ball", ball)] {
            for (choice, p) in [(Choice::Fresnel, r), (Choice::Constant(0.3), 0.3), (Choice::Constant(0.7), 0.7)] {
                let scene = Scene::new(&under_the_sky(&shapes, &glass(eta, choice, None)));
                let t = SceneTransport::new(&scene);
                let starts = Starts(vec![Start::At(tilted(&scene, degrees))]);
                for technique in Technique::ALL {
                    let plan = plan(LAST, technique, &Roulette::Constant { from: 40, q: 0.5 });
                    let n = if technique == Technique::Mis { N } else { 1024 };
                    let samples = collect(
                        &t,
                        &starts,
                        &Prefix(plan),
                        n,
                        1024,
                        Key::new(account.seed(), &format!("{name} {eta} {degrees} {p}")),
                    );
                    let what = format!("{name}, η = {eta}, {degrees}°, p = {p}, {technique}");
                    let mut hits = [0u64; LAST + 2];
                    for path in samples.paths() {
                        let found: Vec<usize> = (0..LAST + 2).filter(|&k| path[k] != DVec3::ZERO).collect();
                        assert_eq!(found.len(), 1, "{what}: {path:?}");
                        let k = found[0];
                        hits[k] += 1;
                        if k <= LAST {
                            let probability = if k == 1 { p } else { (1.0 - p).powi(2) * p.powi(k as i32 - 2) };
                            let value = terms[k] / probability;
                            // rays in the ball start 2⁻¹⁶ of its size off its surface, which turns every chord a little, and all that follow
                            let turned = if name == "ball" {
                                1e-4 * (k * k) as f64 * degrees.to_radians().tan().max(1.0)
                            } else {
                                1e-5 * k as f64
                            };
                            let error = (path[k].x / value - 1.0).abs();
                            assert!(error < turned, "{what}, k = {k}: {} for {value}", path[k]);
                        }
                    }
                    // other techniques change nothing: no connection ends on glass
                    if technique == Technique::Mis {
                        assert_eq!(hits[0], 0);
                        for (k, &hits) in hits.iter().enumerate().skip(1) {
                            let tail =
                                1.0 - p - (1.0 - p).powi(2) * (0..LAST as i32 - 1).map(|j| p.powi(j)).sum::<f64>();
                            let q = if k == 1 {
                                p
                            } else if k <= LAST {
                                (1.0 - p).powi(2) * p.powi(k as i32 - 2)
                            } else {
                                tail
                            };
                            assert_rate(&mut account, &format!("{what}, k = {k}"), hits, u64::from(N), q);
                        }
                    }
                }
            }
        }
    }
}

/// The same through a camera and from both ends; light's walks alone see nothing.
#[test]
fn bidirectional_sees_glass() {
    let mut jury = Jury::open("bidirectional_sees_glass");
    let row = &case("specular", "glass_in_white_furnace").rows("rows")[2];
    let terms: Vec<DVec3> =
        row["terms"].as_array().unwrap().iter().take(K + 1).map(|x| DVec3::splat(x.as_f64().unwrap())).collect();
    for choice in [Choice::Fresnel, Choice::Constant(0.3)] {
        let mut d = under_the_sky(&slab(), &glass(1.5, choice, None));
        d.camera.origin = DVec3::new(3.0f64.sqrt(), 0.0, 1.0);
        (d.camera.target, d.camera.up, d.camera.fov, d.camera.size) = (DVec3::ZERO, DVec3::Z, 0.05, [4, 4]);
        for way in [Way::Bidirectional(Technique::Mis), Way::Prefix(Technique::Mis), Way::Path(Technique::Mis)] {
            let mut terms = terms.clone();
            if let Way::Path(_) = way {
                terms = vec![DVec3::ONE];
            }
            // the rarest terms have no power here: they are counted in the test above
            let shown = terms.len().min(4);
            check_image(&mut jury, &format!("{choice:?}"), &d, way, 1 << 12, &terms[..shown]);
        }
        let scene = Scene::new(&d);
        let film = film(&scene, &scene.camera, Way::Light, K, &Roulette::LECTURE, 256, Key::new(1, "blind"));
        assert_eq!(image_replicates(&film).estimate(0..K + 2).mean, DVec3::ZERO);
    }
    jury.assert_power(0.05, 0.0);
}

/// Rough glass loses what its facets shadow and never gains: no sample of the sum exceeds 1.
#[test]
fn rough_glass_gains_nothing() {
    for alpha in [0.05, 0.3, 0.8] {
        for masking in [Masking::HeightCorrelated, Masking::Separable] {
            let bsdf = glass(1.5, Choice::Fresnel, Some(Ggx { alpha, masking }));
            for shapes in [slab(), vec![sphere(DVec3::NEG_Z, 1.0, false)]] {
                let scene = Scene::new(&under_the_sky(&shapes, &bsdf));
                for degrees in [0.0, 45.0, 80.0] {
                    let starts = Starts(vec![Start::At(tilted(&scene, degrees))]);
                    let estimator = PathTracer(plan(200, Technique::Scatter, &Roulette::Never));
                    let samples =
                        collect(&SceneTransport::new(&scene), &starts, &estimator, 2048, 1024, Key::new(3, "rough"));
                    let most = samples.values.iter().map(|v| v.max_element()).fold(0.0, f64::max);
                    assert!(most < 1.0 + 1e-4, "α = {alpha}, {masking:?}, {degrees}°: {most}");
                    let mean = samples.values.iter().map(|v| v.x).sum::<f64>() / 2048.0;
                    assert!(
                        mean > if alpha < 0.1 { 0.8 } else { 0.15 },
                        "α = {alpha}, {masking:?}, {degrees}°: {mean}"
                    );
                }
            }
        }
    }
}

/// Lossless glass in a furnace hides nothing and adds nothing: L = E/(1 − ρ) wherever one looks from the air.
#[test]
fn glass_disappears_in_a_furnace() {
    let mut jury = Jury::open("glass_disappears_in_a_furnace");
    let (rho, e) = (DVec3::new(0.3, 0.5, 0.6), DVec3::new(1.0, 2.0, 0.5));
    let block = Geometry::Box { min: DVec3::splat(-0.5), max: DVec3::splat(0.1), rotate_y: 30.0, inward: false };
    for choice in [Choice::Fresnel, Choice::Constant(0.4)] {
        let mut d = description(&[
            (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), rho, e),
            (block.clone(), rho, DVec3::ZERO),
            (sphere(DVec3::new(0.5, -0.4, 0.3), 0.35, false), rho, DVec3::ZERO),
        ]);
        d.materials[1].bsdf = glass(1.5, choice, None);
        d.materials[2].bsdf = glass(1.8, choice, None);
        (d.camera.origin, d.camera.target) = (DVec3::splat(0.9), DVec3::ZERO);
        let total = e / (DVec3::ONE - rho);
        let scene = Scene::new(&d);
        let roulette = Roulette::Constant { from: 3, q: 0.2 };
        for (way, spp) in [
            (Way::Path(Technique::Scatter), 1024),
            (Way::Path(Technique::Mis), 1024),
            (Way::Prefix(Technique::Power), 1024),
            (Way::Single(Technique::Mis), 512),
            (Way::Bidirectional(Technique::Mis), 512),
        ] {
            let film = film(
                &scene,
                &scene.camera,
                way,
                3,
                &roulette,
                spp,
                Key::new(jury.seed(), &format!("{way:?} {choice:?}")),
            );
            let slots = film.shape.slots;
            let e = image_replicates(&film).estimate(0..slots);
            let judged = jury.judge(&format!("{way:?} {choice:?}"), &e, total, 0.02 * total, 0.1 * total);
            assert_ne!(judged, Judged::TooNoisy, "{way:?}: {e:?}");
        }
    }
    jury.assert_power(0.25, 0.0);
}
