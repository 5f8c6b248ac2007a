//! Surfaces that coincide: emitters lie in front, in every way of sampling and in the matrix; what has no right answer is
//! named, and only where somebody sees it.
#![allow(clippy::unwrap_used, clippy::print_stderr)]

mod common;

use common::scenes::quad;
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::engine::by_matrix::Matrix;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::engine::known::coplanar;
use fredholm::estimator::Technique;
use fredholm::progress::Progress;
use fredholm::scene::coplanar::{Kind, Overlap, Surfaces};
use fredholm::scene::description::{CameraDescription, Description, Geometry, Material, Shape, Sides};
use fredholm::scene::{Primitive, Scene, builtin, load};
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, Outcome, compare};
use fredholm::terms::{Estimate, Series};
use glam::{DQuat, DVec3};

/// The room of `faults/lamp_in_ceiling.toml`, two metres wide, 0.6 grey.
fn room() -> Geometry {
    Geometry::Box { min: DVec3::NEG_ONE, max: DVec3::ONE, rotate_y: 0.0, inward: true }
}

fn block(min: [f64; 3], max: [f64; 3]) -> Geometry {
    Geometry::Box { min: min.into(), max: max.into(), rotate_y: 0.0, inward: false }
}

/// A quad that is seen from below.
fn below(min: [f64; 2], max: [f64; 2], y: f64) -> Geometry {
    let v = DVec3::new;
    quad(v(min[0], y, min[1]), v(max[0] - min[0], 0.0, 0.0), v(0.0, 0.0, max[1] - min[1]))
}

/// A quad that is seen from above.
fn above(min: [f64; 2], max: [f64; 2], y: f64) -> Geometry {
    let v = DVec3::new;
    quad(v(min[0], y, min[1]), v(0.0, 0.0, max[1] - min[1]), v(max[0] - min[0], 0.0, 0.0))
}

const GREY: f64 = 0.6;

struct Part(Geometry, f64, f64, Sides);

fn dark(g: Geometry) -> Part {
    Part(g, GREY, 0.0, Sides::Front)
}

fn lamp(g: Geometry) -> Part {
    Part(g, GREY, 10.0, Sides::Front)
}

fn scene(parts: Vec<Part>) -> Description {
    let v = DVec3::new;
    let camera = CameraDescription {
        origin: v(0.0, 0.0, 0.95),
        target: v(0.0, 0.3, 0.0),
        up: DVec3::Y,
        fov: 90.0,
        size: [16, 16],
    };
    let material = |(i, p): (usize, &Part)| Material::diffuse(i.to_string(), DVec3::splat(p.1), p.3);
    let shape = |(i, p): (usize, &Part)| Shape {
        name: format!("shapes[{i}]"),
        geometry: p.0.clone(),
        material: i,
        emission: DVec3::splat(p.2),
    };
    Description {
        name: "coplanar".into(),
        camera,
        materials: parts.iter().enumerate().map(material).collect(),
        shapes: parts.iter().enumerate().map(shape).collect(),
        lights: vec![],
        expect: None,
    }
}

/// Every vertex through a map; `length` is the map's factor on lengths.
fn mapped(d: &Description, length: f64, f: impl Fn(DVec3) -> DVec3) -> Description {
    let mut d = d.clone();
    let edge = |o: DVec3, e: DVec3| f(o + e) - f(o);
    for s in &mut d.shapes {
        s.geometry = match s.geometry.clone() {
            Geometry::Quad { origin, edge_u, edge_v } => quad(f(origin), edge(origin, edge_u), edge(origin, edge_v)),
            Geometry::Box { min, max, rotate_y, inward } => {
                assert!(rotate_y == 0.0);
                Geometry::Box { min: f(min), max: f(max), rotate_y, inward }
            }
            Geometry::Disk { center, normal, radius } => {
                Geometry::Disk { center: f(center), normal: edge(center, normal), radius: length * radius }
            }
            Geometry::Sphere { center, radius, z, inward } => {
                Geometry::Sphere { center: f(center), radius: length * radius, z, inward }
            }
            Geometry::Mesh { vertices, faces, uvs } => {
                Geometry::Mesh { vertices: vertices.into_iter().map(&f).collect(), faces, uvs }
            }
        };
    }
    (d.camera.origin, d.camera.target) = (f(d.camera.origin), f(d.camera.target));
    d
}

/// The faces of a box as quads, so that it can be turned about any axis.
fn faces(g: &Geometry) -> Vec<Geometry> {
    let one = |p: &Primitive| match *p {
        Primitive::Parallelogram { origin, edge_u, edge_v } => quad(origin, edge_u, edge_v),
        _ => unreachable!(),
    };
    g.primitives().iter().map(one).collect()
}

