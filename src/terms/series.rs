//! The result type every world returns, and all that statistics and reports know.

use crate::math::names::named;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// What a mean was added up from: many events alike, or a few that are bright. An event is one contribution x = r + g + b.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Events {
    /// (Σ x)²/Σ x²: so many equal events would carry the mean with as much noise. 0: nothing was found.
    pub mean: f64,
    /// (Σ x²)²/Σ x⁴, or less: so many equal events would carry the variance.
    pub variance: f64,
    /// k̂ of the largest contributions ([`largest`](super::largest)); 0 where it is not known.
    pub tail: f64,
}

impl Events {
    /// So many equal events.
    pub fn equal(n: f64) -> Self {
        Self { mean: n, variance: n, tail: 0.0 }
    }
}

/// A mean with its standard error, per channel. For a matrix result the error is zero and `replicates` is 0.
///
/// Whether the error may be believed is for [`Evidence`](crate::stats::Evidence) to say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The estimated value.
    pub mean: DVec3,
    /// Standard error of `mean`; ∞ where the variance is infinite, NaN where it is not known (one replicate, or a variance that may
    /// be infinite).
    pub std_error: DVec3,
    /// Independent replicates behind the error: `replicates − 1` degrees of freedom. 0 means exact. Where the error comes from
    /// pixels, since there are few replicates, as many as would know it as well.
    pub replicates: u64,
    /// What it was added up from, where that was counted.
    #[serde(default)]
    pub events: Option<Events>,
}

impl Estimate {
    /// A value known without error.
    pub fn exact(mean: DVec3) -> Self {
        Self { mean, std_error: DVec3::ZERO, replicates: 0, events: None }
    }

    /// Nothing was estimated: the tail of paths that are cut at K.
    pub const NONE: Self = Self { mean: DVec3::NAN, std_error: DVec3::NAN, replicates: 0, events: None };

    /// Whether this is [`Estimate::NONE`]. (A broken render is NaN too, but it has replicates.)
    pub fn is_none(&self) -> bool {
        self.replicates == 0 && self.mean.is_nan()
    }
}

/// Whether sums without end (the tail, the whole) have a finite variance, which is what makes an error bar of samples mean anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Variance {
    /// Yes.
    #[default]
    Finite,
    /// No.
    Infinite,
    /// Nobody knows.
    Unknown,
}

impl Variance {
    /// What stands in place of a standard error; none where it means what it says.
    pub fn instead(self) -> Option<f64> {
        match self {
            Self::Finite => None,
            Self::Infinite => Some(f64::INFINITY),
            Self::Unknown => Some(f64::NAN),
        }
    }
}

/// Which realisation of the operator a result comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum World {
    /// Rays in the scene, one estimator per term.
    Terms,
    /// Rays in the scene, the full path tracer: only the sum.
    Path,
    /// The matrix over patches.
    Radiosity,
}

impl World {
    /// All of them.
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
    /// Number 0.
    Red,
    /// Number 1.
    Green,
    /// Number 2.
    Blue,
}

impl Channel {
    /// All of them, by number.
    pub const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];

    /// Its name.
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
    /// Samples that were not finite; they are left in the sums, so a result with any is visibly broken.
    pub non_finite: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// The terms of one world, as seen by one linear functional of the image (its mean, the mean of a region, …).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Functional {
    /// `image`, `region 0,3`, `projection 5`, ….
    pub name: String,
    /// One estimate per k = 0..=K (empty for the path tracer).
    pub terms: Vec<Estimate>,
    /// Everything longer than K; [`Estimate::NONE`] where paths are cut at K, and then `total` holds k ≤ K only.
    pub tail: Estimate,
    /// Σ_{k≤K} terms, with the error that their covariance gives.
    pub sum: Estimate,
    /// Σ_{k≤K} terms + tail: the whole image.
    pub total: Estimate,
}

