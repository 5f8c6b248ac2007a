//! Cost and accuracy of form factors:
//! `cargo bench --bench factors [-- cube:1944 cornell:2305 cornell:8602 rays:33000:1024 split:33000:256
//! obj:200000:1000000:256 reference]`.
//!
//! Prints CPU seconds of all threads (wall time in brackets) and errors.
//!
//! | argument | measures |
//! |---|---|
//! | `cube:PATCHES` | a cube, compared with the exact form factor (contour integral) of every pair |
//! | `cornell:PATCHES` | form factors of the Cornell box |
//! | `rays:PATCHES:RAYS` | stored rays in the Cornell box, with `RAYS` rays per row |
//! | `split:PATCHES:RAYS` | the parts of the error of stored rays that come from D (direct light) and from T, by comparison of seeds |
//! | `obj:TRIANGLES:PATCHES:RAYS` | stored rays in a room from an OBJ file |
//! | `reference` | additionally compares the Cornell box with a matrix of 256, then 6400 visibility rays per pair |
//!
//! u = L − E is the reflected light in the red channel. Its error is the area-weighted relative L² norm.
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::operator::form_factor::{FormFactors, VisibilitySampling, polygon_to_polygon};
use fredholm::operator::patches::Patches;
use fredholm::operator::rays::{Half, Light, Rays};
use fredholm::progress::Progress;
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
            Some(("split", n)) => {
                let (n, per_row) = n.split_once(':').unwrap_or((n, "256"));
                split(n.parse().unwrap(), per_row.parse().unwrap());
            }
            Some(("rays", n)) => {
                let (n, per_row) = n.split_once(':').unwrap_or((n, "256"));
                rays(n.parse().unwrap(), per_row.parse().unwrap(), with_reference);
            }
            Some(("obj", rest)) => {
                let n: Vec<usize> = rest.split(':').map(|n| n.parse().unwrap()).collect();
                obj(n[0], n[1], n[2], with_reference);
            }
            _ => {}
        }
    }
}

/// Stored rays in the Cornell box.
fn rays(n: usize, per_row: usize, with_reference: bool) {
    by_rays(&load::scene("cornell", &load::Options::default()).unwrap().description, n, per_row, with_reference);
}

/// Stored rays, with the error bar computed from the two halves of the rays. If `with_reference`, also compares with the
/// rays of another seed.
fn by_rays(description: &Description, n: usize, per_row: usize, with_reference: bool) {
    let scene = timed("scene", || Scene::new(description));
    let patches = timed("patches", || Patches::new(description, n).unwrap());
    println!("{}, {} patches, {per_row} rays a row; {}", description.name, patches.len(), memory());
    let shoot = |seed| Rays::new(&patches, &scene, per_row, seed, Progress::NONE).unwrap();
    let rows = timed("rays", || shoot(0));
    let light = Light { patches: &patches, rays: &rows };
    let solved = timed("solve", || light.solve(1e-7, 200));
    let radius = timed("spectral radius", || light.spectral_radius(&solved.last, 1e-6, 100));
    let noise = timed("error bar", || light.noise(&solved.radiance));
    let reflected = |l: Vec<DVec3>| l.iter().zip(patches.iter()).map(|(l, p)| *l - p.emission).collect::<Vec<DVec3>>();
    let size = light.norm(&reflected(solved.radiance.clone()));
    println!(
        "  {} steps, residual {:.1e}, radius {:.6?} after {}, {} of {} rays lost, {:.2} GB of rows; {}",
        solved.steps,
        solved.residual.max_element(),
        radius.each_ref().map(|s| s.radius),
        radius[0].steps,
        rows.lost,
        rows.n * rows.per_row,
        rows.bytes() as f64 * 1e-9,
        memory()
    );
    println!("  bar of u {}", three(light.norm(&noise) / size));
    drop(noise);
    if with_reference {
        // two independent solutions differ by √2 times the error of one
        let first = reflected(solved.radiance);
        drop(rows);
        let rows = shoot(1);
        let light = Light { patches: &patches, rays: &rows };
        let second = reflected(light.solve(1e-7, 200).radiance);
        let apart: Vec<DVec3> = first.iter().zip(&second).map(|(a, b)| (*a - *b) / 2f64.sqrt()).collect();
        println!("  error of u by two seeds {}", three(light.norm(&apart) / size));
    }
}