/// Two triangles instead of a quad.
fn mesh(g: &Geometry) -> Geometry {
    let Geometry::Quad { origin: o, edge_u: u, edge_v: v } = *g else { panic!() };
    Geometry::Mesh { vertices: vec![o, o + u, o + u + v, o + v], faces: vec![[0, 1, 2], [0, 2, 3]], uvs: vec![] }
}

/// As rays and patches meet them.
fn surfaces(d: &Description) -> Surfaces {
    d.centred().scene.surfaces()
}

fn moved(s: &Surfaces, d: &Description) -> Vec<usize> {
    let before = d.centred().scene.primitives();
    (0..s.list.len()).filter(|&i| s.list[i] != before[i]).collect()
}

/// Names of the pairs that are seen and have no right answer.
fn warned(d: &Description) -> Vec<[String; 2]> {
    coplanar::seen(&Scene::new(d)).iter().map(|r| r.names.clone()).collect()
}

#[test]
fn built_in_scenes_stay_as_they_are() {
    for b in &builtin::ALL {
        let d = load::scene(b.name, &load::Options::default()).unwrap().description;
        let s = surfaces(&d);
        assert_eq!((moved(&s, &d), s.moved), (vec![], 0.0), "{}", b.name);
        assert_eq!(warned(&d), Vec::<[String; 2]>::new(), "{}", b.name);
    }
}

/// A lamp in the plane y = 1 as quad, mesh and disk.
fn lamp_shapes() -> [Geometry; 3] {
    let square = below([-0.3, -0.3], [0.3, 0.3], 1.0);
    [square.clone(), mesh(&square), Geometry::Disk { center: DVec3::Y, normal: DVec3::NEG_Y, radius: 0.3 }]
}

fn any_axis(noise: &mut common::Noise) -> DVec3 {
    DVec3::new(noise.uniform() - 0.5, noise.uniform() - 0.5, noise.uniform() - 0.5).normalize()
}

/// A lamp in the plane of each face of a room, as quad, mesh and disk, the whole turned by any angle: it comes to lie in front
/// by four times what rays may be off, or a little more, and nothing else moves.
#[test]
fn lamps_come_to_lie_in_front() {
    let mut noise = common::Noise(17);
    for lamp_shape in lamp_shapes() {
        for turn in 0..40 {
            let axis = any_axis(&mut noise);
            let turn = DQuat::from_axis_angle(axis, if turn == 0 { 0.0 } else { 6.3 * noise.uniform() });
            let mut parts: Vec<Part> = faces(&room()).into_iter().map(dark).collect();
            parts.push(lamp(lamp_shape.clone()));
            let d = mapped(&scene(parts), 1.0, |x| turn * x);
            let s = surfaces(&d);
            let lamps: Vec<usize> = (6..s.list.len()).collect();
            assert_eq!(moved(&s, &d), lamps, "{turn}");
            for o in &s.overlaps {
                assert!(o.pair[0] == 3 && o.pair[1] >= 6 && o.same_way, "{o:?}");
                // the height of the ceiling over the lamp
                assert!(-o.height[1] > 0.999 * o.gap && -o.height[0] < 1.01 * o.gap, "{o:?}");
                assert_eq!([o.nearer(true), o.nearer(false)], [Some(1), Some(0)]);
            }
            assert_eq!(s.overlaps.len(), lamps.len());
            // Σ |nᵢ| Rᵢ is 3 at most in a room of this size
            assert!(s.moved < 1.01 * 3.0 * 64.0 / 2f64.powi(24), "{}", s.moved);
        }
    }
}

#[test]
fn what_only_touches_or_lies_clearly_in_front_does_not_count() {
    let pairs = [
        // edges, a corner, a shared edge of two halves, parallel planes a millimetre apart
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([1.0, 0.0], [2.0, 1.0], 0.0)],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([1.0, 1.0], [2.0, 2.0], 0.0)],
        vec![mesh(&above([0.0, 0.0], [1.0, 1.0], 0.0))],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), above([0.2, 0.2], [0.8, 0.8], 1e-3)],
        vec![above([0.0, 0.0], [1.0, 1.0], 0.0), block([0.0, 0.001, 0.0], [1.0, 0.5, 1.0])],
        vec![room(), above([-1.0, -1.0], [1.0, 1.0], 0.0)],
    ];
    for geometries in pairs {
        let d = scene(geometries.into_iter().map(lamp).collect());
        let s = surfaces(&d);
        assert_eq!((s.overlaps.len(), moved(&s, &d)), (0, vec![]), "{:?}", d.shapes);
    }
}

