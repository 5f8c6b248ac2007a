//! Scenes whose terms are known in closed form, or to seven digits by spectral collocation: `tests/truth/`.
//!
//! The estimators start at fixed points or spread over one surface, so there is no camera between them and the truth.
//! Where three cases differ in numbers only, they are the three channels of one scene.
//!
//! **Power.** t* ≈ 7 at 255 degrees of freedom, so 1 % is proved from n = (2 t* cv/0.01)² = 2·10⁶ cv² samples on, and an
//! error of half a term is seen from 800 cv² on. 2¹⁵ to 2¹⁷ samples per pixel prove 1 % for cv ≤ 0.25, which connections
//! and MIS reach here for low k, and the mean over pixels for higher k; the rest is judged for consistency, and
//! `assert_power` keeps count.
//!
//! Not here: plates and coaxial cylinders are infinite and need mirrors to be closed (they are tested as matrices in
//! `matrix_walk.rs`); point lights and environments do not exist yet. The sky over a bowl is a glowing lid without
//! reflection, which is the same thing seen from inside.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury, at};
use common::sampling::{Kind, Start, Starts, TECHNIQUES, collect, film, mean_of, plan, point};
use common::scenes::{Surface, bands, cube_faces, description, quad, room, sphere};
use common::truth::{Case, case};
use fredholm::estimator::{PathTracer, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::SceneTransport;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::description::Geometry;
use fredholm::terms::Estimate;
use fredholm::terms::functional::image_replicates;
use glam::DVec3;

const K: usize = 8;
/// No roulette for the terms, then the analog walk: its variance is finite whatever the scene.
const TAIL: Roulette = Roulette::Albedo { from: K };

/// Where paths start, and what they must find there: `T^k E` for k = 0.. and L.
struct Pixel {
    what: String,
    start: Start,
    terms: Vec<DVec3>,
    total: DVec3,
}

/// Judges terms and total of every pixel, and of their mean, which has the samples of all.
fn check(jury: &mut Jury, scene: &Scene, pixels: &[Pixel], kind: Kind, technique: Technique, spp: u32) {
    let t = SceneTransport::new(scene);
    let starts = Starts(pixels.iter().map(|p| p.start).collect());
    let key = Key::new(jury.seed(), &format!("{kind:?} {technique}"));
    let film = film(&t, &starts, kind, &plan(K, technique, &TAIL), spp, key);
    assert_eq!(film.non_finite, 0);
    let (mean, n) = (image_replicates(&film), pixels.len() as f64);
    let whole = pixels.iter().map(|p| p.total).sum::<DVec3>() / n;
    for k in (0..=K).filter(|_| kind != Kind::Path) {
        let (e, truth) = (mean.estimate(k..k + 1), pixels.iter().map(|p| p.terms[k]).sum::<DVec3>() / n);
        let (delta, label) = (0.01 * truth + 1e-4 * whole, format!("{kind:?}, {technique}, mean of pixels, T{k}"));
        let judged = jury.judge(&label, &e, truth, delta, 0.5 * truth + 0.005 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{label}: {e:?}, truth {truth}");
    }
    for (i, p) in pixels.iter().enumerate() {
        let label = format!("{kind:?}, {technique}, {}", p.what);
        let slots = film.shape.slots;
        jury.part(&format!("{label}, L"), &at(&film, i, 0..slots), p.total, p.total);
        if kind != Kind::Path {
            for (k, &truth) in p.terms.iter().enumerate().take(K + 1) {
                jury.part(&format!("{label}, T{k}"), &at(&film, i, k..k + 1), truth, p.total);
            }
        }
    }
}

/// One number per channel from three cases.
fn three(cases: &[Case; 3], x: impl Fn(&Case) -> f64) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|c: usize| x(&cases[c])))
}

// ------------------------------------------------------------------------------------------------ closed rooms

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

// ------------------------------------------------------------------------------------------------ spheres

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

// ------------------------------------------------------------------------------------------------ direct light