fn three(x: DVec3) -> String {
    format!("{:.2e} {:.2e} {:.2e}", x.x, x.y, x.z)
}

/// Peak memory of the process so far.
fn memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap();
    format!("{:.2} GB at most", line.trim().trim_end_matches(" kB").parse::<f64>().unwrap() * 1.024e-6)
}

/// Stored rays in a room of many triangles, loaded from an OBJ file.
fn obj(triangles: usize, n: usize, per_row: usize, with_reference: bool) {
    let folder = std::env::temp_dir().join(format!("fredholm-obj-{triangles}"));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("room.obj");
    write_room(&folder, triangles);
    println!("{}", path.display());
    let loaded = timed("load", || load::scene(path.to_str().unwrap(), &load::Options::default()).unwrap());
    println!("  {} triangles", loaded.description.primitives().len());
    by_rays(&loaded.description, n, per_row, with_reference);
}

/// Writes a room that is open at the front, with a wavy floor, a torus, a ball and a lamp, of about `triangles` triangles.
fn write_room(folder: &std::path::Path, triangles: usize) {
    use std::f64::consts::{PI, TAU};
    use std::fmt::Write;
    let (mut text, mut vertices) = (String::from("mtllib room.mtl\n"), 0);
    // a grid of m × k quadrilaterals, each as two triangles
    let mut sheet = |name: &str, [m, k]: [usize; 2], at: &dyn Fn(f64, f64) -> DVec3| {
        writeln!(text, "o {name}\nusemtl {name}").unwrap();
        for i in 0..(m + 1) * (k + 1) {
            let p = at((i % (m + 1)) as f64 / m as f64, (i / (m + 1)) as f64 / k as f64);
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
        for i in 0..m * k {
            let a = vertices + 1 + i / m * (m + 1) + i % m;
            writeln!(text, "f {a} {} {}\nf {a} {} {}", a + 1, a + m + 2, a + m + 2, a + m + 1).unwrap();
        }
        vertices += (m + 1) * (k + 1);
    };
    let v = DVec3::new;
    let part = |share: f64, wide: f64| {
        let k = (share * triangles as f64 / 2.0 / wide).sqrt();
        [(wide * k).ceil() as usize, k.ceil() as usize]
    };
    let wave = |x: f64, z: f64| 0.04 * (3.0 * TAU * x).sin() * (2.0 * TAU * z).cos();
    sheet("floor", part(0.36, 1.0), &|s, t| v(s, wave(s, t), t));
    sheet("back", part(0.06, 1.0), &|s, t| v(s, t * (1.0 - wave(s, 0.0)) + wave(s, 0.0), 0.0));
    sheet("left", part(0.06, 1.0), &|s, t| v(0.0, t, 1.0 - s));
    sheet("right", part(0.06, 1.0), &|s, t| v(1.0, t, s));
    sheet("ceiling", part(0.06, 1.0), &|s, t| v(s, 1.0, 1.0 - t));
    sheet("torus", part(0.2, 2.0), &|s, t| {
        let (a, b) = (TAU * s, TAU * t);
        let r = 0.17 + 0.06 * b.cos();
        v(0.3 + r * a.cos(), 0.3 + 0.06 * b.sin() + 0.5 * r * a.cos(), 0.45 - r * a.sin())
    });
    // rings that avoid the poles, where triangles would have no area
    sheet("ball", part(0.2, 2.0), &|s, t| {
        let (a, b) = (TAU * s, PI * (0.002 + 0.996 * t));
        v(0.7 + 0.17 * b.sin() * a.cos(), 0.3 - 0.17 * b.cos(), 0.6 - 0.17 * b.sin() * a.sin())
    });
    sheet("lamp", [2, 2], &|s, t| v(0.35 + 0.3 * s, 0.98, 0.35 + 0.3 * t));
    std::fs::write(folder.join("room.obj"), text).unwrap();
    let colours = [
        ("floor", "0.7 0.7 0.7"),
        ("back", "0.7 0.7 0.7"),
        ("left", "0.63 0.07 0.05"),
        ("right", "0.14 0.45 0.09"),
        ("ceiling", "0.7 0.7 0.7"),
        ("torus", "0.8 0.6 0.2"),
        ("ball", "0.5 0.6 0.8"),
        ("lamp", "0 0 0\nKe 12 11 9"),
    ];
    let materials: String = colours.iter().map(|(name, kd)| format!("newmtl {name}\nKd {kd}\n")).collect();
    std::fs::write(folder.join("room.mtl"), materials).unwrap();
}

/// Sources of the error of u: combines D and T from two seeds each.
fn split(n: usize, per_row: usize) {
    let description = load::scene("cornell", &load::Options::default()).unwrap().description;
    let scene = Scene::new(&description);
    let patches = Patches::new(&description, n).unwrap();
    println!("cornell, {} patches, {per_row} rays a row", patches.len());
    let rows = timed("rays, two seeds", || {
        [0, 1].map(|seed| Rays::new(&patches, &scene, per_row, seed, Progress::NONE).unwrap())
    });
    let lights = rows.each_ref().map(|rays| Light { patches: &patches, rays });
    let u = |d: usize, t: usize| {
        let direct = lights[d].direct();
        let (mut sum, mut term) = (direct.clone(), direct);
        for _ in 0..25 {
            term = lights[t].bounce(&term, Half::Both);
            sum.iter_mut().zip(&term).for_each(|(s, t)| *s += *t);
        }
        sum
    };
    let [a, b, c, d] = timed("four solutions", || [u(0, 0), u(1, 0), u(0, 1), u(1, 1)]);
    let apart = |x: &[DVec3], y: &[DVec3]| {
        let off: Vec<DVec3> = x.iter().zip(y).map(|(x, y)| (*x - *y) / 2f64.sqrt()).collect();
        lights[0].norm(&off) / lights[0].norm(&a)
    };
    let radiance: Vec<DVec3> = a.iter().zip(patches.iter()).map(|(u, p)| *u + p.emission).collect();
    println!("  error of u by D        {}", three(0.5 * (apart(&a, &b) + apart(&c, &d))));
    println!("  error of u by T        {}", three(0.5 * (apart(&a, &c) + apart(&b, &d))));
    println!("  error of u by both     {}", three(apart(&a, &d)));
    println!("  bar of u               {}", three(lights[0].norm(&lights[0].noise(&radiance)) / lights[0].norm(&a)));
}

/// Runs a closure and prints its time.
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
    let f = timed("form factors", || dense(&patches, &scene, VisibilitySampling::default()));
    let invariants = f.invariants();
    // exact value: the contour integral of 4×4 parts of each patch; only the rule for distant patches is approximate
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

/// Form factor as the mean over 4×4 parts of both patches, so that all distances are large compared with the parts.
fn in_parts(a: &[DVec3], b: &[DVec3]) -> f64 {
    let parts = |p: &[DVec3]| -> Vec<[DVec3; 4]> {
        let (u, v) = ((p[1] - p[0]) / 4.0, (p[3] - p[0]) / 4.0);
        let part = |k: i32| p[0] + f64::from(k % 4) * u + f64::from(k / 4) * v;
        (0..16).map(|k| [part(k), part(k) + u, part(k) + u + v, part(k) + v]).collect()
    };
    let b = parts(b);
    parts(a).iter().map(|p| b.iter().map(|q| polygon_to_polygon(p, q)).sum::<f64>()).sum::<f64>() / 16.0
}

fn dense(patches: &Patches, scene: &Scene, sampling: VisibilitySampling) -> FormFactors {
    FormFactors::new(patches, scene, sampling, Progress::NONE).unwrap()
}

fn cornell(n: usize, with_reference: bool) {
    let description = load::scene("cornell", &load::Options::default()).unwrap().description;
    let scene = Scene::new(&description);
    let patches = timed("patches", || Patches::new(&description, n).unwrap());
    println!("cornell, {} patches", patches.len());
    let f = timed("form factors", || dense(&patches, &scene, VisibilitySampling::default()));
    println!("  {} visibility rays, {:?}", f.rays, f.invariants());
    if !with_reference {
        return;
    }
    let exact = timed("reference", || dense(&patches, &scene, VisibilitySampling { rays: 256, refined: 6400 }));
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

/// Area-weighted relative L² distance of `u` from `truth`.
fn distance(patches: &Patches, u: &[f64], truth: &[f64]) -> f64 {
    let norm =
        |f: &dyn Fn(usize) -> f64| patches.iter().enumerate().map(|(i, p)| p.area * f(i).powi(2)).sum::<f64>().sqrt();
    norm(&|i| u[i] - truth[i]) / norm(&|i| truth[i])
}

/// CPU seconds of all threads of this process so far.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}