#[test]
fn scaling_by_powers_of_two_changes_no_bit_and_shifts_no_pair() {
    let mut parts: Vec<Part> = faces(&room()).into_iter().map(dark).collect();
    parts.push(lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)));
    parts.push(dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3])));
    parts.push(lamp(Geometry::Disk { center: DVec3::X, normal: DVec3::NEG_X, radius: 0.2 }));
    let plain = scene(parts);
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, 0.9, 0.1).normalize(), 0.7);
    let quads = Description {
        shapes: plain.shapes.iter().filter(|s| !matches!(s.geometry, Geometry::Box { .. })).cloned().collect(),
        ..plain.clone()
    };
    for d in [plain, mapped(&quads, 1.0, |x| turn * x)] {
        let s = surfaces(&d);
        assert!(s.overlaps.len() >= 2);
        for k in [-30, 12] {
            let f = 2f64.powi(k);
            let t = surfaces(&mapped(&d, f, |x| f * x));
            let scaled = |o: &Overlap| Overlap { height: o.height.map(|h| f * h), gap: f * o.gap, ..*o };
            assert_eq!(t.overlaps, s.overlaps.iter().map(scaled).collect::<Vec<_>>());
            assert_eq!(t.moved, f * s.moved);
        }
        for far in [1e3, 1e6, 1e8] {
            let t = surfaces(&mapped(&d, 1.0, |x| x + DVec3::new(far, -0.7 * far, 0.3 * far)));
            let pairs = |s: &Surfaces| s.overlaps.iter().map(|o| (o.pair, o.same_way)).collect::<Vec<_>>();
            assert_eq!(pairs(&t), pairs(&s), "{far}");
            assert!((t.moved - s.moved).abs() < 0.02 * s.moved, "{far}: {} {}", t.moved, s.moved);
        }
    }
}

#[test]
fn of_emitters_that_look_the_same_way_the_first_lies_in_front() {
    let d = scene(vec![
        dark(room()),
        lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)),
        lamp(below([0.0, 0.0], [0.5, 0.5], 1.0)),
        lamp(above([-0.1, -0.1], [0.1, 0.1], 1.0)),
    ]);
    let s = surfaces(&d);
    assert_eq!(moved(&s, &d), [6, 7, 8]);
    for o in &s.overlaps {
        // seen from inside the room: the ceiling (3) looks down as 6 and 7 do, 8 looks up
        let from_below = o.nearer(true).map(|i| o.pair[i]);
        let from_above = o.nearer(false).map(|i| o.pair[i]);
        match o.pair {
            [3, 8] => assert_eq!([from_below, from_above], [Some(3), Some(8)]),
            [3, lamp] => assert_eq!([from_below, from_above], [Some(lamp), Some(3)]),
            [lamp, 8] => assert_eq!([from_below, from_above], [Some(lamp), Some(8)]),
            pair => assert_eq!((pair, from_below, from_above), ([6, 7], Some(6), Some(7))),
        }
    }
}

#[test]
fn balls_that_coincide_are_found_too() {
    let ball = |z, inward| Geometry::Sphere { center: DVec3::new(0.1, 0.2, 0.3), radius: 0.4, z, inward };
    let all = [-1.0, 1.0];
    let d = scene(vec![dark(room()), dark(ball(all, false)), lamp(ball(all, false)), dark(ball([0.5, 1.0], true))]);
    let s = surfaces(&d);
    assert_eq!(s.overlaps.iter().map(|o| o.pair).collect::<Vec<_>>(), [[6, 7], [6, 8], [7, 8]]);
    assert_eq!(moved(&s, &d), [7]);
    let Primitive::Sphere { radius, .. } = s.list[7].1 else { panic!() };
    assert!(radius > 0.4 && radius < 0.4 + 1e-5, "{radius}");
    // the lower band and the upper one only touch
    let d = scene(vec![dark(room()), dark(ball([-1.0, 0.5], false)), dark(ball([0.5, 1.0], false))]);
    assert_eq!(surfaces(&d).overlaps, []);
}