/// A light that reflects nothing over a floor: T¹ at points of the floor by closed form, and no second bounce at all.
fn direct(jury: &mut Jury, name: &str, light: Geometry, emission: f64, rho: f64, points: &[(DVec3, f64)]) {
    let floor = quad(DVec3::new(-1.5, 11.0, 0.0), DVec3::NEG_Y * 13.0, DVec3::X * 13.0);
    let scene = Scene::new(&description(&[
        (light, DVec3::ZERO, DVec3::splat(emission)),
        (floor, DVec3::splat(rho), DVec3::ZERO),
    ]));
    let starts = Starts(points.iter().map(|&(p, _)| Start::At(point(&scene, p, DVec3::Z))).collect());
    let t = SceneTransport::new(&scene);
    for technique in TECHNIQUES {
        let key = Key::new(jury.seed(), name);
        let film = film(&t, &starts, Kind::Prefix, &plan(4, technique, &Roulette::LECTURE.after(4)), 1 << 17, key);
        for (i, &(p, truth)) in points.iter().enumerate() {
            let (what, truth) = (format!("{name}, {technique}, T1 at {p}"), DVec3::splat(truth));
            let judged = jury.judge(&what, &at(&film, i, 1..2), truth, 0.01 * truth, 0.5 * truth);
            assert!(technique == Technique::Scatter || judged != Judged::TooNoisy, "{what}");
            for slot in [0, 2, 3, 4, 5] {
                assert_eq!(at(&film, i, slot..slot + 1).mean, DVec3::ZERO, "{what}: slot {slot}");
            }
        }
    }
}

#[test]
fn direct_light_is_the_closed_form() {
    let mut jury = Jury::open("direct_light_is_the_closed_form");

    let rect = case("direct", "direct_rect_light");
    let corner = rect.table("light");
    let [a, b, d] = [0, 1, 3].map(|i: usize| DVec3::from_slice(&corner[i]));
    // its normal must point down
    let light = quad(a, d - a, b - a);
    let points: Vec<_> = rect.table("points").iter().map(|p| DVec3::from_slice(p)).zip(rect.list("T1")).collect();
    direct(&mut jury, "rectangle", light, rect.number("Le"), rect.number("rho"), &points);

    let disk = case("direct", "direct_disk_light");
    let center = DVec3::Z * disk.number("h");
    let light = Geometry::Disk { center, normal: DVec3::NEG_Z, radius: disk.number("R") };
    let points: Vec<_> = disk.list("offsets").iter().map(|x| DVec3::X * *x).zip(disk.list("T1")).collect();
    direct(&mut jury, "disk", light, disk.number("Le"), disk.number("rho"), &points);

    // a sphere wholly above the horizon is a point of intensity π R² Le
    let (ball, source) = (case("direct", "direct_sphere_equals_point"), case("direct", "direct_point_light"));
    let light = sphere(DVec3::Z * source.number("h"), ball.number("R"), false);
    let scale = ball.number("I") / source.number("I");
    let point = |(x, t): (&f64, f64)| (DVec3::Y * *x, t * scale);
    let offsets = source.list("offsets");
    let points: Vec<_> = offsets.iter().zip(source.list("T1")).map(point).collect();
    direct(&mut jury, "sphere", light, ball.number("Le"), source.number("rho"), &points);

    jury.assert_power(0.3, 0.15);
}

// ------------------------------------------------------------------------------------------------ the continuous cube

/// Fixed points and whole faces of the unit cube.
fn cube_pixels(scene: &Scene, cases: &[Case; 3], faces: &[u32]) -> Vec<Pixel> {
    let mut pixels = vec![];
    for (i, at) in cases[0].table("points").iter().enumerate() {
        let (axis, far) = (at[0] as usize / 2, at[0] as usize % 2);
        let mut p = DVec3::ZERO;
        p[axis] = far as f64;
        p[if axis == 0 { 1 } else { 0 }] = at[1];
        p[if axis == 2 { 1 } else { 2 }] = at[2];
        let mut n = DVec3::ZERO;
        n[axis] = if far == 1 { -1.0 } else { 1.0 };
        pixels.push(Pixel {
            what: format!("point {at:?}"),
            start: Start::At(point(scene, p, n)),
            terms: (0..=K).map(|k| three(cases, |c| c.table("terms_pts")[k][i])).collect(),
            total: three(cases, |c| c.list("L_pts")[i]),
        });
    }
    for (i, &side) in faces.iter().enumerate() {
        pixels.push(Pixel {
            what: format!("face {i}"),
            start: Start::On(side),
            terms: (0..=K).map(|k| three(cases, |c| c.table("face_integrals_terms")[k][i])).collect(),
            total: three(cases, |c| c.list("face_integrals_L")[i]),
        });
    }
    pixels
}

