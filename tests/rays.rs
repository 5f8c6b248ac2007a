//! Stored rays: what holds by counting, what holds within the sampling error, and what the error bars are worth.
#![allow(clippy::unwrap_used)]

mod common;

mod discrete;
use common::ledger;
use discrete::*;
use fredholm::operator::form_factor::{FormFactors, Stopped};
use fredholm::operator::matrix::{LinearOperator, PatchOperator, spectral_radius};
use fredholm::operator::patches::Patches;
use fredholm::operator::rays::{Coarse, Half, Hit, Light, Rays, Rows, record};
use fredholm::progress::Progress;
use fredholm::scene::{Scene, description::*, load};
use fredholm::solver::Radiosity;
use fredholm::stats::critical;
use fredholm::terms::Part;
use glam::DVec3;
use std::sync::atomic::AtomicBool;

fn shoot(scene: &Description, patches: &Patches, per_row: usize, seed: u64) -> Rays {
    Rays::new(patches, &Scene::new(scene), per_row, seed, Progress::NONE).unwrap()
}

/// A closed room with a turned block, and a ball that stands half in the floor, so that floor patches are partly covered.
fn clutter() -> Description {
    let mut description = room(DVec3::ONE, [0.7, 0.6, 0.5, 0.8, 0.3, 0.9], [0., 0., 0., 0., 0., 1.]);
    let block = Geometry::Box { min: v(0.1, 0.1, -0.1), max: v(0.4, 0.4, 0.5), rotate_y: 20.0, inward: false };
    let ball = Geometry::Sphere { center: v(0.66, 0.62, 0.05), radius: 0.21, z: [-1.0, 1.0], inward: false };
    for geometry in [block, ball] {
        description.shapes.push(Shape { name: "extra".into(), geometry, material: 0, emission: DVec3::ZERO });
    }
    description
}

#[test]
fn closed_rooms_close_exactly() {
    for (scene, n) in [(room(v(1., 2., 3.), [0.5; 6], [0.0; 6]), 300), (clutter(), 400)] {
        let patches = Patches::new(&scene, n).unwrap();
        let rays = shoot(&scene, &patches, 64, 3);
        // a ray of a wall from under the block or the ball would meet a black back; what of block and ball is outside
        // the room sees nothing, and so it should
        let walls: Vec<usize> = (0..rays.n).filter(|i| patches[*i].primitive < 6).collect();
        let open = walls.iter().filter(|i| rays.row(**i).iter().any(|half| half.contains(&Hit::NOTHING))).count();
        assert_eq!((open, rays.lost), (0, 0));
        let checks = Light { patches: &patches, rays: &rays }.checks();
        assert_eq!(checks.row_sum_max, 1.0);
        assert!(checks.largest < 1.0 && checks.reciprocity_z < 3.0 && checks.reciprocity < 0.02, "{checks:?}");
        let t = rays.operator(vec![1.0; rays.n]);
        let mut image = vec![0.0; rays.n];
        t.apply(&vec![1.0; rays.n], &mut image);
        assert!(walls.iter().all(|i| image[*i] == 1.0));
    }
    // the floor under the ball is partly covered, or the test would show nothing
    let patches = Patches::new(&clutter(), 400).unwrap();
    assert!(patches.iter().filter(|p| p.area < 0.9 * p.stretch * p.flat_area).count() > 5);
}

#[test]
fn a_furnace_keeps_its_share() {
    let scene = room(DVec3::ONE, [0.5; 6], [1.0; 6]);
    let patches = Patches::new(&scene, 96).unwrap();
    let rays = shoot(&scene, &patches, 32, 0);
    let light = Light { patches: &patches, rays: &rays };
    for (k, term) in light.terms(6).iter().enumerate().filter(|t| t.0 != 1) {
        // every emitter is as near as the next wall for some patches and far for others, so that T E itself is sampled
        let from_direct = light.terms(1)[1].iter().sum::<DVec3>() / rays.n as f64;
        let expected = if k == 0 { 1.0 } else { from_direct.x * 0.5f64.powi(k as i32 - 1) };
        let mean = term.iter().zip(&rays.area).map(|(t, a)| *a * t.x).sum::<f64>() / 6.0;
        assert!((mean / expected - 1.0).abs() < 0.02, "{k}: {mean} {expected}");
    }
    let radius = light.spectral_radius(&vec![record(DVec3::ONE); rays.n], 1e-12, 100);
    assert!((radius[0].radius - 0.5).abs() < 1e-6, "{}", radius[0].radius);
}

