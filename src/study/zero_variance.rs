//! The zero-variance walk, and what is left of it when the guide is only nearly right.
//!
//! ```text
//! relative variance of patch i:  E[(X − B_i)²]/B_i²        guide v:  error ‖v − B‖/‖B‖  over the patches, by area
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | X | absorption estimator of a walk led by v | [`GuidedWalk::whole`] |
//! | X for one term | walk of k steps led by T^{m−1} E | [`GuidedWalk::term`] |
//! | v from a mesh of n patches | E + the reflected light of the coarse solution, read at the centre of each fine patch | [`Guide::Mesh`] |
//! | v = S_n | partial sum of the Neumann series, and one more application of T for what walks can still reach | [`Guide::Partial`] |
//!
//! A channel is a problem of its own: a walk led by red light is not led by blue. Reference: see
//! [`guide::walk`](crate::guide::walk).

use crate::engine::Settings;
use crate::engine::by_matrix::Matrix;
use crate::estimator::{Absorption, Batch, Job, Paths, Plan, Prefix, Roulette, Technique, TermEstimator, TermSink};
use crate::guide::GuidedWalk;
use crate::guide::walk::GuidedRows;
use crate::math::{Columns, Key};
use crate::operator::matrix::PatchOperator;
use crate::operator::matrix_walk::Rows;
use crate::operator::patches::Patch;
use crate::operator::{MatrixWalk, Sensor, Transport};
use crate::progress::Progress;
use crate::solver::{Neumann, Radiosity};
use rayon::prelude::*;
use std::fmt;

/// How the samples of all patches lie about the truth; patches where the truth is 0 are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean over patches and samples of ((X − B)/B)².
    pub variance: f64,
    /// Largest |X − B|/B of any sample.
    pub largest: f64,
    /// Mean over the patches of (mean of the samples)/B − 1, and its standard error.
    pub bias: [f64; 2],
    /// Steps per walk.
    pub steps: f64,
    /// Walks.
    pub walks: u64,
}

/// Where a guide comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guide {
    /// None: the analog walk, p = F, q = 1 − ρ.
    Analog,
    /// S_n, n terms of the Neumann series beyond E.
    Partial(usize),
    /// The solution on a mesh of so many patches.
    Mesh(usize),
    /// B itself.
    Exact,
}

impl fmt::Display for Guide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Analog => f.write_str("none (analog walk)"),
            Self::Partial(0) => f.write_str("E"),
            Self::Partial(1) => f.write_str("E + T E"),
            Self::Partial(n) => write!(f, "E + … + T^{n} E"),
            Self::Mesh(n) => write!(f, "mesh of {n} patches"),
            Self::Exact => f.write_str("B itself"),
        }
    }
}

/// A guide, how far it is from B, and the spread of the walks that it leads.
#[derive(Clone, Debug, PartialEq)]
pub struct Led {
    /// Which.
    pub guide: Guide,
    /// ‖v − B‖/‖B‖ of the reflected light, by area; NaN without a guide.
    pub error: f64,
    /// Of the whole series.
    pub spread: Spread,
}

/// What the study of one channel found.
#[derive(Clone, Debug, PartialEq)]
pub struct ZeroVariance {
    /// 0, 1, 2: red, green, blue.
    pub channel: usize,
    /// Guides, worst first, B itself last.
    pub guides: Vec<Led>,
    /// Every term by a walk of its own, led by the lower terms.
    pub terms: Vec<Spread>,
}

/// Walks from each patch: more do not say more about a variance.
const MOST: u32 = 1024;

