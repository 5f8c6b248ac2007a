//! Walks on the matrix that follow a map, and their variance.
//!
//! ```text
//! p_ij = T_ij v_j/(T v)_i        weight of a step  T_ij/p_ij = (T v)_i/v_j        q_i = E_i/(E_i + (T v)_i)
//! X = W E/q where the walk ends,  W = Π weight/(1 − q)        E[X] = B_i for every v > 0        v = B:  X = B_i
//! s_i = E[X²] = E_i²/q_i + Σ_j T_ij (T v)_i/(v_j (1 − q_i)) s_j        s: second moments, infinite if their matrix grows
//! error of the map  ‖v − B‖/‖B − E‖        relative variance  E[(X/B_i − 1)²], mean over the patches
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | v | the map: an estimate of B for every patch | [`values`] |
//! | p, q | probabilities of the next patch, and of the end | `GuidedWalk` |
//! | X | result of one walk | [`walk`] |
//! | s | second moments, from the matrix | [`predicted`] |
//!
//! References: Kahn and Marshall (1953); Kalos and Whitlock, *Monte Carlo Methods* (1986), section 4.4.

use super::{Ingredients, RED};
use fredholm::engine::by_matrix::Matrix;
use fredholm::guide::GuidedWalk;
use fredholm::guide::walk::Row;
use fredholm::math::{Key, Purpose, Rgb, Rng};
use fredholm::operator::matrix::{LinearOperator, PatchOperator};
use fredholm::operator::{MatrixWalk, Step, Transport};
use fredholm::report::book::{Folder, Number};
use fredholm::solver::direct::{self, Singular};
use fredholm::solver::{Iteration, PartialSums, Radiosity};
use rayon::prelude::*;

/// The weight of a step of a walk that follows a map.
pub type StepWeight = fn(&GuidedWalk<'_>, &Row, &Step<Row>) -> f64;

/// The second moments have settled if they change by less than this.
const SETTLED: f64 = 1e-9;
/// If they have not settled after so many steps, they are taken to be infinite.
const MOST: usize = 10_000;
/// Groups of walks, from which the errors are computed.
const GROUPS: u32 = 32;

/// A kind of map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Map {
    /// No map: the next patch by F, the end by 1 − ρ.
    None,
    /// 1/√B: bright where the room is dark.
    Reversed,
    /// The same value everywhere.
    Flat,
    /// The sum of the terms up to n.
    Sum(usize),
    /// B times 1 + σ or 1 − σ, by chance.
    Rough(f64),
    /// B itself.
    Exact,
}

/// All maps, from none to B itself.
const MAPS: [Map; 12] = [
    Map::None,
    Map::Reversed,
    Map::Flat,
    Map::Sum(3),
    Map::Sum(4),
    Map::Sum(6),
    Map::Sum(8),
    Map::Sum(12),
    Map::Rough(0.2),
    Map::Rough(0.1),
    Map::Rough(0.05),
    Map::Exact,
];

/// Number of maps with the values of B in a random order.
pub const ORDERS: u32 = 20;

/// A map, and the walks that follow it.
#[derive(Clone)]
pub struct Walked {
    /// The map.
    pub map: Map,
    /// ‖v − B‖/‖B − E‖; NaN without a map.
    pub error: f64,
    /// Mean of X/B − 1.
    pub bias: Number,
    /// Mean of (X/B − 1)².
    pub variance: Number,
    /// The same from the second moments of the matrix.
    pub predicted: f64,
    /// The largest |X/B − 1|.
    pub largest: f64,
}

/// All maps.
#[derive(Clone)]
pub struct Walks {
    /// One entry for each map.
    pub all: Vec<Walked>,
    /// How many maps with the values of B in a random order have an infinite variance.
    pub infinite: usize,
}

