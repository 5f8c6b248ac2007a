//! Russian roulette as data: q is the probability of **termination**, and survivors get the weight 1/(1 − q).
//!
//! q\[v\] is applied at surface vertex v = 0, 1, … after that vertex is scored (its emission and its connection). The
//! probability of reaching vertex v is `Q_v = Π_{i<v} (1 − q[i])`. Since `E[ X·1{v reached}/Q_v ] = X`, every schedule is
//! unbiased term by term.
//!
//! The variance limits how large q may be (ρ: reflectance, F: form factors). With constant survival probability s = 1 − q it
//! is finite only where the spectral radius of ρ²F/s is below 1 (`q < 1 − ρ²` in a furnace). The *measured* variance can be
//! trusted only where the fourth moment is finite (`ρ⁴ < (1 − q)³`). With s = ρ the operator ρ²F/s is T itself.
//! `engine::known::growth` measures the spectral radius where it is not known.
//!
//! Roulette by albedo never ends a path where the albedo is 1, or is only known to be at most 1. Two more rules end such
//! paths. Neither makes a finite variance infinite:
//!
//! | rule | from vertex | why it is harmless |
//! |---|---|---|
//! | survive with probability α/τ where the throughput α is below τ = 1/16 | 128 | survivors weigh τ < 1: `E[X²] ≤ 2 max(α) Σ_k (k + 1) T^k`, finite where r(T) < 1 |
//! | survive with probability 1 − 2/v | V = 16384 | weights grow like v², and `Σ_v v² r^v` is finite for every r < 1; the mean length is 2V vertices |
//!
//! Here r = r(T) is the spectral radius. Where r < 1 − q is known for a constant q, that q is used instead of the two rules:
//! [`Transport::last_resort`]. Channels in which nothing emits, or in which a path carries nothing any more, are ignored.
//!
//! Where a guide estimates how much light is still to come, walks may end or split by that estimate: `guide::expected`.

use crate::math::Rgb;
use crate::operator::Transport;
use std::{fmt, str::FromStr};

/// From this vertex on, paths with a throughput below this value survive with exactly this value. The rule is needed because
/// an albedo may be a bound that is 1 where light is lost, as in a hollow ball of rough metal.
const FAINT: (usize, f32) = (128, 1.0 / 16.0);
/// From this vertex V on, paths survive with probability at most 1 − 2/v. Then V²/v² of them reach vertex v, and their mean
/// length is 2V.
const LONG: usize = 16_384;

/// The largest survival probability at vertex `v` with which every path still ends eventually.
#[inline(always)]
pub(crate) fn at_last(v: usize) -> f32 {
    if v < LONG { 1.0 } else { 1.0 - 2.0 / v as f32 }
}

/// A schedule of termination probabilities.
#[derive(Clone, Debug, PartialEq)]
pub enum Roulette {
    /// Paths never end by roulette.
    Never,
    /// q = 0 at vertices before `from`, then the constant `q`. The lecture's schedule is 0, 0, then 0.5.
    Constant {
        /// First vertex with roulette.
        from: usize,
        /// Probability of termination.
        q: f64,
    },
    /// q\[v\] as listed; the last entry holds for all later vertices.
    Table(Vec<f64>),
    /// q = 0 before `from`, then q = 1 − the largest channel of the albedo. This is the analog walk. Its variance is finite
    /// where r(T) < 1 and no weight exceeds the albedo. The [module](self) states the rules that end paths where the albedo
    /// is 1.
    Albedo {
        /// First vertex with roulette.
        from: usize,
    },
    /// q = 0 before `from`, then q = 1 − the largest channel of the throughput so far, at least 0.
    Throughput {
        /// First vertex with roulette.
        from: usize,
    },
}

impl Roulette {
    /// The lecture's schedule: no roulette at the first two vertices, then q = 0.5.
    pub const LECTURE: Self = Self::Constant { from: 2, q: 0.5 };

