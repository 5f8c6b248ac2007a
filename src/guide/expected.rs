//! Roulette and splitting by the light that a path is still expected to find. A guide supplies the expected value.
//!
//! ```text
//! w = α · (light expected from here on) / (light expected of the path at its start)
//! contribution:  q = 1 − min(w, 1)                        weight window:  w < ½: q = 1 − 2w     ½ ≤ w ≤ 1: q = 0     w > 1: q = 1 − w < 0
//! ```
//!
//! α is the throughput of the path. A path goes on as n walks of weight 1/(1 − q) each, with E\[n\] = 1 − q. For q ≥ 0 this
//! is Russian roulette, for q < 0 the path splits. Both are unbiased for every expected value, right or wrong.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T L, T (L − E) | reflected radiance expected to leave a state: all of it, and without the light that connections find | [`Expected`] |
//! | q | probability of termination; if negative, −q is the expected number of added copies | [`ByExpectation::q`] |
//! | n | number of walks that go on | [`ByExpectation::copies`] |
//!
//! Reference: Vorba and Křivánek, *Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation* (2016).

use crate::estimator::Roulette;
use crate::estimator::roulette::at_last;
use crate::math::Rgb;
use crate::operator::{SceneTransport, Transport};
use std::{fmt, str::FromStr};

/// Reflected radiance expected to leave a state, as the mean of the channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// T L: all reflected radiance.
    pub all: f32,
    /// T (L − E): the reflected radiance that connections from this state do not find.
    pub indirect: f32,
}

/// A transport that knows approximately how much reflected light leaves a state.
pub trait Expecting: Transport {
    /// The expected radiance at a state; `None` if it is unknown there.
    fn expected(&self, at: &Self::State) -> Option<Expected>;
}

/// Without a guide the expected radiance is unknown everywhere.
impl Expecting for SceneTransport<'_> {
    fn expected(&self, _: &Self::State) -> Option<Expected> {
        None
    }
}

/// Rule by which guided walks end or split. Where the expected radiance is unknown, they end by albedo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByExpectation {
    /// Adjoint-driven roulette: q = 0 before vertex `from`, then q = 1 − w, clamped to 0 … 0.9.
    Contribution {
        /// First vertex with roulette.
        from: usize,
    },
    /// A weight window. For w below ½ a path survives with probability 2w, at least 0.1. For w above 1 it splits into w
    /// walks on average, at most 8; this is a negative q = 1 − w.
    Window {
        /// First vertex with roulette or splitting.
        from: usize,
    },
}

/// A path that has split into this many copies does not split again. It goes on with certainty and unchanged weight, so the
/// estimate stays unbiased. If weights keep growing after that, `engine::known::growth` detects it.
const CROWD: u32 = 64;
/// Lower bound on the survival probability: one roulette raises a weight at most tenfold. A path that is still lighter is
/// tested at every vertex, so that a path without expected light ends after a few vertices.
const LEAST_SURVIVAL: f32 = 0.1;
/// A path whose w is below this share of the pixel's expected value plays roulette, and survivors get w equal to it. Between
/// this share and 1 nothing happens to a path, because ending and splitting also have a price. Where light comes from
/// everywhere, roulette that begins at w = 1 costs more than it saves.
const LEAST_SHARE: f32 = 0.5;

impl ByExpectation {
    /// Largest number of copies into which a path may split at one vertex.
    pub const MOST: u32 = 8;
    /// The default rules, one of each kind.
    pub const ALL: [Self; 2] = [Self::Contribution { from: 1 }, Self::Window { from: 0 }];

    /// The first vertex at which paths may end or split.
    pub fn from(self) -> usize {
        let (Self::Contribution { from } | Self::Window { from }) = self;
        from
    }

    /// The roulette used where the expected radiance is unknown.
    pub fn plain(self) -> Roulette {
        Roulette::Albedo { from: self.from() }
    }

