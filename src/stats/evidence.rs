//! Evidence behind a number: may an error bar be printed with it, can it have a verdict, and if not, why not?
//!
//! ```text
//! n = min( (Σ x)²/Σ x²,  expected number of events )       n₄ = (Σ x²)²/Σ x⁴       P(x > t) ~ t^(−1/k̂)
//! ```
//!
//! | property of the number | printed with ± | may be judged | symbol |
//! |---|---|---|---|
//! | it rests on n events | n ≥ 100 | n ≥ 400 | [`SHOWN`], [`JUDGED`] |
//! | its variance rests on n₄ events | n₄ ≥ 20 | n₄ ≥ 40 | [`SHOWN_SPREAD`], [`JUDGED_SPREAD`] |
//! | it is a variance, used as a point of a fitted slope | n₄ ≥ 10 | – | [`FITTED_SPREAD`] |
//! | its contributions have the tail index k̂ | k̂ < 0.7 | k̂ < 0.7 | [`TAIL`] |
//! | fewer than 16 replicates, which agree bit for bit | if n ≥ 100 | no difference is ever claimed | [`ALIKE`] |
//! | it is the mean of a picture whose noise comes from n pixels | – | n ≥ 10 | [`JUDGED_PIXELS`] |
//! | it is a pixel, and half the pixels rest on n events | n ≥ 12 and k̂ < 0.7, 8 replicates | – | [`SHOWN_PIXEL`] |
//! | it comes from one replicate | never | never | |
//! | its variance is infinite, or not known to be finite | never | never | [`Variance`] |
//! | it is not finite | never | never | |
//!
//! An event is one nonzero contribution x = r + g + b. **Used:** the means of the replicates and their scatter; Σ x, Σ x²
//! and the largest contributions, all from the film; and, for events that have not happened yet, their expected number
//! ([`Doubt`], from the scene and the sampling method).
//!
//! **Not detected:** a rare event that has not happened, that no doubt names, and that is not in the tail of the events so
//! far. Light through a keyhole is an example. The samples then look like those of a scene without the keyhole.
//!
//! **Why these numbers.** A sum of n events has a skewness of at least 1/√n. At the level that a family of tests needs,
//! z ≈ 5.5, a t-test is then wrong by a factor of about exp(z³/6√n): 4 for n = 400. A 95 % interval needs fewer events. The
//! limits for n₄, and those of n for ±, are chosen so that intervals of skewed sums cover at least 93 %
//! (`tests/evidence.rs`). From k̂ = 0.7 on, even a million samples do not make a mean normal (Vehtari, Simpson, Gelman, Yao
//! and Gabry, *Pareto smoothed importance sampling*, 2024).

use super::hypothesis::{ROUNDING, critical};
use crate::terms::{Doubt, Estimate, Events, Variance};
use serde::Serialize;
use std::fmt;

/// Events that a verdict needs.
pub const JUDGED: f64 = 400.0;
/// Events behind the variance that a verdict needs.
pub const JUDGED_SPREAD: f64 = 40.0;
/// Events that an error bar needs.
pub const SHOWN: f64 = 100.0;
/// Events behind the variance that an error bar needs.
pub const SHOWN_SPREAD: f64 = 20.0;
/// Events behind a variance that serves as a point of a fitted slope.
pub const FITTED_SPREAD: f64 = 10.0;
/// Tail index k̂ from which on no error is known.
pub const TAIL: f64 = 0.7;
/// Pixels from which the noise of a picture must come, for a t-test of its mean, if the samples are not known.
pub const JUDGED_PIXELS: f64 = 10.0;
/// Events on which half the pixels must rest, for the errors of pixels to be trusted.
pub const SHOWN_PIXEL: f64 = 12.0;
/// Replicates that the error of a pixel needs.
pub const PIXEL_REPLICATES: u64 = 8;
/// Fewer replicates than this may agree bit for bit by chance. For this many, the probability is below 2⁻³⁰.
pub const ALIKE: u64 = 16;
/// If a standard error is not reliable enough for a verdict, agreement must not depend on it. The interval must then
/// still fit into δ if its noise is multiplied by 1 + this number.
pub const WIDER: f64 = 9.0;