/// Walks led by several guides on the matrix of one channel; `coarse` are other meshes of the same scene, coarsest first.
pub fn study(
    matrix: &Matrix<Radiosity>,
    coarse: &[Matrix<Radiosity>],
    channel: usize,
    settings: &Settings,
    progress: Progress<'_>,
) -> ZeroVariance {
    let samples = settings.spp.min(MOST);
    let (t, e) = (matrix.radiosity.operator(channel), matrix.radiosity.emission(channel));
    let b: Vec<f64> = matrix.solution.radiance.iter().map(|b| b[channel]).collect();
    let mut guides = vec![Guide::Analog];
    guides.extend([0, 1, 2, 4, 8].map(Guide::Partial));
    guides.extend(coarse.iter().map(|m| Guide::Mesh(m.radiosity.patches.len())));
    guides.push(Guide::Exact);
    let work = (guides.len() + settings.max_bounces) * b.len();
    progress.begin(&format!("guided walks, {}", ["red", "green", "blue"][channel]), work as u64);
    let mut found = ZeroVariance { channel, guides: vec![], terms: vec![] };
    // the analog walk of the matrix; a led walk knows itself where to end
    let roulette = Roulette::Albedo { from: 0 };
    let estimator = Absorption(Plan { max_bounces: 0, technique: Technique::Scatter, roulette });
    for (stream, guide) in guides.into_iter().enumerate() {
        if progress.stopped() {
            return found;
        }
        let key = settings.key(&format!("guided {channel}"), 1).branch(stream as u32);
        let rows = GuidedRows { rows: b.len() as u32, left: 0 };
        let v = values(guide, matrix, coarse, channel, &t, &e, &b);
        let (error, spread) = match v {
            None => (f64::NAN, spread(&analog(&t, &e), &Rows(rows.rows), &estimator, None, &b, (samples, key))),
            Some(v) => {
                let error = distance(&v, &b, &e, &t.factors.area);
                (error, spread(&GuidedWalk::whole(&t, &e, v), &rows, &estimator, None, &b, (samples, key)))
            }
        };
        found.guides.push(Led { guide, error, spread });
        progress.advance(b.len() as u64);
    }
    // one term at a time, led by the terms below it: nothing is left to chance
    let powers: Vec<Vec<f64>> = Neumann::new(&t, e.clone()).take(settings.max_bounces + 1).collect();
    for k in 1..=settings.max_bounces {
        if progress.stopped() {
            return found;
        }
        let led = GuidedWalk::term(&t, &e, powers[..k].to_vec());
        let plan = Plan { max_bounces: k, technique: Technique::Scatter, roulette: Roulette::Never };
        let key = settings.key(&format!("guided term {channel}"), 1).branch(k as u32);
        let rows = GuidedRows { rows: b.len() as u32, left: k as u32 };
        found.terms.push(spread(&led, &rows, &Prefix(plan), Some(k), &powers[k], (samples.min(64), key)));
        progress.advance(b.len() as u64);
    }
    found
}

/// The guide as numbers; nothing for the analog walk.
fn values(
    guide: Guide,
    matrix: &Matrix<Radiosity>,
    coarse: &[Matrix<Radiosity>],
    channel: usize,
    t: &PatchOperator<'_>,
    e: &[f64],
    b: &[f64],
) -> Option<Vec<f64>> {
    let reflected = match guide {
        Guide::Analog => return None,
        Guide::Exact => return Some(b.to_vec()),
        Guide::Partial(n) => {
            let mut sum = vec![0.0; e.len()];
            let terms = Neumann::new(t, e.to_vec()).skip(1).take(n);
            terms.for_each(|term| sum.iter_mut().zip(term).for_each(|(s, x)| *s += x));
            sum
        }
        Guide::Mesh(n) => {
            let other = coarse.iter().find(|m| m.radiosity.patches.len() == n)?;
            let light = other.radiosity.emission(channel);
            let at = |p: &Patch| {
                let q = p.lift(p.centre).position;
                let j = other.radiosity.patches.locate(p.primitive, p.front, q);
                j.map_or(0.0, |j| other.solution.radiance[j][channel] - light[j])
            };
            matrix.radiosity.patches.iter().map(at).collect()
        }
    };
    // a guide that is 0 where light comes from would lose that light: a hundredth of the mean is nowhere missing
    let floor = 0.01 * reflected.iter().sum::<f64>() / e.len() as f64;
    let floor = if floor > 0.0 { floor } else { 0.01 * e.iter().sum::<f64>() / e.len() as f64 };
    // and where no light can come from, a walk would look for it for ever
    let lit = lit(t, e);
    Some((0..e.len()).map(|i| if lit[i] { reflected[i].max(floor) + e[i] } else { 0.0 }).collect())
}

