//! Running estimators by name, with films or sample by sample.

use fredholm::estimator::render::{Amount, render};
use fredholm::estimator::{Batch, Job, Paths, Plan, Prefix, SingleTerm, TermEstimator, TermSink};
use fredholm::estimator::{PathTracer, Roulette, Technique};
use fredholm::math::{Columns, Key, Rng};
use fredholm::operator::{Kernel, SceneTransport, Sensor, Transport};
use fredholm::progress::Progress;
use fredholm::scene::{Scene, Side, Vertex};
use fredholm::terms::{Estimate, TermFilm};
use glam::{DVec3, Vec3};

pub const TECHNIQUES: [Technique; 3] = [Technique::Scatter, Technique::Connect, Technique::Mis];

/// Which estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Single,
    Prefix,
    Path,
}

pub fn plan(max_bounces: usize, technique: Technique, roulette: &Roulette) -> Plan {
    Plan { max_bounces, technique, roulette: roulette.clone() }
}

/// A film of R = 256 replicates.
pub fn film<T: Kernel>(t: &T, sensor: &impl Sensor<T>, kind: Kind, plan: &Plan, spp: u32, key: Key) -> TermFilm {
    let amount = Amount { spp, replicates: 256, key };
    let plan = plan.clone();
    match kind {
        Kind::Single => render(t, sensor, &SingleTerm(plan), amount, Progress::NONE),
        Kind::Prefix => render(t, sensor, &Prefix(plan), amount, Progress::NONE),
        Kind::Path => render(t, sensor, &PathTracer(plan), amount, Progress::NONE),
    }
}

/// Every sample by itself: `values[(pixel · samples + sample) · slots + slot]`.
pub struct Collected {
    samples: u32,
    slots: usize,
    pub values: Vec<DVec3>,
    pub rays: Vec<u64>,
}

impl TermSink for Collected {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            let path = pixel[i] as usize * self.samples as usize + sample[i] as usize;
            self.values[path * self.slots + slot] += value.get(i).as_dvec3();
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        self.rays[slot] += rays as u64;
    }
}

impl Collected {
    pub fn new(pixels: u32, samples: u32, slots: usize) -> Self {
        Self {
            samples,
            slots,
            values: vec![DVec3::ZERO; pixels as usize * samples as usize * slots],
            rays: vec![0; slots],
        }
    }

    /// The slots of one path.
    pub fn path(&self, pixel: u32, sample: u32) -> &[DVec3] {
        let path = pixel as usize * self.samples as usize + sample as usize;
        &self.values[path * self.slots..(path + 1) * self.slots]
    }

    /// The slots of every path.
    pub fn paths(&self) -> impl Iterator<Item = &[DVec3]> {
        self.values.chunks(self.slots)
    }
}

/// All samples of all pixels, in waves of `wave` samples per pixel.
pub fn collect<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    samples: u32,
    wave: u32,
    key: Key,
) -> Collected {
    let pixels = sensor.size()[0] * sensor.size()[1];
    let mut sink = Collected::new(pixels, samples, estimator.slots());
    let mut paths = Paths::default();
    for s in (0..samples).step_by(wave as usize) {
        let batch = Batch { key, pixels: 0..pixels, samples: s..(s + wave).min(samples) };
        estimator.sample(&Job { t, sensor, batch: &batch }, &mut paths, &mut sink);
    }
    sink
}

/// The mean of a function of independent samples, from 256 group means.
pub fn mean_of(values: impl ExactSizeIterator<Item = DVec3>) -> Estimate {
    let size = values.len() / 256;
    assert!(size > 0 && size * 256 == values.len(), "whole groups only");
    let mut groups = vec![DVec3::ZERO; 256];
    values.enumerate().for_each(|(i, v)| groups[i / size] += v / size as f64);
    fredholm::stats::estimate(&groups)
}

/// Where the paths of a pixel start.
#[derive(Clone, Copy, Debug)]
pub enum Start {
    /// Always here.
    At(Vertex),
    /// At a uniform point of a side.
    On(Side),
}

/// Pixel i starts as the i-th says.
pub struct Starts(pub Vec<Start>);

impl Sensor<SceneTransport<'_>> for Starts {
    fn size(&self) -> [u32; 2] {
        [self.0.len() as u32, 1]
    }
    fn start(&self, t: &SceneTransport<'_>, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        match self.0[pixel as usize] {
            Start::At(vertex) => Some(vertex),
            Start::On(side) => {
                let u = rng.four();
                let (p, n) = t.scene.point(side, [u[0], u[1]]);
                Some(Vertex { p, n, omega: n, side })
            }
        }
    }
}

/// The surface point at `p`, seen from the side its normal `n` points to.
#[track_caller]
pub fn point(scene: &Scene, p: DVec3, n: DVec3) -> Vertex {
    let from: Vec3 = (p - scene.origin() + 0.125 * n).as_vec3();
    let v = scene.trace(from, -n.as_vec3()).unwrap();
    assert!(
        (v.p.as_dvec3() + scene.origin() - p).length() < 1e-3 && v.n.as_dvec3().dot(n) > 0.999,
        "{p} is not on a surface: {v:?}"
    );
    v
}

/// The difference of two independent estimates; of an exact one only the other's replicates count.
pub fn difference(a: &Estimate, b: &Estimate) -> Estimate {
    let std_error = (a.std_error * a.std_error + b.std_error * b.std_error).map(f64::sqrt);
    let replicates = [a.replicates, b.replicates].into_iter().filter(|r| *r > 0).min().unwrap_or(0);
    Estimate { mean: a.mean - b.mean, std_error, replicates, events: None }
}
