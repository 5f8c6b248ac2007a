//! Cost and noise of a roulette schedule, predicted from the cross moments of paths without roulette.
//!
//! ```text
//! Q_v = Π_{i<v} (1 − q[i])                       the probability of reaching vertex v
//! E[S_a S_b] = M_ab / Q_{v(a)∧v(b)}              each has weight 1/Q, and both exist if the later vertex is reached
//! Var = Σ_ab ( M_ab / Q_{v(a)∧v(b)} − m_ab )  =  Σ_v A_v / Q_v − m
//! cost = Σ_v c_v Q_v                             rays per path
//! ```
//!
//! This is exact for every schedule that does not depend on the path, since `Q_max / (Q_v(a) Q_v(b)) = 1/Q_min` for each
//! pair of vertices. M_ab and m_ab are the [cross moments](crate::terms::cross_moments) of the slots. The tail is one more
//! slot, at vertex K. It includes everything beyond K, as it was when the moments were recorded.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | v(a), k(a) | vertex and term of a slot | [`Vertices::vertex`], [`Vertices::term`] |
//! | A_v | Σ of M_ab over all pairs of slots whose smaller vertex is v | [`Separable::second`] |
//! | m | Σ of m_ab over all pairs of slots | [`Separable::product`] |
//! | c_v | rays requested once vertex v is reached | [`Separable::rays`] |
//!
//! Efficiency is 1/(V · rays), where V is the variance of one sample, averaged over pixels and channels. Reference for the
//! weight: Arvo and Kirk, *Particle transport and image synthesis* (1990); the sum over vertices is elementary.

use crate::estimator::{Roulette, Vertices};
use crate::terms::cross_moments::{CrossMoments, Recorded, Value};

/// The part of the image whose noise is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// One term.
    Term(usize),
    /// Everything longer than K.
    Tail,
    /// The sum of all terms from this one on, with the tail.
    From(usize),
    /// The whole image.
    All,
}

impl Part {
    /// Indirect light: Σ_{k≥2} T^k E, with the tail. Light that arrives after at least one bounce between lamp and surface
    /// seen.
    pub const INDIRECT: Self = Self::From(2);

    /// Returns true if the part contains term `k`. `tail` is the number K + 1 under which the tail counts as a term.
    fn contains(self, k: usize, tail: usize) -> bool {
        match self {
            Self::Term(own) => own == k && k < tail,
            Self::Tail => k == tail,
            Self::From(first) => k >= first.min(tail),
            Self::All => true,
        }
    }
}

/// Noise and cost as functions of the probabilities of reaching each vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Separable {
    /// A_v, for v = 0..=K.
    pub second: Vec<f64>,
    /// m, the sum of the products of means.
    pub product: f64,
    /// c_v, for v = 0..=K, of the whole path.
    pub rays: Vec<f64>,
}

impl Separable {
    /// Computes A_v, m and c_v of a part of the image from the moments of [`Vertices`], averaged over the channels.
    pub fn of(moments: &CrossMoments, part: Part) -> Self {
        let vertices = moments.slots / 2;
        let mut of = Self { second: vec![0.0; vertices], product: 0.0, rays: vec![0.0; vertices] };
        for (a, rays) in moments.rays.iter().enumerate() {
            of.rays[Vertices::vertex(a)] += rays;
        }
        let wanted = |&a: &usize| part.contains(Vertices::term(a), vertices);
        for a in (0..moments.slots).filter(wanted) {
            for b in (0..moments.slots).filter(wanted) {
                of.second[Vertices::vertex(a.min(b))] += moments.second(a, b);
                of.product += moments.product(a, b);
            }
        }
        of
    }

    /// V: variance of one sample under roulette that reaches vertex v with probability `reach[v]`.
    pub fn variance(&self, reach: &[f64]) -> f64 {
        self.second.iter().zip(reach).map(|(a, q)| a / q).sum::<f64>() - self.product
    }