/// What is seen and has no right answer is named; what is hidden, alike or in front is not.
#[test]
fn warnings_come_where_paths_come() {
    let rug = above([-0.4, -0.4], [0.3, 0.2], -1.0);
    let painted = |g, rho, sides| Part(g, rho, 0.0, sides);
    let light = || lamp(below([-0.3, -0.3], [0.3, 0.3], 0.99));
    let case = |parts: Vec<Part>| scene([dark(room()), light()].into_iter().chain(parts).collect());
    let names = |a: usize, b: usize| vec![[a, b].map(|i| format!("shapes[{i}]"))];
    let front = Sides::Front;
    let ball = |z| Geometry::Sphere { center: DVec3::new(0.0, -0.5, -0.3), radius: 0.3, z, inward: false };
    let cases: Vec<(&str, Description, Vec<[String; 2]>)> = vec![
        ("a rug", case(vec![painted(rug.clone(), 0.3, front)]), names(0, 2)),
        ("a rug with two sides", case(vec![painted(rug.clone(), 0.3, Sides::Both)]), names(0, 2)),
        (
            "a rug the size of a coin",
            case(vec![painted(above([0.2, 0.2], [0.22, 0.22], -1.0), 0.3, front)]),
            names(0, 2),
        ),
        ("a rug like the floor", case(vec![painted(rug.clone(), GREY, front)]), vec![]),
        ("a rug upside down", case(vec![painted(below([-0.4, -0.4], [0.3, 0.2], -1.0), GREY, front)]), names(0, 2)),
        ("a standing block", case(vec![dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3]))]), vec![]),
        (
            "one of two sides",
            case(vec![painted(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3]), 0.3, Sides::Both)]),
            vec![],
        ),
        ("in a corner", case(vec![painted(block([-1.0, -1.0, -1.0], [-0.4, -0.2, 0.3]), 0.3, Sides::Both)]), vec![]),
        (
            "two in a stack",
            case(vec![
                dark(block([-0.5, -1.0, -0.5], [0.1, -0.6, 0.3])),
                painted(block([-0.5, -0.6, -0.5], [0.1, -0.2, 0.3]), 0.2, front),
            ]),
            vec![],
        ),
        (
            "two quads in the air",
            case(vec![
                painted(above([-0.4, -0.4], [0.3, 0.2], -0.5), 0.3, front),
                painted(above([0.1, 0.0], [0.5, 0.5], -0.5), 0.5, front),
            ]),
            names(2, 3),
        ),
        (
            "a block twice",
            case(vec![
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
            ]),
            vec![],
        ),
        (
            "in two colours",
            case(vec![
                dark(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3])),
                painted(block([-0.5, -0.9, -0.5], [0.1, -0.2, 0.3]), 0.3, front),
            ]),
            names(2, 3),
        ),
        ("two balls", case(vec![dark(ball([-1.0, 1.0])), painted(ball([-1.0, 1.0]), 0.3, front)]), names(2, 3)),
        ("two equal balls", case(vec![dark(ball([-1.0, 1.0])), dark(ball([-1.0, 1.0]))]), vec![]),
        ("two lamps", case(vec![lamp(below([0.0, 0.0], [0.5, 0.5], 0.99))]), vec![]),
        ("two lamps that differ", case(vec![Part(below([0.0, 0.0], [0.5, 0.5], 0.99), GREY, 5.0, front)]), names(1, 2)),
        ("a lamp in the ceiling", case(vec![lamp(below([0.5, 0.5], [0.9, 0.9], 1.0))]), vec![]),
        ("a lamp that stands", case(vec![lamp(block([0.3, -1.0, 0.3], [0.5, -0.9, 0.5]))]), vec![]),
    ];
    for (what, d, expected) in cases {
        assert_eq!(warned(&d), expected, "{what}");
    }
}

/// Glass is counted by its surfaces: twice is not once.
#[test]
fn glass_twice_is_a_conflict() {
    let d = load::scene("caustic", &load::Options::default()).unwrap().description;
    assert_eq!(warned(&d), Vec::<[String; 2]>::new());
    let mut twice = d.clone();
    twice.shapes.push(d.shapes[1].clone());
    assert_eq!(warned(&twice).len(), 1);
}

#[test]
fn relations_say_which_kind() {
    let d = scene(vec![
        dark(room()),
        lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0)),
        dark(block([-0.5, -1.0, -0.5], [0.1, -0.2, 0.3])),
        dark(above([0.3, 0.3], [0.6, 0.6], -1.0)),
    ]);
    let kinds: Vec<_> = surfaces(&d).relations(&d).iter().map(|r| (r.shapes, r.kind)).collect();
    assert_eq!(kinds, [([0, 1], Kind::InFront), ([0, 2], Kind::Differ), ([0, 3], Kind::Alike)]);
}