/// The patches that some light comes to, by any number of bounces: known from the matrix, whatever B is.
fn lit(t: &PatchOperator<'_>, e: &[f64]) -> Vec<bool> {
    let mut lit: Vec<bool> = e.iter().map(|&e| e > 0.0).collect();
    loop {
        let sees = |i: usize| t.rho[i] > 0.0 && t.factors.row(i).iter().zip(&lit).any(|(&f, &l)| l && f > 0.0);
        let more: Vec<usize> = (0..e.len()).filter(|&i| !lit[i] && sees(i)).collect();
        if more.is_empty() {
            return lit;
        }
        more.into_iter().for_each(|i| lit[i] = true);
    }
}

/// ‖v − b‖/‖b − e‖ by area: what is reflected is what a guide has to know.
fn distance(v: &[f64], b: &[f64], e: &[f64], area: &[f64]) -> f64 {
    let norm = |x: &dyn Fn(usize) -> f64| (0..b.len()).map(|i| area[i] * x(i).powi(2)).sum::<f64>().sqrt();
    norm(&|i| v[i] - b[i]) / norm(&|i| b[i] - e[i])
}

/// The unled walk on the same channel: p = F, q = 1 − ρ.
fn analog(t: &PatchOperator<'_>, e: &[f64]) -> MatrixWalk {
    let grey = |x: &[f64]| x.iter().map(|&x| glam::Vec3::splat(x as f32)).collect();
    MatrixWalk::new(t.factors.f.iter().map(|&f| f64::from(f)).collect(), grey(&t.rho), grey(e))
}

/// Patches of one job.
const ROWS: u32 = 32;

/// Walks from every patch, and how they lie about `truth`; `slot` of the estimator is what counts, or all.
fn spread<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    slot: Option<usize>,
    truth: &[f64],
    (samples, key): (u32, Key),
) -> Spread {
    let rows = truth.len() as u32;
    let job = |first: u32| {
        let pixels = first..(first + ROWS).min(rows);
        let mut values = Values { first, samples, slot, x: vec![0.0; pixels.len() * samples as usize], rays: 0 };
        for s in (0..samples).step_by(ROWS as usize) {
            let batch = Batch { key, pixels: pixels.clone(), samples: s..(s + ROWS).min(samples) };
            estimator.sample(&Job { t, sensor, batch: &batch }, &mut Paths::default(), &mut values);
        }
        values
    };
    let firsts: Vec<u32> = (0..rows).step_by(ROWS as usize).collect();
    let done: Vec<Values> = firsts.into_par_iter().map(job).collect();
    let mut all = Spread::default();
    let (mut patches, mut rays) = (0, 0);
    for part in &done {
        rays += part.rays;
        for (x, &b) in part.x.chunks(samples as usize).zip(&truth[part.first as usize..]) {
            if b > 0.0 {
                let off = |x: &f64| x / b - 1.0;
                all.variance += x.iter().map(|x| off(x).powi(2)).sum::<f64>();
                all.bias[0] += x.iter().map(off).sum::<f64>();
                all.largest = x.iter().map(|x| off(x).abs()).fold(all.largest, f64::max);
                patches += 1;
            }
        }
    }
    all.walks = u64::from(samples) * patches;
    let n = all.walks as f64;
    all.variance /= n;
    // patch by patch the samples are independent, and so are the patches
    all.bias = [all.bias[0] / n, (all.variance / n).sqrt()];
    all.steps = rays as f64 / (f64::from(samples) * f64::from(rows)) - 1.0;
    all
}

/// The samples of some patches.
struct Values {
    first: u32,
    samples: u32,
    slot: Option<usize>,
    x: Vec<f64>,
    rays: usize,
}

impl TermSink for Values {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        if self.slot.is_none_or(|s| s == slot) {
            for i in 0..pixel.len() {
                let at = (pixel[i] - self.first) * self.samples + sample[i];
                self.x[at as usize] += f64::from(value.x[i]);
            }
        }
    }
    fn rays(&mut self, _: usize, rays: usize) {
        self.rays += rays;
    }
}
