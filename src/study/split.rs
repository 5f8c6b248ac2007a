//! How to distribute samples over the terms: compares the variance of three ways at equal cost.
//!
//! ```text
//! Var = Σ σ_k²/n_k      Cost = Σ n_k c_k      Var · Cost ≥ (Σ σ_k √c_k)²,  equal iff  n_k ∝ σ_k/√c_k
//! equal split: Var · Cost = Σ σ_k² · Σ c_k    prefix reuse: 1ᵀC1 · c,  all terms from one path
//! ```
//!
//! The bound is the Cauchy–Schwarz inequality for the vectors (σ_k/√n_k) and (√(n_k c_k)). Neyman found this split for
//! strata (*J. Royal Statistical Society* 97, 1934).
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | σ_k² | variance of one sample of term k, averaged over pixels and channels | [`Term::variance`] |
//! | c_k | rays, or seconds, of one sample of term k | [`Term::rays`], [`Term::seconds`] |
//! | n_k | samples per pixel given to term k | [`Term::spp`], [`optimal`] |
//! | C | covariance of the terms of one path | [`Reuse::covariance`] |
//!
//! In the first two ways every term has its own film and its own random numbers. The terms are then independent, so that the
//! variance of their sum is the sum of their variances.

use crate::engine::Settings;
use crate::estimator::render::{Amount, render};
use crate::estimator::{OneTerm, Prefix, SingleTerm};
use crate::math::Key;
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::covariance::{Covariance, covariance};
use crate::terms::scatter::Scatter;
use std::time::Instant;

/// Measured noise and cost of one term.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Samples per pixel.
    pub spp: u32,
    /// σ_k²: variance of one sample.
    pub variance: f64,
    /// Standard error of `variance`.
    pub std_error: f64,
    /// Rays of one sample.
    pub rays: f64,
    /// Wall-clock seconds of one sample.
    pub seconds: f64,
}

/// Measured noise and cost of prefix reuse, where one path samples all terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Reuse {
    /// Samples per pixel.
    pub spp: u32,
    /// C: covariance of the terms of one path, slot by slot.
    pub covariance: Covariance,
    /// Rays of one path.
    pub rays: f64,
    /// Wall-clock seconds of one path.
    pub seconds: f64,
}

/// The product of variance and cost, with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Var · Cost.
    pub value: f64,
    /// Standard error of `value`. The error of the cost is neglected.
    pub std_error: f64,
}

/// Unit in which cost is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Rays per pixel.
    Rays,
    /// Wall-clock seconds per pixel.
    Seconds,
}

impl Term {
    /// c_k: cost of one sample of this term.
    pub fn cost(&self, unit: Unit) -> f64 {
        if unit == Unit::Rays { self.rays } else { self.seconds }
    }
}

impl Reuse {
    /// 1ᵀC1 · c: variance of the sum of all terms of one path, times the cost of the path.
    pub fn work(&self, unit: Unit) -> Work {
        let (sum, error) = self.covariance.sum();
        let cost = if unit == Unit::Rays { self.rays } else { self.seconds };
        Work { value: sum * cost, std_error: error * cost }
    }
}

/// Variance times cost of the sum of all terms, if term k gets `counts[k]` samples.
pub fn work(terms: &[Term], counts: &[u32], unit: Unit) -> Work {
    let pairs = || terms.iter().zip(counts).map(|(t, &n)| (t, f64::from(n)));
    let cost: f64 = pairs().map(|(t, n)| n * t.cost(unit)).sum();
    let variance: f64 = pairs().map(|(t, n)| t.variance / n).sum();
    let error = pairs().map(|(t, n)| (t.std_error / n).powi(2)).sum::<f64>().sqrt();
    Work { value: variance * cost, std_error: error * cost }
}

/// (Σ σ_k √c_k)²: the smallest product of variance and cost that any split reaches. Its error follows from the delta method.
///
/// ```
/// use fredholm::study::split::{Term, Unit, best, work};
/// // two terms with σ = 1, 3 and c = 1, 4: (1·1 + 3·2)² against (1 + 9)(1 + 4) of the equal split
/// let term = |variance, rays| Term { spp: 16, variance, std_error: 0.0, rays, seconds: 1.0 };
/// let terms = [term(1.0, 1.0), term(9.0, 4.0)];
/// assert_eq!(best(&terms, Unit::Rays).value, 49.0);
/// assert_eq!(work(&terms, &[16, 16], Unit::Rays).value, 50.0);
/// ```
pub fn best(terms: &[Term], unit: Unit) -> Work {
    let root: f64 = terms.iter().map(|t| (t.variance * t.cost(unit)).sqrt()).sum();
    // ∂(Σ σ√c)²/∂σ² = Σ σ√c · √c/σ; a term without noise has no error either
    let slope = |t: &Term| if t.variance > 0.0 { root * (t.cost(unit) / t.variance).sqrt() } else { 0.0 };
    let error = terms.iter().map(|t| (slope(t) * t.std_error).powi(2)).sum::<f64>().sqrt();
    Work { value: root * root, std_error: error }
}

