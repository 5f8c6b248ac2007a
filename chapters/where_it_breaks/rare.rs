//! A small lamp found by directions: a rare event with a large value, and what the sample variance says about it.
//!
//! ```text
//! X = ρE with probability p, otherwise 0      P(no event in N samples) = (1 − p)^N      p = r²/(r² + h²)
//! m ± 1.96 s/√N:  the 95 % interval of a run that knows only its own samples
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r, h | radius of the lamp, a disk; its height above the point x | [`RareLamp::new`] |
//! | p | probability that a direction with density cos θ/π hits the lamp | [`RareLamp::p`] |
//! | pN | expected number of events of a run of N samples | [`Row::expected`] |
//! | m, s | mean and standard deviation of the samples of one run | [`RareLamp::run`] |
//!
//! Reference: the form factor of a disk is in Modest, *Radiative Heat Transfer* (2013), appendix D.

use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Transport};
use fredholm::report::book::{self, Folder, Number};
use fredholm::scene::{Scene, Vertex, load};
use fredholm::stats::Evidence;
use fredholm::terms::{Estimate, Events};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::path::Path;

/// Expected numbers of events.
pub const EXPECTED: [u32; 5] = [1, 3, 10, 30, 100];
/// p of the lamp of the table and of that of the figure.
pub const P: [f64; 2] = [0.01, 0.001];

/// Runs of one length.
#[derive(Clone, Copy)]
pub struct Row {
    /// pN.
    pub expected: u32,
    /// (1 − p)^N.
    pub predicted: f64,
    /// Share of the runs without an event.
    pub none: Number,
    /// Share of the runs whose 95 % interval contains the truth.
    pub covered: Number,
    /// Share of the runs for which the library would print an error bar.
    pub printed: Number,
}

/// A floor under a disk that emits downwards.
pub struct RareLamp {
    scene: Scene,
    x: Vertex,
    p: f64,
}

/// Σ X and Σ X² of the first samples of a run, in units of ρE and (ρE)².
type Sums = [f64; 2];

impl RareLamp {
    /// The disk at height 1 that a direction hits with probability p.
    pub fn new(p: f64) -> book::Result<Self> {
        let text = SCENE.replace("RADIUS", &(p / (1.0 - p)).sqrt().to_string());
        let scene = Scene::new(&load::toml(&text, Path::new("rare lamp"), &load::Options::default())?.description);
        let above = (DVec3::new(0.0, 0.5, 0.0) - scene.origin()).as_vec3();
        let x = scene.trace(above, Vec3::NEG_Y).ok_or("there is no floor")?;
        Ok(Self { scene, x, p })
    }

    // ANCHOR: sample
    /// X/(ρE): E of what a random direction finds.
    fn sample(&self, t: &SceneTransport<'_>, numbers: &mut Rng) -> f64 {
        t.scatter(&self.x, numbers).map_or(0.0, |s| f64::from((s.weight * t.emission(&s.state)).y) / RHO_E)
    }
    // ANCHOR_END: sample

    /// Sums of the first N samples of one run, for every N of the list.
    pub fn run(&self, key: Key, run: u32, stops: &[u32]) -> Vec<Sums> {
        let (t, mut sums, mut from) = (SceneTransport::new(&self.scene), [0.0; 2], 0);
        let mut until = |n: u32| {
            for i in from..n {
                let x = self.sample(&t, &mut Rng::at(key, run, i, 0, Purpose::Scatter));
                sums = [sums[0] + x, sums[1] + x * x];
            }
            from = n;
            sums
        };
        stops.iter().map(|&n| until(n)).collect()
    }
}

/// Many runs, judged at several lengths. `confidence` is the factor of the standard error: 1.96 for 95 %.
pub fn runs(folder: &Folder<'_>, confidence: f64) -> book::Result<Vec<Row>> {
    let lamp = RareLamp::new(P[0])?;
    let stops = EXPECTED.map(|n| (f64::from(n) / lamp.p).round() as u32);
    let (count, key) = (folder.pick(4000, 1000), Key::new(folder.seed, "rare"));
    let all: Vec<_> = (0..count).into_par_iter().map(|run| lamp.run(key, run, &stops)).collect();
    let share = |holds: &dyn Fn(&Sums) -> bool, i: usize| {
        let x = all.iter().filter(|run| holds(&run[i])).count() as f64 / f64::from(count);
        Number { value: x, std_error: (x * (1.0 - x) / f64::from(count - 1)).sqrt() }
    };
    let row = |i: usize| Row {
        expected: EXPECTED[i],
        predicted: (1.0 - lamp.p).powf(f64::from(stops[i])),
        none: share(&|s| s[0] == 0.0, i),
        covered: share(&|&s| interval(s, stops[i], confidence).contains(&lamp.p), i),
        printed: share(&|&s| prints(s, stops[i]), i),
    };
    Ok((0..EXPECTED.len()).map(row).collect())
}

// ANCHOR: interval
/// Mean and standard error of a run, from its own samples.
fn mean([sum, square]: Sums, n: u32) -> (f64, f64) {
    let n = f64::from(n);
    let m = sum / n;
    (m, ((square / n - m * m) / (n - 1.0)).max(0.0).sqrt())
}

fn interval(sums: Sums, n: u32, confidence: f64) -> std::ops::RangeInclusive<f64> {
    let (m, error) = mean(sums, n);
    m - confidence * error..=m + confidence * error
}
// ANCHOR_END: interval

/// Returns true if the library prints an error bar for these samples.
fn prints(sums: Sums, n: u32) -> bool {
    let (m, error) = mean(sums, n);
    let events = Some(Events::equal(if sums[1] > 0.0 { sums[0] * sums[0] / sums[1] } else { 0.0 }));
    let [mean, std_error] = [m, error].map(DVec3::splat);
    Evidence::of(&Estimate { mean, std_error, replicates: u64::from(n), events }).no_error.is_none()
}

/// N and m/p of the running mean of some runs.
pub fn running(folder: &Folder<'_>) -> book::Result<Vec<Vec<(f64, f64)>>> {
    let lamp = RareLamp::new(P[1])?;
    let most = folder.pick(5.0, 4.0);
    let mut stops: Vec<u32> = (0..=400).map(|i| 10f64.powf(1.0 + (most - 1.0) * f64::from(i) / 400.0) as u32).collect();
    stops.dedup();
    let key = Key::new(folder.seed, "running");
    let mean =
        |sums: Vec<Sums>| stops.iter().zip(sums).map(|(&n, s)| (n.into(), s[0] / f64::from(n) / lamp.p)).collect();
    Ok((0..4).into_par_iter().map(|run| lamp.run(key, run, &stops)).collect::<Vec<_>>().into_iter().map(mean).collect())
}

/// ρE of the scene.
const RHO_E: f64 = 0.5 * 8.0;

/// The scene; RADIUS is that of the lamp.
const SCENE: &str = r#"
name = "rare lamp"
[camera]
origin = [0, 0.5, 1]
target = [0, 0, 0]
fov = 60
up = [0, 1, 0]
size = [16, 16]
[materials.floor]
type = "diffuse"
reflectance = [0.5, 0.5, 0.5]
[materials.lamp]
type = "diffuse"
reflectance = [0, 0, 0]
sides = "front"
[[shapes]]
type = "quad"
origin = [-2, 0, 2]
edge_u = [4, 0, 0]
edge_v = [0, 0, -4]
material = "floor"
[[shapes]]
type = "disk"
center = [0, 1, 0]
normal = [0, -1, 0]
radius = RADIUS
material = "lamp"
emission = [8, 8, 8]
"#;