    /// q at vertex `v` of a path with this throughput, at a surface with this albedo.
    #[inline(always)]
    pub fn termination(&self, v: usize, throughput: Rgb, albedo: Rgb) -> f32 {
        match self {
            Self::Never => 0.0,
            Self::Constant { from, q } => {
                if v < *from {
                    0.0
                } else {
                    *q as f32
                }
            }
            Self::Table(q) => q.get(v).or(q.last()).map_or(0.0, |&q| q as f32),
            Self::Albedo { from } => {
                if v < *from {
                    return 0.0;
                }
                // a channel that carries nothing is ignored
                let carried = Rgb::select(throughput.cmpgt(Rgb::ZERO), albedo, Rgb::ZERO);
                let s = carried.max_element().clamp(0.0, 1.0);
                if v < FAINT.0 {
                    return 1.0 - s;
                }
                1.0 - (s * (throughput.max_element() / FAINT.1).min(1.0)).min(at_last(v))
            }
            Self::Throughput { from } => {
                if v < *from {
                    0.0
                } else {
                    1.0 - throughput.max_element().clamp(0.0, at_last(v))
                }
            }
        }
    }

    /// q at vertex `v` if it is the same on every path; None if it follows the albedo or the throughput.
    pub fn fixed(&self, v: usize) -> Option<f64> {
        match self {
            Self::Never => Some(0.0),
            Self::Constant { from, q } => Some(if v < *from { 0.0 } else { *q }),
            Self::Table(q) => Some(q.get(v).or(q.last()).copied().unwrap_or(0.0)),
            Self::Albedo { .. } | Self::Throughput { .. } => None,
        }
    }

    /// The first vertex from which on the rule of the schedule does not change any more.
    pub fn settled(&self) -> usize {
        match self {
            Self::Never => 0,
            Self::Table(q) => q.len().saturating_sub(1),
            Self::Constant { from, .. } | Self::Albedo { from } | Self::Throughput { from } => *from,
        }
    }

    /// A table with the same q before vertex `v`, and `q` from there on. None if q before `v` is not the same on every path.
    pub fn then(&self, v: usize, q: f64) -> Option<Self> {
        let before: Option<Vec<f64>> = (0..v).map(|i| self.fixed(i)).collect();
        before.map(|table| Self::Table(table.into_iter().chain([q]).collect()))
    }

    /// The probability q that the path ends at vertex `v`, where it has state `at` and this throughput. It is used after the light
    /// found at the vertex has been added. If no other rule ends the path, it includes the
    /// transport's last resort.
    #[inline(always)]
    pub fn q<T: Transport>(&self, t: &T, v: usize, throughput: Rgb, at: &T::State) -> f32 {
        let q = self.termination(v, throughput, t.albedo(at));
        match t.last_resort() {
            Some((from, last)) if v >= from && self.fixed(v).is_none() && !self.sleeps(v) => q.max(last),
            _ => q,
        }
    }

    /// Returns true if q is 0 at vertex `v` on every path, so that no random number is needed.
    pub fn sleeps(&self, v: usize) -> bool {
        match self {
            Self::Never => true,
            Self::Constant { from, q } => v < *from || *q == 0.0,
            Self::Table(q) => q.get(v).or(q.last()).is_none_or(|&q| q == 0.0),
            Self::Albedo { from } | Self::Throughput { from } => v < *from,
        }
    }

    /// Returns true if paths end with probability 1. Otherwise estimators stop at the last term and report no tail.
    pub fn ends(&self) -> bool {
        match self {
            Self::Never => false,
            Self::Constant { q, .. } => *q > 0.0,
            Self::Table(q) => q.last().is_some_and(|&q| q > 0.0),
            Self::Albedo { .. } | Self::Throughput { .. } => true,
        }
    }

    /// The same schedule without roulette before vertex `v`: the terms k ≤ v keep all their samples.
    #[must_use]
    pub fn after(self, v: usize) -> Self {
        match self {
            Self::Never => Self::Never,
            Self::Constant { from, q } => Self::Constant { from: from.max(v), q },
            Self::Albedo { from } => Self::Albedo { from: from.max(v) },
            Self::Throughput { from } => Self::Throughput { from: from.max(v) },
            Self::Table(mut q) => {
                let last = q.last().copied().unwrap_or(0.0);
                q.resize(q.len().max(v + 1), last);
                q[..v].fill(0.0);
                Self::Table(q)
            }
        }
    }
}

impl fmt::Display for Roulette {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Never => write!(f, "none"),
            Self::Constant { from: 2, q: 0.5 } => write!(f, "lecture"),
            Self::Constant { from, q } => write!(f, "constant:{q}@{from}"),
            Self::Table(q) => write!(f, "table:{}", q.iter().map(f64::to_string).collect::<Vec<_>>().join(",")),
            Self::Albedo { from } => write!(f, "albedo@{from}"),
            Self::Throughput { from } => write!(f, "throughput@{from}"),
        }
    }
}

