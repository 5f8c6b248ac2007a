//! The zero-variance walk, and how its variance grows when the guide is only approximately right.
//!
//! A *guide* v is an estimate of the solution B on every patch. The walk samples its next patch, and decides when to end, in
//! proportion to v. With v = B every walk gives exactly B_i: the variance is zero.
//!
//! ```text
//! relative variance of patch i:  E[(X − B_i)²]/B_i²        guide v:  error ‖v − B‖/‖B‖  over the patches, by area
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | X | sample of the absorption estimator, by a walk that follows guide v | [`GuidedWalk::whole`] |
//! | X for one term | sample of T^k E, by a walk of k steps guided by T^{m−1} E with m steps left | [`GuidedWalk::term`] |
//! | v from a mesh of n patches | E plus the reflected light of the solution on a coarse mesh, read at the centre of each fine patch | [`Guide::Mesh`] |
//! | v = S_n | partial sum of the Neumann series, at least one hundredth of the mean wherever light can arrive | [`Guide::Partial`] |
//!
//! Each colour channel is a separate problem, because a guide for red light is not right for blue light. Reference: see
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

/// How far the samples of all patches lie from the true value B. Patches with B = 0 are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean over patches and samples of ((X − B)/B)².
    pub variance: f64,
    /// Largest |X − B|/B of all samples.
    pub largest: f64,
    /// Relative bias: mean over the patches of (mean of the samples)/B − 1, and its standard error.
    pub bias: [f64; 2],
    /// Mean number of steps per walk.
    pub steps: f64,
    /// Number of walks.
    pub walks: u64,
}

/// Source of a guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guide {
    /// No guide: the analog walk with p = F and q = 1 − ρ.
    Analog,
    /// The partial sum S_n: E and n further terms of the Neumann series.
    Partial(usize),
    /// The solution on a mesh with this number of patches.
    Mesh(usize),
    /// The exact solution B.
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

/// One guide, an approximation of the radiosity B: how far it is from B, and the variance of the walks that it guides.
#[derive(Clone, Debug, PartialEq)]
pub struct Led {
    /// The guide.
    pub guide: Guide,
    /// ‖v − B‖/‖B − E‖ over the patches, weighted by area: the error relative to the reflected light. NaN without a guide.
    pub error: f64,
    /// Spread of the samples of the whole series.
    pub spread: Spread,
}

/// Results for one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ZeroVariance {
    /// Index of the channel: 0, 1, 2 for red, green, blue.
    pub channel: usize,
    /// Guides from the worst to the best; the last one is B itself.
    pub guides: Vec<Led>,
    /// Spread of every term k ≥ 1, each from its own walk, guided by the terms below it.
    pub terms: Vec<Spread>,
}

/// Largest number of walks from each patch; more walks would not make the variance much more accurate.
const MOST: u32 = 1024;

/// Runs walks with several guides on the matrix of one channel. `coarse` holds matrices of other meshes of the same scene,
/// coarsest first.
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
    // roulette of the analog walk; a guided walk takes its termination probability from the guide
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
    // one term at a time, guided by the terms below it: every walk gives the exact value
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

/// The values of a guide on every patch; none for the analog walk.
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
    // where the guide is 0, walks would miss light that comes from there; a floor of a hundredth of the mean avoids this
    let floor = 0.01 * reflected.iter().sum::<f64>() / e.len() as f64;
    let floor = if floor > 0.0 { floor } else { 0.01 * e.iter().sum::<f64>() / e.len() as f64 };
    // patches that no light reaches get 0: a walk that enters one would never end
    let lit = lit(t, e);
    Some((0..e.len()).map(|i| if lit[i] { reflected[i].max(floor) + e[i] } else { 0.0 }).collect())
}

/// Marks the patches that some light reaches after any number of bounces. This follows from the matrix without knowing B.
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

/// ‖v − b‖/‖b − e‖, weighted by area: the error of the guide relative to the reflected light b − e.
fn distance(v: &[f64], b: &[f64], e: &[f64], area: &[f64]) -> f64 {
    let norm = |x: &dyn Fn(usize) -> f64| (0..b.len()).map(|i| area[i] * x(i).powi(2)).sum::<f64>().sqrt();
    norm(&|i| v[i] - b[i]) / norm(&|i| b[i] - e[i])
}

/// The walk without a guide on the same channel: p = F, q = 1 − ρ.
fn analog(t: &PatchOperator<'_>, e: &[f64]) -> MatrixWalk {
    let grey = |x: &[f64]| x.iter().map(|&x| glam::Vec3::splat(x as f32)).collect();
    MatrixWalk::new(t.factors.f.iter().map(|&f| f64::from(f)).collect(), grey(&t.rho), grey(e))
}

/// Number of patches that one parallel job handles.
const ROWS: u32 = 32;

/// Runs walks from every patch and measures their spread about `truth`. Only `slot` of the estimator counts; with `None` all
/// slots are added.
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
    // samples are independent within a patch and between patches
    all.bias = [all.bias[0] / n, (all.variance / n).sqrt()];
    all.steps = rays as f64 / (f64::from(samples) * f64::from(rows)) - 1.0;
    all
}

/// The samples of a range of patches.
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
