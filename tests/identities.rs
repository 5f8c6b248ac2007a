//! Equalities that hold sample by sample: no statistics, nothing to average.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::judge::{Judged, Jury};
use common::sampling::{Kind, TECHNIQUES, collect, film, plan};
use common::scenes::{bands, description, quad, room, sphere};
use fredholm::estimator::{PathTracer, Plan, Prefix, Roulette, SingleTerm, Technique};
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::matrix_walk::Rows;
use fredholm::operator::{Kernel, MatrixWalk, SceneTransport, Sensor, Transport};
use fredholm::scene::description::{Description, Geometry};
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Scene, Vertex};
use fredholm::terms::functional::image_replicates;
use fredholm::terms::{Estimate, TermFilm};
use glam::{DVec3, Vec3};

fn cornell(size: [u32; 2]) -> Description {
    let mut d = load::scene("cornell", &Options::default()).unwrap().description;
    d.camera.size = size;
    d
}

const WHITE: DVec3 = DVec3::new(0.8, 0.7, 0.6);

/// The spherical light: centre and radius.
const BALL: (DVec3, f64) = (DVec3::new(-0.6, 0.5, -0.6), 0.15);

/// A room with a ball, a disk light, a spherical light and a mesh.
fn lamps() -> Description {
    let tent = Geometry::Mesh {
        vertices: [[-0.9, -1.0, -0.9], [0.1, -1.0, -0.9], [-0.4, -0.2, -0.6], [-0.4, -1.0, -0.1]]
            .map(DVec3::from)
            .to_vec(),
        faces: vec![[0, 2, 1], [1, 2, 3], [3, 2, 0]],
        uvs: vec![],
    };
    let disk = Geometry::Disk { center: DVec3::new(0.3, 0.95, -0.4), normal: DVec3::NEG_Y, radius: 0.3 };
    description(&[
        (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), WHITE, DVec3::ZERO),
        (sphere(DVec3::new(0.4, -0.6, -0.5), 0.35, false), DVec3::new(0.2, 0.5, 0.9), DVec3::ZERO),
        (sphere(BALL.0, BALL.1, false), DVec3::splat(0.5), DVec3::new(4.0, 3.0, 2.0)),
        (disk, DVec3::splat(0.3), DVec3::new(2.0, 5.0, 3.0)),
        (tent, DVec3::new(0.7, 0.3, 0.2), DVec3::ZERO),
    ])
}

/// Flat things only, triangles and parallelograms mixed: traced in packets.
fn mixed_flat() -> Description {
    let roof = Geometry::Mesh {
        vertices: [[-0.5, 0.9, -0.5], [0.5, 0.9, -0.5], [0.5, 0.8, 0.5], [-0.5, 0.9, 0.5]].map(DVec3::from).to_vec(),
        faces: vec![[0, 1, 2], [0, 2, 3]],
        uvs: vec![],
    };
    let block = Geometry::Box {
        min: DVec3::new(-0.6, -1.0, -0.7),
        max: DVec3::new(0.0, 0.1, -0.2),
        rotate_y: 25.0,
        inward: false,
    };
    let shard = quad(DVec3::new(0.2, -0.9, -0.3), DVec3::new(0.5, 0.2, -0.4), DVec3::new(0.1, 0.7, 0.2));
    description(&[
        (room(DVec3::splat(-1.0), DVec3::ONE, 7.0), WHITE, DVec3::ZERO),
        (roof, DVec3::splat(0.4), DVec3::new(3.0, 4.0, 5.0)),
        (block, DVec3::new(0.2, 0.6, 0.3), DVec3::ZERO),
        (shard, DVec3::new(0.9, 0.1, 0.5), DVec3::new(0.5, 0.0, 0.0)),
    ])
}