impl Functional {
    /// What is made of the terms k ≥ `from`: these, the tail, the sum and the total.
    pub fn made_of(&mut self, from: usize) -> impl Iterator<Item = &mut Estimate> {
        let late = self.terms.iter_mut().skip(from);
        late.chain([&mut self.tail, &mut self.sum, &mut self.total])
    }
}

/// A kind of paths that a way of sampling cannot find.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnsampledPaths {
    /// In words, after "does not see".
    pub what: String,
    /// The first term that has such paths.
    pub from: usize,
}

/// What the samples of a result cannot know about themselves: most often a kind of paths that is met only by chance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Doubt {
    /// In words: `the light of a lamp through mirrors or glass`.
    pub what: String,
    /// The first term that it concerns.
    pub from: usize,
    /// So many events of the kind are to be expected from one path; 1e-6: from a million paths one. 0: no number of paths will do.
    pub per_path: f64,
}

/// What a world returns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Which world.
    pub world: World,
    /// How it was made, for tables and legends: `prefix, mis`.
    pub label: String,
    /// The first is the image mean; region means and projections follow.
    pub functionals: Vec<Functional>,
    /// Work done.
    pub cost: Cost,
    /// Kinds of paths that this way of sampling cannot find in this scene; empty if it finds all light.
    #[serde(default)]
    #[serde(alias = "unseen")]
    pub unsampled: Vec<UnsampledPaths>,
    /// What its samples cannot know: kinds of paths that they meet only by chance. Until enough have been met error bars are too
    /// small, and nothing in the samples says so; the events of the estimates are therefore no more than are to be expected.
    #[serde(default)]
    pub doubts: Vec<Doubt>,
    /// Why no comparison with this result is decided, if none is: the scene has no right answer.
    #[serde(default)]
    pub undecided: Option<String>,
    /// Whether the tail and the whole have a finite variance.
    #[serde(default)]
    pub variance: Variance,
}

impl Series {
    /// The first term that two results do not both estimate, and what one of them leaves out there; nothing if each finds the
    /// paths that the other finds.
    pub fn gap(&self, other: &Self) -> Option<(usize, String)> {
        let only = |a: &Self, b: &Self| -> Vec<(usize, String)> {
            let missing = a.unsampled.iter().filter(|p| !b.unsampled.contains(p));
            missing.map(|p| (p.from, format!("{} does not see {}", a.label, p.what))).collect()
        };
        only(self, other).into_iter().chain(only(other, self)).min()
    }

    /// The events of the kind that a doubt names, as many as are to be expected.
    pub fn expected(&self, doubt: &Doubt) -> f64 {
        doubt.per_path * self.cost.paths as f64
    }

    /// The same with doubts: what they concern rests on no more events than they allow.
    #[must_use]
    pub fn doubted(mut self, doubts: Vec<Doubt>) -> Self {
        for doubt in &doubts {
            let most = self.expected(doubt);
            let estimates = self.functionals.iter_mut().flat_map(|f| f.made_of(doubt.from));
            estimates.filter_map(|e| e.events.as_mut()).for_each(|e| e.mean = e.mean.min(most));
        }
        Self { doubts, ..self }
    }

    /// The terms k < `end` alone: no tail, and a whole that means nothing else's.
    #[must_use]
    pub fn before(&self, end: usize) -> Self {
        let mut cut = self.clone();
        for f in &mut cut.functionals {
            f.terms.truncate(end);
            f.tail = Estimate::NONE;
        }
        cut
    }

    /// Takes back the error bars of the tail and of the whole, unless their variance is finite.
    pub fn judge(&mut self, variance: Variance) {
        self.variance = variance;
        let Some(instead) = variance.instead() else { return };
        for f in &mut self.functionals {
            for e in [&mut f.tail, &mut f.total].into_iter().filter(|e| e.replicates > 0) {
                e.std_error = DVec3::splat(instead);
            }
        }
    }

    /// The image means.
    pub fn image(&self) -> &Functional {
        &self.functionals[0]
    }
}
