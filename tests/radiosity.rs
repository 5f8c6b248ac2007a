//! The discrete world against closed forms (`tests/truth/discrete.json`: dense algebra, checked independently).
//!
//! Form factors are stored in single precision: entries of that matrix are right to 6e-8 relative, and what follows
//! from them to a few 1e-7.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod discrete;
use discrete::*;
use fredholm::operator::{form_factor::*, matrix::*, patches::*};
use fredholm::progress::Progress;
use fredholm::scene::{Description, description::Geometry};
use fredholm::solver::{direct, *};
use glam::DVec3;
use serde_json::Value;

const SINGLE: f64 = 4e-7;

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn rows(v: &Value) -> Vec<Vec<f64>> {
    v.as_array().unwrap().iter().map(numbers).collect()
}

fn close(what: &str, got: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(got.len(), expected.len(), "{what}");
    for (i, (g, e)) in got.iter().zip(expected).enumerate() {
        assert!((g - e).abs() <= tolerance, "{what}[{i}]: {g} instead of {e}, off by {:e}", g - e);
    }
}

fn grey(x: &[DVec3]) -> Vec<f64> {
    assert!(x.iter().all(|x| x.x == x.y && x.y == x.z));
    x.iter().map(|x| x.x).collect()
}

/// Terms, solution and spectral radius of a matrix, against a case with one region per patch.
fn check_matrix(id: &str, factors: &FormFactors, rho: &[f64], e: &[f64], expected: &Value, tolerance: f64) {
    let t = PatchOperator::new(factors, rho.to_vec());
    let terms = rows(&expected["terms"]);
    for (k, (x, expected)) in Neumann::new(&t, e.to_vec()).zip(&terms).enumerate() {
        close(&format!("{id}, k = {k}"), &x, expected, tolerance);
    }
    let key = if expected["L"].is_null() { "B" } else { "L" };
    close(id, &direct::solve(&t, e).unwrap().x, &numbers(&expected[key]), 4.0 * tolerance);
    let radius = expected["spectral_radius"].as_f64().unwrap();
    close(id, &[spectral_radius(factors, rho, 1e-15, 1000).radius], &[radius], tolerance);
}

#[test]
fn two_surfaces_bounce_as_two_by_two_matrices() {
    for (id, case) in truth() {
        // (areas make F symmetric: the inner surface has r² or r of the outer one)
        let inner = match id.as_str() {
            "plates_0.9_0.4" | "plates_0.8_0.2" => 1.0,
            "concentric_spheres_r0.25" => 0.0625,
            "coaxial_cylinders_r0.5" => 0.5,
            _ => continue,
        };
        let f = rows(&case["expected"]["F"]).concat().iter().map(|f| *f as f32).collect();
        let factors = FormFactors { n: 2, f, area: vec![inner, 1.0], rays: 0 };
        assert_eq!(factors.invariants().closure, 0.0);
        assert_eq!(factors.invariants().reciprocity, 0.0);
        let (rho, e) = (numbers(&case["inputs"]["rho"]), numbers(&case["inputs"]["E"]));
        check_matrix(&id, &factors, &rho, &e, &case["expected"], 1e-14);
    }
}

#[test]
fn plates_alternate_and_only_the_two_step_ratio_settles() {
    let factors = FormFactors { n: 2, f: vec![0., 1., 1., 0.], area: vec![1.0, 1.0], rays: 0 };
    let t = PatchOperator::new(&factors, vec![0.9, 0.4]);
    let sums: Vec<f64> = Neumann::new(&t, vec![1.0, 0.0]).take(9).map(|x| x.iter().sum()).collect();
    for (k, w) in sums.windows(3).enumerate() {
        close("one step", &[w[1] / w[0]], &[if k % 2 == 0 { 0.4 } else { 0.9 }], 1e-14);
        close("two steps", &[w[2] / w[0]], &[0.36], 1e-14);
    }
    // ±0.6 are both eigenvalues; the norms of T are 0.9
    close("radius", &[spectral_radius(&factors, &t.rho, 1e-15, 1000).radius], &[0.6], 1e-14);
    close("norms", &[t.norm_1(), t.norm_inf()], &[0.9, 0.9], 1e-14);
}