/// A mesh of 10⁵ triangles twice: each overlaps its twin and nothing else.
#[test]
fn meshes_of_many_triangles_are_searched_by_a_tree() {
    let n = 224u32;
    let at = |i: u32, j: u32| {
        let (x, z) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
        DVec3::new(x, if i < n / 2 { 0.0 } else { 0.1 * (7.0 * x).sin() * (5.0 * z).cos() }, z)
    };
    let vertices: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| at(i, j))).collect();
    let cell = |i: u32, j: u32| {
        let a = j * (n + 1) + i;
        [[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]
    };
    let faces: Vec<[u32; 3]> = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    let m = Geometry::Mesh { vertices, faces, uvs: vec![] };
    let d = scene(vec![dark(m.clone()), dark(m)]);
    let started = std::time::Instant::now();
    let s = surfaces(&d);
    let took = started.elapsed();
    eprintln!("{} triangles in {took:?}", s.list.len());
    let half = s.list.len() / 2;
    assert!(half > 100_000);
    assert_eq!(s.overlaps.len(), half);
    assert!(s.overlaps.iter().all(|o| o.pair[1] == o.pair[0] + half));
    assert_eq!(s.moved, 0.0);
}

fn settings(technique: Technique, spp: u32, seed: u64) -> Settings {
    Settings { spp, seed, technique, max_bounces: 3, ..Settings::default() }
}

/// T⁰, T¹, T², and the whole.
type Values = [Estimate; 4];

/// What one way of sampling finds, from four runs, so that there are 60 degrees of freedom.
fn values(scene: &Scene, estimator: Estimator, technique: Technique, spp: u32, seed: u64) -> Values {
    let runs: Vec<Values> = (0..4)
        .map(|i| {
            let settings = settings(technique, spp / 4, seed ^ (i << 60));
            let s = by_rays::terms(scene, estimator, &settings, Progress::NONE).series;
            let f = s.image();
            [f.terms[0], f.terms[1], f.terms[2], f.total]
        })
        .collect();
    [0, 1, 2, 3].map(|k| Estimate {
        mean: runs.iter().map(|r| r[k].mean).sum::<DVec3>() / 4.0,
        std_error: runs.iter().map(|r| r[k].std_error.powf(2.0)).sum::<DVec3>().map(f64::sqrt) / 4.0,
        replicates: 61,
        events: None,
    })
}

/// Every way of sampling, with the values that it knows well enough to be judged.
const WAYS: [(&str, Estimator, Technique, u32, &[usize]); 5] = [
    ("scatter", Estimator::Prefix, Technique::Scatter, 4096, &[0, 3]),
    ("connect", Estimator::Prefix, Technique::Connect, 4096, &[0, 1, 2, 3]),
    ("mis", Estimator::Prefix, Technique::Mis, 4096, &[0, 1, 2, 3]),
    ("light", Estimator::Light, Technique::Mis, 4096, &[0, 1, 2, 3]),
    ("bidirectional", Estimator::Bidirectional, Technique::Mis, 512, &[0, 1, 2, 3]),
];

fn matrix(d: &Description, patches: usize) -> Matrix<Radiosity> {
    by_matrix::dense_matrix(d, &Scene::new(d), patches, 1.0, 3, Progress::NONE).unwrap()
}

fn apart(a: &Estimate, b: &Estimate) -> Estimate {
    let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
    let replicates = [a.replicates, b.replicates].into_iter().filter(|r| *r > 0).min().unwrap_or(0);
    Estimate { mean: a.mean - b.mean, std_error, replicates, events: None }
}

/// From anywhere in a room that is turned by any angle, a ray to a lamp in the plane of a wall meets the front of the lamp, and
/// nothing blocks the way back.
#[test]
fn rays_meet_the_lamp_and_not_the_wall() {
    let mut noise = common::Noise(4);
    for lamp_shape in lamp_shapes() {
        for _ in 0..30 {
            let axis = any_axis(&mut noise);
            let turn = DQuat::from_axis_angle(axis, 6.3 * noise.uniform());
            let mut parts: Vec<Part> = faces(&room()).into_iter().map(dark).collect();
            parts.push(lamp(lamp_shape.clone()));
            let scene = Scene::new(&mapped(&scene(parts), 1.0, |x| turn * x));
            let down = turn * DVec3::NEG_Y;
            for _ in 0..1000 {
                let mut between = |r: f64| r * (2.0 * noise.uniform() - 1.0);
                let from = turn * DVec3::new(between(0.99), between(0.99), between(0.99));
                let (x, z) = (between(0.21), between(0.21));
                let to = turn * DVec3::new(x, 1.0, z);
                let d = (to - from).normalize();
                let hit = scene.trace(from.as_vec3(), d.as_vec3()).unwrap();
                assert!(hit.side / 2 >= 6 && hit.side.is_multiple_of(2), "{from} {to}: side {}", hit.side);
                let eye = from.as_vec3();
                assert!(!scene.blocked(hit.p, down.as_vec3(), eye, glam::Vec3::ZERO), "{from} {to}");
            }
        }
    }
}