// ANCHOR: walk
/// One walk from a patch. It ends with the probability q, and then its result is W E/q.
fn walk<T: Transport>(
    t: &T,
    mut at: T::State,
    weigh: impl Fn(&T::State, &Step<T::State>) -> f64,
    rng: impl Fn(usize, Purpose) -> Rng,
) -> f64 {
    let mut w = 1.0;
    for v in 0.. {
        let q = f64::from(t.absorption(&at).unwrap_or(1.0 - t.albedo(&at).x));
        if f64::from(rng(v, Purpose::Roulette).one()) < q {
            return w * f64::from(t.emission(&at).x) / q;
        }
        let Some(step) = t.scatter(&at, &mut rng(v, Purpose::Scatter)) else { break };
        w *= weigh(&at, &step) / (1.0 - q);
        at = step.state;
    }
    0.0
}
// ANCHOR_END: walk

/// Walks from every patch: bias, variance and the largest deviation.
fn walked<T: Transport>(
    t: &T,
    start: impl Fn(u32) -> T::State + Sync,
    weigh: impl Fn(&T::State, &Step<T::State>) -> f64 + Sync,
    b: &[f64],
    (walks, key): (u32, Key),
) -> (Number, Number, f64) {
    let group = |g: u32| {
        let (mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0f64);
        for s in (g..walks).step_by(GROUPS as usize) {
            for (i, b) in (0..).zip(b) {
                let off = walk(t, start(i), &weigh, |v, purpose| Rng::at(key, i, s, v, purpose)) / b - 1.0;
                (sum, squares, largest) = (sum + off, squares + off * off, largest.max(off.abs()));
            }
        }
        let n = f64::from(walks / GROUPS) * b.len() as f64;
        (sum / n, squares / n, largest)
    };
    let groups: Vec<(f64, f64, f64)> = (0..GROUPS).into_par_iter().map(group).collect();
    let number = |of: fn(&(f64, f64, f64)) -> f64| {
        let n = f64::from(GROUPS);
        let value = groups.iter().map(of).sum::<f64>() / n;
        let spread: f64 = groups.iter().map(|g| (of(g) - value).powi(2)).sum();
        Number { value, std_error: (spread / (n * (n - 1.0))).sqrt() }
    };
    let largest = groups.iter().map(|g| g.2).fold(0.0, f64::max);
    (number(|g| g.0), number(|g| g.1), largest)
}

/// The values of a map on every patch.
fn values(map: Map, t: &PatchOperator<'_>, e: &[f64], b: &[f64], exact: fn(&[f64], &[f64]) -> Vec<f64>) -> Vec<f64> {
    match map {
        Map::None | Map::Flat => vec![1.0; b.len()],
        Map::Reversed => b.iter().map(|b| b.powf(-0.5)).collect(),
        Map::Sum(n) => {
            let mut sums = PartialSums::new(t, e);
            (0..n).for_each(|_| _ = sums.advance());
            sums.iterate().to_vec()
        }
        Map::Rough(sigma) => {
            let factor = |i: usize| if chance(0, i) < 0.5 { 1.0 - sigma } else { 1.0 + sigma };
            (0..).zip(b).map(|(i, b)| b * factor(i)).collect()
        }
        Map::Exact => exact(b, e),
    }
}

/// A random number for a patch. The maps are the same for every seed of the walks.
fn chance(map: u32, patch: usize) -> f32 {
    Rng::at(Key::new(0, "maps").branch(map), patch as u32, 0, 0, Purpose::Start).one()
}

/// The values of B in a random order.
fn shuffled(b: &[f64], map: u32) -> Vec<f64> {
    let mut order: Vec<usize> = (0..b.len()).collect();
    order.sort_by(|&i, &j| chance(map, i).total_cmp(&chance(map, j)));
    order.into_iter().map(|i| b[i]).collect()
}

