//! What form factors cost and how right they are:
//! `cargo bench --bench factors [-- cube:1944 cornell:2305 cornell:8602 rays:33000:1024 reference]`.
//!
//! Prints CPU seconds of all threads (wall time in brackets) and errors. A cube is compared with the closed contour of
//! every pair; with `reference` the Cornell box is compared with a matrix of 256, then 6400 visibility rays per pair.
//! u = L − E is the reflected light, red channel; its error is the area-weighted relative L² norm.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::operator::form_factor::{FormFactors, Sampling, Watch, polygon_to_polygon};
use fredholm::operator::patches::Patches;
use fredholm::operator::rays::{Light, Rays};
use fredholm::scene::description::*;
use fredholm::scene::{Scene, load};
use fredholm::solver::Radiosity;
use glam::DVec3;
use std::time::Instant;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let words = if words.is_empty() { ["cube:1944", "cornell:2305"].map(String::from).to_vec() } else { words };
    let with_reference = words.iter().any(|w| w == "reference");
    for word in &words {
        match word.split_once(':') {
            Some(("cube", n)) => cube(n.parse().unwrap()),
            Some(("cornell", n)) => cornell(n.parse().unwrap(), with_reference),
            Some(("rays", n)) => {
                let (n, per_row) = n.split_once(':').unwrap_or((n, "256"));
                rays(n.parse().unwrap(), per_row.parse().unwrap(), with_reference);
            }
            _ => {}
        }
    }
}

/// Stored rays in the Cornell box, with the bar from their halves; `reference`: against those of another seed as well.
fn rays(n: usize, per_row: usize, with_reference: bool) {
    let description = load::scene("cornell", &load::Options::default()).unwrap().description;
    let scene = Scene::new(&description);
    let patches = timed("patches", || Patches::new(&description, n).unwrap());
    println!("cornell, {} patches, {per_row} rays a row", patches.len());
    let shoot = |seed| Rays::new(&patches, &scene, per_row, seed, Watch::default()).unwrap();
    let red = |l: &[DVec3]| l.iter().zip(patches.iter()).map(|(l, p)| l.x - p.emission.x).collect::<Vec<f64>>();
    let rows = timed("rays", || shoot(0));
    let light = Light { patches: &patches, rays: &rows };
    let solved = timed("solve", || light.solve(1e-7, 200));
    let radius = timed("spectral radius", || light.spectral_radius(&solved.last, 1e-6, 100));
    let noise = timed("error bar", || light.noise(&solved.radiance));
    let u = red(&solved.radiance);
    let norm = |x: &[f64]| x.iter().zip(patches.iter()).map(|(x, p)| p.area * x * x).sum::<f64>().sqrt();
    println!(
        "  {} steps, residual {:.1e}, radius {:.6?} after {}, {} lost, {:.2} GB of rows",
        solved.steps,
        solved.residual.max_element(),
        radius.each_ref().map(|s| s.radius),
        radius[0].steps,
        rows.lost,
        rows.bytes() as f64 * 1e-9
    );
    println!("  bar of u {:.1e}", norm(&noise.iter().map(|d| d.x).collect::<Vec<_>>()) / norm(&u));
    if with_reference {
        // two independent solutions differ by √2 of the error of one
        let first = u;
        let other = shoot(1);
        let second = red(&Light { patches: &patches, rays: &other }.solve(1e-7, 200).radiance);
        println!("  error of u by two seeds {:.1e}", distance(&patches, &first, &second) / 2f64.sqrt());
    }
}

/// Runs it and prints what it cost.
fn timed<R>(what: &str, f: impl FnOnce() -> R) -> R {
    let (cpu, wall) = (cpu_seconds(), Instant::now());
    let result = f();
    println!("  {what:34} {:8.2} CPU-s ({:.2} s)", cpu_seconds() - cpu, wall.elapsed().as_secs_f64());
    result
}