    /// Rays per path.
    pub fn cost(&self, reach: &[f64]) -> f64 {
        self.rays.iter().zip(reach).map(|(c, q)| c * q).sum()
    }

    /// The variance of one sample times its mean number of rays (the inverse of the efficiency), if paths reach vertex v with
    /// probability `reach[v]`.
    pub fn work(&self, reach: &[f64]) -> f64 {
        self.variance(reach) * self.cost(reach)
    }
}

/// Q_v for v = 0..=`last`; None if q depends on the path.
pub fn reach(schedule: &Roulette, last: usize) -> Option<Vec<f64>> {
    let mut q = 1.0;
    let mut all = vec![q];
    for v in 0..last {
        q *= 1.0 - schedule.fixed(v)?;
        all.push(q);
    }
    Some(all)
}

/// Variance and cost (in rays) of one sample under a schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// V of each term k = 0..=K.
    pub terms: Vec<Value>,
    /// V of the tail.
    pub tail: Value,
    /// V of the whole image.
    pub all: Value,
    /// V of indirect light, [`Part::INDIRECT`].
    pub indirect: Value,
    /// Rays per path.
    pub rays: Value,
    /// 1/(V · rays) of the whole image.
    pub efficiency: Value,
    /// 1/(V · rays) of indirect light.
    pub indirect_efficiency: Value,
}

impl Noise {
    /// Predicts noise and cost from the moments of [`Vertices`], recorded without roulette before vertex K. None if q
    /// depends on the path.
    pub fn predicted(recorded: &Recorded, schedule: &Roulette) -> Option<Self> {
        let last = (recorded.all.slots / 2).checked_sub(1)?;
        let reach = reach(schedule, last)?;
        let variance = |m: &CrossMoments, part: Part| Separable::of(m, part).variance(&reach);
        Some(Self::of(recorded, last, variance, |m| Separable::of(m, Part::All).cost(&reach)))
    }

    /// Measured noise and cost, from the moments of an estimator whose slots are the terms and the tail, with whatever
    /// roulette it used.
    pub fn measured(recorded: &Recorded) -> Self {
        let last = recorded.all.slots.saturating_sub(2);
        Self::of(recorded, last, measured_variance, |m| m.rays.iter().sum())
    }

    /// All numbers, given the variance of each part and the rays per path as functions of the moments.
    fn of(
        recorded: &Recorded,
        last: usize,
        variance: impl Fn(&CrossMoments, Part) -> f64,
        rays: impl Fn(&CrossMoments) -> f64,
    ) -> Self {
        let value = |part: Part| recorded.value(|m| variance(m, part));
        let efficiency = |part: Part| recorded.value(|m| 1.0 / (variance(m, part) * rays(m)));
        Self {
            terms: (0..=last).map(|k| value(Part::Term(k))).collect(),
            tail: value(Part::Tail),
            all: value(Part::All),
            indirect: value(Part::INDIRECT),
            rays: recorded.value(&rays),
            efficiency: efficiency(Part::All),
            indirect_efficiency: efficiency(Part::INDIRECT),
        }
    }
}

/// V of a part of the image, measured: from moments whose slots are the terms and the tail.
pub fn measured_variance(m: &CrossMoments, part: Part) -> f64 {
    let tail = m.slots.saturating_sub(1);
    let slots = || (0..m.slots).filter(|&k| part.contains(k, tail));
    slots().flat_map(|a| slots().map(move |b| (a, b))).map(|(a, b)| m.second(a, b) - m.product(a, b)).sum()
}

/// The ratio of the efficiencies of two schedules for a part of the image, from one recording. Its error accounts for the
/// samples that both share. None if a schedule depends on the path.
pub fn gain(recorded: &Recorded, of: &Roulette, over: &Roulette, part: Part) -> Option<Value> {
    let last = (recorded.all.slots / 2).checked_sub(1)?;
    let (of, over) = (reach(of, last)?, reach(over, last)?);
    Some(recorded.value(|m| {
        let s = Separable::of(m, part);
        s.work(&over) / s.work(&of)
    }))
}

