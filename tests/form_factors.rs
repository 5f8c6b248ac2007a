//! Form factors against closed forms (`tests/truth/discrete.json`: 30-digit evaluations, checked by quadrature and by
//! ray casting), and the invariants of the assembled matrix.
#![allow(clippy::unwrap_used)]

mod discrete;
use discrete::*;
use fredholm::operator::form_factor::*;
use fredholm::operator::patches::{BruteForce, Patches, polygon};
use fredholm::progress::Progress;
use fredholm::scene::{Primitive, description::*};
use fredholm::solver::Radiosity;
use glam::DVec3;

fn rectangle(o: DVec3, u: DVec3, w: DVec3) -> Vec<DVec3> {
    vec![o, o + u, o + u + w, o + w]
}

/// The truth cases whose id starts with `prefix`.
fn cases(prefix: &str) -> Vec<(String, serde_json::Value)> {
    truth().into_iter().filter(|(id, _)| id.starts_with(prefix)).collect()
}

fn close(id: &str, got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{id}: {got} instead of {expected}, off by {:e}", got - expected);
}

#[test]
fn rectangles_have_their_closed_form() {
    let mut count = 0;
    for (id, case) in cases("ff_p") {
        let x = |key: &str| case["inputs"][key].as_f64().unwrap();
        let (a, b) = if id.starts_with("ff_parallel_general") {
            let a = rectangle(v(x("x1"), x("y1"), 0.0), v(x("x2") - x("x1"), 0., 0.), v(0., x("y2") - x("y1"), 0.));
            let b = rectangle(v(x("X1"), x("Y1"), x("z")), v(0., x("Y2") - x("Y1"), 0.), v(x("X2") - x("X1"), 0., 0.));
            (a, b)
        } else if id.starts_with("ff_parallel") {
            let a = rectangle(DVec3::ZERO, v(x("a"), 0., 0.), v(0., x("b"), 0.));
            (a, rectangle(v(0., 0., x("c")), v(0., x("b"), 0.), v(x("a"), 0., 0.)))
        } else if id.starts_with("ff_perp_general") {
            let a = rectangle(v(x("x1"), x("y1"), 0.0), v(x("x2") - x("x1"), 0., 0.), v(0., x("y2") - x("y1"), 0.));
            let b = rectangle(v(0.0, x("Y1"), x("z1")), v(0., x("Y2") - x("Y1"), 0.), v(0., 0., x("z2") - x("z1")));
            (a, b)
        } else if id.starts_with("ff_perp") {
            let a = rectangle(DVec3::ZERO, v(x("w"), 0., 0.), v(0., x("l"), 0.));
            (a, rectangle(DVec3::ZERO, v(0., x("l"), 0.), v(0., 0., x("h"))))
        } else {
            continue;
        };
        count += 1;
        // distant pairs take the Gauss rule, all others the closed contour
        let expected = case["expected"]["F12"].as_f64().unwrap();
        let far = id.ends_with("d10");
        close(&id, polygon_to_polygon(&a, &b), expected, if far { 1e-6 * expected } else { 3e-14 });
        let area = |p: &[DVec3]| polygon::area_vector(p).length();
        let back = polygon_to_polygon(&b, &a) * area(&b) / area(&a);
        close(&id, back, polygon_to_polygon(&a, &b), 1e-14);
    }
    assert_eq!(count, 12);
}

#[test]
fn nothing_is_exchanged_behind() {
    let a = rectangle(DVec3::ZERO, DVec3::X, DVec3::Y);
    let below = rectangle(v(0., 0., -1.), DVec3::X, DVec3::Y);
    let back_turned = rectangle(v(0., 0., 1.), DVec3::X, DVec3::Y);
    let coplanar = rectangle(v(1., 0., 0.), DVec3::X, DVec3::Y);
    for b in [below, back_turned, coplanar] {
        assert_eq!(polygon_to_polygon(&a, &b), 0.0);
    }
}