// ANCHOR: second
/// The relative variance of walks that follow the map v, by their second moments. It is infinite if these grow for ever.
fn predicted(t: &PatchOperator<'_>, e: &[f64], b: &[f64], v: &[f64]) -> f64 {
    let n = b.len();
    let (mut tv, mut image, mut s) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    t.apply(v, &mut tv);
    let q: Vec<f64> = e.iter().zip(&tv).map(|(e, tv)| e / (e + tv)).collect();
    for _ in 0..MOST {
        // s_i = E_i²/q_i + Σ_j T_ij (T v)_i/(v_j (1 − q_i)) s_j, and E_i/q_i = E_i + (T v)_i
        t.apply(&s.iter().zip(v).map(|(s, v)| s / v).collect::<Vec<f64>>(), &mut image);
        let next: Vec<f64> = (0..n).map(|i| e[i] * (e[i] + tv[i]) + tv[i] / (1.0 - q[i]) * image[i]).collect();
        let change = next.iter().zip(&s).map(|(x, s)| (x - s).abs()).fold(0.0, f64::max);
        s = next;
        if change < SETTLED {
            return s.iter().zip(b).map(|(s, b)| s / (b * b) - 1.0).sum::<f64>() / n as f64;
        }
    }
    f64::INFINITY
}
// ANCHOR_END: second

/// The same without a map: p = F, q = 1 − ρ, and every step that survives has the weight 1.
fn predicted_without(t: &PatchOperator<'_>, e: &[f64], b: &[f64]) -> Result<f64, Singular> {
    let scored: Vec<f64> = e.iter().zip(&t.rho).map(|(e, rho)| e * e / (1.0 - rho)).collect();
    let s = direct::solve(t, &scored)?.x;
    Ok(s.iter().zip(b).map(|(s, b)| s / (b * b) - 1.0).sum::<f64>() / b.len() as f64)
}

impl Walks {
    /// Walks with every map on a matrix.
    pub(super) fn measure(folder: &Folder<'_>, room: &Matrix<Radiosity>, with: &Ingredients) -> Result<Self, Singular> {
        let (t, e) = (room.radiosity.operator(RED), room.radiosity.emission(RED));
        let b: Vec<f64> = room.solution.radiance.iter().map(|b| b[RED]).collect();
        let walks = folder.pick(1 << 16, 1 << 13);
        let one = |(stream, map): (u32, Map)| {
            let amount = (walks, Key::new(folder.seed, "walks").branch(stream));
            let v = values(map, &t, &e, &b, with.map);
            let ((bias, variance, largest), predicted, error) = if map == Map::None {
                let grey = |x: &[f64]| x.iter().map(|&x| Rgb::splat(x as f32)).collect();
                let rows = t.factors.f.iter().map(|&f| f64::from(f)).collect();
                let plain = MatrixWalk::new(rows, grey(&t.rho), grey(&e));
                let found = walked(&plain, |i| i, |_, step| f64::from(step.weight.x), &b, amount);
                (found, predicted_without(&t, &e, &b)?, f64::NAN)
            } else {
                let (predicted, error) = (predicted(&t, &e, &b, &v), distance(&t, &v, &b) / distance(&t, &b, &e));
                let guided = GuidedWalk::whole(&t, &e, v);
                let weigh = |at: &Row, step: &Step<Row>| (with.step)(&guided, at, step);
                (walked(&guided, |row| Row { row, left: 0 }, weigh, &b, amount), predicted, error)
            };
            Ok(Walked { map, error, bias, variance, predicted, largest })
        };
        let infinite = (1..=ORDERS).filter(|&map| predicted(&t, &e, &b, &shuffled(&b, map)).is_infinite()).count();
        Ok(Self { all: (0..).zip(MAPS).map(one).collect::<Result<_, _>>()?, infinite })
    }

    /// The walks that followed this map.
    pub fn of(&self, map: Map) -> Option<&Walked> {
        self.all.iter().find(|w| w.map == map)
    }
}

/// ‖x − y‖ over the patches, by area.
fn distance(t: &PatchOperator<'_>, x: &[f64], y: &[f64]) -> f64 {
    t.norm(&x.iter().zip(y).map(|(x, y)| x - y).collect::<Vec<_>>())
}
