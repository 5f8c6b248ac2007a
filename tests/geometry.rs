//! Tolerances come from rounding: no answer depends on the size of a scene, on where it stands, or on how thin its lights are.
//!
//! | promise | value | test |
//! |---|---|---|
//! | a lamp keeps its size | T⁰E of a lamp is its share of the picture, whatever the ground is and however large | `a_small_lamp_keeps_its_size_beside_any_ground` |
//! | thin lights | T¹E of a point below a rectangle (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-3) | `needles_and_strips_light_what_they_should` |
//! | a place far away | every bit of every term, and of the matrix | `a_room_far_away_is_the_room_at_the_origin` |
//! | a far camera | T⁰E, T¹E of a room | `a_camera_may_stand_far_away` |
//! | one density per pair of points | that of the two points in `f64` | `both_techniques_state_the_densities_of_the_pair` |
//! | curved lights | T¹E = ρ inside a sphere; ρ/(1+δ)² beside one | `a_glowing_sphere_is_seen_from_inside_and_from_beside` |
//! | what single precision cannot hold | an error with the shape, its line and the reason | `a_shape_that_rounding_would_deform_is_refused` |
#![allow(clippy::unwrap_used)]

mod common;

use common::open;
use common::sampling::{Kind, TECHNIQUES, collect, film, plan};
use common::scenes::{description, quad, room, sphere};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Bidirectional, LightTracer, Prefix, Roulette, Technique};
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::patches::Patches;
use fredholm::operator::{SceneTransport, Transport};
use fredholm::progress::Progress;
use fredholm::scene::description::{CameraDescription, Description, Geometry, LightDescription, Sides};
use fredholm::scene::load::{Options, toml};
use fredholm::scene::{Scene, Vertex};
use fredholm::terms::{Estimate, TermFilm, functional::image_replicates};
use glam::{DQuat, DVec3};
use std::path::Path;

fn camera(origin: DVec3, target: DVec3, up: DVec3, fov: f64, size: u32) -> CameraDescription {
    CameraDescription { origin, target, up, fov, size: [size; 2] }
}

/// Term k of the image mean.
fn image(film: &TermFilm, k: usize) -> Estimate {
    image_replicates(film).estimate(k..k + 1)
}

fn mesh(corners: [DVec3; 4]) -> Geometry {
    Geometry::Mesh { vertices: corners.to_vec(), faces: vec![[0, 1, 2], [0, 2, 3]], uvs: vec![] }
}

/// A horizontal square of this half width, front down or up, as each kind of shape; the sphere touches the point from above or below.
fn flat(kind: &str, at: DVec3, half: f64, up: f64) -> Geometry {
    let (u, v) = (DVec3::X * half, DVec3::Z * half * -up);
    let o = at - u - v;
    match kind {
        "quad" => quad(o, 2.0 * u, 2.0 * v),
        "mesh" => mesh([o, o + 2.0 * u, o + 2.0 * u + 2.0 * v, o + 2.0 * v]),
        "disk" => Geometry::Disk { center: at, normal: DVec3::Y * up, radius: half },
        _ => sphere(at - DVec3::Y * half * if up > 0.0 { 1.0 } else { 0.0 }, half, false),
    }
}

const KINDS: [&str; 4] = ["quad", "mesh", "disk", "sphere"];

/// A lamp of 2 cm, 0.5 m above the camera, that fills a known part of the picture. On grounds of 20 m to 20 km the picture is the same to
/// the last bit.
#[test]
fn a_small_lamp_keeps_its_size_beside_any_ground() {
    let mut account = open("a_small_lamp_keeps_its_size_beside_any_ground");
    // half the picture is 0.04 of the distance
    let half_angle = 0.04f64;
    let tangent = 0.02 / (1.0 - 0.0004f64).sqrt();
    let disk = std::f64::consts::PI / (4.0 * half_angle * half_angle);
    for (lamp, truth) in [("quad", 0.25), ("mesh", 0.25), ("disk", 0.0004 * disk), ("sphere", tangent * tangent * disk)]
    {
        let mut first = None;
        for ground in KINDS {
            for size in [20.0, 200.0, 2000.0, 20_000.0] {
                let black = |g| (g, DVec3::ZERO, DVec3::ZERO);
                let light = flat(lamp, DVec3::Y, 0.01, -1.0);
                let mut d =
                    description(&[black(flat(ground, DVec3::ZERO, 0.5 * size, 1.0)), (light, DVec3::ZERO, DVec3::ONE)]);
                d.camera = camera(0.5 * DVec3::Y, DVec3::Y, DVec3::Z, 2.0 * half_angle.atan().to_degrees(), 16);
                let scene = Scene::new(&d);
                let plan = plan(0, Technique::Scatter, &Roulette::Never);
                let key = Key::new(account.seed(), lamp);
                let t = SceneTransport::new(&scene);
                let of = |spp| image(&film(&t, &scene.camera, Kind::Prefix, &plan, spp, key), 0);
                let found = of(256).mean;
                let first = first.get_or_insert_with(|| {
                    account.assert_equivalent(lamp, &of(12_288), DVec3::splat(truth), DVec3::splat(0.005 * truth));
                    found
                });
                assert_eq!(found, *first, "{lamp} beside a {ground} of {size} m");
            }
        }
    }
}

