//! Russian roulette as data: q is the probability of **termination**, the weight of survival is 1/(1 − q).
//!
//! q\[v\] is tested at surface vertex v = 0, 1, … after that vertex is scored (its emission and its connection). The
//! probability of reaching vertex v is `Q_v = Π_{i<v} (1 − q[i])`, and `E[ X·1{v reached}/Q_v ] = X`: unbiased term by term
//! whatever the schedule.
//!
//! How large q may be is another matter: with constant survival s the variance is finite only where the spectral radius of
//! ρ²F/s is below 1 (`q < 1 − ρ²` in a furnace), and the *measured* variance can be trusted only where the fourth moment is
//! finite (`ρ⁴ < (1 − q)³`). With s = ρ that operator is T itself. `engine::known::growth` measures the radius where it is not known.
//!
//! Roulette by albedo ends no path where the albedo is 1, or is only known to be at most 1. Two rules end those, and neither makes
//! an infinite variance out of a finite one:
//!
//! | rule | from vertex | why it is harmless |
//! |---|---|---|
//! | survive with α/τ where the throughput α is below τ = 1/16 | 128 | survivors weigh τ < 1: `E[X²] ≤ 2 max(α) Σ_k (k + 1) T^k`, finite where r(T) < 1 |
//! | survive with 1 − 2/v | V = 16384 | weights grow like v², and `Σ_v v² r^v` is finite for every r < 1; 2V vertices in the mean |
//!
//! A constant q in their place needs r < 1 − q, and is used where that is known: [`Transport::last_resort`]. Channels in which nothing emits, or in which a path carries nothing any more,
//! have no say.
//!
//! Where somebody knows how much light is still to come, walks may end or split by that: `guide::expected`.

use crate::math::Rgb;
use crate::operator::Transport;
use std::{fmt, str::FromStr};

/// From this vertex on paths that carry less than this are brought up to it: an albedo may be a bound that is 1 where light is
/// lost, as in a hollow ball of rough metal.
const FAINT: (usize, f32) = (128, 1.0 / 16.0);
/// From this vertex V on paths survive with 1 − 2/v at most: V²/v² of them reach vertex v, 2V is their mean length.
const LONG: usize = 16_384;

/// The largest survival at vertex `v` that ends every path at last.
#[inline(always)]
pub(crate) fn at_last(v: usize) -> f32 {
    if v < LONG { 1.0 } else { 1.0 - 2.0 / v as f32 }
}

/// A schedule of termination probabilities.
#[derive(Clone, Debug, PartialEq)]
pub enum Roulette {
    /// Paths never end by roulette.
    Never,
    /// 0 at vertices before `from`, then `q`. The lecture's is 0, 0, then 0.5.
    Constant {
        /// First vertex with roulette.
        from: usize,
        /// Probability of termination.
        q: f64,
    },
    /// q\[v\] as listed; the last entry holds for all later vertices.
    Table(Vec<f64>),
    /// 0 before `from`, then q = 1 − the largest channel of the albedo: the analog walk, whose variance is finite where r(T) < 1 and
    /// no weight exceeds the albedo. The [module](self) says what ends paths where the albedo is 1.
    Albedo {
        /// First vertex with roulette.
        from: usize,
    },
    /// 0 before `from`, then q = 1 − the largest channel of the throughput so far, at least 0.
    Throughput {
        /// First vertex with roulette.
        from: usize,
    },
}

impl Roulette {
    /// The lecture's schedule: none at the first two vertices, then 0.5.
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
                // a channel that carries nothing has no say
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

    /// q at vertex `v` where it is the same on every path; none where it follows the albedo or the throughput.
    pub fn fixed(&self, v: usize) -> Option<f64> {
        match self {
            Self::Never => Some(0.0),
            Self::Constant { from, q } => Some(if v < *from { 0.0 } else { *q }),
            Self::Table(q) => Some(q.get(v).or(q.last()).copied().unwrap_or(0.0)),
            Self::Albedo { .. } | Self::Throughput { .. } => None,
        }
    }

    /// From this vertex on the schedule is the same everywhere.
    pub fn settled(&self) -> usize {
        match self {
            Self::Never => 0,
            Self::Table(q) => q.len().saturating_sub(1),
            Self::Constant { from, .. } | Self::Albedo { from } | Self::Throughput { from } => *from,
        }
    }

