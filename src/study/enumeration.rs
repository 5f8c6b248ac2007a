//! Proof by enumeration that Russian roulette is unbiased: all the ways it can fall on one path.
//!
//! A stream of random numbers fixes a path x_0, x_1, … without roulette, and with it the terms X_0, X_1, … that the path adds.
//! With roulette the path ends at some vertex N, after that vertex is scored. It has then added S_N. The sum over all N,
//!
//! ```text
//! Σ_n P(N = n) S_n = Σ_k X_k,        P(N = n) = q[n] Π_{v<n} (1 − q[v]),        S_n = Σ_{v≤n} X_v / Π_{u<v} (1 − q[u])
//! ```
//!
//! is an equality, not a statistic. It holds term by term, for every path, and whatever q\[v\] depends on along the path.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x_v | vertex v: what it scores, the weight of the step to the next one | [`Stop`] |
//! | q\[v\] | probability that the path ends at vertex v | [`Roulette::termination`] |
//! | n, P(N = n), S_n | one way the roulette can fall: its probability, and what the path has scored until then | [`End`] |
//!
//! The random numbers of the stream choose one n. The tests of the project compare the estimators with S_n of that n. Both
//! together prove that the estimators are unbiased.
//!
//! Reference: Arvo and Kirk, *Particle transport and image synthesis* (SIGGRAPH 1990).

use crate::estimator::{Roulette, Technique};
use crate::math::{Key, Purpose, Rgb, Rng};
use crate::operator::Transport;
use glam::DVec3;

/// What one vertex of the path without roulette holds.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// Emission at the vertex per unit of throughput: part of term v.
    pub hit: Rgb,
    /// Light from the connection to a lamp per unit of throughput: part of term v + 1.
    pub connect: Rgb,
    /// Albedo of the surface.
    pub albedo: Rgb,
    /// Weight of the step to the next vertex; none where the path ends by itself.
    pub weight: Option<Rgb>,
    /// The random number of the stream that decides the roulette here.
    pub number: f32,
}

/// One way the roulette can fall.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// P(N = n).
    pub probability: f64,
    /// S_n, term by term; the last entry holds everything longer.
    pub scored: Vec<DVec3>,
}

/// The path of one stream without roulette, cut after `longest` vertices.
pub fn follow<T: Transport>(
    t: &T,
    start: T::State,
    technique: Technique,
    stream: (Key, u32, u32),
    longest: usize,
) -> Vec<Stop> {
    let (key, pixel, sample) = stream;
    let mut path: Vec<Stop> = vec![];
    let (mut x, mut hit) = (start, t.emission(&start));
    for v in 0..longest {
        let rng = |purpose| Rng::at(key, pixel, sample, v, purpose);
        let number = rng(Purpose::Roulette).one();
        let mut stop = Stop { hit, connect: Rgb::ZERO, albedo: t.albedo(&x), weight: None, number };
        if technique.connects()
            && let Some(c) = t.connect(&x, &mut rng(Purpose::Connect))
        {
            stop.connect = c.weight * t.emission(&c.state) * technique.connection(c.pdf, c.other_pdf);
        }
        let step = t.scatter(&x, &mut rng(Purpose::Scatter));
        stop.weight = step.map(|s| s.weight);
        path.push(stop);
        let Some(step) = step else { break };
        x = step.state;
        hit = if technique.hits(t) { t.emission(&x) * technique.hit(step.pdf, step.other_pdf) } else { Rgb::ZERO };
    }
    path
}

// ANCHOR: ends
/// All the ways the roulette can fall on a path, and the index of the way that the stream takes. Terms longer than `last` are
/// added together.
pub fn ends(path: &[Stop], schedule: &Roulette, last: usize) -> (Vec<End>, usize) {
    let (mut all, mut taken) = (vec![], None);
    let (mut reach, mut alpha, mut scored) = (1.0, Rgb::ONE, vec![DVec3::ZERO; last + 2]);
    for (v, stop) in path.iter().enumerate() {
        scored[v.min(last + 1)] += (alpha * stop.hit).as_dvec3();
        scored[(v + 1).min(last + 1)] += (alpha * stop.connect).as_dvec3();
        let q = schedule.termination(v, alpha, stop.albedo);
        let Some(weight) = stop.weight.filter(|_| v + 1 < path.len()) else {
            all.push(End { probability: reach, scored: scored.clone() }); // the path ends by itself
            break;
        };
        all.push(End { probability: reach * f64::from(q), scored: scored.clone() });
        if stop.number < q && taken.is_none() {
            taken = Some(v);
        }
        if q == 1.0 {
            break;
        }
        reach *= 1.0 - f64::from(q);
        alpha *= 1.0 / (1.0 - q);
        alpha *= weight;
    }
    let last = all.len() - 1;
    (all, taken.unwrap_or(last))
}

/// Σ_n P(N = n) S_n, term by term.
pub fn mean(ends: &[End]) -> Vec<DVec3> {
    let slots = ends.first().map_or(0, |e| e.scored.len());
    (0..slots).map(|k| ends.iter().map(|e| e.probability * e.scored[k]).sum()).collect()
}
// ANCHOR_END: ends

/// The largest errors of the two equalities over some paths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Number of paths.
    pub paths: u64,
    /// Number of ways over all paths.
    pub ends: u64,
    /// Largest |Σ_n P(N = n) − 1|.
    pub probability: f64,
    /// Largest |Σ_n P(N = n) S_n − X| / X over all terms and channels.
    pub term: f64,
}

impl Errors {
    /// Adds one path: the ways it can end, and what it adds without roulette.
    pub fn add(&mut self, path: &[Stop], schedule: &Roulette, last: usize) {
        let (without, _) = ends(path, &Roulette::Never, last);
        let (all, _) = ends(path, schedule, last);
        let Some(x) = without.last() else { return };
        let (sum, mean) = (all.iter().map(|e| e.probability).sum::<f64>(), mean(&all));
        self.paths += 1;
        self.ends += all.len() as u64;
        self.probability = self.probability.max((sum - 1.0).abs());
        for (m, x) in mean.iter().zip(&x.scored) {
            self.term = self.term.max(relative(*m, *x));
        }
    }
}

/// The largest relative difference of a channel. A term that is 0 must be 0.
fn relative(a: DVec3, x: DVec3) -> f64 {
    let of = |c: usize| if x[c] == 0.0 { a[c].abs() } else { ((a[c] - x[c]) / x[c]).abs() };
    of(0).max(of(1)).max(of(2))
}