    /// q at vertex `v` of a path at the state `at` with this throughput, after its contribution there has been added.
    /// `start` is the radiance expected of the path at its start, 0 if unknown. If q is negative, the path splits into 1 − q
    /// copies on average.
    #[inline(always)]
    pub fn q<T: Expecting>(self, t: &T, v: usize, throughput: Rgb, at: &T::State, start: f32) -> f32 {
        if v < self.from() {
            return 0.0;
        }
        let Some(expected) = (start > 0.0).then(|| t.expected(at)).flatten() else {
            return self.plain().q(t, v, throughput, at);
        };
        let w = throughput.element_sum() * expected.indirect / (t.lit().element_sum() * start);
        let copies = match self {
            Self::Contribution { .. } => w.min(1.0),
            Self::Window { .. } if w < LEAST_SHARE => w / LEAST_SHARE,
            Self::Window { .. } => w.clamp(1.0, Self::MOST as f32),
        };
        // a path that splits has a large weight; sooner or later its weight is small and it ends: only survival is bounded
        let q = 1.0 - if copies > 1.0 { copies } else { copies.max(LEAST_SURVIVAL).min(at_last(v)) };
        match t.last_resort() {
            Some((vertex, last)) if v >= vertex && q >= 0.0 => q.max(last),
            _ => q,
        }
    }

    /// The number of copies that go on, for a uniform number u, and the factor 1/(1 − q) for their throughput. The path is
    /// one of `siblings` copies. The mean number of copies is 1 − q.
    #[inline(always)]
    pub fn copies(q: f32, u: f32, siblings: u32) -> (u32, f32) {
        match q {
            q if q < 0.0 && siblings < CROWD => ((1.0 - q + u) as u32, 1.0 / (1.0 - q)),
            q if q <= 0.0 => (1, 1.0),
            q => (u32::from(u >= q), 1.0 / (1.0 - q)),
        }
    }
}

impl fmt::Display for ByExpectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Contribution { from } => write!(f, "contribution@{from}"),
            Self::Window { from } => write!(f, "window@{from}"),
        }
    }
}

/// Parses the name of a rule by which guided paths end, `contribution` or `window`, and optionally `@V`, the first vertex to
/// which it applies.
impl FromStr for ByExpectation {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let (head, from) = match s.split_once('@') {
            Some((head, v)) => (head, Some(v.parse().map_err(|_| format!("`{v}` is not a vertex number"))?)),
            None => (s, None),
        };
        match head {
            "contribution" => Ok(Self::Contribution { from: from.unwrap_or(1) }),
            "window" => Ok(Self::Window { from: from.unwrap_or(0) }),
            _ => Err(format!("`{s}` is not a rule of termination; use contribution[@V] or window[@V]")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grammar_round_trips() {
        for s in ["contribution@1", "window@0", "window@3"] {
            assert_eq!(s.parse::<ByExpectation>().map(|r| r.to_string()), Ok(s.to_string()));
        }
        assert_eq!("window".parse(), Ok(ByExpectation::Window { from: 0 }));
        for s in ["albedo", "window@x", "window:1"] {
            assert!(s.parse::<ByExpectation>().is_err(), "{s}");
        }
    }

    /// The mean of copies · weight over u is 1 for every q, and a path that has split often enough does not split again.
    #[test]
    fn copies_carry_the_weight_of_the_path() {
        for q in [0.9, 0.25, 0.0, -0.25, -1.0, -3.4, 1.0 - ByExpectation::MOST as f32] {
            let mean = |siblings| {
                let one = |i: u32| ByExpectation::copies(q, (i as f32 + 0.5) / 4096.0, siblings);
                assert!((0..4096).all(|i| one(i).0 <= ByExpectation::MOST));
                (0..4096).map(|i| f64::from(one(i).0) * f64::from(one(i).1)).sum::<f64>() / 4096.0
            };
            assert!((mean(1) - 1.0).abs() < 1e-3 && (mean(CROWD) - 1.0).abs() < 1e-3, "{q}");
            assert!(q >= 0.0 || ByExpectation::copies(q, 0.999, CROWD) == (1, 1.0));
        }
    }
}