#[test]
fn one_patch_per_face_gives_the_constant_basis_solution() {
    for id in ["cube6_cornell", "cube6_mixed", "tetrahedron_closed"] {
        let case = &truth()[id];
        let (rho, e) = (numbers(&case["inputs"]["rho"]), numbers(&case["inputs"]["E"]));
        let scene = if rho.len() == 6 {
            room(DVec3::ONE, rho.clone().try_into().unwrap(), e.clone().try_into().unwrap())
        } else {
            tetrahedron(&rho, &e)
        };
        let (patches, factors) = discretise(&scene, 1);
        let expected = rows(&case["expected"]["F"]).concat();
        close(id, &factors.f.iter().map(|f| f64::from(*f)).collect::<Vec<_>>(), &expected, 6e-8);
        check_matrix(id, &factors, &rho, &e, &case["expected"], SINGLE);
        let r = Radiosity::new(patches, factors);
        close(id, &grey(&r.terms(3)[3]), &rows(&case["expected"]["terms"])[3], SINGLE);
    }
}

/// A regular tetrahedron seen from inside.
fn tetrahedron(rho: &[f64], e: &[f64]) -> Description {
    let p = [v(1., 1., 1.), v(1., -1., -1.), v(-1., 1., -1.), v(-1., -1., 1.)];
    let face = |i: usize| {
        let others: Vec<DVec3> = (0..4).filter(|j| *j != i).map(|j| p[j]).collect();
        let outwards = (others[1] - others[0]).cross(others[2] - others[0]).dot(others[0]) > 0.0;
        let faces = vec![if outwards { [0, 2, 1] } else { [0, 1, 2] }];
        (Geometry::Mesh { vertices: others, faces, uvs: vec![] }, DVec3::splat(rho[i]), DVec3::splat(e[i]))
    };
    scene((0..4).map(face).collect())
}

#[test]
fn patches_of_a_cube_give_the_galerkin_solution() {
    for (id, case) in truth().iter().filter(|(id, _)| id.starts_with("cube_patches")) {
        let m = case["inputs"]["m"].as_u64().unwrap() as usize;
        let array = |key: &str| numbers(&case["inputs"][key]).try_into().unwrap();
        let scene = room(DVec3::ONE, array("rho"), array("E"));
        let (patches, factors) = discretise(&scene, 6 * m * m);
        assert_eq!(patches.len(), 6 * m * m);
        let r = Radiosity::new(patches, factors);
        let solved = r.solve().unwrap();
        assert!(solved.residual.max_element() < 1e-13);
        let b = grey(&solved.radiance);
        let expected = &case["expected"];
        let share = 1.0 / (m * m) as f64;
        let mean = |face| (0..b.len()).filter(|i| r.patches[*i].primitive == face).map(|i| b[i] * share).sum::<f64>();
        close(id, &(0..6).map(mean).collect::<Vec<_>>(), &numbers(&expected["face_mean_B"]), SINGLE);
        // the patch at the low corner of both in-plane axes
        let corner = |face: usize| {
            let mut p = DVec3::splat(0.01);
            p[face / 2] = (face % 2) as f64;
            b[r.patches.locate(face, true, p - r.patches.origin()).unwrap()]
        };
        close(
            id,
            &(0..6).map(corner).collect::<Vec<_>>(),
            &numbers(&expected["B_first_patch_each_face"]),
            2.0 * SINGLE,
        );
        let norm = |x: &Vec<DVec3>| grey(x).iter().map(|x| share * x * x).sum::<f64>().sqrt();
        let norms: Vec<f64> = r.terms(6).iter().map(norm).collect();
        close(id, &norms, &numbers(&expected["L2_terms"]), SINGLE);
        let radius = r.spectral_radius()[0].radius;
        close(id, &[radius], &[expected["spectral_radius"].as_f64().unwrap()], SINGLE);
    }
}

