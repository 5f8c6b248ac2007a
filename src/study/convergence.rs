//! How error and cost of one render depend on its number of samples: V(n), MSE(n), rays and seconds. They are read from the
//! film while it fills.
//!
//! ```text
//! V(n) ∝ n^b,  b = −1 for independent samples        MSE = bias² + V        efficiency = 1 / (V · cost)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V, MSE | variance and mean squared error; see [`scatter`](crate::terms::scatter) | [`Stand::parts`] |
//! | n | samples per pixel at the time of a snapshot | [`Stand::spp`] |
//! | b | fitted slope of log V against log n | [`NoiseCurve::slope`] |
//!
//! Nothing is rendered twice: the first n samples of a film of 2n samples are the film of n samples. The points of a curve
//! are therefore dependent. The error of a slope takes this into account: it is found by leaving out one replicate of all
//! points at a time (the jackknife).

use crate::engine::by_rays::Sampled;
use crate::stats::evidence::FITTED_SPREAD;
use crate::stats::{Evidence, Slope, falling_slope};
use crate::terms::scatter::Scatter;
use crate::terms::{TermFilm, TermImage, Variance};
use std::time::Instant;

/// A snapshot of the film at one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Stand {
    /// Samples per pixel.
    pub spp: u32,
    /// Rays traced up to this snapshot.
    pub rays: u64,
    /// Wall-clock seconds spent on sampling up to this snapshot.
    pub seconds: f64,
    /// Variance and error of each slot, then of the sum of all slots.
    pub parts: Vec<Scatter>,
}

/// Reference images to compare with, rendered with independent random numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Description of the estimator that made the images.
    pub label: String,
    /// The terms T^k E, k = 0..=K.
    pub terms: Vec<TermImage>,
    /// Everything longer than K, if it was estimated.
    pub tail: Option<TermImage>,
    /// The whole image.
    pub total: TermImage,
}

impl From<Sampled> for Reference {
    fn from(s: Sampled) -> Self {
        let tail = (!s.series.image().tail.is_none()).then_some(s.tail);
        Self { label: s.series.label, terms: s.terms, tail, total: s.total }
    }
}

/// Takes snapshots of the film at chosen numbers of samples.
pub struct Recorder<'a> {
    reference: Option<&'a Reference>,
    /// Samples per pixel at which to take a snapshot; if empty, after every pass.
    at: Vec<u32>,
    /// Start of the current sampling interval; `seconds` holds the time of the earlier ones.
    since: Instant,
    seconds: f64,
    kept: Vec<Stand>,
}

impl<'a> Recorder<'a> {
    /// Takes snapshots at the numbers of samples in `at`, in rising order. If `at` is empty, takes one whenever the render
    /// pauses.
    pub fn new(reference: Option<&'a Reference>, at: Vec<u32>) -> Self {
        Self { reference, at, since: Instant::now(), seconds: 0.0, kept: vec![] }
    }

    /// The snapshots taken.
    pub fn stands(self) -> Vec<Stand> {
        self.kept
    }

    /// Takes a snapshot after a pass if one is due. Returns the next number of samples per pixel at which the render should
    /// pause, in addition to its usual pauses.
    pub fn look(&mut self, film: &TermFilm) -> Option<u32> {
        self.seconds += self.since.elapsed().as_secs_f64();
        let spp = film.least_samples();
        if film.shape.replicates > 1 && (self.at.is_empty() || self.at.contains(&spp)) {
            let (rays, parts) = (film.rays.iter().sum(), self.parts(film));
            self.kept.push(Stand { spp, rays, seconds: self.seconds, parts });
        }
        self.since = Instant::now();
        self.at.iter().copied().find(|&n| n > spp)
    }

    fn parts(&self, film: &TermFilm) -> Vec<Scatter> {
        let slots = film.shape.slots;
        let reference = |slot: Option<usize>| -> Option<&TermImage> {
            let r = self.reference?;
            match slot {
                None => Some(&r.total),
                Some(s) if s + 1 == slots => r.tail.as_ref(),
                Some(s) => r.terms.get(s),
            }
        };
        let alone = if slots == 1 { vec![] } else { (0..slots).map(|s| (s..s + 1, Some(s))).collect() };
        let all = alone.into_iter().chain([(0..slots, None)]);
        all.map(|(range, slot)| Scatter::of(film, range, reference(slot))).collect()
    }
}

/// The noise of one term, of the tail or of the sum, against the number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseCurve {
    /// Name of the part: `0`, `1`, …, `tail` or `all`.
    pub name: String,
    /// Samples per pixel and the noise measured there, in rising order.
    pub points: Vec<(u32, Scatter)>,
    /// States whether the variance is finite. The variance of a sum of infinitely many terms may be infinite, and then the
    /// curve has no limit.
    pub variance: Variance,
}

impl NoiseCurve {
    /// The curves of a render: one per slot, then the sum. The tail is left out unless it is known. `variance` applies to
    /// the tail and to the sum.
    pub fn all(stands: &[Stand], tail_is_known: bool, variance: Variance) -> Vec<Self> {
        let count = stands.first().map_or(0, |s| s.parts.len());
        let name = |i: usize| match count - i {
            1 => "all".to_owned(),
            2 => "tail".to_owned(),
            _ => i.to_string(),
        };
        let kept = (0..count).filter(|&i| tail_is_known || i + 2 != count);
        let part = |i| Self {
            name: name(i),
            points: stands.iter().map(|s| (s.spp, s.parts[i].clone())).collect(),
            variance: if i + 2 < count { Variance::Finite } else { variance },
        };
        kept.map(part).collect()
    }

    /// The fitted slope of V. None if there is no noise, if the variance is infinite, or if fewer than two points have
    /// enough evidence.
    pub fn slope(&self) -> Option<Slope> {
        self.fit(Scatter::variance, Scatter::variance_without)
    }

    /// The fitted slope of MSE. None without a reference, or if an estimate of MSE is not positive.
    pub fn error_slope(&self) -> Option<Slope> {
        self.fit(|s| s.squared_error().unwrap_or(f64::NAN), Scatter::squared_error_without)
    }

    fn fit(&self, value: impl Fn(&Scatter) -> f64, without: impl Fn(&Scatter, usize) -> f64) -> Option<Slope> {
        if Evidence::of_variance(self.variance).no_error.is_some() {
            return None;
        }
        // a variance from few events is left out: most of the rare contributions that make it up have not occurred yet
        let known = || self.points.iter().filter(|(_, s)| s.events >= FITTED_SPREAD);
        let points: Vec<(f64, f64)> = known().map(|(n, s)| (f64::from(*n), value(s))).collect();
        let leave = |s: &Scatter| (0..s.replicates()).map(|i| without(s, i)).collect();
        let curves: Vec<Vec<f64>> = known().map(|(_, s)| leave(s)).collect();
        falling_slope(&points, &curves)
    }
}