/// The share of a part in the variance of the whole image, without roulette before vertex K.
pub fn share(recorded: &Recorded, part: Part) -> Value {
    recorded.value(|m| {
        let without = vec![1.0; m.slots / 2];
        Separable::of(m, part).variance(&without) / Separable::of(m, Part::All).variance(&without)
    })
}

#[cfg(test)]
pub(super) mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// The moments of a furnace with E = 1, one albedo ρ and hits only: Y_k = ρ^k on every path. The tail is
    /// ρ^{K+1}/(1 − ρ), as if roulette never ended it.
    pub(in super::super) fn furnace(rho: f64, last: usize) -> CrossMoments {
        sphere(rho, last, 0.0)
    }

    /// The same with independent emission of mean 1 and variance σ² at every vertex but the first.
    pub(in super::super) fn sphere(rho: f64, last: usize, variance: f64) -> CrossMoments {
        let slots = Vertices::slots_for(last);
        // hits have even slots; the tail has the last slot, which is odd, and is not affected by roulette here
        let mean = |a: usize| match a {
            _ if a == slots - 1 => rho.powi(last as i32 + 1) / (1.0 - rho),
            _ if a.is_multiple_of(2) => rho.powi(a as i32 / 2),
            _ => 0.0,
        };
        let product: Vec<f64> = (0..slots * slots).map(|i| mean(i / slots) * mean(i % slots)).collect();
        let mut second = product.clone();
        (1..=last).for_each(|v| second[2 * v * slots + 2 * v] += variance * mean(2 * v).powi(2));
        let rays = (0..slots).map(|a| if a > 0 && a % 2 == 0 { 1.0 } else { 0.0 }).collect();
        CrossMoments {
            slots,
            second: [0, 1, 2].map(|_| second.clone()),
            product: [0, 1, 2].map(|_| product.clone()),
            rays,
        }
    }

    fn constant(q: f64) -> Roulette {
        Roulette::Constant { from: 0, q }
    }

    fn near(a: f64, b: f64, what: &str) {
        assert!((a - b).abs() <= 1e-9 * b.abs() + 1e-12, "{what}: {a}, expected {b}");
    }

    /// `Var[T^k] = ρ^{2k}(s^{−k} − 1)`, the covariances, and the whole image for K → ∞: `ρ²q / ((1 − ρ)²(1 − q − ρ²))`.
    #[test]
    fn a_furnace_has_its_closed_forms() {
        for (rho, q) in [(0.5, 0.5), (0.5, 0.1), (0.8, 0.1), (0.7, 0.2), (0.95, 0.02)] {
            let (s, last) = (1.0 - q, 150);
            let m = furnace(rho, last);
            let reach_all = reach(&constant(q), last).unwrap();
            for k in 0..=8 {
                let of = Separable::of(&m, Part::Term(k));
                let expected = f64::powi(rho, 2 * k as i32) * (f64::powi(s, -(k as i32)) - 1.0);
                near(of.variance(&reach_all), expected, &format!("Var T{k}, ρ = {rho}, q = {q}"));
            }
            // the moments of a pair of terms give their covariance ρ^{j+k}(s^{−min(j,k)} − 1)
            let (j, k) = (2, 5);
            let pair = m.second(2 * j, 2 * k) / reach_all[j.min(k)] - m.product(2 * j, 2 * k);
            let power = |x: f64, n: usize| x.powi(n as i32);
            near(pair, power(rho, j + k) * (1.0 / power(s, j.min(k)) - 1.0), "covariance");
            if rho < 0.9 {
                let all = Separable::of(&m, Part::All);
                let expected = rho * rho * q / ((1.0 - rho).powi(2) * (1.0 - q - rho * rho));
                near(all.variance(&reach_all), expected, &format!("whole image, ρ = {rho}, q = {q}"));
                near(all.cost(&reach_all), s * (1.0 - f64::powi(s, last as i32)) / q, "rays");
            }
        }
    }

    /// With emission of variance σ² the variance is `ρ²/(1 − q − ρ²) · (q/(1 − ρ)² + σ²)`. The best constant q is
    /// `(−b + √(b² + a b D))/a` with a = 1/(1 − ρ)², b = σ², D = 1 − ρ². The test finds it by search.
    #[test]
    fn the_best_constant_schedule_of_a_sphere_is_the_known_one() {
        for (rho, sigma) in [(0.5, 1.0), (0.8, 3.0), (0.3, 0.5)] {
            let mut all = Separable::of(&sphere(rho, 120, sigma * sigma), Part::All);
            // the closed form also counts the vertex of the camera
            all.rays[0] += 1.0;
            let work = |q: f64| all.work(&reach(&constant(q), 120).unwrap());
            let (a, b, d) = (1.0 / f64::powi(1.0 - rho, 2), sigma * sigma, 1.0 - rho * rho);
            let best = (-b + (b * b + a * b * d).sqrt()) / a;
            near(
                work(best) * best,
                {
                    let v = rho * rho / (1.0 - best - rho * rho) * (best * a + b);
                    v * (1.0 - f64::powi(1.0 - best, 121))
                },
                "V / q",
            );
            let (mut lo, mut hi) = (1e-3, d - 1e-3);
            for _ in 0..200 {
                let (x, y) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
                if work(x) < work(y) { hi = y } else { lo = x }
            }
            assert!((lo - best).abs() < 1e-4, "ρ = {rho}, σ = {sigma}: {lo}, expected {best}");
        }
    }

    /// The sum of all slots from term k on has the variance of the matrix sum over these slots, for a moment matrix without
    /// structure: nothing of an earlier term enters.
    #[test]
    fn a_sum_from_some_term_on_leaves_earlier_terms_out() {
        let last = 3;
        let slots = Vertices::slots_for(last);
        let entry = |a: usize, b: usize| 1.0 + ((a * b + a + b) % 7) as f64;
        let second: Vec<f64> = (0..slots * slots).map(|i| entry(i / slots, i % slots)).collect();
        let product: Vec<f64> = second.iter().map(|x| 0.25 * x).collect();
        let m = CrossMoments {
            slots,
            second: [0, 1, 2].map(|_| second.clone()),
            product: [0, 1, 2].map(|_| product.clone()),
            rays: vec![1.0; slots],
        };
        let q = [1.0, 0.8, 0.4, 0.1];
        for first in 0..=last + 1 {
            let kept = || (0..slots).filter(|&a| Vertices::term(a) >= first);
            let pairs = kept().flat_map(|a| kept().map(move |b| (a, b)));
            let expected: f64 = pairs.map(|(a, b)| entry(a, b) * (1.0 / q[Vertices::vertex(a.min(b))] - 0.25)).sum();
            near(Separable::of(&m, Part::From(first)).variance(&q), expected, &format!("terms from {first} on"));
        }
        let same = |a: Part, b: Part| assert_eq!(Separable::of(&m, a), Separable::of(&m, b), "{a:?} {b:?}");
        same(Part::From(0), Part::All);
        same(Part::From(last + 1), Part::Tail);
        same(Part::INDIRECT, Part::From(2));
    }

    #[test]
    fn what_depends_on_the_path_has_no_prediction() {
        assert_eq!(reach(&Roulette::Albedo { from: 2 }, 4), None);
        assert_eq!(reach(&Roulette::LECTURE, 4), Some(vec![1.0, 1.0, 1.0, 0.5, 0.25]));
        assert_eq!(Roulette::LECTURE.then(4, 0.1), Some(Roulette::Table(vec![0.0, 0.0, 0.5, 0.5, 0.1])));
    }
}