fn walk() -> MatrixWalk {
    let rows = vec![0.2, 0.5, 0.3, 0.6, 0.1, 0.2, 0.0, 0.7, 0.2];
    let rho = vec![Rgb::new(0.9, 0.5, 0.2), Rgb::new(0.3, 0.8, 0.6), Rgb::splat(0.7)];
    MatrixWalk::new(rows, rho, vec![Rgb::new(1.0, 2.0, 0.0), Rgb::ZERO, Rgb::splat(0.5)])
}

fn schedules() -> Vec<Roulette> {
    let all = ["none", "lecture", "constant:0.3@0", "table:0,0.2,0.1,0.4", "albedo@1", "throughput@0"];
    all.iter().map(|s| s.parse().unwrap()).collect()
}

/// Σ_k X_k + tail of the prefix estimator is the sample of the independent path tracer, path by path.
fn sums_are_path_tracer_samples<T: Kernel>(name: &str, t: &T, sensor: &impl Sensor<T>, samples: u32) {
    let key = Key::new(5, name);
    let mut tails = 0.0;
    for technique in TECHNIQUES {
        for roulette in schedules() {
            // few terms, so that the tail has its share; without roulette there is none
            let plan = plan(if roulette.ends() { 3 } else { 6 }, technique, &roulette);
            let terms = collect(t, sensor, &Prefix(plan.clone()), samples, 16, key);
            let paths = collect(t, sensor, &PathTracer(plan.clone()), samples, 16, key);
            for (i, (terms, path)) in terms.paths().zip(paths.paths()).enumerate() {
                let sum: DVec3 = terms.iter().sum();
                tails += terms[plan.max_bounces + 1].element_sum();
                let scale = 1e-5 * path[0].abs().max(DVec3::splat(1e-6));
                assert!(
                    (sum - path[0]).abs().cmple(scale).all(),
                    "{name}, {technique}, {roulette}, path {i}: {sum} against {}",
                    path[0]
                );
            }
            assert!(paths.values.iter().filter(|v| v.element_sum() > 0.0).count() as f64 > 0.05 * samples as f64);
        }
    }
    assert!(tails > 0.0, "no path reached the tail: the test saw only half of the identity");
}

#[test]
fn terms_and_tail_sum_to_the_path_tracer_path_by_path() {
    for (name, d) in [("cornell", cornell([16, 16])), ("lamps", lamps()), ("mixed", mixed_flat())] {
        let scene = Scene::new(&d);
        sums_are_path_tracer_samples(name, &SceneTransport::new(&scene), &scene.camera, 32);
    }
    sums_are_path_tracer_samples("walk", &walk(), &Rows(3), 2048);
}

/// Every sum of a film.
fn bits(film: &TermFilm) -> Vec<u64> {
    let s = film.shape;
    let all = (0..s.pixels()).flat_map(|p| (0..s.replicates).flat_map(move |r| (0..s.slots).map(move |k| (p, r, k))));
    all.flat_map(|(p, r, k)| film.sum(p, r, k).to_array()).map(f64::to_bits).collect()
}

const KINDS: [Kind; 3] = [Kind::Prefix, Kind::Single, Kind::Path];

fn camera_film(scene: &Scene, kind: Kind, plan: &Plan, spp: u32, seed: u64) -> TermFilm {
    film(&SceneTransport::new(scene), &scene.camera, kind, plan, spp, Key::new(seed, "identities"))
}

#[test]
fn roulette_that_never_strikes_changes_nothing() {
    let scene = Scene::new(&lamps());
    for kind in KINDS {
        let of = |roulette: &str| {
            bits(&camera_film(&scene, kind, &plan(5, Technique::Mis, &roulette.parse().unwrap()), 256, 1))
        };
        let none = of("none");
        assert!(none.iter().any(|b| *b != 0));
        for schedule in ["constant:0@0", "table:0", "table:0,0,0"] {
            assert!(of(schedule) == none, "{kind:?} {schedule}");
        }
        assert!(of("constant:0.1@0") != none);
    }
}

