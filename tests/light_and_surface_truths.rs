//! Lights without a surface and surfaces that are not Lambertian, in whole scenes whose terms are known in closed form:
//! `tests/truth/direct.json` and `specular.json`, furnaces, bowls and single bodies under a sky.
//!
//! What the eye's walks find is judged from fixed points; what both ends or the light's walks find needs a camera, whose
//! truth is the closed form integrated over the image with two Gauss points per pixel and axis. Where a path has nothing to
//! choose but reflection or refraction, its samples are asserted to rounding and their numbers by the exact binomial.
#![allow(clippy::unwrap_used)]

mod common;

use common::judge::{Judged, Jury, at};
use common::sampling::{Start, Starts, collect, plan, point};
use common::scenes::{Surface, bands, description, quad, room, sphere};
use common::truth::case;
use common::{assert_rate, open};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::Key;
use fredholm::operator::scene_transport::SurfaceStrip;
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::progress::Progress;
use fredholm::scene::bsdf::{Bsdf, TransportMode, fresnel::hemispherical};
use fredholm::scene::description::{
    BsdfDescription, Choice, Colour, Description, Geometry, Ggx, LightDescription, Masking, Metal, Sides, Sky,
};
use fredholm::scene::description::{
    ConductorSurface, DielectricSurface, DiffuseSurface, MirrorSurface, PhongSurface, PlasticSurface,
};
use fredholm::scene::raster::Raster;
use fredholm::scene::{Scene, SurfaceSensor, Vertex};
use fredholm::terms::TermFilm;
use fredholm::terms::functional::image_replicates;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const K: usize = 4;

/// Which estimator, with which technique.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Prefix(Technique),
    Single(Technique),
    Path(Technique),
    Light,
    Bidirectional(Technique),
}

fn film<'s>(
    scene: &'s Scene,
    sensor: &impl Sensor<SceneTransport<'s>>,
    way: Way,
    last: usize,
    roulette: &Roulette,
    spp: u32,
    key: Key,
) -> TermFilm {
    let t = SceneTransport::new(scene);
    let amount = Amount { spp, replicates: 256, key };
    let with = |technique| Plan { max_bounces: last, technique, roulette: roulette.clone() };
    match way {
        Way::Prefix(technique) => render(&t, sensor, &Prefix(with(technique)), amount, Progress::NONE),
        Way::Single(technique) => render(&t, sensor, &SingleTerm(with(technique)), amount, Progress::NONE),
        Way::Path(technique) => render(&t, sensor, &PathTracer(with(technique)), amount, Progress::NONE),
        Way::Light => render(&t, sensor, &LightTracer(with(Technique::Mis)), amount, Progress::NONE),
        Way::Bidirectional(technique) => render(&t, sensor, &Bidirectional(with(technique)), amount, Progress::NONE),
    }
}

/// The mean over the image of what a closed form says of rays from the eye, term by term.
fn image_mean(d: &Description, truth: impl Fn(DVec3, DVec3) -> Vec<DVec3>) -> Vec<DVec3> {
    let c = &d.camera;
    let forward = (c.target - c.origin).normalize();
    let right = forward.cross(c.up).normalize();
    let up = right.cross(forward);
    let [w, h] = c.size;
    let pixel = 2.0 * (0.5 * c.fov).to_radians().tan() / f64::from(w);
    let nodes = |n: u32| (0..n).flat_map(|i| [-1.0, 1.0].map(|s| f64::from(i) + 0.5 + s * 0.5 / 3.0f64.sqrt()));
    let mut sum: Vec<DVec3> = vec![];
    for (x, y) in nodes(w).flat_map(|x| nodes(h).map(move |y| (x, y))) {
        let d = forward + right * (x - 0.5 * f64::from(w)) * pixel - up * (y - 0.5 * f64::from(h)) * pixel;
        let terms = truth(c.origin, d.normalize());
        sum.resize(terms.len(), DVec3::ZERO);
        sum.iter_mut().zip(terms).for_each(|(s, t)| *s += t / f64::from(4 * w * h));
    }
    sum
}