/// ∫ cos cos/(π r²) over a rectangle of half sides a, b centred at height 1 above a point that it is parallel to.
fn from_below(a: f64, b: f64) -> f64 {
    let part = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
    2.0 / std::f64::consts::PI * (part(a, b) + part(b, a))
}

/// A receiver of 2 mm looks up at a light that is a thousand times as long as it is wide, along an axis and askew.
#[test]
fn needles_and_strips_light_what_they_should() {
    let mut account = open("needles_and_strips_light_what_they_should");
    let receiver = flat("quad", DVec3::ZERO, 0.001, 1.0);
    for (kind, a, b, degrees) in [
        ("quad", 0.05, 300.0, 0.0),
        ("mesh", 0.05, 300.0, 0.0),
        ("quad", 0.005, 300.0, 0.0),
        ("mesh", 0.05, 30.0, 33.0),
        ("quad", 0.05, 30.0, 33.0),
        ("quad", 1e4, 1e4, 20.0),
    ] {
        let turn = DQuat::from_rotation_y(f64::to_radians(degrees));
        let (u, v) = (turn * DVec3::X * a, turn * DVec3::Z * b);
        let o = DVec3::Y - u - v;
        let light = match kind {
            "quad" => quad(o, 2.0 * u, 2.0 * v),
            _ => mesh([o, o + 2.0 * u, o + 2.0 * u + 2.0 * v, o + 2.0 * v]),
        };
        let truth = 0.5 * from_below(a, b);
        let grey = DVec3::splat(0.5);
        let mut d = description(&[(receiver.clone(), grey, DVec3::ZERO), (light, DVec3::ZERO, DVec3::ONE)]);
        d.camera = camera(0.0005 * DVec3::Y, DVec3::ZERO, DVec3::Z, 60.0, 4);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        for technique in TECHNIQUES.into_iter().chain([Technique::Power]) {
            // points of a large light hardly ever lie near
            if technique == Technique::Connect && a * b > 10.0 {
                continue;
            }
            let name = format!("{kind} {a} × {b} at {degrees}°, {technique}");
            let plan = plan(1, technique, &Roulette::Never);
            let found = film(&t, &scene.camera, Kind::Prefix, &plan, 16_384, Key::new(account.seed(), &name));
            account.assert_consistent(&name, &image(&found, 1), DVec3::splat(truth));
        }
        let name = format!("{kind} {a} × {b}, both ends");
        let amount = Amount { spp: 4096, replicates: 256, key: Key::new(account.seed(), &name) };
        let both = Bidirectional(plan(1, Technique::Mis, &Roulette::Never));
        let found = render(&t, &scene.camera, &both, amount, Progress::NONE);
        account.assert_consistent(&name, &image(&found, 1), DVec3::splat(truth));
    }
}

/// A furnace with a mesh, a quad, a ball and a point light in it, about a point whose coordinates are exact in `f64`.
fn furnished(at: DVec3) -> Description {
    let mut d = description(&[
        (room(at - DVec3::ONE, at + DVec3::new(1.0, 1.5, 1.0), 0.0), DVec3::splat(0.5), DVec3::ONE),
        (
            mesh(
                [[0.25, 0.125, 0.25], [0.75, 0.125, 0.5], [0.5, 0.6875, 0.5], [0.25, 0.5, 0.75]]
                    .map(|p| at + DVec3::from(p)),
            ),
            DVec3::new(0.75, 0.5, 0.25),
            DVec3::ZERO,
        ),
        (
            quad(at + DVec3::new(-0.5, -0.5, -0.5), DVec3::X * 0.375, DVec3::new(0.0, 0.25, 0.25)),
            DVec3::splat(0.25),
            DVec3::ONE,
        ),
        (sphere(at + DVec3::new(-0.25, 0.5, 0.25), 0.125, false), DVec3::splat(0.5), DVec3::new(2.0, 1.0, 0.5)),
    ]);
    d.materials[1].sides = Sides::Both;
    d.lights.push(LightDescription::Point { position: at + DVec3::new(0.5, 1.0, -0.5), intensity: DVec3::ONE });
    d.camera = camera(at, at + DVec3::new(1.0, 0.25, 0.375), DVec3::Y, 80.0, 8);
    d
}

