//! Cost of a path: `cargo bench --bench paths [-- SPP] [WORD …]`, one thread, 256×256, k = 0..=8, MIS.
//!
//! Prints CPU nanoseconds per path by estimator and scene, as medians of five interleaved rounds, and the cost of keeping all
//! terms relative to keeping only their sum. Words choose estimators and scenes whose names contain one of them.
//!
//! | scene | what it times |
//! |---|---|
//! | `cornell` | flat Lambertian surfaces, few primitives |
//! | `cornell-spheres` | a mirror and a glass sphere among them |
//! | `env-ggx` | rough metals under a sky and a point light |
//! | `mesh` | the walls of `cornell` around 93 744 triangles |
#![allow(clippy::print_stdout, clippy::unwrap_used, missing_docs)]

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{
    Bidirectional, Job, LightTracer, PathTracer, Paths, Plan, Prefix, Roulette, SingleTerm, Technique, TermEstimator,
    TermSink,
};
use fredholm::math::{Columns, Key};
use fredholm::operator::{SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::description::{Description, Geometry, Shape};
use fredholm::scene::{Scene, load};
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

/// The prefix estimator with all terms added to one slot: the same paths, without separate terms.
struct OnlyTheSum(Prefix);

struct OneSlot<'a, S>(&'a mut S);

impl<S: TermSink> TermSink for OneSlot<'_, S> {
    fn add(&mut self, _: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        self.0.add(0, pixel, sample, value);
    }
}

impl<T: Transport> TermEstimator<T> for OnlyTheSum {
    fn slots(&self) -> usize {
        1
    }
    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        self.0.sample(job, paths, &mut OneSlot(sink));
    }
}

/// The walls and the lamp of `cornell` around a bumpy sphere of 93 744 triangles.
fn mesh() -> Description {
    let mut d = load::scene("cornell", &load::Options::default()).unwrap().description;
    d.shapes.truncate(6);
    let (rows, columns) = (218, 216);
    let at = |i: usize, j: usize| {
        let (v, u) = (PI * i as f64 / rows as f64, TAU * j as f64 / columns as f64);
        let r = 0.6 + 0.05 * (7.0 * u).sin() * (9.0 * v).sin() * v.sin();
        DVec3::new(r * v.sin() * u.cos(), r * v.cos() - 0.3, r * v.sin() * u.sin())
    };
    let vertices = (0..=rows).flat_map(|i| (0..columns).map(move |j| at(i, j))).collect();
    let number = |i: usize, j: usize| (i * columns + j % columns) as u32;
    let mut faces = vec![];
    for i in 0..rows {
        for j in 0..columns {
            let [a, b, c, d] = [number(i, j), number(i, j + 1), number(i + 1, j), number(i + 1, j + 1)];
            faces.extend((i > 0).then_some([a, b, d]));
            faces.extend((i + 1 < rows).then_some([a, d, c]));
        }
    }
    let geometry = Geometry::Mesh { vertices, faces, uvs: vec![] };
    let material = d.shapes[0].material;
    d.shapes.push(Shape { geometry, material, emission: DVec3::ZERO, ..d.shapes[0].clone() });
    d
}

/// Seconds of CPU time of all threads so far, where Linux tells them; otherwise seconds since the start.
fn cpu(start: Instant) -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").ok();
    let used = |task: std::io::Result<std::fs::DirEntry>| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    let ns: Option<f64> = tasks.map(|tasks| tasks.filter_map(used).sum());
    ns.filter(|ns| *ns > 0.0).map_or(start.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// CPU nanoseconds per path of an estimator.
fn time(scene: &Scene, what: &str, spp: u32) -> f64 {
    let t = SceneTransport::new(scene);
    let plan = |roulette| Plan { max_bounces: 8, technique: Technique::Mis, roulette };
    let (cut, tail) = (plan(Roulette::Never), plan(Roulette::Albedo { from: 8 }));
    let (amount, camera, now) = (Amount::new(spp, Key::new(0, what)), &scene.camera, Instant::now());
    let before = cpu(now);
    let film = match what {
        "prefix, all terms" => render(&t, camera, &Prefix(cut), amount, Progress::NONE),
        "prefix, sum only" => render(&t, camera, &OnlyTheSum(Prefix(cut)), amount, Progress::NONE),
        "prefix, all terms and tail" => render(&t, camera, &Prefix(tail), amount, Progress::NONE),
        "light" => render(&t, camera, &LightTracer(cut), amount, Progress::NONE),
        "bidirectional" => render(&t, camera, &Bidirectional(cut), amount, Progress::NONE),
        "path tracer (scalar)" => render(&t, camera, &PathTracer(cut), amount, Progress::NONE),
        _ => render(&t, camera, &SingleTerm(cut), amount, Progress::NONE),
    };
    (cpu(now) - before) * 1e9 / (film.shape.pixels() as f64 * f64::from(spp))
}

const ESTIMATORS: [&str; 7] = [
    "prefix, all terms",
    "prefix, sum only",
    "prefix, all terms and tail",
    "path tracer (scalar)",
    "single",
    "light",
    "bidirectional",
];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let spp = words.iter().find_map(|a| a.parse().ok()).unwrap_or(32);
    // a list without a word that fits is not restricted
    let chosen = |names: &[&'static str]| -> Vec<&'static str> {
        let fits = |name: &&&str| {
            words.iter().any(|w| w == **name || name.contains(w.as_str()) && !names.contains(&w.as_str()))
        };
        let some: Vec<_> = names.iter().filter(fits).copied().collect();
        if some.is_empty() { names.to_vec() } else { some }
    };
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    let (estimators, scenes) = (chosen(&ESTIMATORS), chosen(&["cornell", "cornell-spheres", "env-ggx", "mesh"]));
    println!("{:28} {}", "ns per path", scenes.iter().map(|s| format!("{s:>16}")).collect::<String>());
    let scenes = scenes.iter().map(|&name| {
        let mut d = match name {
            "mesh" => mesh(),
            name => load::scene(name, &load::Options::default()).unwrap().description,
        };
        d.camera.size = [256, 256];
        Scene::new(&d)
    });
    let scenes: Vec<Scene> = scenes.collect();
    let mut rounds = vec![vec![vec![]; scenes.len()]; estimators.len()];
    for _ in 0..5 {
        for (what, rounds) in estimators.iter().zip(&mut rounds) {
            scenes.iter().zip(rounds).for_each(|(scene, times)| times.push(time(scene, what, spp)));
        }
    }
    let median = |times: &mut Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let medians: Vec<Vec<f64>> = rounds.iter_mut().map(|r| r.iter_mut().map(median).collect()).collect();
    for (what, row) in estimators.iter().zip(&medians) {
        println!("{what:28} {}", row.iter().map(|ns| format!("{ns:16.0}")).collect::<String>());
    }
    for of in ["prefix, sum only", "path tracer (scalar)"] {
        let find = |name: &str| estimators.iter().position(|e| *e == name);
        if let (Some(all), Some(other)) = (find("prefix, all terms"), find(of)) {
            let row = medians[all].iter().zip(&medians[other]).map(|(a, b)| format!("{:16.2}", a / b));
            println!("all terms / {of:16} {}", row.collect::<String>());
        }
    }
}