/// All lengths times s.
fn scaled(d: &Description, s: f64) -> Description {
    let mut d = d.clone();
    d.camera.origin *= s;
    d.camera.target *= s;
    for shape in &mut d.shapes {
        match &mut shape.geometry {
            Geometry::Mesh { vertices, .. } => vertices.iter_mut().for_each(|v| *v *= s),
            Geometry::Quad { origin, edge_u, edge_v } => [origin, edge_u, edge_v].into_iter().for_each(|v| *v *= s),
            Geometry::Box { min, max, .. } => [min, max].into_iter().for_each(|v| *v *= s),
            Geometry::Sphere { center, radius, .. } | Geometry::Disk { center, radius, .. } => {
                *center *= s;
                *radius *= s;
            }
        }
    }
    d
}

#[test]
fn a_scene_scaled_by_a_power_of_two_is_the_same_bits() {
    for (name, d) in [("cornell", cornell([16, 16])), ("lamps", lamps()), ("mixed", mixed_flat())] {
        for technique in TECHNIQUES {
            let plan = plan(4, technique, &Roulette::LECTURE);
            let of = |s: f64| bits(&camera_film(&Scene::new(&scaled(&d, s)), Kind::Prefix, &plan, 256, 2));
            let one = of(1.0);
            for s in [0.125, 8.0] {
                assert!(of(s) == one, "{name}, {technique}, scaled by {s}");
            }
        }
    }
}

fn minus(a: &Estimate, b: &Estimate) -> Estimate {
    let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
    Estimate { mean: a.mean - b.mean, std_error, replicates: a.replicates, events: None }
}

#[test]
fn a_scene_scaled_by_ten_has_the_same_terms() {
    let mut jury = Jury::open("a_scene_scaled_by_ten_has_the_same_terms");
    for d in [cornell([16, 16]), lamps()] {
        let plan = plan(4, Technique::Mis, &Roulette::Albedo { from: 4 });
        let seed = jury.seed();
        let of =
            |s: f64, seed| image_replicates(&camera_film(&Scene::new(&scaled(&d, s)), Kind::Prefix, &plan, 4096, seed));
        let one = of(1.0, seed);
        for (i, s) in [0.1, 10.0].into_iter().enumerate() {
            let other = of(s, seed.wrapping_add(1 + i as u64));
            for k in 0..6 {
                let (a, b) = (one.estimate(k..k + 1), other.estimate(k..k + 1));
                let (delta, difference) = (0.03 * a.mean + 0.01 * one.estimate(0..6).mean, minus(&a, &b));
                let judged =
                    jury.judge(&format!("slot {k}, scaled by {s}"), &difference, DVec3::ZERO, delta, 4.0 * delta);
                assert_ne!(judged, Judged::TooNoisy, "slot {k}: {difference:?}, δ = {delta}");
            }
        }
    }
    jury.assert_power(0.5, 0.0);
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    let scene = Scene::new(&cornell([24, 16]));
    for kind in KINDS {
        let plan = plan(4, Technique::Mis, &Roulette::LECTURE);
        let of = |threads| pool(threads).install(|| camera_film(&scene, kind, &plan, 300, 3));
        let (one, two, seven) = (of(1), of(2), of(7));
        assert!(bits(&one) == bits(&two) && bits(&one) == bits(&seven), "{kind:?}");
        assert_eq!((&one.rays, &one.samples), (&two.rays, &two.samples));
    }
}

#[test]
fn packets_give_the_bits_of_single_rays() {
    for (name, d) in [("cornell", cornell([16, 16])), ("mixed", mixed_flat())] {
        let (packets, single) = (Scene::new(&d), Scene::new(&d).one_by_one());
        for technique in TECHNIQUES {
            for kind in [Kind::Prefix, Kind::Single] {
                let plan = plan(6, technique, &Roulette::LECTURE);
                let (a, b) = (camera_film(&packets, kind, &plan, 512, 4), camera_film(&single, kind, &plan, 512, 4));
                assert!(bits(&a) == bits(&b), "{name}, {technique}, {kind:?}");
                assert_eq!(a.rays, b.rays);
            }
        }
    }
}