#[test]
fn a_room_far_away_is_the_room_at_the_origin() {
    let bits = |d: &Description| {
        let scene = Scene::new(d);
        let t = SceneTransport::new(&scene);
        let key = Key::new(1, "far");
        let plan = plan(3, Technique::Mis, &Roulette::Albedo { from: 3 });
        let mut all = collect(&t, &scene.camera, &Prefix(plan.clone()), 8, 8, key).values;
        for film in [
            render(&t, &scene.camera, &Bidirectional(plan.clone()), Amount::new(8, key), Progress::NONE),
            render(&t, &scene.camera, &LightTracer(plan), Amount::new(8, key), Progress::NONE),
        ] {
            all.extend((0..64).flat_map(|p| (0..4).map(move |k| (p, k))).map(|(p, k)| film.sum(p, 0, k)));
        }
        // the matrix holds surfaces only
        let patches = Patches::new(&Description { lights: vec![], ..d.clone() }, 100).unwrap();
        all.extend(patches.iter().flat_map(|p| [p.centre, p.normal, DVec3::splat(p.area)]));
        all
    };
    let here = bits(&furnished(DVec3::ZERO));
    for at in [
        DVec3::new(1e5, 0.0, 0.0),
        DVec3::new(-1e6, 3e5, 1e6),
        DVec3::new(1e8, 1e8, 0.0),
        DVec3::new(5e7, 0.0, -1e9),
        DVec3::new(0.375, -7.5, 1024.25),
    ] {
        assert!(bits(&furnished(at)) == here, "the room at {at} has other bits");
    }

    // where nothing is sampled but directions, T^k E = 0.5^k to the last bit
    for at in [0.0, 1e5, 1e6, 1e8] {
        let at = DVec3::new(at, -at, 0.5 * at);
        let mut d = description(&[(room(at - DVec3::ONE, at + DVec3::ONE, 0.0), DVec3::splat(0.5), DVec3::ONE)]);
        d.camera = camera(at, at + DVec3::new(1.0, 0.2, 0.3), DVec3::Y, 70.0, 8);
        let scene = Scene::new(&d);
        let estimator = Prefix(plan(6, Technique::Scatter, &Roulette::Never));
        let all = collect(&SceneTransport::new(&scene), &scene.camera, &estimator, 16, 16, Key::new(2, "furnace"));
        for path in all.paths() {
            assert!((0..=6).all(|k| path[k] == DVec3::splat(0.5f64.powi(k as i32))), "{at}: {path:?}");
        }
    }
}

/// A glowing box seen from ever farther away fills the same part of the picture, and its face reflects nothing but what the wall behind
/// the camera sends.
#[test]
fn a_camera_may_stand_far_away() {
    let mut account = open("a_camera_may_stand_far_away");
    for distance in [3.0f64, 1e3, 1e6, 3e7, 1e9] {
        // seen along −z: a square of 1 m before a brighter one that fills the rest of the picture, 2 m wide
        let black = |g, e| (g, DVec3::ZERO, DVec3::splat(e));
        let face = |z: f64, half: f64| quad(DVec3::new(-half, -half, z), 2.0 * half * DVec3::X, 2.0 * half * DVec3::Y);
        let mut d = description(&[black(face(0.0, 0.5), 1.0), black(face(-1e-3, 1.05), 3.0)]);
        let fov = 2.0 * (1.0 / distance).atan().to_degrees();
        d.camera = camera(DVec3::new(0.0, 0.0, distance), DVec3::ZERO, DVec3::Y, fov, 16);
        let scene = Scene::new(&d);
        let plan = plan(0, Technique::Scatter, &Roulette::Never);
        let key = Key::new(account.seed(), "camera");
        let t = SceneTransport::new(&scene);
        let found = image(&film(&t, &scene.camera, Kind::Prefix, &plan, 1024, key), 0);
        account.assert_equivalent(&format!("{distance} m"), &found, DVec3::splat(2.5), DVec3::splat(0.005));
        // and light that is led to the eye finds the pixels that the eye's rays start from
        let amount = Amount { spp: 1024, replicates: 256, key };
        let light = LightTracer(plan);
        let found = image(&render(&t, &scene.camera, &light, amount, Progress::NONE), 0);
        account.assert_equivalent(&format!("light from {distance} m"), &found, DVec3::splat(2.5), DVec3::splat(0.1));
    }
}