#[test]
fn a_point_sees_polygons_disks_and_spheres() {
    for (id, case) in cases("ff_point") {
        let expected = case["expected"]["F"].as_f64().unwrap();
        let x = |key: &str| case["inputs"][key].as_f64().unwrap();
        let vector = |w: &serde_json::Value| DVec3::from_array([0, 1, 2].map(|i| w[i].as_f64().unwrap()));
        if id.starts_with("ff_point_polygon") {
            let polygon: Vec<DVec3> = case["inputs"]["polygon"].as_array().unwrap().iter().map(vector).collect();
            let (p, n) = (vector(&case["inputs"]["p"]), vector(&case["inputs"]["n"]));
            close(&id, point_to_polygon(p, n, &polygon), expected, 3e-15);
            continue;
        }
        // tessellated as patches are, weighted by true over flat area: the error falls like 1/n
        let (geometry, normal) = if id.starts_with("ff_point_disk") {
            (Geometry::Disk { center: v(x("a"), 0., x("h")), normal: -DVec3::Z, radius: x("r") }, DVec3::Z)
        } else {
            let w = x("angle_deg").to_radians();
            let center = x("d") * v(w.sin(), 0.0, w.cos());
            (Geometry::Sphere { center, radius: x("R"), z: [-1.0, 1.0], inward: false }, DVec3::Z)
        };
        let scene = scene(vec![(geometry, DVec3::splat(0.5), DVec3::ZERO)]);
        let error = |n: usize| {
            let patches = Patches::new(&scene, n).unwrap();
            let here = -patches.origin();
            let front = patches.iter().filter(|p| p.normal.dot(p.centre - here) < 0.0);
            front.map(|p| p.stretch * point_to_polygon(here, normal, &p.polygon)).sum::<f64>() - expected
        };
        let (coarse, fine) = (error(400), error(25600));
        assert!(fine.abs() < 1e-4 && fine.abs() <= 0.05 * coarse.abs() + 1e-12, "{id}: {coarse:e} {fine:e}");
    }
}

#[test]
fn a_box_has_its_matrix() {
    let case = &truth()["ff_box_1x2x3"];
    let scene = room(v(1., 2., 3.), [0.5; 6], [0.0; 6]);
    let faces: Vec<Vec<DVec3>> = Patches::new(&scene, 1).unwrap().iter().map(|p| p.polygon.to_vec()).collect();
    let (patches, f) = discretise(&scene, 1);
    for i in 0..6 {
        for j in 0..6 {
            let expected = case["expected"]["F"][i][j].as_f64().unwrap();
            close("box", polygon_to_polygon(&faces[i], &faces[j]), expected, 3e-14);
            close("box, single precision", f64::from(f.f[i * 6 + j]), expected, 3e-8);
        }
    }
    assert_eq!(patches.surface_area(), 22.0);
}

/// Mean form factor between two primitives.
fn between(patches: &Patches, f: &FormFactors, from: usize, to: usize) -> f64 {
    let of = |k: usize| patches.iter().enumerate().filter(move |(_, p)| p.primitive == k);
    let sum: f64 = of(from).map(|(i, p)| p.area * of(to).map(|(j, _)| f64::from(f.row(i)[j])).sum::<f64>()).sum();
    sum / of(from).map(|(_, p)| p.area).sum::<f64>()
}

#[test]
fn disks_and_spheres_converge_to_their_closed_form() {
    let disk = |z: f64, normal: DVec3, radius: f64| Geometry::Disk { center: v(0., 0., z), normal, radius };
    let facing = |a: Geometry, b: Geometry| {
        scene(vec![(a, DVec3::splat(0.5), DVec3::ZERO), (b, DVec3::splat(0.5), DVec3::ZERO)])
    };
    let sphere = Geometry::Sphere { center: DVec3::ZERO, radius: 0.5, z: [-1.0, 1.0], inward: false };
    for (id, scene) in [
        ("ff_disks_1_2_h1", facing(disk(0., DVec3::Z, 1.), disk(1., -DVec3::Z, 2.))),
        ("ff_disks_1_1_h0.25", facing(disk(0., DVec3::Z, 1.), disk(0.25, -DVec3::Z, 1.))),
        ("ff_sphere_disk_R0.5_r2_h1", facing(sphere, disk(1., -DVec3::Z, 2.))),
    ] {
        let expected = truth()[id]["expected"]["F12"].as_f64().unwrap();
        let error = |n: usize| {
            let (patches, f) = discretise(&scene, n);
            assert!(f.invariants().reciprocity < 2e-7);
            between(&patches, &f, 0, 1) - expected
        };
        let (coarse, fine) = (error(60), error(960));
        assert!(fine.abs() < 4e-3 && fine.abs() < 0.3 * coarse.abs(), "{id}: {coarse:e} {fine:e}");
    }
}