#[test]
fn waves_of_any_size_give_the_same_bits() {
    let check = |name: &str, of: &dyn Fn(u32) -> Vec<DVec3>| {
        let whole = of(96);
        assert!(whole.iter().any(|v| v.element_sum() > 0.0));
        for wave in [1, 7, 64] {
            assert!(of(wave) == whole, "{name}: waves of {wave} samples");
        }
    };
    let key = Key::new(6, "waves");
    for technique in TECHNIQUES {
        let plan = plan(4, technique, &Roulette::LECTURE);
        for (name, d) in [("cornell", cornell([5, 3])), ("lamps", lamps())] {
            let scene = Scene::new(&d);
            let t = SceneTransport::new(&scene);
            check(name, &|wave| collect(&t, &scene.camera, &Prefix(plan.clone()), 96, wave, key).values);
            check(name, &|wave| collect(&t, &scene.camera, &SingleTerm(plan.clone()), 96, wave, key).values);
        }
        check("walk", &|wave| collect(&walk(), &Rows(3), &Prefix(plan.clone()), 96, wave, key).values);
    }
}

#[test]
fn seeds_choose_the_bits() {
    let scene = Scene::new(&lamps());
    for kind in KINDS {
        let of = |seed| bits(&camera_film(&scene, kind, &plan(3, Technique::Mis, &Roulette::LECTURE), 256, seed));
        let one = of(1);
        assert!(one == of(1) && one != of(2), "{kind:?}");
    }
}

/// The density of next-event estimation at y, seen from x, per solid angle: the plain formulae in `f64`.
fn light_density(scene: &Scene, x: &Vertex, y: &Vertex) -> f64 {
    let (d, m) = (y.p.as_dvec3() - x.p.as_dvec3(), y.n.as_dvec3());
    if ((y.p.as_dvec3() - BALL.0).length() - BALL.1).abs() < 1e-4 {
        // the ball is sampled by solid angle: one over that of its cap, 2π(1 − cos θ)
        let cos = (1.0 - (BALL.1 / (BALL.0 - x.p.as_dvec3()).length()).powi(2)).sqrt();
        return 1.0 / (scene.lights.len() as f64 * std::f64::consts::TAU * (1.0 - cos));
    }
    f64::from(scene.light_density(y.side)) * d.length_squared() / -d.normalize().dot(m)
}

/// The density of the cosine about x towards y.
fn cosine_density(x: &Vertex, y: &Vertex) -> f64 {
    (y.p.as_dvec3() - x.p.as_dvec3()).normalize().dot(x.n.as_dvec3()) / std::f64::consts::PI
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * b.abs()
}