/// The room with a hole in its ceiling, where the lamp is: nothing coincides there.
fn with_hole(hole: [f64; 4], lamp_part: Part, ceiling: Sides) -> Description {
    let [a, b, c, d] = hole;
    let mut parts: Vec<Part> = faces(&room()).into_iter().enumerate().filter(|f| f.0 != 3).map(|f| dark(f.1)).collect();
    let strips = [([-1.0, -1.0], [a, 1.0]), ([c, -1.0], [1.0, 1.0]), ([a, -1.0], [c, b]), ([a, d], [c, 1.0])];
    let strips = strips.into_iter().filter(|(min, max)| max[0] - min[0] > 0.0 && max[1] - min[1] > 0.0);
    parts.extend(strips.map(|(min, max)| Part(below(min, max, 1.0), GREY, 0.0, ceiling)));
    parts.push(lamp_part);
    scene(parts)
}

fn in_plane(lamp_parts: Vec<Part>, ceiling: Sides) -> Description {
    let mut parts: Vec<Part> = faces(&room()).into_iter().enumerate().filter(|f| f.0 != 3).map(|f| dark(f.1)).collect();
    parts.push(Part(below([-1.0, -1.0], [1.0, 1.0], 1.0), GREY, 0.0, ceiling));
    parts.extend(lamp_parts);
    scene(parts)
}

/// A lamp in the plane of a ceiling is worth as much as one that fills a hole of it: by every way of sampling, and in the
/// matrix; for ceilings of one and of two sides, lamps of one and two sides, as quads and meshes, from wall to wall, and twice.
#[test]
fn lamps_in_a_plane_are_worth_their_light() {
    let mut account = common::open("lamps_in_a_plane_are_worth_their_light");
    let seed = account.seed();
    let square = || below([-0.3, -0.3], [0.3, 0.3], 1.0);
    let small = [-0.3, -0.3, 0.3, 0.3];
    let wall_to_wall = || below([-1.0, -0.2], [1.0, 0.4], 1.0);
    let two = |g| Part(g, GREY, 10.0, Sides::Both);
    let (front, both) = (Sides::Front, Sides::Both);
    let cases = [
        ("the fault", in_plane(vec![lamp(square())], front), with_hole(small, lamp(square()), front)),
        ("ceiling of two sides", in_plane(vec![lamp(square())], both), with_hole(small, lamp(square()), both)),
        ("lamp of two sides", in_plane(vec![two(square())], front), with_hole(small, two(square()), front)),
        ("mesh", in_plane(vec![lamp(mesh(&square()))], both), with_hole(small, lamp(mesh(&square())), both)),
        (
            "wall to wall",
            in_plane(vec![lamp(wall_to_wall())], front),
            with_hole([-1.0, -0.2, 1.0, 0.4], lamp(wall_to_wall()), front),
        ),
        ("twice", in_plane(vec![lamp(square()), lamp(square())], front), with_hole(small, lamp(square()), front)),
    ];
    for (what, flush, hole) in cases {
        assert!(surfaces(&flush).moved > 0.0 && surfaces(&hole).moved == 0.0, "{what}");
        let reference = values(&Scene::new(&hole), Estimator::Prefix, Technique::Mis, 4096, seed ^ 1);
        let scene = Scene::new(&flush);
        for (way, estimator, technique, spp, judged) in WAYS {
            // the first case by every way, the others by two
            if what != "the fault" && !["mis", "light"].contains(&way) {
                continue;
            }
            let found = values(&scene, estimator, technique, spp, seed);
            for &k in judged {
                let delta = [0.06, 0.03, 0.03, 0.05][k] * reference[k].mean;
                let d = apart(&found[k], &reference[k]);
                account.assert_equivalent(&format!("{what}, {way}, {k}"), &d, DVec3::ZERO, delta);
            }
        }
        // the matrices of both, on patches that differ only by what the cuts do: power that leaves all surfaces
        let patches = if what == "the fault" { 600 } else { 240 };
        let (a, b) = (matrix(&flush, patches), matrix(&hole, patches));
        let patches = &a.radiosity.patches;
        assert!(patches.covered_area() > 0.35, "{what}: {}", patches.covered_area());
        for k in 0..4 {
            let power = |m: &Matrix<Radiosity>| m.surface[k].x * m.radiosity.patches.surface_area();
            let (x, y) = (power(&a), power(&b));
            assert!((x - y).abs() < 3e-3 * y, "{what}, k = {k}: {x} {y}");
        }
        let [x, y] = [&a, &b].map(|m| m.spectral[0].radius);
        assert!((x - y).abs() < 1e-3, "{what}: {x} {y}");
        // in a closed room every row of F adds up to 1, and to 0 on the outside of a surface of two sides
        let f = &a.radiosity.factors;
        for i in 0..f.n {
            let sum: f64 = f.row(i).iter().map(|x| f64::from(*x)).sum();
            assert!(sum.abs().min((sum - 1.0).abs()) < 1e-3, "{what}: row {i} adds up to {sum}");
        }
    }
}

