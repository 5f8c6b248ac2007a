//! The result type that every world returns. Statistics and reports use nothing else.
//!
//! A *world* is one way to compute the terms: by rays with an estimator for each term, by rays with the path tracer, or by a
//! matrix over patches. An *event* is one nonzero contribution to a mean. A *doubt* is an error that the samples of a result
//! cannot reveal, because they find a kind of path only by chance.

use crate::math::names::named;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Number of equal contributions that would give the same noise: large if a mean is the sum of many similar contributions,
/// small if a few bright ones dominate. An event is one contribution x = r + g + b.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Events {
    /// (Σ x)²/Σ x²: the number of equal events that would give the mean the same relative noise. 0 if nothing was found.
    pub mean: f64,
    /// (Σ x²)²/Σ x⁴, or a lower bound of it: the number of equal events that would determine the variance as well.
    pub variance: f64,
    /// k̂, the tail index of the largest contributions ([`largest`](super::largest)); 0 if it is not known.
    pub tail: f64,
}

impl Events {
    /// `n` equal events.
    pub fn equal(n: f64) -> Self {
        Self { mean: n, variance: n, tail: 0.0 }
    }
}

/// A mean with its standard error, per channel. For a matrix result the error is zero and `replicates` is 0.
///
/// [`Evidence`](crate::stats::Evidence) decides whether the error can be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The estimated value.
    pub mean: DVec3,
    /// Standard error of `mean`; ∞ where the variance is infinite, NaN where it is not known (one replicate, or a variance that may
    /// be infinite).
    pub std_error: DVec3,
    /// Independent replicates behind the error: `replicates − 1` degrees of freedom. 0 means exact. If there are few
    /// replicates, the error comes from the pixels. This is then the number of replicates that would determine the error as
    /// well.
    pub replicates: u64,
    /// Events behind the mean, if they were counted.
    #[serde(default)]
    pub events: Option<Events>,
}

impl Estimate {
    /// A value known without error.
    pub fn exact(mean: DVec3) -> Self {
        Self { mean, std_error: DVec3::ZERO, replicates: 0, events: None }
    }

    /// No estimate: the tail of paths that are cut at K.
    pub const NONE: Self = Self { mean: DVec3::NAN, std_error: DVec3::NAN, replicates: 0, events: None };

    /// Returns true if this is [`Estimate::NONE`]. (A broken render is NaN too, but it has replicates.)
    pub fn is_none(&self) -> bool {
        self.replicates == 0 && self.mean.is_nan()
    }
}

/// Tells whether infinite sums (the tail, the total) have a finite variance. Error bars from samples are meaningful only
/// then.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Variance {
    /// The variance is finite.
    #[default]
    Finite,
    /// The variance is infinite.
    Infinite,
    /// It is not known whether the variance is finite.
    Unknown,
}

impl Variance {
    /// The value to show in place of a standard error: ∞ or NaN. None if the variance is finite and the standard error is
    /// valid.
    pub fn instead(self) -> Option<f64> {
        match self {
            Self::Finite => None,
            Self::Infinite => Some(f64::INFINITY),
            Self::Unknown => Some(f64::NAN),
        }
    }
}

/// The ways to compute a result. Each is one realisation of the operator T.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum World {
    /// Rays in the scene, with an estimator for each term.
    Terms,
    /// Rays in the scene, with the full path tracer: only the sum.
    Path,
    /// A matrix over patches.
    Radiosity,
}

impl World {
    /// All worlds.
    pub const ALL: [Self; 3] = [Self::Terms, Self::Path, Self::Radiosity];
}

impl std::fmt::Display for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Terms => "terms",
            Self::Path => "path",
            Self::Radiosity => "radiosity",
        })
    }
}

impl std::str::FromStr for World {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// A colour channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Channel 0.
    Red,
    /// Channel 1.
    Green,
    /// Channel 2.
    Blue,
}

impl Channel {
    /// All channels, by number.
    pub const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];

    /// The name: `red`, `green` or `blue`.
    pub fn name(self) -> &'static str {
        ["red", "green", "blue"][self as usize]
    }
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Channel {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// Work done for a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Paths started.
    pub paths: u64,
    /// Rays traced, closest-hit and shadow together.
    pub rays: u64,
    /// Samples that were not finite; they stay in the sums, so a result with any is visibly broken.
    pub non_finite: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// The terms of one world under one linear functional of the image (its mean, the mean of a region, …).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Functional {
    /// `image`, `region 0,3`, `projection 5`, ….
    pub name: String,
    /// One estimate per k = 0..=K (empty for the path tracer).
    pub terms: Vec<Estimate>,
    /// Everything longer than K; [`Estimate::NONE`] where paths are cut at K, and then `total` holds k ≤ K only.
    pub tail: Estimate,
    /// Σ_{k≤K} terms; the covariance of the terms is included in the error.
    pub sum: Estimate,
    /// Σ_{k≤K} terms + tail: the whole image.
    pub total: Estimate,
}