/// Grammar: `none`, `lecture`, `constant:Q@V`, `table:q0,q1,…`, `albedo[@V]`, `throughput[@V]`.
impl FromStr for Roulette {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let grammar = "none, lecture, constant:Q@V, table:q0,q1,…, albedo[@V] or throughput[@V]";
        let (head, from) = match s.split_once('@') {
            Some((head, v)) => {
                (head, Some(v.parse().map_err(|_| format!("`{v}` is not a vertex number; use {grammar}"))?))
            }
            None => (s, None),
        };
        let q = |s: &str| match s.trim().parse::<f64>() {
            Ok(q) if (0.0..1.0).contains(&q) => Ok(q),
            _ => Err(format!("q = `{s}` is not a probability of termination in [0, 1)")),
        };
        match head.split_once(':') {
            None => match head {
                "none" => Ok(Self::Never),
                "lecture" => Ok(Self::LECTURE),
                "albedo" => Ok(Self::Albedo { from: from.unwrap_or(2) }),
                "throughput" => Ok(Self::Throughput { from: from.unwrap_or(2) }),
                _ => Err(format!("unknown roulette `{s}`; use {grammar}")),
            },
            Some(("constant", value)) => Ok(Self::Constant { from: from.unwrap_or(2), q: q(value)? }),
            Some(("table", values)) if from.is_none() => {
                Ok(Self::Table(values.split(',').map(q).collect::<Result<_, _>>()?))
            }
            Some(_) => Err(format!("unknown roulette `{s}`; use {grammar}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grammar_round_trips() {
        for s in ["none", "lecture", "constant:0.25@3", "table:0,0,0.5", "albedo@2", "throughput@0"] {
            assert_eq!(s.parse::<Roulette>().map(|r| r.to_string()), Ok(s.to_string()));
        }
        for s in ["half", "constant:1@0", "table:0.1,x", "constant:-0.1", "lecture:2"] {
            assert!(s.parse::<Roulette>().is_err(), "{s}");
        }
    }

    /// Every path ends, also where the albedo is only known to be at most 1. Weights grow more slowly than any geometric
    /// sequence.
    #[test]
    fn albedo_ends_every_path() {
        let r = Roulette::Albedo { from: 2 };
        assert_eq!(r.termination(1, Rgb::ONE, Rgb::ONE), 0.0);
        assert_eq!(r.termination(2, Rgb::ONE, Rgb::splat(0.25)), 0.75);
        // full weight: no roulette before V, then survival probabilities whose product falls like 1/v²
        assert_eq!(r.termination(LONG - 1, Rgb::ONE, Rgb::ONE), 0.0);
        let survival = |to: usize| (LONG..to).map(|v| 1.0 - f64::from(r.termination(v, Rgb::ONE, Rgb::ONE))).product();
        let (twice, eight): (f64, f64) = (survival(2 * LONG), survival(8 * LONG));
        assert!((twice - 1.0 / 4.0).abs() < 1e-3 && (eight - 1.0 / 64.0).abs() < 1e-3, "{twice} {eight}");
        // the analog walk is unchanged as long as it ends by itself
        assert_eq!(r.termination(10_000, Rgb::ONE, Rgb::splat(0.999)), 1.0 - 0.999);
        // paths with a small throughput are brought up to 1/16, no more
        assert_eq!(r.termination(127, Rgb::splat(1.0 / 64.0), Rgb::ONE), 0.0);
        assert_eq!(r.termination(128, Rgb::splat(1.0 / 64.0), Rgb::ONE), 0.75);
        // a channel that carries nothing keeps no path alive
        assert_eq!(r.termination(2, Rgb::new(0.5, 0.0, 0.0), Rgb::new(0.25, 1.0, 1.0)), 0.75);
        assert_eq!(r.termination(2, Rgb::ZERO, Rgb::ONE), 1.0);
        let throughput = Roulette::Throughput { from: 2 };
        assert_eq!(throughput.termination(LONG, Rgb::ONE, Rgb::ONE), 2.0 / LONG as f32);
    }

    #[test]
    fn after_spares_the_first_vertices_only() {
        let r = Roulette::Table(vec![0.1, 0.2]).after(3);
        assert_eq!(r, Roulette::Table(vec![0.0, 0.0, 0.0, 0.2]));
        assert_eq!(Roulette::LECTURE.after(8), Roulette::Constant { from: 8, q: 0.5 });
    }
}