fn cube(n: usize) {
    let geometry = Geometry::Box { min: DVec3::ZERO, max: DVec3::ONE, rotate_y: 0.0, inward: true };
    let camera = CameraDescription { origin: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, fov: 40.0, size: [8, 8] };
    let description = Description {
        name: "cube".into(),
        camera,
        materials: vec![Material::diffuse("grey", DVec3::splat(0.5), Sides::Front)],
        shapes: vec![Shape { name: "room".into(), geometry, material: 0, emission: DVec3::ONE }],
        lights: vec![],
        expect: None,
    };
    let scene = Scene::new(&description);
    let patches = Patches::new(&description, n).unwrap();
    println!("cube, {} patches", patches.len());
    let f = timed("form factors", || dense(&patches, &scene, Sampling::default()));
    let invariants = f.invariants();
    // the closed contour of 4×4 parts of each patch: the far rule is the only approximation
    let (mut worst, mut square, mut whole) = (0.0f64, 0.0, 0.0);
    for i in (0..patches.len()).step_by(patches.len() / 24) {
        for (j, b) in patches.iter().enumerate().filter(|(_, b)| b.primitive != patches[i].primitive) {
            let exact = in_parts(&patches[i].polygon, &b.polygon);
            let error = f64::from(f.row(i)[j]) - exact;
            worst = worst.max((error / exact).abs());
            (square, whole) = (square + error * error, whole + exact * exact);
        }
    }
    println!(
        "  row sums off 1 by {:.1e}, worst entry {worst:.1e}, Frobenius {:.1e}, reciprocity {:.1e}",
        invariants.closure,
        (square / whole).sqrt(),
        invariants.reciprocity
    );
}

/// The mean of 4×4 parts of both, so that every distance is long against the parts.
fn in_parts(a: &[DVec3], b: &[DVec3]) -> f64 {
    let parts = |p: &[DVec3]| -> Vec<[DVec3; 4]> {
        let (u, v) = ((p[1] - p[0]) / 4.0, (p[3] - p[0]) / 4.0);
        let part = |k: i32| p[0] + f64::from(k % 4) * u + f64::from(k / 4) * v;
        (0..16).map(|k| [part(k), part(k) + u, part(k) + u + v, part(k) + v]).collect()
    };
    let b = parts(b);
    parts(a).iter().map(|p| b.iter().map(|q| polygon_to_polygon(p, q)).sum::<f64>()).sum::<f64>() / 16.0
}

fn dense(patches: &Patches, scene: &Scene, sampling: Sampling) -> FormFactors {
    FormFactors::new(patches, scene, sampling, Watch::default()).unwrap()
}

fn cornell(n: usize, with_reference: bool) {
    let description = load::scene("cornell", &load::Options::default()).unwrap().description;
    let scene = Scene::new(&description);
    let patches = timed("patches", || Patches::new(&description, n).unwrap());
    println!("cornell, {} patches", patches.len());
    let f = timed("form factors", || dense(&patches, &scene, Sampling::default()));
    println!("  {} visibility rays, {:?}", f.rays, f.invariants());
    if !with_reference {
        return;
    }
    let exact = timed("reference", || dense(&patches, &scene, Sampling { rays: 256, refined: 6400 }));
    let (mut square, mut whole) = (0.0, 0.0);
    for i in 0..patches.len() {
        for j in 0..patches.len() {
            let (a, b) = (f64::from(f.row(i)[j]), f64::from(exact.row(i)[j]));
            let weight = f.area[i] / f.area[j];
            (square, whole) = (square + weight * (a - b).powi(2), whole + weight * b * b);
        }
    }
    let reflected = |f: FormFactors| -> Vec<f64> {
        let r = Radiosity::new(patches.clone(), f);
        r.solve().unwrap().radiance.iter().zip(patches.iter()).map(|(l, p)| l.x - p.emission.x).collect()
    };
    let (u, truth) = (reflected(f), timed("solve", || reflected(exact)));
    println!(
        "  Frobenius {:.1e}, error of u {:.1e}",
        (square / f64::max(whole, f64::MIN_POSITIVE)).sqrt(),
        distance(&patches, &u, &truth)
    );
}

/// Area-weighted relative L² distance.
fn distance(patches: &Patches, u: &[f64], truth: &[f64]) -> f64 {
    let norm =
        |f: &dyn Fn(usize) -> f64| patches.iter().enumerate().map(|(i, p)| p.area * f(i).powi(2)).sum::<f64>().sqrt();
    norm(&|i| u[i] - truth[i]) / norm(&|i| truth[i])
}

/// CPU seconds of all threads so far.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}
