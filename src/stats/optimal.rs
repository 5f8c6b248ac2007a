//! The most efficient roulette schedule, computed exactly.
//!
//! ```text
//! minimise  V(Q) C(Q) = (Σ_v A_v/Q_v − m) (Σ_v c_v Q_v)        over 1 = Q_0 ≥ Q_1 ≥ … ≥ Q_K > 0
//! ```
//!
//! The symbols are those of [`schedule`](super::schedule): V is the variance, C the cost, Q_v the probability of reaching
//! vertex v. For positive numbers `V C = min_λ (V + λC)²/(4λ)`, attained at λ = V/C. So the best Q minimises V + λC for some
//! λ. This problem is convex and separable. Without the order of the Q_v its solution is `Q_v² = A_v/(λ c_v)`. To keep the
//! order, neighbours that violate it are pooled and share the ratio `r = ΣA/Σc` (pool adjacent violators; the pools do not
//! depend on λ). Finally Q_v is capped at 1:
//!
//! ```text
//! Q_v(λ) = min(1, √(r_v/λ))        r_1 ≥ r_2 ≥ … ≥ r_K
//! ```
//!
//! Only the number λ is left. Suppose the vertices v ≤ j are capped, and let a = Σ_{v≤j} A_v − m and c = Σ_{v≤j} c_v. Then
//! `V C` is smallest at λ = a/c, if that lies in the range r_{j+1} ≤ λ ≤ r_j in which exactly these vertices are capped.
//! Otherwise it is smallest at the nearer end of the range (for a ≤ 0 at the lower end). The best of these K + 1 candidates
//! is the optimum over all schedules, and no iteration is needed.
//!
//! References: Barlow, Bartholomew, Bremner, Brunk, *Statistical Inference under Order Restrictions* (1972) for the pooling;
//! Bolin and Meyer, *An error metric for Monte Carlo ray tracing* (1997), and Rath et al., *EARS* (2022), for efficiency as the
//! aim of roulette.

use super::schedule::Separable;
use crate::estimator::Roulette;

/// The largest termination probability of the optimal schedule at one vertex. Light that no recorded path has found may
/// still exist. With a larger q almost all paths would end before they could find it.
pub const MOST: f64 = 0.9;

/// Q_v, v = 0..=K, of the schedule that minimises V · rays. From a vertex on where nothing is scored any more, Q_v falls
/// towards 0.
pub fn optimal_reach(of: &Separable) -> Vec<f64> {
    let ratios = pooled(&of.second[1..], &of.rays[1..]);
    let at = |lambda: f64| -> Vec<f64> {
        let q = |r: &f64| (r / lambda).sqrt().min(1.0);
        std::iter::once(1.0).chain(ratios.iter().map(q)).collect()
    };
    let (mut a, mut c) = (-of.product, 0.0);
    let (mut best, mut least) = (at(f64::MIN_POSITIVE), f64::INFINITY);
    for j in 0..of.second.len() {
        (a, c) = (a + of.second[j], c + of.rays[j]);
        let upper = if j == 0 { f64::INFINITY } else { ratios[j - 1] };
        let lower = ratios.get(j).copied().unwrap_or(f64::MIN_POSITIVE);
        if upper < lower {
            continue;
        }
        let candidate = at((a / c).max(lower).min(upper));
        let work = of.work(&candidate);
        if work < least {
            (best, least) = (candidate, work);
        }
    }
    best
}

/// The non-increasing ratios r after pooling neighbours that violate the order: r = ΣA/Σc over each pool. A vertex to which
/// no ray leads joins the pool before it.
fn pooled(second: &[f64], rays: &[f64]) -> Vec<f64> {
    // pools from the left: A, c, vertices
    let mut pools: Vec<(f64, f64, usize)> = vec![];
    for (&a, &c) in second.iter().zip(rays) {
        pools.push((a, c, 1));
        while let [.., left, right] = &pools[..]
            && (left.0 * right.1 <= right.0 * left.1)
        {
            let merged = (left.0 + right.0, left.1 + right.1, left.2 + right.2);
            pools.truncate(pools.len() - 2);
            pools.push(merged);
        }
    }
    // Q stays positive where nothing is scored
    let ratio = |a: f64, c: f64| if c > 0.0 { (a / c).max(f64::MIN_POSITIVE) } else { f64::MIN_POSITIVE };
    let ratio = |&(a, c, n): &(f64, f64, usize)| std::iter::repeat_n(ratio(a, c), n);
    pools.iter().flat_map(ratio).collect()
}

