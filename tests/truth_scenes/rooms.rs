//! Closed rooms whose terms are known: furnaces, bands, bowls, and spheres inside each other.

use super::*;

/// In a furnace the cosine technique has no variance: every sample is ρ^k E to rounding.
#[test]
fn every_sample_in_a_furnace_is_the_truth() {
    let ids = ["furnace_uniform_rho0.5_E1.0", "furnace_uniform_rho0.9_E2.0", "furnace_uniform_rho0.99_E1.0"];
    let cases = ids.map(|id| case("closed_rooms", id));
    let (rho, e) = (three(&cases, |c| c.number("rho")), three(&cases, |c| c.number("E")));
    let with = |geometry: Geometry| (geometry, rho, e);
    let cube = room(DVec3::splat(-1.0), DVec3::ONE, 20.0);
    let block = Geometry::Box { min: DVec3::splat(-0.4), max: DVec3::splat(0.1), rotate_y: 50.0, inward: false };
    for (name, surfaces) in [
        ("box", vec![with(cube.clone())]),
        ("sphere", vec![with(sphere(DVec3::ZERO, 1.0, true))]),
        ("box with things in it", vec![with(cube), with(block), with(sphere(DVec3::splat(0.5), 0.3, false))]),
    ] {
        let scene = Scene::new(&description(&surfaces));
        let starts = Starts((0..scene.sides()).filter(|s| scene.takes_part(*s)).map(Start::On).collect());
        let plan = plan(K, Technique::Scatter, &Roulette::Never);
        let t = SceneTransport::new(&scene);
        for (what, samples) in [
            ("prefix", collect(&t, &starts, &Prefix(plan.clone()), 512, 32, Key::new(1, name))),
            ("single", collect(&t, &starts, &SingleTerm(plan), 512, 32, Key::new(1, name))),
        ] {
            for path in samples.paths() {
                for (k, &x) in path.iter().enumerate().take(K + 1) {
                    let truth = three(&cases, |c| c.list("terms")[k]);
                    assert!((x / truth - 1.0).abs().max_element() < 1e-6, "{name}, {what}, k = {k}: {x} {truth}");
                }
            }
        }
    }
}

#[test]
fn furnaces_have_their_terms_with_every_technique() {
    let mut jury = Jury::open("furnaces_have_their_terms_with_every_technique");
    let ids = ["furnace_uniform_rho0.5_E1.0", "furnace_uniform_rho0.9_E2.0", "furnace_uniform_rho0.9_E2.0"];
    let cases = ids.map(|id| case("closed_rooms", id));
    let (rho, e) = (three(&cases, |c| c.number("rho")), three(&cases, |c| c.number("E")));
    // next-event estimation between surfaces that touch has infinite variance; over a sphere it has none
    for (name, geometry, techniques) in [
        ("box", room(DVec3::splat(-1.0), DVec3::ONE, 20.0), &[Technique::Scatter, Technique::Mis][..]),
        ("sphere", sphere(DVec3::ZERO, 1.0, true), &TECHNIQUES[..]),
    ] {
        let scene = Scene::new(&description(&[(geometry, rho, e)]));
        let pixel = Pixel {
            what: name.into(),
            start: Start::On(0),
            terms: (0..=K).map(|k| three(&cases, |c| c.list("terms")[k])).collect(),
            total: three(&cases, |c| c.number("L")),
        };
        for kind in [Kind::Prefix, Kind::Single, Kind::Path] {
            for &technique in techniques {
                check(&mut jury, &scene, std::slice::from_ref(&pixel), kind, technique, 1 << 14);
            }
        }
    }
    jury.assert_power(0.65, 0.0);
}

/// Every band of a sphere: spread over it, and at one point of it.
fn band_pixels(scene: &Scene, cases: &[Case; 3]) -> Vec<Pixel> {
    let cuts = cases[0].list("z_cuts_over_R");
    let mut pixels = vec![];
    for band in 0..cuts.len() - 1 {
        let terms: Vec<DVec3> = (0..=K).map(|k| three(cases, |c| c.table("terms")[k][band])).collect();
        let total = three(cases, |c| c.list("L")[band]);
        let z: f64 = 0.3 * cuts[band] + 0.7 * cuts[band + 1];
        let n = DVec3::new(0.6 * (1.0 - z * z).sqrt(), 0.8 * (1.0 - z * z).sqrt(), z);
        let side = 2 * band as u32;
        for start in [Start::On(side), Start::At(point(scene, n, -n))] {
            pixels.push(Pixel { what: format!("band {band}, {start:?}"), start, terms: terms.clone(), total });
        }
    }
    pixels
}

#[test]
fn spheres_of_bands_have_their_terms() {
    let mut jury = Jury::open("spheres_of_bands_have_their_terms");
    for ids in [
        ["sphere_cap_light"; 3],
        ["sphere_hemispheres"; 3],
        ["sphere_three_bands", "sphere_kirchhoff_bands", "sphere_kirchhoff_bands"],
    ] {
        let cases = ids.map(|id| case("spheres", id));
        let cuts = cases[0].list("z_cuts_over_R");
        let mut surfaces = bands(1.0, &cuts, &vec![0.0; cuts.len() - 1], &vec![0.0; cuts.len() - 1]);
        for (i, s) in surfaces.iter_mut().enumerate() {
            (s.1, s.2) = (three(&cases, |c| c.list("rho")[i]), three(&cases, |c| c.list("E")[i]));
        }
        let scene = Scene::new(&description(&surfaces));
        let pixels = band_pixels(&scene, &cases);
        for technique in TECHNIQUES {
            check(&mut jury, &scene, &pixels, Kind::Prefix, technique, 1 << 15);
        }
        check(&mut jury, &scene, &pixels, Kind::Single, Technique::Mis, 1 << 13);
        check(&mut jury, &scene, &pixels, Kind::Path, Technique::Mis, 1 << 15);
    }
    jury.assert_power(0.2, 0.08);
}

