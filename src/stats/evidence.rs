//! What does a number rest on? May an error stand beside it, may a verdict rest on it, and if not, why not?
//!
//! ```text
//! n = min( (Σ x)²/Σ x²,  events that are to be expected )       n₄ = (Σ x²)²/Σ x⁴       P(x > t) ~ t^(−1/k̂)
//! ```
//!
//! | a number | is printed with ± | may be judged | symbol |
//! |---|---|---|---|
//! | rests on n events | n ≥ 100 | n ≥ 400 | [`SHOWN`], [`JUDGED`] |
//! | whose variance rests on n₄ events | n₄ ≥ 20 | n₄ ≥ 40 | [`SHOWN_SPREAD`], [`JUDGED_SPREAD`] |
//! | a variance as a point of a slope | n₄ ≥ 10 | – | [`FITTED_SPREAD`] |
//! | with a tail k̂ | k̂ < 0.7 | k̂ < 0.7 | [`TAIL`] |
//! | of fewer than 16 replicates that agree bit for bit | if n ≥ 100 | never told apart from another | [`ALIKE`] |
//! | of a picture, whose noise n pixels carry | – | n ≥ 10 | [`JUDGED_PIXELS`] |
//! | of a pixel, where half the pixels rest on n events | n ≥ 12 and k̂ < 0.7, 8 replicates | – | [`SHOWN_PIXEL`] |
//! | of one replicate | never | never | |
//! | whose variance is infinite, or not known to be finite | never | never | [`Variance`] |
//! | that is not finite | never | never | |
//!
//! **What it knows.** The replicates' means with their scatter; the film's Σ x, Σ x² and its largest contributions; and of what
//! has not happened yet, how often it is to be expected ([`Doubt`], from the scene and the way of sampling).
//!
//! **What it cannot know.** Something rare that has not happened, that no doubt names, and that is no tail of what has happened:
//! light through a keyhole, say. Then the samples look like those of a scene without the keyhole.
//!
//! **Why these numbers.** A sum of n events has a skewness of at least 1/√n; a t-test at the depth of a family, z ≈ 5.5, is then
//! wrong by a factor of about exp(z³/6√n): 4 for 400. A 95 % interval asks for less. The numbers of n₄ and n for ± are those with which
//! intervals of skewed sums cover at least 93 % (`tests/evidence.rs`). From k̂ = 0.7 on even a million samples do not make a
//! mean normal (Vehtari, Simpson, Gelman, Yao and Gabry, *Pareto smoothed importance sampling*, 2024).

use super::hypothesis::{ROUNDING, critical};
use crate::terms::{Doubt, Estimate, Events, Variance};
use serde::Serialize;
use std::fmt;

/// Events that a verdict needs.
pub const JUDGED: f64 = 400.0;
/// Events behind the variance that a verdict needs.
pub const JUDGED_SPREAD: f64 = 40.0;
/// Events that an error needs.
pub const SHOWN: f64 = 100.0;
/// Events behind the variance that an error needs.
pub const SHOWN_SPREAD: f64 = 20.0;
/// Events behind a variance, for it to be a point of a curve to which a slope is fitted.
pub const FITTED_SPREAD: f64 = 10.0;
/// A tail from which on no error is known.
pub const TAIL: f64 = 0.7;
/// Pixels that must carry the noise of a picture whose samples are not known, for a t-test of its mean.
pub const JUDGED_PIXELS: f64 = 10.0;
/// Events that half the pixels must rest on, for the errors of pixels to be trusted.
pub const SHOWN_PIXEL: f64 = 12.0;
/// Replicates that the error of a pixel needs.
pub const PIXEL_REPLICATES: u64 = 8;
/// Fewer replicates that agree bit for bit may do so by chance; that many do so with a probability below 2⁻³⁰.
pub const ALIKE: u64 = 16;
/// Where a verdict may not rest on an error, agreement must not depend on it: the interval must fit into δ this many times more.
pub const WIDER: f64 = 9.0;

/// Why a number has no error, or decides nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// A mean is no number.
    NotFinite,
    /// One replicate has no scatter.
    OneReplicate,
    /// The variance is infinite.
    Infinite,
    /// The variance is not known to be finite.
    Unknown,
    /// Nothing was found, or nothing is to be expected.
    NoEvent,
    /// It rests on so many events.
    Few(f64),
    /// Its variance rests on so many.
    Uneven(f64),
    /// Its largest contributions have so heavy a tail.
    Tail(f64),
    /// So few replicates agree bit for bit.
    Alike(u64),
    /// So few replicates there are.
    Replicates(u64),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite => f.write_str("a mean is not finite"),
            Self::OneReplicate => {
                f.write_str("the standard error is unknown: one replicate only (raise the samples per pixel)")
            }
            Self::Infinite => {
                f.write_str("the variance is infinite under this roulette, so that no error bar means anything")
            }
            Self::Unknown => {
                f.write_str("the variance may be infinite under this roulette, so that no error bar can be trusted")
            }
            Self::NoEvent => f.write_str("no event: nothing was found (yet); raise the samples per pixel"),
            Self::Few(n) => write!(f, "it rests on {}: raise the samples per pixel", events(n)),
            Self::Uneven(n) => write!(f, "its error rests on {}: raise the samples per pixel", events(n)),
            Self::Tail(k) => write!(f, "its largest contributions have a heavy tail (k̂ = {k:.1}): no error is known"),
            Self::Replicates(n) => write!(f, "{n} replicates are too few: raise the samples per pixel"),
            Self::Alike(n) => write!(f, "{n} replicates that agree prove nothing: raise the samples per pixel"),
        }
    }
}