    /// The same q before vertex `v`, as a table, and `q` from there on; none where it is not the same on every path.
    pub fn then(&self, v: usize, q: f64) -> Option<Self> {
        let before: Option<Vec<f64>> = (0..v).map(|i| self.fixed(i)).collect();
        before.map(|table| Self::Table(table.into_iter().chain([q]).collect()))
    }

    /// q at vertex `v` of a path that stands at a state with this throughput, after it has been scored there.
    #[inline(always)]
    pub fn q<T: Transport>(&self, t: &T, v: usize, throughput: Rgb, at: &T::State) -> f32 {
        let q = self.termination(v, throughput, t.albedo(at));
        match t.last_resort() {
            Some((from, last)) if v >= from && self.fixed(v).is_none() && !self.sleeps(v) => q.max(last),
            _ => q,
        }
    }

    /// Whether q is 0 at vertex `v` on every path: nothing to draw.
    pub fn sleeps(&self, v: usize) -> bool {
        match self {
            Self::Never => true,
            Self::Constant { from, q } => v < *from || *q == 0.0,
            Self::Table(q) => q.get(v).or(q.last()).is_none_or(|&q| q == 0.0),
            Self::Albedo { from } | Self::Throughput { from } => v < *from,
        }
    }

    /// Whether paths end with probability 1. Where they do not, estimators stop at the last term and report no tail.
    pub fn ends(&self) -> bool {
        match self {
            Self::Never => false,
            Self::Constant { q, .. } => *q > 0.0,
            Self::Table(q) => q.last().is_some_and(|&q| q > 0.0),
            Self::Albedo { .. } | Self::Throughput { .. } => true,
        }
    }

    /// The same schedule with no roulette before vertex `v`: terms k ≤ v keep all their samples.
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

/// `none`, `lecture`, `constant:Q@V`, `table:q0,q1,…`, `albedo[@V]`, `throughput[@V]`.
impl FromStr for Roulette {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let grammar = "none, lecture, constant:Q@V, table:q0,q1,…, albedo[@V] or throughput[@V]";
        let (head, from) = match s.split_once('@') {
            Some((head, v)) => (head, Some(v.parse().map_err(|_| format!("`{v}` is not a vertex number; {grammar}"))?)),
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
                _ => Err(format!("unknown roulette `{s}`; {grammar}")),
            },
            Some(("constant", value)) => Ok(Self::Constant { from: from.unwrap_or(2), q: q(value)? }),
            Some(("table", values)) if from.is_none() => {
                Ok(Self::Table(values.split(',').map(q).collect::<Result<_, _>>()?))
            }
            Some(_) => Err(format!("unknown roulette `{s}`; {grammar}")),
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

    /// Also where the albedo is only known to be at most 1; and weights grow more slowly than any geometric sequence.
    #[test]
    fn albedo_ends_every_path() {
        let r = Roulette::Albedo { from: 2 };
        assert_eq!(r.termination(1, Rgb::ONE, Rgb::ONE), 0.0);
        assert_eq!(r.termination(2, Rgb::ONE, Rgb::splat(0.25)), 0.75);
        // full weight: nothing before V, then a survival whose product falls like 1/v²
        assert_eq!(r.termination(LONG - 1, Rgb::ONE, Rgb::ONE), 0.0);
        let survival = |to: usize| (LONG..to).map(|v| 1.0 - f64::from(r.termination(v, Rgb::ONE, Rgb::ONE))).product();
        let (twice, eight): (f64, f64) = (survival(2 * LONG), survival(8 * LONG));
        assert!((twice - 1.0 / 4.0).abs() < 1e-3 && (eight - 1.0 / 64.0).abs() < 1e-3, "{twice} {eight}");
        // the analog walk is left alone as long as it ends by itself
        assert_eq!(r.termination(10_000, Rgb::ONE, Rgb::splat(0.999)), 1.0 - 0.999);
        // what weighs little comes to weigh 1/16, no more
        assert_eq!(r.termination(127, Rgb::splat(1.0 / 64.0), Rgb::ONE), 0.0);
        assert_eq!(r.termination(128, Rgb::splat(1.0 / 64.0), Rgb::ONE), 0.75);
        // channels that carry nothing keep no path alive
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