/// The optimal counts: n_k ∝ σ_k/√c_k with Σ n_k c_k near `budget`. Each count is rounded to a multiple of `replicates` and
/// is at least `replicates`, also for a term without noise.
pub fn optimal(terms: &[Term], unit: Unit, budget: f64, replicates: u32) -> Vec<u32> {
    let root: f64 = terms.iter().map(|t| (t.variance * t.cost(unit)).sqrt()).sum();
    let count = |t: &Term| {
        let n = if root > 0.0 { budget * (t.variance / t.cost(unit)).sqrt() / root } else { 0.0 };
        whole(n, replicates)
    };
    terms.iter().map(count).collect()
}

/// The positive multiple of `replicates` nearest to `n`.
pub fn whole(n: f64, replicates: u32) -> u32 {
    let most = f64::from((1u32 << 30) / replicates);
    (n / f64::from(replicates)).round().clamp(1.0, most) as u32 * replicates
}

/// Replicates of every film in this module.
pub const REPLICATES: usize = 16;

/// Renders each slot separately with the number of samples in `counts`. The slots are the terms and, if the roulette ends
/// all paths, the tail. None if interrupted.
pub fn measure<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    single: &SingleTerm,
    counts: &[u32],
    key: Key,
    progress: Progress<'_>,
) -> Option<Vec<Term>> {
    let pixels = f64::from(sensor.size()[0]) * f64::from(sensor.size()[1]);
    let mut terms = vec![];
    for (slot, &spp) in counts.iter().enumerate() {
        progress.begin(&format!("term {slot}, {spp} spp"), pixels as u64 * u64::from(spp));
        let (started, estimator) = (Instant::now(), OneTerm { single: single.clone(), slot });
        let film = render(t, sensor, &estimator, Amount { spp, replicates: REPLICATES, key }, progress);
        let seconds = started.elapsed().as_secs_f64();
        if progress.stopped() {
            return None;
        }
        let (scatter, n, paths) = (Scatter::of(&film, 0..1, None), f64::from(spp), f64::from(spp) * pixels);
        terms.push(Term {
            spp,
            variance: n * scatter.variance(),
            std_error: n * scatter.variance_error(),
            rays: film.rays[0] as f64 / paths,
            seconds: seconds / paths,
        });
    }
    Some(terms)
}

/// Renders all terms from one path per sample, and records their covariance. None if interrupted.
pub fn reuse<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    prefix: &Prefix,
    spp: u32,
    key: Key,
    progress: Progress<'_>,
) -> Option<Reuse> {
    let pixels = f64::from(sensor.size()[0]) * f64::from(sensor.size()[1]);
    progress.begin(&format!("prefix, {spp} spp"), pixels as u64 * u64::from(spp));
    let started = Instant::now();
    let film = render(t, sensor, prefix, Amount { spp, replicates: REPLICATES, key }, progress);
    let seconds = started.elapsed().as_secs_f64();
    if progress.stopped() {
        return None;
    }
    let paths = f64::from(spp) * pixels;
    let rays = film.rays.iter().sum::<u64>() as f64 / paths;
    Some(Reuse { spp, covariance: covariance(&film), rays, seconds: seconds / paths })
}

/// A pilot run and the measurements of the three ways.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Each term measured separately, from random numbers that the measurements do not use. The predictions use these
    /// values.
    pub pilot: Vec<Term>,
    /// The pilot run of prefix reuse.
    pub pilot_reuse: Reuse,
    /// First way: the same number of samples for every term.
    pub equal: Vec<Term>,
    /// Second way: n_k ∝ σ_k/√c_k from the pilot run, with cost in rays.
    pub optimal: Vec<Term>,
    /// Third way: all terms from one path.
    pub reuse: Reuse,
}

/// Measures the three ways at equal cost: about the rays that `settings.spp` samples of every term take. The pilot run takes
/// `pilot` additional samples of every term. Counts are rounded to multiples of [`REPLICATES`]. None if interrupted.
pub fn study(scene: &Scene, settings: &Settings, pilot: u32, progress: Progress<'_>) -> Option<Study> {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let (single, prefix) = (SingleTerm(settings.plan()), Prefix(settings.plan()));
    let slots = settings.max_bounces + 1 + usize::from(settings.roulette.ends());
    let round = |n: f64| whole(n, REPLICATES as u32);
    let (pilot, spp) = (round(pilot.into()), round(settings.spp.into()));
    let terms = |counts: &[u32], stream: &str| {
        measure(&t, &scene.camera, &single, counts, settings.key(stream, REPLICATES), progress)
    };
    let paths = |spp, stream: &str| reuse(&t, &scene.camera, &prefix, spp, settings.key(stream, REPLICATES), progress);
    let (known, known_reuse) = (terms(&vec![pilot; slots], "pilot, single")?, paths(pilot, "pilot, prefix")?);
    let budget = f64::from(spp) * known.iter().map(|t| t.rays).sum::<f64>();
    let counts = optimal(&known, Unit::Rays, budget, REPLICATES as u32);
    Some(Study {
        equal: terms(&vec![spp; slots], "single")?,
        optimal: terms(&counts, "single, optimal")?,
        reuse: paths(round(budget / known_reuse.rays), "prefix")?,
        pilot: known,
        pilot_reuse: known_reuse,
    })
}
