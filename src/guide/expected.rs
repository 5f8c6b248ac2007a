//! Walks that end or split by how much light is still to come, where somebody knows about how much that is.
//!
//! ```text
//! w = α · (light expected from here on) / (light expected of the path at its start)
//! contribution:  q = 1 − min(w, 1)                        weight window:  w < ½: q = 1 − 2w     ½ ≤ w ≤ 1: q = 0     w > 1: q = 1 − w < 0
//! ```
//!
//! A path goes on as n walks of weight 1/(1 − q) each, with E\[n\] = 1 − q. For q ≥ 0 that is Russian roulette, for q < 0 the path
//! splits; both are unbiased whatever is expected.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u, T u | reflected light that is expected to leave a state: all, and without what connections find | [`Expected`] |
//! | q | probability of termination, or minus the copies that are added | [`ByExpectation::q`] |
//! | n | how many go on | [`ByExpectation::copies`] |
//!
//! Reference: Vorba and Křivánek, *Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation* (2016).

use crate::estimator::Roulette;
use crate::estimator::roulette::at_last;
use crate::math::Rgb;
use crate::operator::{SceneTransport, Transport};
use std::{fmt, str::FromStr};

/// Reflected radiance that is expected to leave a state, mean of the channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    /// T L: all of it.
    pub all: f32,
    /// T (L − E): what connections from here do not find.
    pub indirect: f32,
}

/// A transport that knows about how much reflected light leaves a state.
pub trait Expecting: Transport {
    /// Nothing where nobody knows.
    fn expected(&self, at: &Self::State) -> Option<Expected>;
}

/// Without a guide nobody knows.
impl Expecting for SceneTransport<'_> {
    fn expected(&self, _: &Self::State) -> Option<Expected> {
        None
    }
}

/// How guided walks end, or split. Where nobody knows what to expect, they end by albedo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByExpectation {
    /// 0 before vertex `from`, then q = 1 − w, at least 0 and at most 0.9: adjoint-driven roulette.
    Contribution {
        /// First vertex with roulette.
        from: usize,
    },
    /// A weight window: below ½ a path survives with probability 2w, at least 0.1; above 1 it splits into w walks in the mean, at
    /// most 8, which is a negative q = 1 − w.
    Window {
        /// First vertex with roulette or splitting.
        from: usize,
    },
}

/// A path that is one of so many copies splits no more: unbiased, since it goes on with weight 1 for certain. Where weights still grow
/// then, `engine::known::growth` sees it.
const CROWD: u32 = 64;
/// Survivors of roulette by contribution weigh no more than ten times what they did; what is lighter still is tested at every
/// vertex, so that paths without a future end after a few.
const LEAST_SURVIVAL: f32 = 0.1;
/// Where less than this part of the pixel is expected of a path, roulette brings the survivors up to it. Between this and 1 nothing
/// happens to a path: to end and to split have a price, too, and where light comes from everywhere ending at 1 costs more than it saves.
const LEAST_SHARE: f32 = 0.5;

impl ByExpectation {
    /// Into how many a path may split at one vertex.
    pub const MOST: u32 = 8;
    /// The usual ones.
    pub const ALL: [Self; 2] = [Self::Contribution { from: 1 }, Self::Window { from: 0 }];

    /// The first vertex at which paths may end or split.
    pub fn from(self) -> usize {
        let (Self::Contribution { from } | Self::Window { from }) = self;
        from
    }

    /// What ends paths where nobody knows what to expect.
    pub fn plain(self) -> Roulette {
        Roulette::Albedo { from: self.from() }
    }

    /// q at vertex `v` of a path that stands at a state with this throughput, after it has been scored there; `start` is what was expected
    /// of the path at its start, 0 if nobody knew. Below 0 it splits into 1 − q copies in the mean.
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
        // what splits is heavy, and ends sooner or later by becoming light: only its survival is bounded
        let q = 1.0 - if copies > 1.0 { copies } else { copies.max(LEAST_SURVIVAL).min(at_last(v)) };
        match t.last_resort() {
            Some((vertex, last)) if v >= vertex && q >= 0.0 => q.max(last),
            _ => q,
        }
    }

    /// How many go on with throughput α/(1 − q), for a uniform number u, of a path that is one of `siblings`; 1 − q in the mean.
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

/// `contribution[@V]`, `window[@V]`.
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
            _ => Err(format!("`{s}` is neither contribution[@V] nor window[@V]")),
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

    /// The mean of copies · weight over u is 1, whatever q; and a path that has split often enough goes on alone.
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
