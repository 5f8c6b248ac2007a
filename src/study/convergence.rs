//! How error and cost grow with the samples of one render: V(n), MSE(n), rays and seconds, read off the film as it fills.
//!
//! ```text
//! V(n) ∝ n^b,  b = −1 for independent samples        MSE = bias² + V        efficiency = 1 / (V · cost)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V, MSE | see [`scatter`](crate::terms::scatter) | [`Stand::parts`] |
//! | n | samples per pixel at a stand | [`Stand::spp`] |
//! | b | fitted slope | [`NoiseCurve::slope`] |
//!
//! Nothing is rendered twice: the film of n samples is a part of the film of 2n. The points of a curve therefore share their
//! replicates, and the error of a slope comes from curves without one replicate each.

use crate::engine::by_rays::Sampled;
use crate::stats::evidence::FITTED_SPREAD;
use crate::stats::{Evidence, Slope, falling_slope};
use crate::terms::scatter::Scatter;
use crate::terms::{TermFilm, TermImage, Variance};
use std::time::Instant;

/// A film at one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Stand {
    /// Samples per pixel.
    pub spp: u32,
    /// Rays so far.
    pub rays: u64,
    /// Wall-clock seconds spent on samples so far.
    pub seconds: f64,
    /// Each slot, then the sum.
    pub parts: Vec<Scatter>,
}

/// Images to compare with, from an independent stream.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// In words.
    pub label: String,
    /// T^k E, k = 0..=K.
    pub terms: Vec<TermImage>,
    /// Everything longer, where it is known.
    pub tail: Option<TermImage>,
    /// The whole.
    pub total: TermImage,
}

impl From<Sampled> for Reference {
    fn from(s: Sampled) -> Self {
        let tail = (!s.series.image().tail.is_none()).then_some(s.tail);
        Self { label: s.series.label, terms: s.terms, tail, total: s.total }
    }
}

/// Keeps what the film says at chosen numbers of samples.
pub struct Recorder<'a> {
    reference: Option<&'a Reference>,
    /// Where to look; empty: after every pass.
    at: Vec<u32>,
    /// Since when samples are taken, and how long they took before.
    since: Instant,
    seconds: f64,
    kept: Vec<Stand>,
}

impl<'a> Recorder<'a> {
    /// Keeps the numbers of samples `at`, in rising order, or all that the render stops at.
    pub fn new(reference: Option<&'a Reference>, at: Vec<u32>) -> Self {
        Self { reference, at, since: Instant::now(), seconds: 0.0, kept: vec![] }
    }

    /// What was kept.
    pub fn stands(self) -> Vec<Stand> {
        self.kept
    }

    /// Looks at the film after a pass; the next number of samples per pixel at which to look, beside the usual ones.
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

/// One term, the tail or the sum of one render, as it falls.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseCurve {
    /// `0`, `1`, …, `tail`, `all`.
    pub name: String,
    /// n and what the film says there, in rising order.
    pub points: Vec<(u32, Scatter)>,
    /// Whether what is shown tends to anything: the variance of a sum without end may be infinite.
    pub variance: Variance,
}

impl NoiseCurve {
    /// The parts of a render: its slots (a tail only if it is `known`), then the sum. `variance` is that of the tail and of the sum.
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

    /// The slope of V; none where there is no noise or no variance, or fewer than two points that rest on events enough.
    pub fn slope(&self) -> Option<Slope> {
        self.fit(Scatter::variance, Scatter::variance_without)
    }

    /// The slope of MSE; none without a reference, or where an estimate of it is not positive.
    pub fn error_slope(&self) -> Option<Slope> {
        self.fit(|s| s.squared_error().unwrap_or(f64::NAN), Scatter::squared_error_without)
    }

    fn fit(&self, value: impl Fn(&Scatter) -> f64, without: impl Fn(&Scatter, usize) -> f64) -> Option<Slope> {
        if Evidence::of_variance(self.variance).no_error.is_some() {
            return None;
        }
        // a variance that rests on few events is no point of a curve: most of it has not happened yet
        let known = || self.points.iter().filter(|(_, s)| s.events >= FITTED_SPREAD);
        let points: Vec<(f64, f64)> = known().map(|(n, s)| (f64::from(*n), value(s))).collect();
        let leave = |s: &Scatter| (0..s.replicates()).map(|i| without(s, i)).collect();
        let curves: Vec<Vec<f64>> = known().map(|(_, s)| leave(s)).collect();
        falling_slope(&points, &curves)
    }
}