impl Reason {
    /// In a cell of a table, in place of ±.
    pub fn short(&self) -> String {
        match *self {
            Self::NotFinite | Self::OneReplicate | Self::Unknown => "–".into(),
            Self::Infinite => "∞".into(),
            Self::NoEvent => "no event".into(),
            Self::Few(n) | Self::Uneven(n) => events(n),
            Self::Tail(k) => format!("k̂ {k:.1}"),
            Self::Alike(n) => format!("{n} alike"),
            Self::Replicates(n) => format!("{n} replicates"),
        }
    }
}

fn events(n: f64) -> String {
    match n {
        n if n < 0.95 => format!("{n:.1} events"),
        n if n < 1.5 => "1 event".into(),
        n => format!("{n:.0} events"),
    }
}

/// What a number rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Why there is no error; nothing where there is one.
    pub no_error: Option<Reason>,
    /// Why nothing may be rejected.
    pub no_verdict: Option<Reason>,
}

impl Evidence {
    /// Of an estimate.
    ///
    /// ```
    /// use fredholm::{stats::{Evidence, evidence::Reason}, terms::{Estimate, Events}};
    /// use glam::DVec3;
    /// let of = |n: f64| Estimate {
    ///     mean: DVec3::ONE, std_error: DVec3::splat(0.1), replicates: 16, events: Some(Events::equal(n)),
    /// };
    /// assert_eq!(Evidence::of(&of(1e4)).no_verdict, None);
    /// assert_eq!(Evidence::of(&of(200.0)).no_error, None);
    /// assert_eq!(Evidence::of(&of(3.0)).no_error, Some(Reason::Few(3.0)));
    /// assert_eq!(Evidence::of(&Estimate::exact(DVec3::ONE)).no_verdict, None);
    /// ```
    pub fn of(e: &Estimate) -> Self {
        if !e.mean.is_finite() {
            return Self::nothing(Reason::NotFinite);
        }
        if e.replicates == 0 {
            return Self { no_error: None, no_verdict: None };
        }
        if e.replicates == 1 {
            return Self::nothing(Reason::OneReplicate);
        }
        if !e.std_error.is_finite() {
            return Self::of_variance(if e.std_error.is_nan() { Variance::Unknown } else { Variance::Infinite });
        }
        let found = e.events.map_or(Self { no_error: None, no_verdict: None }, Self::of_events);
        let alike =
            e.replicates < ALIKE && (0..3).any(|c| e.mean[c] != 0.0 && e.std_error[c] <= ROUNDING * e.mean[c].abs());
        let no_verdict = found.no_verdict.or(alike.then_some(Reason::Alike(e.replicates)));
        Self { no_verdict, ..found }
    }

    /// Of a sum without end, by what is known of its variance.
    pub fn of_variance(variance: Variance) -> Self {
        match variance {
            Variance::Finite => Self { no_error: None, no_verdict: None },
            Variance::Infinite => Self::nothing(Reason::Infinite),
            Variance::Unknown => Self::nothing(Reason::Unknown),
        }
    }

    /// Of what a mean was added up from.
    pub fn of_events(e: Events) -> Self {
        let lacks = |most: f64, spread: f64| match e {
            Events { mean, .. } if mean <= 0.0 => Some(Reason::NoEvent),
            Events { mean, .. } if mean < most => Some(Reason::Few(mean)),
            Events { variance, .. } if variance < spread => Some(Reason::Uneven(variance)),
            Events { tail, .. } if tail >= TAIL => Some(Reason::Tail(tail)),
            _ => None,
        };
        Self { no_error: lacks(SHOWN, SHOWN_SPREAD), no_verdict: lacks(JUDGED, JUDGED_SPREAD) }
    }

    /// Of the pixels of an image, half of which rest on fewer than `median` events, and all on those of `image`.
    pub fn of_pixels(median: f64, image: &Estimate, replicates: u64) -> Self {
        let tail = image.events.map_or(0.0, |e| e.tail);
        let why = match median {
            _ if image.mean == glam::DVec3::ZERO => Some(Reason::NoEvent),
            _ if replicates < PIXEL_REPLICATES => Some(Reason::Replicates(replicates)),
            n if n < SHOWN_PIXEL => Some(Reason::Few(n)),
            _ if tail >= TAIL => Some(Reason::Tail(tail)),
            _ => None,
        };
        Self { no_error: why, no_verdict: why }
    }

    fn nothing(why: Reason) -> Self {
        Self { no_error: Some(why), no_verdict: Some(why) }
    }

    /// Of a difference or a ratio of two.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let no_error = self.no_error.or(other.no_error);
        Self { no_error, no_verdict: self.no_verdict.or(other.no_verdict) }
    }
}

/// What the samples of a result cannot know, and what would help.
pub fn doubt_in_words(label: &str, doubt: &Doubt, expected: f64) -> String {
    if doubt.per_path == 0.0 {
        return format!("{label}: {}", doubt.what);
    }
    format!(
        "{label} meets {} only by chance ({} to be expected): raise the samples per pixel",
        doubt.what,
        events(expected)
    )
}

/// Half width of the two-sided 95 % interval of a mean over `replicates` values with the given standard error.
///
/// Exact values (`replicates` = 0) have no width. One replicate says nothing about its error: NaN, and tables show a dash.
///
/// ```
/// use fredholm::stats::half_width_95;
/// assert_eq!(half_width_95(0.0, 0), 0.0);
/// assert!(half_width_95(1.0, 1).is_nan());
/// assert!((half_width_95(1.0, 16) - 2.131_449_5).abs() < 1e-6);    // 15 degrees of freedom
/// ```
pub fn half_width_95(std_error: f64, replicates: u64) -> f64 {
    match replicates {
        0 => 0.0,
        1 => f64::NAN,
        r => critical(0.05, (r - 1) as f64) * std_error,
    }
}