/// The schedule that reaches vertex v with probability `reach[v]`, and ends paths with probability `beyond` at the last
/// vertex and all later ones.
pub fn schedule(reach: &[f64], beyond: f64) -> Roulette {
    // rounded to three digits: no efficiency is lost, and a user can type the table
    let q = |w: &[f64]| ((1.0 - w[1] / w[0]).clamp(0.0, MOST) * 1e3).round() / 1e3;
    Roulette::Table(reach.windows(2).map(q).chain([beyond]).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::{Key, Purpose, Rng};
    use crate::stats::schedule::{Part, reach, tests};

    /// Reference implementation by search. From several starts it scales each Q_v, and each run of neighbouring Q_v, up or
    /// down until nothing improves.
    fn by_search(of: &Separable) -> f64 {
        let n = of.second.len();
        let mut least = f64::INFINITY;
        for start in [1.0, 0.9, 0.6, 0.3] {
            let mut q: Vec<f64> = (0..n).map(|v| f64::powi(start, v as i32)).collect();
            let mut step = 0.5;
            while step > 1e-7 {
                let mut gained = false;
                for first in 1..n {
                    for end in first + 1..=n {
                        for factor in [1.0 - step, 1.0 / (1.0 - step)] {
                            let mut tried = q.clone();
                            tried[first..end].iter_mut().for_each(|x| *x *= factor);
                            // restore the order: no value above its predecessor
                            (1..n).for_each(|v| tried[v] = tried[v].min(tried[v - 1]));
                            if of.work(&tried) < of.work(&q) * (1.0 - 1e-13) {
                                (q, gained) = (tried, true);
                            }
                        }
                    }
                }
                if !gained {
                    step *= 0.7;
                }
            }
            least = least.min(of.work(&q));
        }
        least
    }

    #[test]
    fn no_search_finds_a_better_schedule() {
        for case in 0..60_u32 {
            let u = |i: usize| f64::from(Rng::at(Key::new(5, "optimal"), case, i as u32, 0, Purpose::Start).one());
            let n = 3 + case as usize % 5;
            // falling on the whole, with neighbours out of order, and means between zero and the largest possible
            let second: Vec<f64> = (0..n).map(|v| f64::powi(0.45, v as i32) * (0.2 + 2.0 * u(v))).collect();
            let rays: Vec<f64> = (0..n).map(|v| 0.5 + u(20 + v)).collect();
            let product = [0.0, 0.3, 0.8, 0.98][case as usize % 4] * second.iter().sum::<f64>();
            let of = Separable { second, product, rays };
            let q = optimal_reach(&of);
            assert!(q[0] == 1.0 && q.windows(2).all(|w| w[1] <= w[0] && w[1] > 0.0), "{q:?}");
            let (exact, searched) = (of.work(&q), by_search(&of));
            assert!(exact <= searched * (1.0 + 1e-12), "case {case}: {exact} of {of:?}, by search {searched}");
            assert!(
                searched <= exact * (1.0 + 1e-3),
                "case {case}: the search stopped at {searched}, {exact} is there"
            );
        }
    }

    /// In a furnace emission has no variance, so no roulette is best. With emission that varies, `A_v ∝ ρ^{2v}`: Q_v is 1 at
    /// first and then falls by ρ per vertex. That is q = 1 − ρ, and it is better than the best constant schedule.
    #[test]
    fn a_furnace_wants_no_roulette_and_a_sphere_the_analog_walk() {
        let all = Separable::of(&tests::furnace(0.5, 12), Part::All);
        assert!(optimal_reach(&all).iter().all(|&q| q == 1.0));

        let (rho, sigma) = (0.6, 2.0);
        let all = Separable::of(&tests::sphere(rho, 60, sigma * sigma), Part::All);
        let q = optimal_reach(&all);
        for v in 3..50 {
            assert!((q[v + 1] / q[v] - rho).abs() < 1e-6, "vertex {v}: {}", q[v + 1] / q[v]);
        }
        let constants = (1..64).map(|i| f64::from(i) / 100.0);
        let best = constants.map(|q| all.work(&reach(&Roulette::Constant { from: 0, q }, 60).unwrap()));
        assert!(all.work(&q) < 0.99 * best.fold(f64::INFINITY, f64::min));
    }

    #[test]
    fn a_table_has_its_probabilities_of_reaching() {
        let table = schedule(&[1.0, 1.0, 0.5, 0.25, 0.0], 0.2);
        assert_eq!(table, Roulette::Table(vec![0.0, 0.5, 0.5, MOST, 0.2]));
        assert_eq!(reach(&table, 3), Some(vec![1.0, 1.0, 0.5, 0.25]));
    }
}
