//! The matrix as a guide: it may change where rays look, and nothing else.
//!
//! ```text
//! p(ω) = cos θ/π · r(ω),  ∫ p dω = 1        E[X_k] = T^k E with the guide and without it        β = 1: the same bits
//! ```
#![allow(clippy::unwrap_used, clippy::print_stderr)]

#[path = "bsdf/chi_square.rs"]
#[allow(dead_code, unreachable_pub)]
mod chi_square;
#[path = "guided/command.rs"]
mod command;
mod common;
#[path = "guided/terms.rs"]
mod terms;

use chi_square::{Cells, Chart, p_value, together};
use common::judge::{Judged, Jury, at};
use common::sampling::{Kind, TECHNIQUES, collect, plan};
use common::scenes::{description, quad, room, sphere};
use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Prefix, Roulette, SingleTerm, Technique};
use fredholm::guide::tracked::{Tracked, TrackedSensor};
use fredholm::guide::{self, ByExpectation, Expecting, Guide, GuidedTransport, Recipe};
use fredholm::math::direction::Frame;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::{SceneTransport, Sensor, Step, Transport};
use fredholm::progress::Progress;
use fredholm::scene::description::PhongSurface;
use fredholm::scene::description::{BsdfDescription, Colour, Description};
use fredholm::scene::load::{self, Options};
use fredholm::scene::{Camera, Scene, SurfaceSensor, Vertex, VertexWave};
use fredholm::stats::Criterion;
use fredholm::terms::functional::image_replicates;
use fredholm::terms::{Estimate, TermFilm};
use glam::{DVec3, Vec3};

fn built_in(name: &str, size: [u32; 2]) -> Description {
    let mut d = load::scene(name, &Options::default()).unwrap().description;
    d.camera.size = size;
    d
}

/// A closed room with a ball and a lamp that shines at the ceiling.
fn lamps() -> Description {
    description(&[
        (room(DVec3::splat(-1.0), DVec3::ONE, 0.0), DVec3::new(0.8, 0.7, 0.6), DVec3::ZERO),
        (sphere(DVec3::new(0.4, -0.6, -0.5), 0.35, false), DVec3::new(0.2, 0.5, 0.9), DVec3::ZERO),
        (
            quad(DVec3::new(-0.6, 0.5, -0.6), DVec3::new(0.0, 0.0, 0.4), DVec3::new(0.4, 0.0, 0.0)),
            DVec3::splat(0.5),
            DVec3::new(9.0, 7.0, 5.0),
        ),
    ])
}

/// The same with a glossy ball, which the guide takes for Lambertian.
fn glossy() -> Description {
    let mut d = lamps();
    d.name = "glossy".into();
    let rho = DVec3::new(0.1, 0.2, 0.4);
    d.materials[1].bsdf = BsdfDescription::Phong(PhongSurface {
        reflectance: Colour::Uniform(rho),
        specular: DVec3::splat(0.5),
        exponent: 8.0,
    });
    d
}

fn guide(description: &Description, recipe: Recipe) -> Guide {
    Guide::new(description, recipe, Key::new(1, "guide"), Progress::NONE).unwrap().unwrap()
}

const COARSE: Recipe = Recipe {
    patches: 300,
    fineness: fredholm::guide::incident::Fineness { rays: 4, connections: 16 },
    bsdf: 0.1,
    emission: false,
};

fn guided<'a>(scene: &'a Scene, guide: &'a Guide) -> GuidedTransport<'a> {
    GuidedTransport { scene: SceneTransport::new(scene), guide }
}

/// How walks end: by roulette, or by what is expected of them.
#[derive(Clone, Debug)]
enum End {
    Roulette(Roulette),
    ByExpectation(ByExpectation),
}
use End::{ByExpectation as By, Roulette as Plain};

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Roulette(r) => r.fmt(f),
            Self::ByExpectation(e) => e.fmt(f),
        }
    }
}

const WINDOW: End = By(ByExpectation::Window { from: 0 });