/// Judges the image means of terms 0..: 2 % is proved or half a term would have been seen; terms that are 0 must be 0.
fn check_image(jury: &mut Jury, name: &str, d: &Description, way: Way, spp: u32, truth: &[DVec3]) {
    // a particle finds the picture more rarely than a path finds the light
    let spp = if way == Way::Light { 8 * spp } else { spp };
    let scene = Scene::new(d);
    let key = Key::new(jury.seed(), &format!("{name} {way:?}"));
    let film = film(&scene, &scene.camera, way, K, &Roulette::Constant { from: K, q: 0.3 }, spp, key);
    assert_eq!(film.non_finite, 0, "{name} {way:?}");
    let image = image_replicates(&film);
    let whole: DVec3 = truth.iter().sum();
    if let Way::Path(_) = way {
        let judged =
            jury.judge(&format!("{name}, {way:?}, sum"), &image.estimate(0..1), whole, 0.02 * whole, 0.3 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{name}, {way:?}");
        return;
    }
    for (k, &truth) in truth.iter().enumerate() {
        let (e, label) = (image.estimate(k..k + 1), format!("{name}, {way:?}, T{k}"));
        if truth == DVec3::ZERO {
            assert_eq!(e.mean, DVec3::ZERO, "{label}");
            continue;
        }
        let judged = jury.judge(&label, &e, truth, 0.02 * truth, 0.5 * truth + 0.01 * whole);
        assert_ne!(judged, Judged::TooNoisy, "{label}: {e:?}, truth {truth}");
    }
}

fn all_ways() -> Vec<Way> {
    let mut all: Vec<Way> = Technique::ALL.into_iter().map(Way::Prefix).collect();
    all.extend([Way::Single(Technique::Mis), Way::Path(Technique::Mis), Way::Light]);
    all.extend([Way::Bidirectional(Technique::Mis), Way::Bidirectional(Technique::Power)]);
    all
}

/// An image of the floor, with nothing else in sight.
fn over_the_floor(surfaces: &[Surface], lights: Vec<LightDescription>, rho: f64) -> Description {
    let floor = quad(DVec3::new(-1.5, 4.5, 0.0), DVec3::NEG_Y * 6.0, DVec3::X * 6.0);
    let mut all = vec![(floor, DVec3::splat(rho), DVec3::ZERO)];
    all.extend_from_slice(surfaces);
    let mut d = description(&all);
    (d.camera.origin, d.camera.target, d.camera.up) = (DVec3::new(3.0, 3.0, 1.5), DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
    (d.camera.fov, d.lights) = (20.0, lights);
    d
}

/// T⁰ … T^K where only T¹ is not zero.
fn once(x: f64) -> Vec<DVec3> {
    let mut terms = vec![DVec3::ZERO; K + 2];
    terms[1] = DVec3::splat(x);
    terms
}

/// Where a ray meets z = 0.
fn on_floor(o: DVec3, d: DVec3) -> DVec3 {
    o - d * (o.z / d.z)
}

/// Lambert's formula: the form factor of a polygon from p with normal z, all of it above the horizon.
fn polygon(p: DVec3, corners: &[DVec3]) -> f64 {
    let v: Vec<DVec3> = corners.iter().map(|c| (c - p).normalize()).collect();
    let edge = |i: usize| {
        let (a, b) = (v[i], v[(i + 1) % v.len()]);
        a.dot(b).acos() * a.cross(b).normalize().z
    };
    ((0..v.len()).map(edge).sum::<f64>() / TAU).abs()
}

// ------------------------------------------------------------------------------------------------ direct light

#[test]
fn lights_without_a_surface_light_points_exactly() {
    let case = case("direct", "direct_point_light");
    let (i, h, rho) = (case.number("I"), case.number("h"), case.number("rho"));
    let light = LightDescription::Point { position: DVec3::Z * h, intensity: DVec3::splat(i) };
    let sun =
        LightDescription::Directional { direction: DVec3::new(1.0, 2.0, -2.0), irradiance: DVec3::new(1.0, 2.0, 3.0) };
    for (name, light) in [("point", light), ("sun", sun)] {
        let scene = Scene::new(&over_the_floor(&[], vec![light], rho));
        for (offset, truth) in case.list("offsets").into_iter().zip(case.list("T1")) {
            let truth =
                if name == "sun" { rho / PI * 2.0 / 3.0 * DVec3::new(1.0, 2.0, 3.0) } else { DVec3::splat(truth) };
            let starts = Starts(vec![Start::At(point(&scene, DVec3::X * offset, DVec3::Z))]);
            for technique in [Technique::Connect, Technique::Mis, Technique::Power] {
                let plan = plan(3, technique, &Roulette::LECTURE);
                let t = SceneTransport::new(&scene);
                let samples = [
                    collect(&t, &starts, &Prefix(plan.clone()), 64, 32, Key::new(1, name)),
                    collect(&t, &starts, &SingleTerm(plan.clone()), 64, 32, Key::new(1, name)),
                ];
                for path in samples.iter().flat_map(|s| s.paths()) {
                    assert!(
                        (path[1] / truth - 1.0).abs().max_element() < 2e-6,
                        "{name}, {technique}: {} {truth}",
                        path[1]
                    );
                    assert!([0, 2, 3, 4].iter().all(|&k| path[k] == DVec3::ZERO), "{name}, {technique}: {path:?}");
                }
                for path in collect(&t, &starts, &PathTracer(plan), 64, 32, Key::new(1, name)).paths() {
                    assert!((path[0] / truth - 1.0).abs().max_element() < 2e-6, "{name}, {technique}");
                }
            }
        }
    }
}

#[test]
fn direct_light_is_the_closed_form_from_both_ends() {
    let mut jury = Jury::open("direct_light_is_the_closed_form_from_both_ends");
    let mut judge = |name: &str, d: &Description, seen_by_hits: bool, truth: &dyn Fn(DVec3) -> f64| {
        let terms = image_mean(d, |o, dir| once(truth(on_floor(o, dir))));
        for way in all_ways() {
            if seen_by_hits || way != Way::Prefix(Technique::Scatter) {
                check_image(&mut jury, name, d, way, 1024, &terms);
            }
        }
    };

    let c = case("direct", "direct_rect_light");
    let corners: Vec<DVec3> = c.table("light").iter().map(|p| DVec3::from_slice(p)).collect();
    let (le, rho) = (c.number("Le"), c.number("rho"));
    for (p, t) in c.table("points").iter().zip(c.list("T1")) {
        assert!((rho * le * polygon(DVec3::from_slice(p), &corners) / t - 1.0).abs() < 1e-9);
    }
    let light = (quad(corners[0], corners[3] - corners[0], corners[1] - corners[0]), DVec3::ZERO, DVec3::splat(le));
    judge("rectangle", &over_the_floor(&[light], vec![], rho), true, &|p| rho * le * polygon(p, &corners));

    let c = case("direct", "direct_disk_light");
    let (r, h, le, rho) = (c.number("R"), c.number("h"), c.number("Le"), c.number("rho"));
    let f = |a2: f64| {
        let s = h * h + a2;
        rho * le * 0.5 * (1.0 - (s - r * r) / ((s + r * r).powi(2) - 4.0 * r * r * a2).sqrt())
    };
    for (a, t) in c.list("offsets").into_iter().zip(c.list("T1")) {
        assert!((f(a * a) / t - 1.0).abs() < 1e-9);
    }
    let light =
        (Geometry::Disk { center: DVec3::Z * h, normal: DVec3::NEG_Z, radius: r }, DVec3::ZERO, DVec3::splat(le));
    judge("disk", &over_the_floor(&[light], vec![], rho), true, &|p| f(p.length_squared()));

    let (c, s) = (case("direct", "direct_point_light"), case("direct", "direct_sphere_equals_point"));
    let (h, rho, i) = (c.number("h"), c.number("rho"), s.number("I"));
    let f = |p: DVec3| rho / PI * i * h / (p.length_squared() + h * h).powf(1.5);
    let light = (sphere(DVec3::Z * h, s.number("R"), false), DVec3::ZERO, DVec3::splat(s.number("Le")));
    judge("ball", &over_the_floor(&[light], vec![], rho), true, &f);
    let light = LightDescription::Point { position: DVec3::Z * h, intensity: DVec3::splat(i) };
    judge("point", &over_the_floor(&[], vec![light], rho), false, &f);

    let light = LightDescription::Directional { direction: DVec3::new(1.0, 2.0, -2.0), irradiance: DVec3::splat(3.0) };
    judge("sun", &over_the_floor(&[], vec![light], rho), false, &|_| rho / PI * 3.0 * 2.0 / 3.0);

    // a sky that is quadratic, about five axes
    let c = case("direct", "direct_env_quadratic");
    let rho = c.number("rho");
    for (cos, t) in c.list("n_dot_u").into_iter().zip(c.list("T1")).take(3) {
        let axis = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let [w, h] = [256, 128];
        let texel = |i: u32| {
            let (theta, phi) =
                (PI * (f64::from(i / w) + 0.5) / f64::from(h), TAU * ((f64::from(i % w) + 0.5) / f64::from(w) - 0.5));
            let d = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
            Vec3::splat(d.dot(axis).powi(2) as f32)
        };
        let sky = Sky::LatLong(Arc::new(Raster::new([w, h], (0..w * h).map(texel).collect())));
        let light = LightDescription::Environment { sky, rotate: 0.0, scale: 1.0 };
        judge(&format!("sky {cos}"), &over_the_floor(&[], vec![light], rho), true, &|_| t);
    }
    jury.assert_power(0.1, 0.0);
}

// ------------------------------------------------------------------------------------------------ mirrors

fn mirror(rho: f64) -> BsdfDescription {
    BsdfDescription::Mirror(MirrorSurface { reflectance: DVec3::splat(rho) })
}

#[test]
fn a_mirror_wall_doubles_the_light() {
    let mut jury = Jury::open("a_mirror_wall_doubles_the_light");
    let c = case("specular", "direct_mirror_wall");
    let corners = |key: &str| c.table(key).iter().map(|p| DVec3::from_slice(p)).collect::<Vec<_>>();
    let (light, image) = (corners("light"), corners("image"));
    let (le, rho, rho_m) = (c.number("Le"), c.number("rho"), c.number("mirror"));
    let wall = quad(DVec3::new(0.0, -20.0, 0.0), DVec3::Y * 40.0, DVec3::Z * 20.0);
    let lamp = (quad(light[0], light[3] - light[0], light[1] - light[0]), DVec3::ZERO, DVec3::splat(le));
    let mut d = over_the_floor(&[lamp, (wall, DVec3::ZERO, DVec3::ZERO)], vec![], rho);
    d.materials[2].bsdf = mirror(rho_m);
    d.camera.target = DVec3::new(1.7, 1.7, 0.0);
    let f = |p: DVec3| {
        let mut terms = once(rho * le * polygon(p, &light));
        terms[2] = DVec3::splat(rho * rho_m * le * polygon(p, &image));
        terms
    };
    let scene = Scene::new(&d);
    let points: Vec<DVec3> = c.table("points").iter().map(|p| DVec3::from_slice(p)).collect();
    let starts = Starts(points.iter().map(|&p| Start::At(point(&scene, p, DVec3::Z))).collect());
    for way in Technique::ALL.into_iter().map(Way::Prefix) {
        let film = film(&scene, &starts, way, K, &Roulette::LECTURE.after(K), 1 << 16, Key::new(jury.seed(), "points"));
        for (i, p) in points.iter().enumerate() {
            for (k, key) in [(1, "T1"), (2, "T2")] {
                let truth = DVec3::splat(c.list(key)[i]);
                assert!((f(*p)[k] / truth - 1.0).abs().max_element() < 1e-9);
                let judged =
                    jury.judge(&format!("{way:?} {p} T{k}"), &at(&film, i, k..k + 1), truth, 0.01 * truth, 0.5 * truth);
                // in the mirror the light is found by hits alone
                assert!(k == 2 || way == Way::Prefix(Technique::Scatter) || judged != Judged::TooNoisy);
            }
            assert!([0, 3, 4, 5].iter().all(|&k| at(&film, i, k..k + 1).mean == DVec3::ZERO));
        }
    }
    // no image of the floor itself: the camera sees the floor only, so that light's walks see all of it
    let terms = image_mean(&d, |o, dir| f(on_floor(o, dir)));
    for way in all_ways() {
        check_image(&mut jury, "mirror wall", &d, way, 4096, &terms);
    }
    // a point light has an image, too, which only light's walks can find
    let mut d = over_the_floor(
        &[(quad(DVec3::new(0.0, -20.0, 0.0), DVec3::Y * 40.0, DVec3::Z * 20.0), DVec3::ZERO, DVec3::ZERO)],
        vec![],
        rho,
    );
    d.materials[1].bsdf = mirror(rho_m);
    d.camera.target = DVec3::new(1.7, 1.7, 0.0);
    let (from, i) = (DVec3::new(1.0, 0.5, 2.0), 4.0);
    d.lights = vec![LightDescription::Point { position: from, intensity: DVec3::splat(i) }];
    let lit = |p: DVec3, from: DVec3| rho / PI * i * from.z / (from - p).length().powi(3);
    let terms = image_mean(&d, |o, dir| {
        let p = on_floor(o, dir);
        let mut terms = once(lit(p, from));
        terms[2] = DVec3::splat(rho_m * lit(p, from * DVec3::new(-1.0, 1.0, 1.0)));
        terms
    });
    for way in [Way::Light, Way::Bidirectional(Technique::Mis), Way::Bidirectional(Technique::Power)] {
        check_image(&mut jury, "image of a point", &d, way, 8192, &terms);
    }
    // and the eye's walks cannot, which is said in `engine::known::unsampled`
    let mut direct = terms.clone();
    direct[2] = DVec3::ZERO;
    check_image(&mut jury, "image of a point", &d, Way::Prefix(Technique::Mis), 1024, &direct);
    jury.assert_power(0.1, 0.1);
}

/// Every sample in a closed room whose surfaces all reflect ρ, in whatever way, is ρ^k E.
#[test]
fn mirrors_and_lambertian_walls_make_the_same_furnace() {
    let two = case("specular", "mirror_two_parallel");
    let lambert =
        |rho: f64| BsdfDescription::Diffuse(DiffuseSurface { reflectance: Colour::Uniform(DVec3::splat(rho)) });
    let metal = |rho: f64| {
        BsdfDescription::Conductor(ConductorSurface { metal: Metal::Reflectance(DVec3::splat(rho)), rough: None })
    };
    let rs = two.number("rs");
    for (name, materials) in [
        ("mirrors", vec![mirror(rs); 3]),
        ("walls of mirrors", vec![mirror(rs), lambert(rs), metal(rs)]),
        ("things of mirrors", vec![lambert(rs), mirror(rs), metal(rs)]),
        ("metal walls", vec![metal(rs), mirror(rs), lambert(rs)]),
    ] {
        let e = DVec3::splat(two.number("E"));
        // round things: where two faces of a block meet, a few rays in a million end on the back of the next face
        let other = sphere(DVec3::new(-0.3, -0.4, -0.2), 0.35, false);
        let shapes = [room(DVec3::splat(-1.0), DVec3::ONE, 20.0), other, sphere(DVec3::splat(0.5), 0.3, false)];
        let mut d = description(&shapes.map(|g| (g, DVec3::ZERO, e)));
        d.materials.iter_mut().zip(materials).for_each(|(m, bsdf)| m.bsdf = bsdf);
        d.camera.origin = DVec3::new(-0.5, 0.6, 0.6);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let plan = plan(8, Technique::Scatter, &Roulette::Never);
        let samples = [
            collect(&t, &scene.camera, &Prefix(plan.clone()), 32, 32, Key::new(1, name)),
            collect(&t, &scene.camera, &SingleTerm(plan), 32, 32, Key::new(1, name)),
        ];
        for path in samples.iter().flat_map(|s| s.paths()) {
            for (k, truth) in two.list("terms").into_iter().enumerate() {
                assert!((path[k] / truth - 1.0).abs().max_element() < 2e-6, "{name}, k = {k}: {} {truth}", path[k]);
            }
        }
    }
}

// ------------------------------------------------------------------------------------------------ glass

fn glass(ior: f64, choice: Choice, rough: Option<Ggx>) -> BsdfDescription {
    BsdfDescription::Dielectric(DielectricSurface { ior, ior_outside: 1.0, choice, rough })
}

fn sky(radiance: f64) -> LightDescription {
    LightDescription::Environment { sky: Sky::Constant(DVec3::splat(radiance)), rotate: 0.0, scale: 1.0 }
}

/// These surfaces of one material, both sides, under a sky of 1.
fn under_the_sky(shapes: &[Geometry], bsdf: &BsdfDescription) -> Description {
    let surfaces: Vec<Surface> = shapes.iter().map(|g| (g.clone(), DVec3::ZERO, DVec3::ZERO)).collect();
    let mut d = description(&surfaces);
    d.materials.iter_mut().for_each(|m| (m.bsdf, m.sides) = (bsdf.clone(), Sides::Both));
    d.lights = vec![sky(1.0)];
    d
}

fn slab() -> Vec<Geometry> {
    let side = |z: f64, u: DVec3, v: DVec3| quad(DVec3::new(-40.0, -40.0, z), u * 80.0, v * 80.0);
    vec![side(0.0, DVec3::X, DVec3::Y), side(-1.0, DVec3::Y, DVec3::X)]
}

/// A vertex on the top, z = 0 or the pole of the unit sphere below it, asked at this angle.
fn tilted(scene: &Scene, degrees: f64) -> Vertex {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let d = DVec3::new(-sin, 0.0, -cos);
    scene.trace((-2.0 * d - scene.origin()).as_vec3(), d.as_vec3()).unwrap()
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

// ------------------------------------------------------------------------------------------------ bodies under a sky

/// ∫ f cos dω, by the midpoint rule in the disk of half vectors seen from above, where lobes are round.
fn albedo(bsdf: &Bsdf, wo: Vec3) -> DVec3 {
    const N: i32 = 600;
    let mut sum = DVec3::ZERO;
    // ω_i = reflection of ω_o about h: dω_i = 4 (ω_o·h) dh, dh = dx dy/h_z
    for (i, j) in (0..N).flat_map(|i| (0..2 * N).map(move |j| (i, j))) {
        let (r, phi) = ((f64::from(i) + 0.5) / f64::from(N), TAU * (f64::from(j) + 0.5) / f64::from(2 * N));
        // r = tan θ/(1 + tan θ): dense at the normal
        let tan = r / (1.0 - r);
        let z = 1.0 / (1.0 + tan * tan).sqrt();
        let h = DVec3::new(tan * z * phi.cos(), tan * z * phi.sin(), z);
        let c = wo.as_dvec3().dot(h);
        let wi = 2.0 * c * h - wo.as_dvec3();
        if c > 0.0 && wi.z > 0.0 {
            // dh = z³ tan dtan dφ
            let dh = z.powi(3) * tan / (1.0 - r).powi(2) / f64::from(N) * TAU / f64::from(2 * N);
            let f = bsdf.eval(wo, wi.as_vec3(), TransportMode::Radiance).as_dvec3();
            sum += f * wi.z * 4.0 * c * dh;
        }
    }
    sum
}

/// A convex body in a sky of 1: T¹ is its albedo in that direction, and there is nothing else.
#[test]
fn convex_bodies_show_their_albedo() {
    let mut jury = Jury::open("convex_bodies_show_their_albedo");
    let rho = DVec3::new(0.9, 0.5, 0.2);
    let colour = || Colour::Uniform(rho);
    let ggx = |alpha: f64| Some(Ggx { alpha, masking: Masking::HeightCorrelated });
    let gold = Metal::Fresnel { eta: DVec3::new(0.17, 0.4, 1.4), k: DVec3::new(3.1, 2.4, 1.6) };
    let mut kinds = vec![
        BsdfDescription::Diffuse(DiffuseSurface { reflectance: colour() }),
        BsdfDescription::Mirror(MirrorSurface { reflectance: rho }),
        BsdfDescription::Conductor(ConductorSurface { metal: gold, rough: None }),
        BsdfDescription::Plastic(PlasticSurface { reflectance: colour(), ior: 1.5, rough: None }),
    ];
    for alpha in [0.1, 0.4, 1.0] {
        kinds.push(BsdfDescription::Conductor(ConductorSurface { metal: gold, rough: ggx(alpha) }));
        kinds.push(BsdfDescription::Plastic(PlasticSurface { reflectance: colour(), ior: 1.5, rough: ggx(alpha) }));
    }
    for exponent in [1.0, 40.0] {
        kinds.push(BsdfDescription::Phong(PhongSurface {
            reflectance: Colour::Uniform(0.5 * rho),
            specular: DVec3::splat(0.4),
            exponent,
        }));
    }
    for bsdf in &kinds {
        let scene = Scene::new(&under_the_sky(&[sphere(DVec3::NEG_Z, 1.0, false)], bsdf));
        let angles = [0.0, 45.0, 75.0];
        let starts = Starts(angles.map(|a| Start::At(tilted(&scene, a))).to_vec());
        let side = Bsdf::new(bsdf, false);
        let delta = side.has_delta();
        for way in [
            Way::Prefix(Technique::Scatter),
            Way::Prefix(Technique::Mis),
            Way::Prefix(Technique::Connect),
            Way::Single(Technique::Power),
        ] {
            let film = film(
                &scene,
                &starts,
                way,
                2,
                &Roulette::LECTURE,
                1 << 15,
                Key::new(jury.seed(), &format!("{bsdf:?} {way:?}")),
            );
            for (i, &degrees) in angles.iter().enumerate() {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let wo = DVec3::new(sin, 0.0, cos).as_vec3();
                let truth = if delta || matches!(bsdf, BsdfDescription::Diffuse(_)) {
                    side.albedo(wo).as_dvec3()
                } else {
                    albedo(&side, wo)
                };
                let label = format!("{bsdf:?}, {way:?}, {degrees}°");
                assert!(truth.max_element() < 1.0 + 1e-3, "{label}: {truth}");
                jury.judge(&label, &at(&film, i, 1..2), truth, 0.01 * truth, 0.3 * truth);
                assert!([0, 2, 3].iter().all(|&k| at(&film, i, k..k + 1).mean == DVec3::ZERO), "{label}");
            }
        }
    }
    jury.assert_power(0.2, 0.05);
}

/// Averaged over the body and its directions: Walsh's integral in closed form, and ρ of a Lambertian body, from all ends.
#[test]
fn bodies_reflect_their_share_of_the_sky() {
    let mut jury = Jury::open("bodies_reflect_their_share_of_the_sky");
    let fresnel = case("fresnel", "fresnel_diffuse_1.5");
    let (out, inside) = (fresnel.number("F_out"), fresnel.number("F_in"));
    assert!((hemispherical(1.5) - out).abs() < 1e-9);
    let rho = DVec3::new(0.9, 0.5, 0.2);
    // what enters, 1 − F_out, leaves the base ρ(1 − F_in)/(1 − ρ F_in) of it
    let plastic = rho.map(|rho| out + (1.0 - out) * rho * (1.0 - inside) / (1.0 - rho * inside));
    let colour = Colour::Uniform(rho);
    for (name, bsdf, truth) in [
        (
            "plastic",
            BsdfDescription::Plastic(PlasticSurface { reflectance: colour.clone(), ior: 1.5, rough: None }),
            plastic,
        ),
        ("paper", BsdfDescription::Diffuse(DiffuseSurface { reflectance: colour }), rho),
    ] {
        let mut d = under_the_sky(&[sphere(DVec3::ZERO, 1.0, false)], &bsdf);
        d.materials[0].sides = Sides::Front;
        let scene = Scene::new(&d);
        let strip = SurfaceStrip { sensor: SurfaceSensor::new(&scene), pixels: 16 };
        for technique in Technique::ALL {
            let film = film(
                &scene,
                &strip,
                Way::Prefix(technique),
                2,
                &Roulette::LECTURE,
                1 << 13,
                Key::new(jury.seed(), &format!("{name} {technique}")),
            );
            let image = image_replicates(&film);
            let judged =
                jury.judge(&format!("{name}, {technique}"), &image.estimate(1..2), truth, 0.01 * truth, 0.1 * truth);
            assert_ne!(judged, Judged::TooNoisy);
            assert!([0, 2, 3].iter().all(|&k| image.estimate(k..k + 1).mean == DVec3::ZERO));
        }
        // from a camera that sees the body only
        if name == "paper" {
            (d.camera.origin, d.camera.fov) = (DVec3::new(0.0, 0.0, 3.0), 20.0);
            let mut terms = once(0.0);
            terms[1] = rho;
            for way in all_ways() {
                check_image(&mut jury, name, &d, way, 1024, &terms);
            }
        }
    }
    jury.assert_power(0.4, 0.0);
}

/// A bowl under a real sky.
#[test]
fn bowls_under_the_sky_have_their_terms() {
    let mut jury = Jury::open("bowls_under_the_sky_have_their_terms");
    for id in ["bowl_hemisphere_rho0.7", "bowl_shallow_rho0.5"] {
        let case = case("spheres", id);
        let (z, rho) = (case.number("z_cut_over_R"), case.number("rho"));
        let mut d = description(&bands(1.0, &[z, -1.0], &[rho], &[0.0]));
        d.lights = vec![sky(case.number("sky"))];
        (d.camera.origin, d.camera.target, d.camera.up) = (DVec3::new(0.0, 0.3, 1.0), DVec3::NEG_Z, DVec3::Y);
        d.camera.fov = 25.0;
        let terms: Vec<DVec3> = case.list("terms").into_iter().take(K + 1).map(DVec3::splat).collect();
        for way in all_ways() {
            let mut terms = terms.clone();
            if let Way::Path(_) = way {
                terms = vec![DVec3::splat(case.number("L"))];
            }
            check_image(&mut jury, id, &d, way, 4096, &terms);
        }
    }
    jury.assert_power(0.1, 0.0);
}
