//! Lamps in the plane of a wall are worth their light, by every way of sampling and in the matrix.

use super::*;
use common::sampling::difference;

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
                let d = difference(&found[k], &reference[k]);
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
            account.assert_equivalent(
                &format!("{way}, {k}"),
                &difference(&found[k], &reference[k]),
                DVec3::ZERO,
                delta,
            );
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
        account.assert_equivalent(&format!("T{k}"), &difference(a, b), DVec3::ZERO, 0.01 * b.mean);
    }
}