/// A film of R = 256 replicates.
fn film<T: Expecting>(
    t: &T,
    camera: &Camera,
    kind: Kind,
    (k, technique, end): (usize, Technique, &End),
    spp: u32,
    key: Key,
) -> TermFilm
where
    Camera: Sensor<T>,
{
    let amount = Amount { spp, replicates: 256, key };
    let plan = |roulette: &Roulette| plan(k, technique, roulette);
    match (kind, end) {
        (Kind::Single, Plain(r)) => render(t, camera, &SingleTerm(plan(r)), amount, Progress::NONE),
        (Kind::Prefix, Plain(r)) => render(t, camera, &Prefix(plan(r)), amount, Progress::NONE),
        (Kind::Path, Plain(r)) => {
            render(t, camera, &guide::PathTracer { plan: plan(r), end: None }, amount, Progress::NONE)
        }
        (Kind::Single, By(end)) => render(t, camera, &SingleTerm(plan(&end.plain())), amount, Progress::NONE),
        (Kind::Prefix, &By(end)) => {
            let prefix = guide::Prefix { max_bounces: k, technique, end };
            render(&Tracked(t), &TrackedSensor(camera), &prefix, amount, Progress::NONE)
        }
        (Kind::Path, &By(end)) => {
            let path = guide::PathTracer { plan: plan(&end.plain()), end: Some(end) };
            render(t, camera, &path, amount, Progress::NONE)
        }
    }
}

/// Every sum of a film.
fn bits(film: &TermFilm) -> Vec<u64> {
    let s = film.shape;
    let all = (0..s.pixels()).flat_map(|p| (0..s.replicates).flat_map(move |r| (0..s.slots).map(move |k| (p, r, k))));
    all.flat_map(|(p, r, k)| film.sum(p, r, k).to_array()).map(f64::to_bits).collect()
}

/// Vertices anywhere on the surfaces.
fn vertices(scene: &Scene, n: usize) -> Vec<Vertex> {
    let sensor = SurfaceSensor::new(scene);
    let rng = |i: usize| Rng::at(Key::new(9, "vertices"), i as u32, 0, 0, Purpose::Start);
    (0..n).map(|i| sensor.vertex(scene, &mut rng(i))).collect()
}

/// p-values of 2¹⁶ directions from x at two resolutions, and how much of the density is missing. Cells never cross the edges of
/// the table, where the density jumps.
fn p_values(x: &Vertex, draw: impl Fn(u32) -> Vec3, density: impl Fn(Vec3) -> f32) -> ([f64; 2], f64) {
    let (frame, chart) = (Frame::new(x.n), Chart::about(Vec3::X));
    let cuts: Vec<f64> = (0..=16).map(|i| (1.0 - f64::from(i) / 16.0).sqrt()).collect();
    let found: Vec<[f64; 2]> = (0..1 << 16).map(|i| chart.at(frame.local(draw(i)))).collect();
    let cells = Cells::new(&mut found[..1 << 14].to_vec(), 8, &cuts);
    let f = |z: f64, phi: f64| DVec3::splat(f64::from(density(frame.world(chart.direction(z, phi)))));
    let expected: Vec<f64> = cells.integrals(f, 1e-4).iter().map(|v| v.x).collect();
    let mut counts = vec![0u64; expected.len()];
    // the pilot has chosen the cells and is not counted
    found[1 << 14..].iter().for_each(|&d| counts[cells.find(d)] += 1);
    let missing = 1.0 - expected.iter().sum::<f64>();
    let p = [128, 512].map(|count| {
        let (observed, expected) = together(&counts, &expected, count);
        p_value(&observed, &expected)
    });
    (p, missing)
}