#[test]
fn the_adjoint_is_the_adjoint() {
    let scene = clutter();
    let patches = Patches::new(&scene, 150).unwrap();
    let rays = shoot(&scene, &patches, 128, 1);
    let rho: Vec<f64> = patches.iter().map(|p| p.reflectance.x).collect();
    let inner = |x: &[f64], y: &[f64]| x.iter().zip(y).zip(&rays.area).map(|((x, y), a)| a * x * y).sum::<f64>();
    let wave = |f: f64| (0..rays.n).map(|i| (f * i as f64).sin()).collect::<Vec<_>>();
    let (x, y) = (wave(0.37), wave(0.91));
    for half in [Half::Both, Half::First, Half::Second] {
        let t = rays.operator(rho.clone()).by(half);
        let (mut tx, mut ty) = (vec![0.0; rays.n], vec![0.0; rays.n]);
        t.apply(&x, &mut tx);
        t.apply_adjoint(&y, &mut ty);
        let scale = inner(&x, &x).max(inner(&y, &y));
        assert!((inner(&y, &tx) - inner(&ty, &x)).abs() < 1e-14 * scale);
    }
}

#[test]
fn rows_agree_with_the_matrix() {
    // the share of a row that goes to each primitive, against the deterministic factors; the error of independent rays
    // is longer than that of the points used
    let scene = cornell();
    let (patches, dense) = discretise(&scene, 300);
    let account = ledger::open("rows_agree_with_the_matrix", 0);
    let rays = shoot(&scene, &patches, 1024, account.seed());
    let critical = critical(ledger::share("rows_agree_with_the_matrix").level(), f64::INFINITY);
    let primitives = patches.primitives().len();
    let by_primitive = |row: &dyn Fn(usize) -> f64| {
        let mut out = vec![0.0; primitives];
        (0..patches.len()).for_each(|j| out[patches[j].primitive] += row(j));
        out
    };
    // visibility samples of the matrix: less than this
    let delta = 3e-3;
    let scores = |dense: &FormFactors| -> (f64, f64) {
        let (mut largest, mut square, mut count) = (0.0f64, 0.0, 0);
        for i in 0..rays.n {
            let exact = by_primitive(&|j| f64::from(dense.row(i)[j]));
            for (p, q) in exact.iter().zip(by_primitive(&|j| rays.entry(i, j))).filter(|(p, _)| **p > 0.01) {
                let z = (q - p) / (p * (1.0 - p).max(1e-3) / rays.per_row as f64).sqrt();
                let excess = ((q - p).abs() - delta).max(0.0) / (p * (1.0 - p).max(1e-3) / rays.per_row as f64).sqrt();
                largest = largest.max(excess);
                (square, count) = (square + z * z, count + 1);
            }
        }
        (largest, (square / f64::from(count)).sqrt())
    };
    let (largest, rms) = scores(&dense);
    assert!(largest < critical && rms < 0.9, "{largest} {rms}");
    // a matrix that is a tenth too bright is found out
    let mut wrong = dense.clone();
    wrong.f.iter_mut().for_each(|f| *f *= 1.1);
    let (largest, rms) = scores(&wrong);
    assert!(largest > critical && rms > 1.2, "{largest} {rms}");
}

/// u in red and its relative distance to a truth, by area.
fn reflected(patches: &Patches, radiance: &[DVec3]) -> Vec<f64> {
    radiance.iter().zip(patches.iter()).map(|(l, p)| l.x - p.emission.x).collect()
}

fn norm(patches: &Patches, x: impl Iterator<Item = f64>) -> f64 {
    patches.iter().zip(x).map(|(p, x)| p.area * x * x).sum::<f64>().sqrt()
}