/// At any pair (x, y) both techniques state the same two densities, so their MIS weights sum to 1. A connection is
/// followed by a ray towards its light point, which must find that point.
#[test]
fn weights_of_the_two_techniques_sum_to_one() {
    for (name, d) in [("cornell", cornell([32, 32])), ("lamps", lamps()), ("mixed", mixed_flat())] {
        let scene = Scene::new(&d);
        let t = SceneTransport::new(&scene);
        let key = Key::new(7, name);
        let (mut connections, mut hits) = (0, 0);
        for sample in 0..60_000 {
            let rng = |bounce, purpose| Rng::at(key, sample % 1024, sample / 1024, bounce, purpose);
            let Some(eye) = scene.camera.start(&t, sample % 1024, &mut rng(0, Purpose::Start)) else { continue };
            let Some(first) = t.scatter(&eye, &mut rng(0, Purpose::Scatter)) else { continue };
            let x = first.state;
            if let Some(c) = t.connect(&x, &mut rng(1, Purpose::Connect)) {
                let y = c.state;
                let distance = (y.p - x.p).length();
                // closer than a thousand offsets of the ray's origin the traced point is another one
                if distance < 0.1 || cosine_density(&x, &y) < 0.01 || c.omega_cosine() < 0.1 {
                    continue;
                }
                let from = Scene::offset_origin(x.p, x.n);
                let seen = scene.trace(from, (y.p - from).normalize()).unwrap();
                assert_eq!(seen.side, y.side, "{name}: the ray towards {y:?} ends at {seen:?}");
                assert!(
                    close(light_density(&scene, &x, &seen), light_density(&scene, &x, &y)),
                    "{name}: {seen:?} {y:?}"
                );
                assert!(close(f64::from(c.pdf), light_density(&scene, &x, &y)), "{name}: {c:?}");
                assert!(close(f64::from(c.other_pdf), cosine_density(&x, &y)), "{name}: {c:?}");
                let w = Technique::Mis.connection(c.pdf, c.other_pdf);
                let v = Technique::Mis.hit(c.other_pdf, c.pdf);
                assert!((w + v - 1.0).abs() < 1e-6);
                connections += 1;
            }
            if let Some(s) = t.scatter(&x, &mut rng(1, Purpose::Scatter)) {
                let y = s.state;
                if scene.light_density(y.side) == 0.0 {
                    assert_eq!(s.other_pdf, 0.0);
                } else if (y.p - x.p).length() > 0.1 && s.omega_cosine() > 0.1 && cosine_density(&x, &y) > 0.01 {
                    assert!(close(f64::from(s.other_pdf), light_density(&scene, &x, &y)), "{name}: {s:?}");
                    assert!((f64::from(s.pdf) / cosine_density(&x, &y) - 1.0).abs() < 2e-3, "{name}: {s:?}");
                    hits += 1;
                }
            }
        }
        eprintln!("{name}: {connections} connections, {hits} hits");
        assert!(connections > 2000 && hits > 100);
    }
}

trait OmegaCosine {
    fn omega_cosine(&self) -> f32;
}

impl OmegaCosine for fredholm::operator::Step<Vertex> {
    /// Cosine at the far end of the step.
    fn omega_cosine(&self) -> f32 {
        self.state.omega.dot(self.state.n)
    }
}

/// Bands of a sphere tile it: which band a ray hits does not depend on where the sphere was cut.
#[test]
fn a_sphere_cut_into_bands_is_the_same_sphere() {
    let whole = Scene::new(&description(&bands(1.0, &[1.0, -1.0], &[0.5], &[1.0])));
    let cut = Scene::new(&description(&bands(1.0, &[1.0, 0.3, -0.4, -1.0], &[0.5; 3], &[1.0; 3])));
    let plan = plan(6, Technique::Scatter, &Roulette::Never);
    assert!(
        bits(&camera_film(&whole, Kind::Prefix, &plan, 256, 8))
            == bits(&camera_film(&cut, Kind::Prefix, &plan, 256, 8))
    );
}

/// A lamp that a receiver sees from exactly beside it sends nothing, not an infinite density.
#[test]
fn a_lamp_seen_from_beside_is_not_seen() {
    let lamp = quad(DVec3::new(-0.5, 0.5, -0.5), DVec3::X, DVec3::Z);
    let wall = quad(DVec3::new(2.0, 0.0, -1.0), DVec3::Z * 2.0, DVec3::Y);
    let scene = Scene::new(&description(&[(lamp, DVec3::ZERO, DVec3::ONE), (wall, WHITE, DVec3::ZERO)]));
    let x = Vertex { p: Vec3::new(2.0, 0.5, 0.1), n: Vec3::NEG_X, omega: Vec3::NEG_X, side: 2 };
    for sample in 0..1000 {
        let rng = &mut Rng::at(Key::new(1, "beside"), 0, sample, 0, Purpose::Connect);
        assert_eq!(SceneTransport::new(&scene).connect(&x, rng), None);
    }
}