#[test]
fn closed_boxes_close_and_obey_reciprocity() {
    for (dims, n) in [(v(1., 1., 1.), 384), (v(1., 2., 3.), 500), (v(3., 0.2, 1.), 300)] {
        let (_, f) = discretise(&room(dims, [0.5; 6], [0.0; 6]), n);
        let found = f.invariants();
        assert!(found.closure < 1e-6, "{dims}: {found:?}");
        assert!(found.reciprocity < 2e-7 && found.smallest >= 0.0 && found.largest < 1.0, "{found:?}");
    }
}

#[test]
fn entries_of_a_fine_cube_are_right_far_and_near() {
    // every entry against the closed contour of the pair: the far rule is the only approximation
    let (patches, f) = discretise(&room(DVec3::ONE, [0.5; 6], [0.0; 6]), 384);
    let mut worst = 0.0f64;
    for (i, a) in patches.iter().enumerate().step_by(7) {
        for (j, b) in patches.iter().enumerate() {
            let got = f64::from(f.row(i)[j]);
            // 16 sub-squares per patch: distances grow in units of the patch, errors shrink by 4⁴
            let expected = if a.primitive == b.primitive { 0.0 } else { refined(&a.polygon, &b.polygon) };
            if expected > 0.0 {
                worst = worst.max((got / expected - 1.0).abs());
            } else {
                assert_eq!(got, 0.0);
            }
        }
    }
    assert!(worst < 1e-5, "{worst:e}");
}

fn refined(a: &[DVec3], b: &[DVec3]) -> f64 {
    let parts = |p: &[DVec3]| -> Vec<Vec<DVec3>> {
        let (u, w) = ((p[1] - p[0]) / 4.0, (p[3] - p[0]) / 4.0);
        (0..16).map(|k| rectangle(p[0] + f64::from(k % 4) * u + f64::from(k / 4) * w, u, w)).collect()
    };
    let b = parts(b);
    parts(a).iter().map(|p| b.iter().map(|q| polygon_to_polygon(p, q)).sum::<f64>()).sum::<f64>() / 16.0
}

#[test]
fn the_cornell_box_keeps_its_books() {
    let scene = cornell();
    let (patches, f) = discretise(&scene, 600);
    assert!((550..=650).contains(&patches.len()));
    // two blocks of 0.6 × 0.6 stand on the floor
    close("covered", patches.covered_area(), 0.72, 1e-9);
    let total: f64 = patches.areas().iter().sum();
    let surface: f64 = scene.primitives().iter().map(|(_, p)| p.area()).sum();
    close("surface", patches.surface_area(), surface, 1e-12);
    close("sum of patches", total, surface - 0.72, 1e-9);
    let found = f.invariants();
    assert!(found.row_sum_max <= 1.0 + 1e-3 && found.smallest >= 0.0, "{found:?}");
    assert!(found.reciprocity < 2e-7, "{found:?}");
    // under the blocks there is no patch
    for (x, z) in [(0.335, 0.38), (-0.335, -0.38), (0.1, 0.2), (-0.55, -0.3)] {
        assert_eq!(patches.locate(0, true, v(x, -1.0, z)), None, "{x} {z}");
    }
    assert!(patches.locate(0, true, v(0.8, -1.0, 0.8)).is_some());
    assert_eq!(patches.locate(0, false, v(0.8, -1.0, 0.8)), None);
    // light is hidden behind the blocks: the floor patch behind the tall one does not see the light as much
    let light = patches.locate(5, true, v(0.0, 0.99, 0.0)).unwrap();
    let behind = patches.locate(0, true, v(-0.4, -1.0, -0.95)).unwrap();
    let free = patches.locate(0, true, v(0.0, -1.0, 0.95)).unwrap();
    assert!(f.row(behind)[light] < 0.1 * f.row(free)[light]);
}

#[test]
fn visibility_samples_leave_the_reflected_light_right() {
    // the same mesh with 6400 instead of 576 rays per pair that is partly hidden; without any, the error is 0.8
    let scene = cornell();
    let patches = Patches::new(&scene, 600).unwrap();
    let reflected = |sampling: VisibilitySampling| {
        let f = FormFactors::new(&patches, &BruteForce::new(&scene), sampling, Progress::NONE).unwrap();
        let lit = Radiosity::new(patches.clone(), f).solve().unwrap().radiance;
        lit.iter().zip(patches.iter()).map(|(l, p)| l.x - p.emission.x).collect::<Vec<_>>()
    };
    let norm = |x: &[f64]| x.iter().zip(patches.iter()).map(|(x, p)| p.area * x * x).sum::<f64>().sqrt();
    let exact = reflected(VisibilitySampling { rays: 512, refined: 6400 });
    let error = |sampling: VisibilitySampling| {
        let u = reflected(sampling);
        norm(&u.iter().zip(&exact).map(|(u, x)| u - x).collect::<Vec<_>>()) / norm(&exact)
    };
    let (usual, few) = (error(VisibilitySampling::default()), error(VisibilitySampling { rays: 8, refined: 8 }));
    assert!(usual < 1e-3 && few > 4.0 * usual, "{usual:e} {few:e}");
}