/// Reason why a number has no error bar, or gives no verdict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// A mean is NaN or infinite.
    NotFinite,
    /// There is only one replicate, which has no scatter.
    OneReplicate,
    /// The variance is infinite.
    Infinite,
    /// The variance is not known to be finite.
    Unknown,
    /// No event was found, or none is expected.
    NoEvent,
    /// The number rests on this many events, which is too few.
    Few(f64),
    /// Its variance rests on this many events, which is too few.
    Uneven(f64),
    /// Its largest contributions have a tail with this index k̂, which is too heavy.
    Tail(f64),
    /// This many replicates, which are too few, agree bit for bit.
    Alike(u64),
    /// There are only this many replicates.
    Replicates(u64),
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite => f.write_str("the mean is NaN or infinite"),
            Self::OneReplicate => f.write_str(
                "the samples form only one group, so their spread is not known: raise the samples per pixel",
            ),
            Self::Infinite => f.write_str("the variance is infinite with this roulette: error bars are meaningless"),
            Self::Unknown => {
                f.write_str("the variance may be infinite with this roulette: error bars cannot be trusted")
            }
            Self::NoEvent => f.write_str("no event (no sample has found light yet): raise the samples per pixel"),
            Self::Few(n) => write!(f, "it rests on only {}: raise the samples per pixel", events(n)),
            Self::Uneven(n) => write!(f, "its standard error rests on only {}: raise the samples per pixel", events(n)),
            Self::Tail(k) => {
                write!(f, "its largest contributions have a heavy tail (k̂ = {k:.1}): its error is unknown")
            }
            Self::Replicates(n) => write!(f, "{n} replicates are too few: raise the samples per pixel"),
            Self::Alike(n) => {
                write!(f, "all {n} replicates are equal, which may be chance: raise the samples per pixel")
            }
        }
    }
}

impl Reason {
    /// Short form for a table cell, in place of ±.
    pub fn short(&self) -> String {
        match *self {
            Self::NotFinite | Self::OneReplicate | Self::Unknown => "–".into(),
            Self::Infinite => "∞".into(),
            Self::NoEvent => "no event".into(),
            Self::Few(n) | Self::Uneven(n) => events(n),
            Self::Tail(k) => format!("k̂ {k:.1}"),
            Self::Alike(n) => format!("{n} equal"),
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

/// Evidence behind a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Reason why there is no error bar; None if there is one.
    pub no_error: Option<Reason>,
    /// Reason why nothing may be rejected; None if a verdict is possible.
    pub no_verdict: Option<Reason>,
}

impl Evidence {
    /// Evidence behind an estimate.
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

    /// Evidence behind an infinite sum (tail or total), from what is known about its variance.
    pub fn of_variance(variance: Variance) -> Self {
        match variance {
            Variance::Finite => Self { no_error: None, no_verdict: None },
            Variance::Infinite => Self::nothing(Reason::Infinite),
            Variance::Unknown => Self::nothing(Reason::Unknown),
        }
    }

    /// Evidence from the events behind a mean.
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

    /// Evidence behind the pixels of an image. Half of them rest on fewer than `median` events; `image` is the estimate of
    /// the image mean.
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

    /// Evidence behind a difference or a ratio of two numbers.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let no_error = self.no_error.or(other.no_error);
        Self { no_error, no_verdict: self.no_verdict.or(other.no_verdict) }
    }
}

/// A doubt as a sentence: which light a result finds only by chance, and what would help.
pub fn doubt_in_words(label: &str, doubt: &Doubt, expected: f64) -> String {
    if doubt.per_path == 0.0 {
        return format!("{label}: {}", doubt.what);
    }
    format!("{label} finds {} only by chance ({} expected): raise the samples per pixel", doubt.what, events(expected))
}

/// Half width of the two-sided 95 % interval of a mean over `replicates` values with the given standard error.
///
/// Exact values (`replicates` = 0) have no width. One replicate gives no error: the result is NaN, and tables show a dash.
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