/// Whole faces glow. A connection to a face that touches one's own has infinite variance near the edge, so `connect` is
/// left to the patch light below.
#[test]
fn glowing_faces_of_a_cube_have_their_terms() {
    let mut jury = Jury::open("glowing_faces_of_a_cube_have_their_terms");
    for ids in [
        ["cube_cont_u50", "cube_cont_u80", "cube_cont_cornell"],
        ["cube_cont_blackceil", "cube_cont_mixed", "cube_cont_mixed"],
    ] {
        let cases = ids.map(|id| case("cube", id));
        let face =
            |(i, g): (usize, Geometry)| (g, three(&cases, |c| c.list("rho")[i]), three(&cases, |c| c.list("E")[i]));
        let surfaces: Vec<Surface> = cube_faces().into_iter().enumerate().map(face).collect();
        let scene = Scene::new(&description(&surfaces));
        let pixels = cube_pixels(&scene, &cases, &[0, 2, 4, 6, 8, 10]);
        check(&mut jury, &scene, &pixels, Kind::Prefix, Technique::Scatter, 1 << 16);
        check(&mut jury, &scene, &pixels, Kind::Prefix, Technique::Mis, 1 << 16);
        check(&mut jury, &scene, &pixels, Kind::Path, Technique::Mis, 1 << 14);
        check(&mut jury, &scene, &pixels, Kind::Single, Technique::Scatter, 1 << 13);
    }
    jury.assert_power(0.09, 0.14);
}

/// A square light in the middle of the ceiling.
#[test]
fn a_cube_with_a_patch_light_has_its_terms() {
    let mut jury = Jury::open("a_cube_with_a_patch_light_has_its_terms");
    let cases = ["cube_cont_patch"; 3].map(|id| case("cube", id));
    let rho = cases[0].list("rho");
    let mut surfaces: Vec<Surface> =
        cube_faces().into_iter().zip(&rho).map(|(g, r)| (g, DVec3::splat(*r), DVec3::ZERO)).collect();
    // the ceiling in nine tiles, the middle one glowing; y × x points down
    surfaces.truncate(5);
    let cuts = [0.0, 0.35, 0.65, 1.0];
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let (dx, dy) = (cuts[i + 1] - cuts[i], cuts[j + 1] - cuts[j]);
        let tile = quad(DVec3::new(cuts[i], cuts[j], 1.0), DVec3::Y * dy, DVec3::X * dx);
        let glow = if (i, j) == (1, 1) { 5.0 } else { 0.0 };
        surfaces.push((tile, DVec3::splat(rho[5]), DVec3::splat(glow)));
    }
    let scene = Scene::new(&description(&surfaces));
    let pixels = cube_pixels(&scene, &cases, &[0, 2, 4, 6, 8]);
    for technique in TECHNIQUES {
        check(&mut jury, &scene, &pixels, Kind::Prefix, technique, 1 << 16);
    }
    check(&mut jury, &scene, &pixels, Kind::Single, Technique::Mis, 1 << 14);
    check(&mut jury, &scene, &pixels, Kind::Path, Technique::Connect, 1 << 14);
    jury.assert_power(0.13, 0.17);
}

// ------------------------------------------------------------------------------------------------ second moments

/// Mean of (a − μ_a)(b − μ_b), which is the covariance since the means are exact.
fn covariance(a: impl ExactSizeIterator<Item = (f64, f64)>, means: (f64, f64)) -> Estimate {
    mean_of(a.map(|(x, y)| DVec3::splat((x - means.0) * (y - means.1))))
}

/// A sphere as equal to the algebra as one gets: two bands.
fn two_bands(f: f64, rho: [f64; 2], e: [f64; 2]) -> Scene {
    Scene::new(&description(&bands(1.0, &[1.0, 1.0 - 2.0 * f, -1.0], &rho, &e)))
}