#[test]
fn error_bars_from_halves_cover_the_truth() {
    let scene = cornell();
    let (patches, dense) = discretise(&scene, 1200);
    let exact = reflected(&patches, &Radiosity::new(patches.clone(), dense).solve().unwrap().radiance);
    let size = norm(&patches, exact.iter().copied());
    let mut errors = vec![];
    for (per_row, seed) in [(256, 1), (256, 2), (1024, 1)] {
        let rays = shoot(&scene, &patches, per_row, seed);
        let light = Light { patches: &patches, rays: &rays };
        let solved = light.solve(1e-7, 200);
        assert!(solved.residual.max_element() < 1e-5 && solved.steps > 10, "{} {}", solved.residual, solved.steps);
        let u = reflected(&patches, &solved.radiance);
        let error = norm(&patches, u.iter().zip(&exact).map(|(u, x)| u - x)) / size;
        let bar = norm(&patches, light.noise(&solved.radiance).iter().map(|d| d.x)) / size;
        // the bar is that of two halves that complement each other: a little too long
        assert!(error < bar * 1.05 && bar < 1.8 * error, "{per_row}: error {error:e}, bar {bar:e}");
        errors.push(error);
    }
    assert!(errors[0] < 1.5e-2 && errors[2] < 6e-3, "{errors:?}");
    assert!(errors[2] < 0.5 * errors[0], "faster than N^-1/2: {errors:?}");
}

#[test]
fn direct_light_by_pairs_pays() {
    let scene = cornell();
    let (patches, dense) = discretise(&scene, 600);
    let r = Radiosity::new(patches.clone(), dense);
    let exact = reflected(&patches, &r.solve().unwrap().radiance);
    let size = norm(&patches, exact.iter().copied());
    let rays = shoot(&scene, &patches, 1024, 5);
    let light = Light { patches: &patches, rays: &rays };
    let error = |u: &[f64]| norm(&patches, u.iter().zip(&exact).map(|(u, x)| u - x)) / size;
    let apart = error(&reflected(&patches, &light.solve(1e-7, 200).radiance));
    // all light through the rows: u = T (E + u)
    let mut radiance = light.emission();
    for _ in 0..60 {
        let bounced = light.bounce(&radiance, Half::Both);
        radiance = bounced.iter().zip(patches.iter()).map(|(b, p)| *b + p.emission).collect();
    }
    let through = error(&reflected(&patches, &radiance));
    assert!(through > 5.0 * apart, "{through:e} {apart:e}");
    // and it is T E, near and far
    let te = r.terms(1)[1].iter().map(|t| t.x).collect::<Vec<_>>();
    let d = light.direct();
    let off = norm(&patches, d.iter().zip(&te).map(|(d, t)| d.x - t)) / norm(&patches, te.iter().copied());
    assert!(off < 5e-3, "{off:e}");
}

#[test]
fn coarse_operators_are_what_the_same_rays_give() {
    let scene = clutter();
    let patches = Patches::new(&scene, 300).unwrap();
    let rays = shoot(&scene, &patches, 64, 9);
    let parent = patches.parents();
    let t = rays.operator(patches.iter().map(|p| p.reflectance.x).collect());
    let coarse = Coarse::new(&t, &parent, &rays.area);
    let n = coarse.len();
    assert!(n < rays.n * 2 / 3, "{n} of {}", rays.n);
    // by counting: rays of the children, weighted by their share of the area
    let mut counted = vec![0.0; n * n];
    for (i, p) in patches.iter().enumerate() {
        let weight = p.reflectance.x * p.area / coarse.area()[parent[i] as usize] / rays.per_row as f64;
        for hit in rays.row(i).into_iter().flatten().filter(|h| **h != Hit::NOTHING) {
            counted[parent[i] as usize * n + parent[hit.patch()] as usize] += weight;
        }
    }
    for j in 0..n {
        let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
        unit[j] = 1.0;
        coarse.apply(&unit, &mut column);
        assert!((0..n).all(|i| (column[i] - counted[i * n + j]).abs() < 1e-14), "{j}");
    }
    // unions stay on one side of one surface, and together they are the surface
    for (i, p) in patches.iter().enumerate() {
        let first = parent.iter().position(|q| *q == parent[i]).unwrap();
        assert_eq!((p.primitive, p.front), (patches[first].primitive, patches[first].front));
    }
    assert!((coarse.area().iter().sum::<f64>() / rays.area.iter().sum::<f64>() - 1.0).abs() < 1e-12);
}