#[test]
fn guided_directions_have_the_density_they_claim() {
    let mut account = common::open("guided_directions_have_the_density_they_claim");
    let d = lamps();
    let (scene, guide) = (Scene::new(&d), guide(&d, COARSE));
    let t = guided(&scene, &guide);
    let (mut tested, mut strongest) = (0, 1.0f32);
    for (i, x) in vertices(&scene, 24).iter().enumerate() {
        let Some(warp) = guide.at(x) else { continue };
        let key = Key::new(account.seed(), "directions").branch(i as u32);
        let density = |d: Vec3| d.dot(x.n).max(0.0) * std::f32::consts::FRAC_1_PI * warp.ratio(x.n, d);
        let step = |j: u32| t.scatter(x, &mut Rng::at(key, j, 0, 0, Purpose::Scatter));
        // the room is closed: something is always hit, and it looks back along the ray
        let draw = |j: u32| -step(j).unwrap().state.omega;
        let (p, missing) = p_values(x, draw, density);
        assert!(missing.abs() < 1e-3, "{x:?}: the density adds up to 1 − {missing}");
        let level = account.spend(2);
        assert!(p[0] > level && p[1] > level, "{x:?}: p = {p:?}, level {level:e}");
        // the weight of every step is that of its direction, but for the few within rounding of an edge, and its density is the
        // part of the cosine
        let mut off = 0;
        for s in (0..4096).filter_map(step) {
            let (d, rho) = (-s.state.omega, t.albedo(x));
            strongest = strongest.max(warp.ratio(x.n, d));
            let part = COARSE.bsdf as f32 * d.dot(x.n) * std::f32::consts::FRAC_1_PI;
            assert!((s.pdf / part - 1.0).abs() < 1e-3);
            off += usize::from((s.weight * warp.ratio(x.n, d) / rho - Vec3::ONE).abs().max_element() > 1e-3);
        }
        assert!(off <= 4, "{x:?}: {off} of 4096 steps have another weight");
        tested += 1;
    }
    assert!(tested >= 16 && strongest > 3.0, "{tested} vertices, largest ratio {strongest}");
    // the same judge must see that the cosine alone is another density
    let x = vertices(&scene, 24).into_iter().find(|x| guide.at(x).is_some()).unwrap();
    let key = Key::new(account.seed(), "wrong");
    let draw = |j: u32| -t.scatter(&x, &mut Rng::at(key, j, 0, 0, Purpose::Scatter)).unwrap().state.omega;
    let (p, _) = p_values(&x, draw, |d| d.dot(x.n).max(0.0) * std::f32::consts::FRAC_1_PI);
    let level = account.spend(2);
    assert!(p[0] < level && p[1] < level, "the cosine passes for the guide: {p:?}");
}

const KINDS: [Kind; 3] = [Kind::Prefix, Kind::Single, Kind::Path];

fn of<T: Expecting>(t: &T, camera: &Camera, kind: Kind, technique: Technique) -> Vec<u64>
where
    Camera: Sensor<T>,
{
    bits(&film(t, camera, kind, (5, technique, &Plain(Roulette::LECTURE)), 256, Key::new(2, "bits")))
}

#[test]
fn a_guide_that_leaves_all_to_the_bsdf_changes_no_bit() {
    for d in [built_in("cornell", [8, 8]), built_in("cornell-spheres", [8, 8]), lamps()] {
        let scene = Scene::new(&d);
        let (none, some) = (guide(&d, Recipe { bsdf: 1.0, ..COARSE }), guide(&d, COARSE));
        for technique in TECHNIQUES {
            for kind in KINDS {
                let plain = of(&SceneTransport::new(&scene), &scene.camera, kind, technique);
                assert!(of(&guided(&scene, &none), &scene.camera, kind, technique) == plain, "{}, {kind:?}", d.name);
                assert!(of(&guided(&scene, &some), &scene.camera, kind, technique) != plain, "{}, {kind:?}", d.name);
            }
        }
    }
}

#[test]
fn guided_packets_give_the_bits_of_single_rays() {
    let d = built_in("cornell", [16, 16]);
    let (packets, single, guide) = (Scene::new(&d), Scene::new(&d).one_by_one(), guide(&d, COARSE));
    for technique in TECHNIQUES {
        for kind in [Kind::Prefix, Kind::Single] {
            let [a, b] = [&packets, &single].map(|s| of(&guided(s, &guide), &s.camera, kind, technique));
            assert!(a == b, "{technique}, {kind:?}");
        }
    }
}