#[test]
fn roulette_in_a_furnace_has_its_variance() {
    let mut jury = Jury::open("roulette_in_a_furnace_has_its_variance");
    let n = 1 << 18;
    for id in [
        "rr_furnace_rho0.5_q0.5",
        "rr_furnace_rho0.5_q0.1",
        "rr_furnace_rho0.8_q0.1",
        "rr_furnace_rho0.7_q0.2",
        "rr_furnace_rho0.95_q0.02",
    ] {
        let case = case("variance", id);
        let (rho, q, mean) = (case.number("rho"), case.number("q"), case.number("mean"));
        assert!(rho.powi(4) < (1.0 - q).powi(3), "the variance of this case cannot be measured");
        let cube = room(DVec3::splat(-1.0), DVec3::ONE, 0.0);
        let scene = Scene::new(&description(&[(cube, DVec3::splat(rho), DVec3::ONE)]));
        let starts = Starts(vec![Start::On(0)]);
        let n = if q < 0.05 { n / 8 } else { n };
        let tracer = PathTracer(plan(0, Technique::Scatter, &Roulette::Constant { from: 0, q }));
        let x = collect(&SceneTransport::new(&scene), &starts, &tracer, n, 1024, Key::new(jury.seed(), id));

        let mut judge = |what: &str, e: Estimate, truth: f64| {
            let truth = DVec3::splat(truth);
            let judged = jury.judge(&format!("{id}, {what}"), &e, truth, 0.05 * truth, 0.4 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{id}, {what}: {e:?}, truth {truth}");
        };
        judge("mean", mean_of(x.values.iter().copied()), mean);
        judge("variance", mean_of(x.values.iter().map(|x| (*x - mean).powf(2.0))), case.number("var_collision"));
        judge("second moment", mean_of(x.values.iter().map(|x| x.powf(2.0))), case.number("second_moment_collision"));
        // the number of vertices is geometric: its variance (1 − q)/q² is known
        let vertices = x.rays[0] as f64 / f64::from(n);
        let std_error = DVec3::splat(((1.0 - q) / (q * q) / f64::from(n)).sqrt());
        judge(
            "vertices",
            Estimate { mean: DVec3::splat(vertices), std_error, replicates: 0, events: None },
            case.number("mean_vertices"),
        );
    }
    jury.assert_power(0.6, 0.0);
}

/// The constant q that wins on a sphere whose emission varies: the variance there and at the analog q = 1 − ρ.
#[test]
fn roulette_on_a_sphere_has_its_variance() {
    let mut jury = Jury::open("roulette_on_a_sphere_has_its_variance");
    // a share f of the sphere emits e₀, the rest e₁: mean 1, standard deviation σ
    for (id, f, e) in [
        ("rr_optimal_q_rho0.5_sigma1", 0.5, [2.0, 0.0]),
        ("rr_optimal_q_rho0.8_sigma3", 0.1, [10.0, 0.0]),
        ("rr_optimal_q_rho0.3_sigma0.5", 0.5, [1.5, 0.5]),
    ] {
        let case = case("variance", id);
        let rho = case.number("rho");
        let sigma = (f * (e[0] - 1.0f64).powi(2) + (1.0 - f) * (e[1] - 1.0f64).powi(2)).sqrt();
        assert!((sigma - case.number("sigma")).abs() < 1e-12);
        let scene = two_bands(f, [rho; 2], e);
        for (q, key) in [(case.number("q_star"), "var_at_q_star"), (1.0 - rho, "var_at_analog")] {
            assert!(rho.powi(4) < (1.0 - q).powi(3), "the variance of this case cannot be measured");
            let tracer = PathTracer(plan(0, Technique::Scatter, &Roulette::Constant { from: 0, q }));
            let t = SceneTransport::new(&scene);
            let stream = Key::new(jury.seed(), &format!("{id} {key}"));
            let x = collect(&t, &Starts(vec![Start::On(2)]), &tracer, 1 << 18, 1024, stream);
            // the start counts with the mean emission, as in the closed form
            let mean = rho / (1.0 - rho) + e[1];
            let measured = mean_of(x.values.iter().map(|x| (*x - mean).powf(2.0)));
            let truth = DVec3::splat(case.number(key));
            let judged = jury.judge(&format!("{id}, {key}"), &measured, truth, 0.05 * truth, 0.4 * truth);
            assert_ne!(judged, Judged::TooNoisy, "{id}, {key}: {measured:?}, truth {truth}");
        }
    }
}

#[test]
fn terms_of_one_path_have_their_covariance() {
    let mut jury = Jury::open("terms_of_one_path_have_their_covariance");
    for id in ["estimator_covariance_a", "estimator_covariance_c"] {
        let case = case("variance", id);
        let (rho, e, f) = (case.list("rho"), case.list("E"), case.list("f"));
        assert_eq!(case.number("r0"), rho[0], "paths start on the first band");
        let scene = two_bands(f[0], [rho[0], rho[1]], [e[0], e[1]]);
        let (t, start) = (SceneTransport::new(&scene), Starts(vec![Start::On(0)]));
        let (mean, cov) = (case.list("mean"), case.table("cov"));
        let last = case.number("K") as usize;
        let plan = plan(last, Technique::Scatter, &Roulette::Never);
        let n = 1u32 << 18;
        let reuse = collect(&t, &start, &Prefix(plan.clone()), n, 1024, Key::new(jury.seed(), id));
        let separate = collect(&t, &start, &SingleTerm(plan), n / 4, 1024, Key::new(jury.seed(), id));
        for (name, x, shared) in [("prefix", &reuse, true), ("single", &separate, false)] {
            for (a, b) in (1..=last).flat_map(|a| (a..=last).map(move |b| (a, b))) {
                let pairs: Vec<(f64, f64)> = x.paths().map(|p| (p[a].x, p[b].x)).collect();
                let measured = covariance(pairs.into_iter(), (mean[a - 1], mean[b - 1]));
                let truth = if shared || a == b { cov[a - 1][b - 1] } else { 0.0 };
                let scale = DVec3::splat((cov[a - 1][a - 1] * cov[b - 1][b - 1]).sqrt());
                let what = format!("{id}, {name}, Cov(X{a}, X{b})");
                let judged = jury.judge(&what, &measured, DVec3::splat(truth), 0.03 * scale, 0.3 * scale);
                assert_ne!(judged, Judged::TooNoisy, "{what}: {measured:?}");
            }
        }
        // and their price: a path shared, or one for every k, besides the ray that starts each
        let rays = |x: &common::sampling::Collected, n: u32, starts: f64| {
            x.rays.iter().sum::<u64>() as f64 / f64::from(n) - starts
        };
        assert_eq!(rays(&reuse, n, 1.0), case.number("rays_reuse"));
        assert_eq!(rays(&separate, n / 4, last as f64 + 1.0), case.number("rays_separate"));
    }
    jury.assert_power(0.2, 0.0);
}

#[test]
fn roulette_and_uniform_directions_have_their_variance_term_by_term() {
    let mut jury = Jury::open("roulette_and_uniform_directions_have_their_variance_term_by_term");
    let case_of = |id: &str| case("variance", id);
    let furnace = |rho: f64| {
        let cube = room(DVec3::splat(-1.0), DVec3::ONE, 0.0);
        Scene::new(&description(&[(cube, DVec3::splat(rho), DVec3::ONE)]))
    };
    let start = Starts(vec![Start::On(0)]);
    let n = 1 << 18;

    let case = case_of("estimator_furnace_zero_variance");
    let (rho, p, last) = (case.number("rho"), case.number("p"), case.number("K") as usize);
    let scene = furnace(rho);
    let estimator = Prefix(plan(last, Technique::Scatter, &Roulette::Constant { from: 0, q: 1.0 - p }));
    let x = collect(&SceneTransport::new(&scene), &start, &estimator, n, 1024, Key::new(jury.seed(), "roulette"));
    let cov = case.table("cov");
    for (a, b) in (1..=last).flat_map(|a| (a..=last).map(move |b| (a, b))) {
        let pairs: Vec<(f64, f64)> = x.paths().map(|p| (p[a].x, p[b].x)).collect();
        let measured = covariance(pairs.into_iter(), (rho.powi(a as i32), rho.powi(b as i32)));
        let truth = DVec3::splat(cov[a - 1][b - 1]);
        let judged = jury.judge(&format!("Cov(X{a}, X{b}) with roulette"), &measured, truth, 0.05 * truth, 0.2 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{a} {b} {measured:?} {truth}");
    }

    let case = case_of("uniform_hemisphere_var_rho0.8");
    let rho = case.number("rho");
    let scene = furnace(rho);
    let t = SceneTransport { scene: &scene, sampling: Sampling::Uniform };
    let estimator = Prefix(plan(6, Technique::Scatter, &Roulette::Never));
    let x = collect(&t, &start, &estimator, n, 1024, Key::new(jury.seed(), "uniform"));
    for (k, &variance) in (1..).zip(&case.list("var")) {
        let of = |p: &[DVec3]| p[k].x;
        let values: Vec<f64> = x.paths().map(of).collect();
        let mean = rho.powi(k as i32);
        let measured = covariance(values.iter().map(|x| (*x, *x)), (mean, mean));
        let truth = DVec3::splat(variance);
        let judged = jury.judge(&format!("Var X{k}, uniform"), &measured, truth, 0.05 * truth, 0.5 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{k} {measured:?} {truth}");
        let (e, truth) = (mean_of(values.iter().map(|x| DVec3::splat(*x))), DVec3::splat(mean));
        let judged = jury.judge(&format!("X{k}, uniform"), &e, truth, 0.02 * truth, 0.2 * truth);
        assert_ne!(judged, Judged::TooNoisy, "{k} {e:?} {truth}");
    }
    jury.assert_power(0.3, 0.0);
}