#[test]
fn the_spectral_radius_is_that_of_the_matrix() {
    let scene = cornell();
    let (patches, dense) = discretise(&scene, 600);
    let rays = shoot(&scene, &patches, 1024, 4);
    let light = Light { patches: &patches, rays: &rays };
    let start: Vec<_> = patches.iter().map(|p| record(p.reflectance)).collect();
    let sampled = light.spectral_radius(&start, 1e-9, 400);
    for (c, sampled) in sampled.iter().enumerate() {
        let rho: Vec<f64> = patches.iter().map(|p| p.reflectance[c]).collect();
        let exact = spectral_radius(&dense, &rho, 1e-12, 2000).radius;
        assert!((sampled.radius / exact - 1.0).abs() < 2e-3, "{c}: {} {exact}", sampled.radius);
        assert!(sampled.mode.iter().all(|m| *m > -1e-9 && *m <= 1.0));
    }
    // the same numbers one channel at a time
    let rho: Vec<f64> = patches.iter().map(|p| p.reflectance.y).collect();
    let (t, d) = (rays.operator(rho.clone()), PatchOperator::new(&dense, rho));
    let x = vec![1.0; rays.n];
    let (mut a, mut b) = (vec![0.0; rays.n], vec![0.0; rays.n]);
    t.apply(&x, &mut a);
    d.apply(&x, &mut b);
    let bounce = light.bounce(&vec![DVec3::ONE; rays.n], Half::Both);
    assert!(a.iter().zip(&bounce).all(|(a, b)| (a - b.y).abs() < 1e-14));
    assert!(norm(&patches, a.iter().zip(&b).map(|(a, b)| a - b)) < 0.02 * norm(&patches, b.iter().copied()));
}

#[test]
fn rows_do_not_depend_on_threads_and_can_be_stopped() {
    let scene = clutter();
    let patches = Patches::new(&scene, 120).unwrap();
    let in_pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| shoot(&scene, &patches, 64, 2))
    };
    let (one, three) = (in_pool(1), in_pool(3));
    assert_eq!(one, three);
    assert_ne!(one, shoot(&scene, &patches, 64, 3));
    // packets and single rays meet the same
    let single = Rays::new(&patches, &Scene::new(&scene).one_by_one(), 64, 2, Progress::NONE).unwrap();
    assert_eq!(one, single);
    let stop = AtomicBool::new(true);
    assert_eq!(Rays::new(&patches, &Scene::new(&scene), 64, 2, Progress::NONE.stopped_by(&stop)), Err(Stopped));
}

#[test]
fn records_change_no_more_than_rounding() {
    // terms and hits are kept in few bytes; the same series with f64 throughout, one channel at a time
    let scene = clutter();
    let patches = Patches::new(&scene, 300).unwrap();
    let rays = shoot(&scene, &patches, 128, 6);
    let light = Light { patches: &patches, rays: &rays };
    let solved = light.solve(1e-9, 300);
    for c in 0..3 {
        let t = rays.operator(patches.iter().map(|p| p.reflectance[c]).collect());
        let mut term: Vec<f64> = light.direct().iter().map(|d| d[c]).collect();
        let mut u = term.clone();
        for _ in 0..solved.steps + 20 {
            let mut next = vec![0.0; rays.n];
            t.apply(&term, &mut next);
            u.iter_mut().zip(&next).for_each(|(u, x)| *u += x);
            term = next;
        }
        let found: Vec<f64> = solved.radiance.iter().zip(patches.iter()).map(|(l, p)| l[c] - p.emission[c]).collect();
        let off = norm(&patches, u.iter().zip(&found).map(|(a, b)| a - b)) / norm(&patches, u.iter().copied());
        assert!(off > 0.0 && off < 2e-7, "{c}: {off:e}");
    }
}

#[test]
fn the_bar_covers_what_other_seeds_say() {
    // two independent solutions differ by √2 of the error of one
    let scene = cornell();
    let patches = Patches::new(&scene, 2000).unwrap();
    let solve = |seed| {
        let rays = shoot(&scene, &patches, 256, seed);
        let light = Light { patches: &patches, rays: &rays };
        let radiance = light.solve(1e-7, 200).radiance;
        let bar = norm(&patches, light.noise(&radiance).iter().map(|d| d.x));
        (reflected(&patches, &radiance), bar)
    };
    let runs: Vec<_> = (0..4).map(solve).collect();
    for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        let ((u, bar), (v, _)) = (&runs[a], &runs[b]);
        let error = norm(&patches, u.iter().zip(v).map(|(u, v)| u - v)) / 2f64.sqrt();
        // of 2000 patches: both are known to about two per cent
        assert!(error < *bar && *bar < 1.6 * error, "{a} {b}: error {error:e}, bar {bar:e}");
        // seeds that agree by accident would say nothing
        assert!(error > 5e-3 * norm(&patches, u.iter().copied()));
    }
}