#[test]
fn guides_do_not_depend_on_the_number_of_threads() {
    let d = built_in("cornell", [8, 8]);
    let scene = Scene::new(&d);
    let [one, three] = [1, 3].map(|n| {
        rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| {
            let guide = guide(&d, COARSE);
            of(&guided(&scene, &guide), &scene.camera, Kind::Prefix, Technique::Mis)
        })
    });
    assert!(one == three);
}

/// Σ_k X_k + tail of the prefix estimator is the sample of the independent path tracer, path by path, with a guide as without.
#[test]
fn guided_terms_and_tail_sum_to_the_guided_path_tracer() {
    for d in [built_in("cornell", [12, 12]), built_in("cornell-spheres", [12, 12])] {
        let (scene, guide) = (Scene::new(&d), guide(&d, COARSE));
        let t = guided(&scene, &guide);
        let ends = [Plain(Roulette::Albedo { from: 1 }), By(ByExpectation::Contribution { from: 1 }), WINDOW];
        for (technique, end) in TECHNIQUES.into_iter().flat_map(|t| ends.iter().map(move |e| (t, e))) {
            let key = Key::new(5, "sums");
            let (terms, paths) = match *end {
                By(end) => {
                    let plan = plan(3, technique, &end.plain());
                    let (tracked, sensor) = (Tracked(&t), TrackedSensor(&scene.camera));
                    let path = guide::PathTracer { plan, end: Some(end) };
                    (
                        collect(&tracked, &sensor, &guide::Prefix { max_bounces: 3, technique, end }, 16, 16, key),
                        collect(&t, &scene.camera, &path, 16, 16, key),
                    )
                }
                Plain(ref roulette) => {
                    let plan = plan(3, technique, roulette);
                    let path = guide::PathTracer { plan: plan.clone(), end: None };
                    (
                        collect(&t, &scene.camera, &Prefix(plan), 16, 16, key),
                        collect(&t, &scene.camera, &path, 16, 16, key),
                    )
                }
            };
            let mut tails = 0.0;
            for (i, (terms, path)) in terms.paths().zip(paths.paths()).enumerate() {
                let sum: DVec3 = terms.iter().sum();
                tails += terms[4].element_sum();
                let scale = 1e-5 * path[0].abs().max(DVec3::splat(1e-6));
                assert!((sum - path[0]).abs().cmple(scale).all(), "{}, {technique}, {i}: {sum}, {}", d.name, path[0]);
            }
            assert!(tails > 0.0);
        }
    }
}

/// Paths that split do so alike in packets and one by one, on any number of threads; and where nobody knows what to expect they do
/// not split.
#[test]
fn walks_split_the_same_however_they_are_walked() {
    let d = built_in("cornell", [16, 16]);
    let (packets, single, guide) = (Scene::new(&d), Scene::new(&d).one_by_one(), guide(&d, COARSE));
    let of = |scene: &Scene, kind, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let how = (3, Technique::Mis, &WINDOW);
        pool.install(|| film(&guided(scene, &guide), &scene.camera, kind, how, 256, Key::new(2, "split")))
    };
    for kind in KINDS {
        let all = [of(&packets, kind, 1), of(&packets, kind, 3), of(&single, kind, 2)];
        assert!(all.iter().all(|film| bits(film) == bits(&all[0])), "{kind:?}");
    }
    // more rays go out of the second vertex of the same paths than without splitting
    let rays = |end: &End| {
        let how = (3, Technique::Mis, end);
        film(&guided(&packets, &guide), &packets.camera, Kind::Prefix, how, 256, Key::new(2, "split")).rays[2]
    };
    let (split, ended) = (rays(&WINDOW), rays(&By(ByExpectation::Contribution { from: 0 })));
    assert!(split as f64 > 1.1 * ended as f64, "{split} {ended}");
    for kind in KINDS {
        let of = |end: End| {
            let how = (3, Technique::Mis, &end);
            bits(&film(&SceneTransport::new(&packets), &packets.camera, kind, how, 256, Key::new(2, "blind")))
        };
        let blind = of(By(ByExpectation::Window { from: 1 }));
        assert!(blind == of(Plain(Roulette::Albedo { from: 1 })), "{kind:?}");
    }
}