#[test]
fn sphere_bands_are_exact_on_any_mesh() {
    // the kernel of a ball is constant, so no facet enters
    for (id, case) in truth().iter().filter(|(id, _)| id.starts_with("sphere_")) {
        let (cuts, rho, e) = (&case["inputs"]["z_cuts_over_R"], &case["inputs"]["rho"], &case["inputs"]["E"]);
        let (cuts, rho, e) = (numbers(cuts), numbers(rho), numbers(e));
        let band = |i: usize| {
            let z = [cuts[i + 1], cuts[i]];
            let geometry = Geometry::Sphere { center: v(0.1, 0.2, 0.3), radius: 1.7, z, inward: true };
            (geometry, DVec3::splat(rho[i]), DVec3::splat(e[i]))
        };
        let (patches, factors) = discretise(&scene((0..rho.len()).map(band).collect()), 150);
        assert!(factors.invariants().closure < 1e-6);
        let r = Radiosity::new(patches, factors);
        let means = |x: &[DVec3]| -> Vec<f64> {
            // constant on every band
            let values = grey(x);
            (0..rho.len())
                .map(|i| {
                    let of: Vec<f64> =
                        (0..x.len()).filter(|j| r.patches[*j].primitive == i).map(|j| values[j]).collect();
                    assert!(of.iter().all(|x| (x - of[0]).abs() < 2e-6));
                    of[0]
                })
                .collect()
        };
        let terms = r.terms(8);
        for (x, expected) in terms.iter().zip(rows(&case["expected"]["terms"])) {
            close(id, &means(x), &expected, SINGLE);
        }
        let l1: Vec<f64> = terms.iter().map(|x| r.patches.surface_mean(x).x).collect();
        close(id, &l1, &numbers(&case["expected"]["L1_mean"]), SINGLE);
        close(id, &means(&r.solve().unwrap().radiance), &numbers(&case["expected"]["L"]), 3e-6);
        let [(one, infinity), ..] = r.norms();
        let key = |key: &str| case["expected"][key].as_f64().unwrap();
        close(id, &[one, infinity], &[key("norm_T_L1"), key("norm_T_Linf")], 1e-6);
        close(id, &[r.spectral_radius()[0].radius], &[key("spectral_radius")], 1e-6);
    }
}

#[test]
fn concentric_spheres_converge_to_their_two_by_two_matrix() {
    let case = &truth()["concentric_spheres_r0.25"]["expected"];
    let sphere = |radius, inward| Geometry::Sphere { center: DVec3::ZERO, radius, z: [-1.0, 1.0], inward };
    let shapes =
        vec![(sphere(0.25, false), DVec3::splat(0.9), DVec3::ZERO), (sphere(1.0, true), DVec3::splat(0.6), DVec3::ONE)];
    let scene = scene(shapes);
    let error = |n: usize| {
        let (patches, factors) = discretise(&scene, n);
        let r = Radiosity::new(patches, factors);
        let radius = (r.spectral_radius()[0].radius - case["spectral_radius"].as_f64().unwrap()).abs();
        // area means of T E over both spheres, and the largest deviation from the mean on the outer one
        let te = grey(&r.terms(1)[1]);
        let mean = |k: usize| {
            let of = || r.patches.iter().zip(&te).filter(|(p, _)| p.primitive == k);
            of().map(|(p, x)| p.area * x).sum::<f64>() / of().map(|(p, _)| p.area).sum::<f64>()
        };
        let expected = rows(&case["terms"])[1].clone();
        radius.max((mean(0) - expected[0]).abs()).max((mean(1) - expected[1]).abs())
    };
    // O(1/n) once the inner sphere has some 20 facets
    let (coarse, fine) = (error(300), error(1200));
    assert!(fine < 5e-3 && fine < 0.3 * coarse, "{coarse:e} {fine:e}");
}

#[test]
fn a_furnace_decays_by_its_albedo_in_every_norm() {
    let (patches, factors) = discretise(&room(v(1., 2., 3.), [0.7; 6], [1.0; 6]), 150);
    let r = Radiosity::new(patches, factors);
    for (k, x) in r.terms(5).iter().enumerate() {
        close("T^k E", &grey(x), &vec![0.7f64.powi(k as i32); x.len()], 3e-6);
    }
    let [(one, infinity), ..] = r.norms();
    close("norms and radius", &[one, infinity, r.spectral_radius()[0].radius], &[0.7; 3], 1e-6);
    // finite variance iff ρ²/s < 1: s = 0.5 gives 0.98, s = 0.48 gives 1.02
    close(
        "second moments",
        &[r.second_moment_radius(0.5)[0], r.second_moment_radius(0.48)[0]],
        &[0.98, 0.49 / 0.48],
        2e-6,
    );
}