#[test]
fn every_point_finds_its_patch() {
    let mut description = cornell();
    description.materials[3].sides = Sides::Both;
    let ball = Geometry::Sphere { center: v(0.4, 0.2, 0.1), radius: 0.3, z: [-0.7, 0.9], inward: false };
    let disk = Geometry::Disk { center: v(-0.5, 0.5, 0.5), normal: v(1., 1., 0.), radius: 0.2 };
    for geometry in [ball, disk] {
        let name = "extra".into();
        description.shapes.push(Shape { name, geometry, material: 3, emission: DVec3::ZERO });
    }
    let patches = Patches::new(&description, 800).unwrap();
    let mut backs = 0;
    for (i, p) in patches.iter().enumerate() {
        backs += usize::from(!p.front);
        for k in 0..25 {
            let h = |i: i32| 0.02 + 0.24 * f64::from(i);
            let x = p.lift(polygon::at(&p.polygon, h(k % 5), h(k / 5)).0);
            let off = x.position + 1e-7 * x.normal;
            // a facet of a curved surface ends where the next begins, up to its sagitta
            let found = patches.locate(p.primitive, p.front, off).unwrap();
            let curved = matches!(patches.primitives()[p.primitive], Primitive::Sphere { .. } | Primitive::Disk { .. });
            assert!(found == i || curved, "{i} {found}");
            assert_eq!(patches[found].front, p.front);
            if k == 12 {
                assert_eq!(found, i);
            }
        }
    }
    assert!(backs > 20);
}

#[test]
fn points_just_outside_a_face_still_find_a_patch() {
    let patches = Patches::new(&room(DVec3::ONE, [0.5; 6], [0.0; 6]), 96).unwrap();
    for (face, p) in [(0, v(0., -1e-9, 1. + 1e-9)), (5, v(1. + 1e-9, 1. + 1e-9, 1.)), (2, v(-1e-9, 0., -1e-9))] {
        let p = p - patches.origin();
        let i = patches.locate(face, true, p).unwrap();
        assert_eq!(patches[i].primitive, face);
        assert!(patches[i].polygon.iter().any(|q| q.distance(p) < 1e-8));
    }
}

#[test]
fn two_sided_blocks_on_a_two_sided_floor_count_every_side_once() {
    // floor and block bottom coincide: seen from inside the block and from below, only one of them may exchange light
    let mut scene = scene(vec![
        (quad(DVec3::ZERO, DVec3::Y, DVec3::X), DVec3::splat(0.5), DVec3::ZERO),
        (
            Geometry::Box { min: v(0.25, 0.25, 0.), max: v(0.75, 0.75, 0.5), rotate_y: 0.0, inward: false },
            DVec3::splat(0.5),
            DVec3::ZERO,
        ),
    ]);
    scene.materials.iter_mut().for_each(|m| m.sides = Sides::Both);
    let (patches, f) = discretise(&scene, 200);
    close("covered", patches.covered_area(), 0.5, 1e-12);
    let found = f.invariants();
    assert!(found.row_sum_max < 1.0 + 1e-6, "{found:?}");
    // the inside of the block is a closed room
    let inside = patches.locate(0, false, v(0.5, 0.5, 0.0) - patches.origin()).unwrap();
    close("inside", f.row(inside).iter().map(|f| f64::from(*f)).sum(), 1.0, 1e-6);
}

#[test]
fn bad_scenes_are_refused_with_a_reason() {
    let flat = scene(vec![(quad(DVec3::ZERO, DVec3::X, DVec3::X), DVec3::ONE, DVec3::ZERO)]);
    assert!(Patches::new(&flat, 10).unwrap_err().to_string().contains("shapes[0]"));
    assert!(Patches::new(&cornell(), 0).is_err());
    assert!(Patches::new(&scene(vec![]), 10).is_err());
}