#[test]
fn a_mesh_of_many_triangles_loses_no_rays() {
    // a closed box of triangles about a ball of triangles, as an exporter would write them
    let folder = tempfile::tempdir().unwrap();
    let (mut text, mut vertices) = (String::from("mtllib a.mtl\n"), 0);
    let mut sheet = |name: &str, m: usize, at: &dyn Fn(f64, f64) -> DVec3| {
        text += &format!("o {name}\nusemtl {name}\n");
        for i in 0..(m + 1) * (m + 1) {
            let p = at((i % (m + 1)) as f64 / m as f64, (i / (m + 1)) as f64 / m as f64);
            text += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
        for i in 0..m * m {
            let a = vertices + 1 + i / m * (m + 1) + i % m;
            text += &format!("f {a} {} {}\nf {a} {} {}\n", a + 1, a + m + 2, a + m + 2, a + m + 1);
        }
        vertices += (m + 1) * (m + 1);
    };
    sheet("wall", 12, &|s, t| v(s, 0.0, 1.0 - t));
    sheet("lamp", 12, &|s, t| v(s, 1.0, t));
    sheet("wall", 12, &|s, t| v(s, t, 0.0));
    sheet("wall", 12, &|s, t| v(1.0 - s, t, 1.0));
    sheet("wall", 12, &|s, t| v(0.0, t, 1.0 - s));
    sheet("wall", 12, &|s, t| v(1.0, t, s));
    sheet("ball", 24, &|s, t| {
        let (a, b) = (std::f64::consts::TAU * s, std::f64::consts::PI * (0.02 + 0.96 * t));
        v(0.5 + 0.3 * b.sin() * a.cos(), 0.45 - 0.3 * b.cos(), 0.5 - 0.3 * b.sin() * a.sin())
    });
    std::fs::write(folder.path().join("a.obj"), text).unwrap();
    let mtl = "newmtl wall\nKd 0.6 0.5 0.4\nnewmtl ball\nKd 0.5 0.6 0.7\nnewmtl lamp\nKd 0.2 0.2 0.2\nKe 1 1 1\n";
    std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    let path = folder.path().join("a.obj");
    let scene = load::scene(path.to_str().unwrap(), &load::Options::default()).unwrap().description;
    let patches = Patches::new(&scene, 12_000).unwrap();
    assert_eq!(patches.primitives().len(), 2 * (6 * 144 + 576));
    assert!((patches.len() as f64 / 12_000.0 - 1.0).abs() < 0.2 && patches.covered_area() == 0.0, "{}", patches.len());
    let rays = shoot(&scene, &patches, 64, 2);
    let checks = Light { patches: &patches, rays: &rays }.checks();
    assert!(checks.lost < 1e-5, "{}", checks.lost);
    // what starts inside the room stays there; the outside of its walls sees nothing
    let inside =
        |i: usize| (patches.origin() + patches[i].centre + 1e-4 * patches[i].normal - 0.5).abs().max_element() < 0.5;
    let met = |i: usize| rays.row(i).into_iter().flatten().filter(|h| **h != Hit::NOTHING).count();
    let [mut within, mut out] = [0; 2];
    for i in 0..rays.n {
        *(if inside(i) { &mut within } else { &mut out }) += 1;
        assert!(if inside(i) { met(i) >= 63 } else { met(i) == 0 }, "{i}: {}", met(i));
    }
    assert!(within > out && out > 2000, "{within} {out}");
}

#[test]
fn parts_of_the_rows_are_the_rows() {
    let scene = clutter();
    let patches = Patches::new(&scene, 150).unwrap();
    let (whole, built) = (shoot(&scene, &patches, 64, 4), Scene::new(&scene));
    for of in [1, 2, 7, patches.len() as u32, patches.len() as u32 + 3] {
        let mut all = Rays::empty(&patches, 64);
        let mut own = 0;
        for index in (0..of).rev() {
            let part = Rows::trace(&patches, &built, 64, 4, Part { index, of }, Progress::NONE).unwrap();
            assert_eq!(part.direct.len(), part.numbers().count());
            own += part.direct.len();
            all.take(&part);
        }
        assert_eq!(own, patches.len());
        assert!(all == whole, "{of} parts");
    }
}