fn cornell_box(n: usize) -> Radiosity {
    let (patches, factors) = discretise(&cornell(), n);
    Radiosity::new(patches, factors)
}

#[test]
fn the_adjoint_is_the_adjoint() {
    let r = cornell_box(150);
    let t = r.operator(1);
    let n = t.len();
    let wave = |a: f64| (0..n).map(|i| (a * i as f64).sin()).collect::<Vec<f64>>();
    let (x, y) = (wave(1.3), wave(0.7));
    let (mut tx, mut ty) = (vec![0.0; n], vec![0.0; n]);
    t.apply(&x, &mut tx);
    t.apply_adjoint(&y, &mut ty);
    let dot = |a: &[f64], b: &[f64]| (0..n).map(|i| r.factors.area[i] * a[i] * b[i]).sum::<f64>();
    close("<y, T x> = <T* y, x>", &[dot(&y, &tx)], &[dot(&ty, &x)], 1e-14);
    // T is self-adjoint in the weight A/ρ
    let over = |a: &[f64], b: &[f64]| {
        (0..n).filter(|i| t.rho[*i] > 0.0).map(|i| r.factors.area[i] / t.rho[i] * a[i] * b[i]).sum::<f64>()
    };
    let lit: Vec<f64> = (0..n).map(|i| if t.rho[i] > 0.0 { y[i] } else { 0.0 }).collect();
    let masked: Vec<f64> = (0..n).map(|i| if t.rho[i] > 0.0 { x[i] } else { 0.0 }).collect();
    let apply = |x: &[f64]| {
        let mut y = vec![0.0; n];
        t.apply(x, &mut y);
        y
    };
    close("symmetry", &[over(&lit, &apply(&masked))], &[over(&apply(&lit), &masked)], 1e-6);
}

#[test]
fn the_neumann_series_sums_to_the_direct_solution() {
    let r = cornell_box(200);
    let solved = r.solve().unwrap();
    let scale = LIGHT.x;
    for channel in 0..3 {
        let t = r.operator(channel);
        let direct: Vec<f64> = solved.radiance.iter().map(|l| l[channel]).collect();
        let sum = Neumann::new(&t, r.emission(channel)).partial_sums().nth(120).unwrap();
        close("series", &sum, &direct, 1e-13 * scale);
    }
    assert!(r.residual(&solved.radiance).max_element() <= 1e-14 * scale);
    // the residual of a partial sum is the next term
    let t = r.operator(0);
    let partial = Neumann::new(&t, r.emission(0)).partial_sums().nth(3).unwrap();
    let next = Neumann::new(&t, r.emission(0)).nth(4).unwrap().into_iter().fold(0.0, f64::max);
    close("residual", &[direct::residual(&t, &r.emission(0), &partial)], &[next], 1e-13);
}

#[cfg(feature = "faer")]
#[test]
fn both_factorisations_agree() {
    let r = cornell_box(150);
    let (t, e) = (r.operator(0), r.emission(0));
    let (a, b) = (direct::solve_nalgebra(&t, &e).unwrap(), direct::solve_faer(&t, &e).unwrap());
    close("x", &a.x, &b.x, 1e-13);
    assert!(a.residual < 1e-13 && b.residual < 1e-13);
}

#[test]
fn a_scene_that_keeps_all_its_light_has_no_solution() {
    let plates = FormFactors { n: 2, f: vec![0., 1., 1., 0.], area: vec![1.0, 1.0], rays: 0 };
    assert_eq!(direct::solve(&PatchOperator::new(&plates, vec![1.0, 1.0]), &[1.0, 0.0]), Err(direct::Singular));
}

