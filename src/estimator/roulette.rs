//! Russian roulette as data: q is the probability of **termination**, the weight of survival is 1/(1 − q).
//!
//! q\[v\] is tested at surface vertex v = 0, 1, … after that vertex is scored (its emission and its connection). The
//! probability of reaching vertex v is `Q_v = Π_{i<v} (1 − q[i])`, and `E[ X·1{v reached}/Q_v ] = X`: unbiased term by term
//! whatever the schedule. A path may also go on as n walks of weight 1/(1 − q) each, with E\[n\] = 1 − q > 1: a negative q.
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
//! Reference for roulette by expected contribution: Vorba and Křivánek, *Adjoint-Driven Russian Roulette and Splitting in Light
//! Transport Simulation* (2016).

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
fn at_last(v: usize) -> f32 {
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
    /// 0 before `from`, then q = 1 − (what is still expected of the path)/(what was expected of it at its start), at least 0 and at
    /// most 0.9: adjoint-driven roulette. The transport must know what to expect ([`Transport::expected`]); where it does not, as
    /// [`Self::Albedo`].
    Contribution {
        /// First vertex with roulette.
        from: usize,
    },
    /// A weight window: w = (what is still expected of the path)/(what was expected of it at its start). Below ½ it survives
    /// with probability 2w, at least 0.1; above 1 it splits into w walks in the mean, at most 8, which is a negative
    /// q = 1 − w. Estimators that do not split take that for 0.
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
const WINDOW: f32 = 0.5;

impl Roulette {
    /// Into how many a path may split at one vertex.
    pub const MOST: u32 = 8;

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
            Self::Albedo { from } | Self::Contribution { from } | Self::Window { from } => {
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
            Self::Albedo { .. } | Self::Throughput { .. } | Self::Contribution { .. } | Self::Window { .. } => None,
        }
    }

    /// From this vertex on the schedule is the same everywhere.
    pub fn settled(&self) -> usize {
        match self {
            Self::Never => 0,
            Self::Table(q) => q.len().saturating_sub(1),
            Self::Constant { from, .. }
            | Self::Albedo { from }
            | Self::Throughput { from }
            | Self::Contribution { from }
            | Self::Window { from } => *from,
        }
    }

    /// The same q before vertex `v`, as a table, and `q` from there on; none where it is not the same on every path.
    pub fn then(&self, v: usize, q: f64) -> Option<Self> {
        let before: Option<Vec<f64>> = (0..v).map(|i| self.fixed(i)).collect();
        before.map(|table| Self::Table(table.into_iter().chain([q]).collect()))
    }

    /// q at vertex `v` of a path that stands at a state with this throughput, after it has been scored there; `start` is what was expected
    /// of the path at its start, 0 if nobody knew. Below 0 it splits into 1 − q copies in the mean.
    #[inline(always)]
    pub fn q<T: Transport>(&self, t: &T, v: usize, throughput: Rgb, at: &T::State, start: f32) -> f32 {
        let q = self.own(t, v, throughput, at, start);
        match t.last_resort() {
            Some((from, last)) if v >= from && q >= 0.0 && self.fixed(v).is_none() && !self.sleeps(v) => q.max(last),
            _ => q,
        }
    }

    /// The same before the last resort of the scene.
    #[inline(always)]
    fn own<T: Transport>(&self, t: &T, v: usize, throughput: Rgb, at: &T::State, start: f32) -> f32 {
        if let Self::Contribution { from } | Self::Window { from } = self
            && v >= *from
            && start > 0.0
            && let Some(expected) = t.expected(at)
        {
            let w = throughput.element_sum() * expected.indirect / (t.lit().element_sum() * start);
            let copies = match self {
                Self::Contribution { .. } => w.min(1.0),
                _ if w < WINDOW => w / WINDOW,
                _ => w.clamp(1.0, Self::MOST as f32),
            };
            // what splits is heavy, and ends sooner or later by becoming light: only its survival is bounded
            return 1.0 - if copies > 1.0 { copies } else { copies.max(LEAST_SURVIVAL).min(at_last(v)) };
        }
        self.termination(v, throughput, t.albedo(at))
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

    /// Whether q is 0 at vertex `v` on every path: nothing to draw.
    pub fn sleeps(&self, v: usize) -> bool {
        match self {
            Self::Never => true,
            Self::Constant { from, q } => v < *from || *q == 0.0,
            Self::Table(q) => q.get(v).or(q.last()).is_none_or(|&q| q == 0.0),
            Self::Albedo { from } | Self::Throughput { from } | Self::Contribution { from } | Self::Window { from } => {
                v < *from
            }
        }
    }

    /// Whether paths end with probability 1. Where they do not, estimators stop at the last term and report no tail.
    pub fn ends(&self) -> bool {
        match self {
            Self::Never => false,
            Self::Constant { q, .. } => *q > 0.0,
            Self::Table(q) => q.last().is_some_and(|&q| q > 0.0),
            Self::Albedo { .. } | Self::Throughput { .. } | Self::Contribution { .. } | Self::Window { .. } => true,
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
            Self::Contribution { from } => Self::Contribution { from: from.max(v) },
            Self::Window { from } => Self::Window { from: from.max(v) },
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
            Self::Contribution { from } => write!(f, "contribution@{from}"),
            Self::Window { from } => write!(f, "window@{from}"),
        }
    }
}

/// `none`, `lecture`, `constant:Q@V`, `table:q0,q1,…`, `albedo[@V]`, `throughput[@V]`, `contribution[@V]`, `window[@V]`.
impl FromStr for Roulette {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let grammar =
            "none, lecture, constant:Q@V, table:q0,q1,…, albedo[@V], throughput[@V], contribution[@V] or window[@V]";
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
                "contribution" => Ok(Self::Contribution { from: from.unwrap_or(1) }),
                "window" => Ok(Self::Window { from: from.unwrap_or(0) }),
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
        for s in [
            "none",
            "lecture",
            "constant:0.25@3",
            "table:0,0,0.5",
            "albedo@2",
            "throughput@0",
            "contribution@1",
            "window@0",
        ] {
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

    /// The mean of copies · weight over u is 1, whatever q; and a path that has split often enough goes on alone.
    #[test]
    fn copies_carry_the_weight_of_the_path() {
        for q in [0.9, 0.25, 0.0, -0.25, -1.0, -3.4, 1.0 - Roulette::MOST as f32] {
            let mean = |siblings| {
                let one = |i: u32| Roulette::copies(q, (i as f32 + 0.5) / 4096.0, siblings);
                assert!((0..4096).all(|i| one(i).0 <= Roulette::MOST));
                (0..4096).map(|i| f64::from(one(i).0) * f64::from(one(i).1)).sum::<f64>() / 4096.0
            };
            assert!((mean(1) - 1.0).abs() < 1e-3 && (mean(CROWD) - 1.0).abs() < 1e-3, "{q}");
            assert!(q >= 0.0 || Roulette::copies(q, 0.999, CROWD) == (1, 1.0));
        }
    }

    #[test]
    fn after_spares_the_first_vertices_only() {
        let r = Roulette::Table(vec![0.1, 0.2]).after(3);
        assert_eq!(r, Roulette::Table(vec![0.0, 0.0, 0.0, 0.2]));
        assert_eq!(Roulette::LECTURE.after(8), Roulette::Constant { from: 8, q: 0.5 });
    }
}