/// A bowl under a sky of radiance 1.
#[test]
fn bowls_have_their_terms_at_every_point() {
    let mut jury = Jury::open("bowls_have_their_terms_at_every_point");
    for id in ["bowl_hemisphere_rho0.7", "bowl_shallow_rho0.5"] {
        let case = case("spheres", id);
        let (z, rho) = (case.number("z_cut_over_R"), case.number("rho"));
        let lid = Geometry::Disk { center: DVec3::Z * z, normal: DVec3::NEG_Z, radius: (1.0 - z * z).sqrt() };
        let mut surfaces = bands(1.0, &[z, -1.0], &[rho], &[0.0]);
        surfaces.push((lid, DVec3::ZERO, DVec3::splat(case.number("sky"))));
        let scene = Scene::new(&description(&surfaces));
        let terms: Vec<DVec3> = case.list("terms").into_iter().map(DVec3::splat).collect();
        let total = DVec3::splat(case.number("L"));
        let deep = |down: f64| {
            let h = -1.0 + down * (1.0 + z);
            let n = DVec3::new((1.0 - h * h).sqrt(), 0.0, h);
            Start::At(point(&scene, n, -n))
        };
        let starts = [("wall", Start::On(0)), ("bottom", deep(0.0)), ("near the rim", deep(0.8))];
        let pixels = starts.map(|(what, start)| Pixel { what: what.into(), start, terms: terms.clone(), total });
        for technique in [Technique::Scatter, Technique::Mis] {
            check(&mut jury, &scene, &pixels, Kind::Prefix, technique, 1 << 15);
        }
        // the lid touches the rim, so connections have infinite variance there: they are judged from the bottom, k = 1
        let (t, bottom) = (SceneTransport::new(&scene), Starts(vec![pixels[1].start]));
        let plan = plan(1, Technique::Connect, &Roulette::Never);
        let film = film(&t, &bottom, Kind::Prefix, &plan, 1 << 17, Key::new(jury.seed(), "bottom"));
        jury.part("connect, bottom, T1", &at(&film, 0, 1..2), terms[1], total);
    }
    jury.assert_power(0.2, 0.3);
}

#[test]
fn concentric_spheres_have_their_terms() {
    let mut jury = Jury::open("concentric_spheres_have_their_terms");
    let case = case("two_surface", "concentric_spheres_r0.25");
    let (rho, e) = (case.list("rho"), case.list("E"));
    let radius = [case.number("r_inner"), case.number("r_outer")];
    let surface = |i: usize| (sphere(DVec3::ZERO, radius[i], i == 1), DVec3::splat(rho[i]), DVec3::splat(e[i]));
    let scene = Scene::new(&description(&[surface(0), surface(1)]));
    let mut pixels = vec![];
    for i in 0..2 {
        let n = DVec3::new(0.48, 0.6, 0.64) * if i == 0 { 1.0 } else { -1.0 };
        let p = DVec3::new(0.48, 0.6, 0.64) * radius[i];
        for start in [Start::On(2 * i as u32), Start::At(point(&scene, p, n))] {
            let terms = case.table("terms").iter().map(|t| DVec3::splat(t[i])).collect();
            pixels.push(Pixel { what: format!("{start:?}"), start, terms, total: DVec3::splat(case.list("L")[i]) });
        }
    }
    for technique in TECHNIQUES {
        check(&mut jury, &scene, &pixels, Kind::Prefix, technique, 1 << 15);
    }
    check(&mut jury, &scene, &pixels, Kind::Path, Technique::Mis, 1 << 15);
    jury.assert_power(0.15, 0.0);
}

/// Off centre only the area means of one bounce stay exact: ρ F E with the same F.
#[test]
fn eccentric_spheres_keep_the_area_mean_of_one_bounce() {
    let mut jury = Jury::open("eccentric_spheres_keep_the_area_mean_of_one_bounce");
    let case = case("two_surface", "eccentric_spheres_formfactor");
    let (r, f) = (case.number("r_inner"), case.table("F"));
    // three pairs of emissions and albedos, one per channel
    let (rho, e) = ([DVec3::new(0.9, 0.5, 0.3), DVec3::new(0.6, 0.8, 1.0)], [DVec3::X, DVec3::new(0.0, 1.0, 0.5)]);
    let scene = Scene::new(&description(&[
        (sphere(DVec3::new(0.1, -0.2, 0.3), r, false), rho[0], e[0]),
        (sphere(DVec3::ZERO, 1.0, true), rho[1], e[1]),
    ]));
    let t = SceneTransport::new(&scene);
    let starts = Starts(vec![Start::On(0), Start::On(2)]);
    for technique in TECHNIQUES {
        let key = Key::new(jury.seed(), "eccentric");
        let film = film(&t, &starts, Kind::Prefix, &plan(1, technique, &Roulette::Never), 1 << 17, key);
        for i in 0..2 {
            let truth = rho[i] * (e[0] * f[i][0] + e[1] * f[i][1]);
            let what = format!("{technique}, sphere {i}");
            let judged = jury.judge(&what, &at(&film, i, 1..2), truth, 0.01 * truth, 0.5 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{what}");
        }
    }
    jury.assert_power(0.15, 0.0);
}