#[test]
fn weighted_ratios_rise_to_the_spectral_radius() {
    // one patch per face: known norms and ratios
    let case = &truth()["cube6_cornell_theory"];
    let (rho, e) = (numbers(&case["inputs"]["rho"]), numbers(&case["inputs"]["E"]));
    let (_, factors) = discretise(&room(DVec3::ONE, [0.0; 6], [0.0; 6]), 1);
    let t = PatchOperator::new(&factors, rho);
    let norms: Vec<f64> = Neumann::new(&t, e).take(12).map(|x| t.weighted_norm(&x)).collect();
    close("norms", &norms, &numbers(&case["expected"]["weighted_norms"]), SINGLE);
    close("norm", &[t.norm_inf()], &[case["expected"]["Linf_norm_T"].as_f64().unwrap()], SINGLE);

    // the Cornell box: E lives where ρ = 0, so from k = 1 on
    let r = cornell_box(150);
    for (channel, spectral) in r.spectral_radius().iter().enumerate() {
        let t = r.operator(channel);
        let norms: Vec<f64> =
            Neumann::new(&t, r.emission(channel)).skip(1).take(40).map(|x| t.weighted_norm(&x)).collect();
        let ratios: Vec<f64> = norms.windows(2).map(|w| w[1] / w[0]).collect();
        // single precision makes F symmetric to 6e-8 only
        assert!(ratios.windows(2).all(|w| w[1] >= w[0] - 1e-7), "{ratios:?}");
        assert!(ratios.iter().all(|q| *q <= spectral.radius + 1e-7));
        close("limit", &[ratios[38]], &[spectral.radius], 1e-4);
        assert!(spectral.radius <= t.norm_1().min(t.norm_inf()) && spectral.residual < 1e-4);
        // T u = r u
        let mut image = vec![0.0; t.len()];
        t.apply(&spectral.mode, &mut image);
        let expected: Vec<f64> = spectral.mode.iter().map(|u| spectral.radius * u).collect();
        close("mode", &image, &expected, 1e-4);
    }
}

#[test]
fn the_spectral_radius_of_the_cornell_box_settles_with_the_mesh() {
    let radii: Vec<f64> = [60, 240, 960].iter().map(|n| cornell_box(*n).spectral_radius()[0].radius).collect();
    let steps = [radii[1] - radii[0], radii[2] - radii[1]];
    assert!(steps[1].abs() < 0.6 * steps[0].abs() && steps[1].abs() < 0.01, "{radii:?}");
}

/// Not a test of the result: prints what the form factors cost. `cargo test --release -- --ignored timings --nocapture`
#[test]
#[ignore = "a benchmark"]
fn timings() {
    struct Everything(BruteForce);
    impl Visibility for Everything {
        fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool {
            self.0.visible(a, b)
        }
    }
    let run = |name: &str, scene: &Description, n: usize, visibility: &dyn Visibility| {
        let (wall, cpu) = (std::time::Instant::now(), cpu_seconds());
        let patches = Patches::new(scene, n).unwrap();
        let mesh = cpu_seconds() - cpu;
        let f = FormFactors::new(&patches, visibility, VisibilitySampling::default(), Progress::NONE).unwrap();
        println!(
            "{name} n = {}: mesh {mesh:.2}, all {:.2} CPU-s, {:.2} s wall, {:.1} M rays, {:?}",
            f.n,
            cpu_seconds() - cpu,
            wall.elapsed().as_secs_f64(),
            f.rays as f64 * 1e-6,
            f.invariants()
        );
        f
    };
    let cube = room(DVec3::ONE, [0.5; 6], [0.0; 6]);
    run("cube", &cube, 1944, &BruteForce::new(&cube));
    let box_ = cornell();
    for n in [600, 2305] {
        let f = run("cornell", &box_, n, &BruteForce::new(&box_));
        run("cornell, rays against everything", &box_, n, &Everything(BruteForce::new(&box_)));
        let patches = Patches::new(&box_, n).unwrap();
        println!("covered {}", patches.covered_area());
        let r = Radiosity::new(patches, f);
        println!("{:?}", r.spectral_radius().map(|s| (s.radius, s.steps)));
        let cpu = cpu_seconds();
        println!("{:?} residual, {:.2} CPU-s", r.solve().unwrap().residual, cpu_seconds() - cpu);
    }
}