impl Functional {
    /// The estimates that contain terms k ≥ `from`: these terms, the tail, the sum and the total.
    pub fn made_of(&mut self, from: usize) -> impl Iterator<Item = &mut Estimate> {
        let late = self.terms.iter_mut().skip(from);
        late.chain([&mut self.tail, &mut self.sum, &mut self.total])
    }
}

/// A kind of path that a sampling method cannot find.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnsampledPaths {
    /// The light of these paths, in words; it completes the sentence "… cannot find …".
    pub what: String,
    /// The first term that has such paths.
    pub from: usize,
}

/// A source of error that the samples of a result cannot reveal: mostly a kind of path that is found only by chance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Doubt {
    /// In words: `lamps seen in mirrors or glass`.
    pub what: String,
    /// The first term that is affected.
    pub from: usize,
    /// Expected number of such events per path. 1e-6 means one event in a million paths; 0 means that no number of paths is
    /// enough.
    pub per_path: f64,
}

/// The complete result of a world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// The world that computed the result.
    pub world: World,
    /// Description for tables and legends: `prefix, mis`.
    pub label: String,
    /// The functionals: the image mean first, then region means and projections.
    pub functionals: Vec<Functional>,
    /// Work done.
    pub cost: Cost,
    /// Kinds of paths that the sampling method cannot find in this scene; empty if it finds all light.
    #[serde(default)]
    #[serde(alias = "unseen")]
    pub unsampled: Vec<UnsampledPaths>,
    /// Kinds of paths that carry much light but are found rarely. As long as none is found, the error bars are too small, and
    /// the samples cannot show it. An error is therefore trusted only if enough such paths are expected (`stats::evidence`).
    #[serde(default)]
    pub doubts: Vec<Doubt>,
    /// If present, the reason why no comparison with this result gives a verdict: the scene has no unique correct image.
    #[serde(default)]
    pub undecided: Option<String>,
    /// Tells whether the tail and the total have a finite variance.
    #[serde(default)]
    pub variance: Variance,
}

impl Series {
    /// The first term that the two results do not both estimate in full, and a sentence that names the light that one of
    /// them cannot find. None if both find the same paths.
    pub fn gap(&self, other: &Self) -> Option<(usize, String)> {
        let only = |a: &Self, b: &Self| -> Vec<(usize, String)> {
            let missing = a.unsampled.iter().filter(|p| !b.unsampled.contains(p));
            missing.map(|p| (p.from, format!("{} cannot find {}", a.label, p.what))).collect()
        };
        only(self, other).into_iter().chain(only(other, self)).min()
    }

    /// Expected number of events of the kind that a doubt names.
    pub fn expected(&self, doubt: &Doubt) -> f64 {
        doubt.per_path * self.cost.paths as f64
    }

    /// Adds doubts. The numbers of events of all affected estimates are limited to the expected numbers.
    #[must_use]
    pub fn doubted(mut self, doubts: Vec<Doubt>) -> Self {
        for doubt in &doubts {
            let most = self.expected(doubt);
            let estimates = self.functionals.iter_mut().flat_map(|f| f.made_of(doubt.from));
            estimates.filter_map(|e| e.events.as_mut()).for_each(|e| e.mean = e.mean.min(most));
        }
        Self { doubts, ..self }
    }

    /// Keeps only the terms k < `end` and removes the tail. The total is then no longer comparable with that of a complete
    /// result.
    #[must_use]
    pub fn before(&self, end: usize) -> Self {
        let mut cut = self.clone();
        for f in &mut cut.functionals {
            f.terms.truncate(end);
            f.tail = Estimate::NONE;
        }
        cut
    }

    /// Replaces the error bars of the tail and of the total by ∞ or NaN, unless their variance is finite.
    pub fn judge(&mut self, variance: Variance) {
        self.variance = variance;
        let Some(instead) = variance.instead() else { return };
        for f in &mut self.functionals {
            for e in [&mut f.tail, &mut f.total].into_iter().filter(|e| e.replicates > 0) {
                e.std_error = DVec3::splat(instead);
            }
        }
    }

    /// The functional of the image mean.
    pub fn image(&self) -> &Functional {
        &self.functionals[0]
    }
}