/// Scenes that strain densities: one light each and a receiver.
fn strained() -> Vec<(&'static str, Description)> {
    let grey = |g| (g, DVec3::splat(0.5), DVec3::ZERO);
    let light = |g| (g, DVec3::splat(0.5), DVec3::ONE);
    let ground = flat("quad", DVec3::ZERO, 1.0, 1.0);
    let needle = |a: f64, b: f64| flat_strip("mesh", a, b);
    vec![
        ("needles", description(&[grey(ground.clone()), light(needle(0.05, 300.0))])),
        ("strip", description(&[grey(ground.clone()), light(flat_strip("quad", 0.005, 300.0))])),
        ("tiny", description(&[grey(ground.clone()), light(flat("quad", DVec3::new(0.0, 1e-3, 0.0), 1e-6, -1.0))])),
        ("huge", description(&[grey(ground.clone()), light(flat("quad", DVec3::Y, 1e4, -1.0))])),
        (
            "wall",
            description(&[
                grey(ground.clone()),
                light(quad(DVec3::new(1.0, 0.0, -1.0), 2.0 * DVec3::Z, 2.0 * DVec3::Y)),
            ]),
        ),
        ("inside", description(&[light(sphere(DVec3::ZERO, 1.0, true))])),
        ("ball", description(&[grey(ground.clone()), light(sphere(DVec3::new(0.0, 1.001, 0.0), 1.0, false))])),
        ("disk", description(&[grey(ground), light(flat("disk", DVec3::new(0.3, 0.01, 0.0), 0.05, -1.0))])),
    ]
}

fn flat_strip(kind: &str, a: f64, b: f64) -> Geometry {
    let (u, v) = (DVec3::X * a, DVec3::Z * b);
    let o = DVec3::Y - u - v;
    match kind {
        "quad" => quad(o, 2.0 * u, 2.0 * v),
        _ => mesh([o, o + 2.0 * u, o + 2.0 * u + 2.0 * v, o + 2.0 * v]),
    }
}

/// What a ray finds and what a connection chooses have the densities of the two points, by scattering and by next-event estimation:
/// cos θ_x/π and p_A r²/cos θ_y, or that of the cone, in `f64`. So at every pair of points the weights add up to one.
#[test]
fn both_techniques_state_the_densities_of_the_pair() {
    for (name, d) in strained() {
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let key = Key::new(3, name);
        let sides: Vec<u32> = (0..scene.sides()).step_by(2).filter(|s| scene.albedo(*s).x > 0.0).collect();
        let mut counted = [0; 2];
        for sample in 0..40_000u32 {
            let mut rng = Rng::at(key, sample, 0, 0, Purpose::Start);
            let u = rng.four();
            let side = sides[sample as usize % sides.len()];
            let (p, n) = scene.point(side, [u[0], u[1]]);
            let x = Vertex { p, n, omega: n, side };
            let pair = |y: &Vertex| {
                let (a, b) = (x.p.as_dvec3(), y.p.as_dvec3());
                let r2 = a.distance_squared(b);
                let to = (b - a) / r2.sqrt();
                let (cos_x, cos_y) = (to.dot(x.n.as_dvec3()), -to.dot(y.n.as_dvec3()));
                // how far the rounding of both points may turn the direction
                let bend = 8.0 * f64::from(f32::EPSILON) * (a.abs().max(b.abs()).max_element() / r2.sqrt() + 1.0);
                (r2, cos_x, cos_y, bend)
            };
            let found = [t.scatter(&x, &mut Rng::at(key, sample, 0, 1, Purpose::Scatter)), t.connect(&x, &mut rng)];
            for (way, step) in found.into_iter().enumerate() {
                let Some(step) = step.filter(|s| scene.light_density(s.state.side) > 0.0) else { continue };
                let (scatter, light) = if way == 0 { (step.pdf, step.other_pdf) } else { (step.other_pdf, step.pdf) };
                let (r2, cos_x, cos_y, bend) = pair(&step.state);
                if cos_x < 1e3 * bend || cos_y < 1e3 * bend {
                    continue;
                }
                counted[way] += 1;
                let expected = cos_x / std::f64::consts::PI;
                assert!((f64::from(scatter) / expected - 1.0).abs() < 2e-3, "{name}: {step:?}, cos θ/π = {expected}");
                if name == "ball" {
                    continue; // its cone has a test of its own: tests/lights.rs
                }
                let expected = f64::from(scene.light_density(step.state.side)) * r2 / cos_y;
                assert!(
                    (f64::from(light) / expected - 1.0).abs() < 3e-3,
                    "{name}: {step:?}, p_A r²/cos θ = {expected}"
                );
            }
        }
        let least = if name == "tiny" { [0, 1000] } else { [40, 40] };
        assert!(counted[0] >= least[0] && counted[1] >= least[1], "{name}: {counted:?} pairs");
    }
}