/// In packets and one by one, the same bits.
#[test]
fn both_engines_see_the_same_lamp() {
    let square = lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0));
    let d = in_plane(vec![square], Sides::Front);
    let run = |scene: &Scene| {
        let settings = settings(Technique::Mis, 64, 5);
        by_rays::terms(scene, Estimator::Prefix, &settings, Progress::NONE).series.functionals
    };
    let packets = run(&Scene::new(&d));
    assert_eq!(packets, run(&Scene::new(&d).one_by_one()));
    assert!(packets[0].terms[0].mean.x > 0.5);
}

/// The fault, far from the origin.
#[test]
fn lamps_in_a_plane_far_away() {
    let mut account = common::open("lamps_in_a_plane_far_away");
    let seed = account.seed();
    let square = || lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0));
    let (flush, hole) =
        (in_plane(vec![square()], Sides::Front), with_hole([-0.3, -0.3, 0.3, 0.3], square(), Sides::Front));
    let far = mapped(&flush, 1.0, |x| x + DVec3::new(1e6, 3e6, -2e6));
    let reference = values(&Scene::new(&hole), Estimator::Prefix, Technique::Mis, 4096, seed ^ 1);
    let scene = Scene::new(&far);
    for (way, estimator, technique, spp, judged) in WAYS {
        let found = values(&scene, estimator, technique, spp, seed);
        for &k in judged {
            let delta = [0.06, 0.03, 0.03, 0.05][k] * reference[k].mean;
            account.assert_equivalent(&format!("{way}, {k}"), &apart(&found[k], &reference[k]), DVec3::ZERO, delta);
        }
    }
}

/// The mean over all surfaces of each term: what lies under the lamp is dark, and counts in the area.
#[test]
fn what_a_lamp_covers_sends_no_light() {
    let mut account = common::open("what_a_lamp_covers_sends_no_light");
    let seed = account.seed();
    let square = || lamp(below([-0.3, -0.3], [0.3, 0.3], 1.0));
    let norms = |d: &Description, seed| {
        let scene = Scene::new(d);
        let area = fredholm::scene::SurfaceSensor::new(&scene).area;
        let of = fredholm::study::surface::norms;
        let r = of(&scene, Estimator::Prefix, 1 << 21, &settings(Technique::Mis, 1, seed), Progress::NONE);
        [0, 1, 2, 3].map(|k| {
            let e = r.estimate(k..k + 1);
            Estimate { mean: e.mean * area, std_error: e.std_error * area, ..e }
        })
    };
    let flush = norms(&in_plane(vec![square()], Sides::Front), seed);
    let hole = norms(&with_hole([-0.3, -0.3, 0.3, 0.3], square(), Sides::Front), seed ^ 1);
    for (k, (a, b)) in flush.iter().zip(&hole).enumerate().skip(1) {
        // the covered ceiling is 1.5 % of the area
        account.assert_equivalent(&format!("T{k}"), &apart(a, b), DVec3::ZERO, 0.01 * b.mean);
    }
}