#[test]
fn a_glowing_sphere_is_seen_from_inside_and_from_beside() {
    let mut account = open("a_glowing_sphere_is_seen_from_inside_and_from_beside");
    // inside, both densities of every pair are equal, and each of the two samples carries half of ρ: nothing is left to chance
    let mut d = description(&[(sphere(DVec3::ZERO, 1.0, true), DVec3::splat(0.5), DVec3::ONE)]);
    d.camera = camera(DVec3::ZERO, DVec3::Z, DVec3::Y, 90.0, 8);
    let scene = Scene::new(&d);
    let all = collect(
        &SceneTransport::new(&scene),
        &scene.camera,
        &Prefix(plan(1, Technique::Mis, &Roulette::Never)),
        256,
        256,
        Key::new(account.seed(), "inside"),
    );
    let mean = all.paths().map(|p| p[1].x).sum::<f64>() / all.paths().count() as f64;
    assert!((mean - 0.5).abs() < 5e-8, "T1 inside a sphere is {mean}");

    // a point of the receiver at height δ above a unit sphere sees it with the configuration factor 1/(1 + δ)²
    for gap in [0.1, 1e-3, 1e-5] {
        let receiver = flat("quad", DVec3::Y * (1.0 + gap), 1e-2 * gap, -1.0);
        let ball = sphere(DVec3::ZERO, 1.0, false);
        let mut d = description(&[(receiver, DVec3::splat(0.5), DVec3::ZERO), (ball, DVec3::ZERO, DVec3::ONE)]);
        d.camera = camera(DVec3::Y * (1.0 + 0.995 * gap), DVec3::Y * (1.0 + gap), DVec3::Z, 30.0, 4);
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let truth = DVec3::splat(0.5 / (1.0 + gap).powi(2));
        for technique in TECHNIQUES {
            let name = format!("{gap} above, {technique}");
            let plan = plan(1, technique, &Roulette::Never);
            let found = film(&t, &scene.camera, Kind::Prefix, &plan, 16_384, Key::new(account.seed(), &name));
            account.assert_equivalent(&name, &image(&found, 1), truth, 0.02 * truth);
        }
        let name = format!("{gap} above, both ends");
        let amount = Amount { spp: 16_384, replicates: 256, key: Key::new(account.seed(), &name) };
        let both = Bidirectional(plan(1, Technique::Mis, &Roulette::Never));
        let found = render(&t, &scene.camera, &both, amount, Progress::NONE);
        account.assert_equivalent(&name, &image(&found, 1), truth, 0.02 * truth);
    }
}

/// Two rooms of 2 m, so far apart that single precision cannot hold both; the first alone is held wherever it stands.
#[test]
fn a_shape_that_rounding_would_deform_is_refused() {
    let file = |boxes: &[f64]| {
        let head = "[camera]\norigin = [0, 0, 0]\ntarget = [0.3, 0.2, 1]\nup = [0, 1, 0]\nfov = 70\nsize = [4, 4]\n\
                    [materials.g]\ntype = \"diffuse\"\nreflectance = [0.5, 0.5, 0.5]\n";
        let one = |x: &f64| {
            format!(
                "[[shapes]]\ntype = \"box\"\nmin = [{:?}, -1, -1]\nmax = [{:?}, 1, 1]\ninward = true\nmaterial = \"g\"\n\
                 emission = [1, 1, 1]\n",
                x - 1.0,
                x + 1.1
            )
        };
        head.to_owned() + &boxes.iter().map(one).collect::<String>()
    };
    let load = |boxes: &[f64]| toml(&file(boxes), Path::new("rooms.toml"), &Options::default());
    for x in [0.0, 1e5, 5e7, 1e9] {
        load(&[x]).unwrap();
    }
    load(&[0.0, 1e3]).unwrap();
    let error = load(&[0.0, 1e5]).unwrap_err();
    assert_eq!((error.line, error.key.as_deref()), (Some(17), Some("shapes[1]")), "{error}");
    let text = error.to_string();
    assert!(text.contains("single precision moves its points by") && text.contains("smallest height is"), "{text}");
}