/// The command line: a count and names in `info`, a warning, and no verdict with the exit code of one.
#[test]
fn commands_name_what_coincides() {
    let desk = tempfile::tempdir().unwrap();
    let file = |rug: &str| {
        format!(
            "name = \"rug\"\n[camera]\norigin = [0, 0, 0.95]\ntarget = [0, -0.3, 0]\nup = [0, 1, 0]\nfov = 90\nsize = [8, 8]\n\
             [materials.w]\ntype = \"diffuse\"\nreflectance = [0.6, 0.6, 0.6]\nsides = \"front\"\n\
             [materials.r]\ntype = \"diffuse\"\nreflectance = [0.1, 0.2, 0.3]\nsides = \"both\"\n\
             [[shapes]]\ntype = \"box\"\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\ninward = true\nmaterial = \"w\"\n\
             [[shapes]]\ntype = \"quad\"\norigin = [-0.3, 1, -0.3]\nedge_u = [0.6, 0, 0]\nedge_v = [0, 0, 0.6]\n\
             material = \"w\"\nemission = [10, 10, 10]\n\
             [[shapes]]\ntype = \"quad\"\norigin = [-0.5, {rug}, -0.5]\nedge_u = [0, 0, 1]\nedge_v = [1, 0, 0]\nmaterial = \"r\"\n"
        )
    };
    std::fs::write(desk.path().join("flush.toml"), file("-1")).unwrap();
    std::fs::write(desk.path().join("raised.toml"), file("-0.999")).unwrap();
    let run = |line: &str| {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
        let output = command.args(line.split_whitespace()).current_dir(desk.path()).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    };
    let words = "shapes `shapes[0]` and `shapes[2]` lie in one plane and differ";
    let (code, out, err) = run("info flush.toml");
    assert_eq!(code, 0);
    assert!(out.contains("coplanar overlaps: 2"), "{out}");
    assert!(out.contains("shapes[0] and shapes[1]: what emits lies in front"), "{out}");
    assert!(out.contains("shapes[0] and shapes[2]: they differ"), "{out}");
    assert!(err.contains(words), "{err}");
    let (code, out, err) = run("series flush.toml --spp 32 --patches 60 -q -o a");
    assert!(code == 0 && err.contains(words) && out.contains(&format!("Undecided: {words}")), "{code} {out} {err}");
    assert!(out.lines().all(|l| l.chars().count() <= 100), "{out}");
    let summary = fredholm::report::text::summary::read(&desk.path().join("a/summary.json")).unwrap();
    assert!(summary.verdicts.iter().all(|v| v.outcome == fredholm::stats::Outcome::Inconclusive));
    assert!(summary.series.iter().all(|s| s.undecided.as_deref() == Some(words)));
    let (code, out, _) = run("check bias --scene flush.toml --spp 4096 --batch 64 -q -o b");
    assert!(code == 0 && out.contains("Undecided"), "{code} {out}");
    let (code, out, _) = run("check equilibrium flush.toml --spp 64 --points 8 -q -o c");
    assert!(code == 0 && out.contains("Undecided"), "{code} {out}");
    let (code, out, _) = run("compare a a -o d");
    assert!(code == 1 && out.contains("Undecided"), "{code} {out}");
    // a millimetre above the floor all is well
    let (_, out, err) = run("info raised.toml");
    assert!(out.contains("coplanar overlaps: 1") && !err.contains("warning"), "{out} {err}");
    let (_, out, _) = run("series raised.toml --spp 32 --patches 60 -q -o e");
    assert!(!out.contains("Undecided"), "{out}");
}

/// No verdict where the scene has no right answer, whatever the numbers.
#[test]
fn comparisons_of_a_scene_without_a_right_answer_are_undecided() {
    let rug = Part(above([-0.4, -0.4], [0.3, 0.2], -1.0), 0.1, 0.0, Sides::Front);
    let d = scene(vec![dark(room()), lamp(below([-0.3, -0.3], [0.3, 0.3], 0.9)), rug]);
    let scene = Scene::new(&d);
    let run =
        |seed| by_rays::terms(&scene, Estimator::Prefix, &settings(Technique::Mis, 64, seed), Progress::NONE).series;
    let (a, mut b) = (run(1), run(2));
    assert!(a.undecided.as_deref().unwrap().contains("`shapes[0]` and `shapes[2]`"), "{:?}", a.undecided);
    // far off, and certainly so
    b.functionals.iter_mut().for_each(|f| f.total.mean *= 3.0);
    let c = compare(&a, &b, &Criterion::default(), &[]);
    assert_eq!((c.outcome, c.undecided.clone()), (Outcome::Inconclusive, a.undecided.clone()));
    assert!(c.rows.iter().all(|r| r.outcome == Outcome::Inconclusive && r.reason.is_some()));
    let plain = |s: &Series| Series { undecided: None, ..s.clone() };
    assert_eq!(compare(&plain(&a), &plain(&b), &Criterion::default(), &[]).outcome, Outcome::Differs);
    // one side is enough
    assert_eq!(compare(&plain(&a), &b, &Criterion::default(), &[]).outcome, Outcome::Inconclusive);
}
