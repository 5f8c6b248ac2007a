//! Both sides of the equation at points, and what rests on some of them.

use crate::scene::Vertex;
use crate::stats::{Evidence, Measured, estimate, two_sided_p};
use crate::terms::{Estimate, Events, TermFilm, Variance};
use glam::DVec3;

/// Both sides at one point.
#[derive(Clone, Debug)]
pub struct Balance {
    /// Where.
    pub at: Vertex,
    /// E, exactly.
    pub emission: DVec3,
    /// L.
    pub left: Estimate,
    /// E + T L.
    pub right: Estimate,
    /// d, replicate by replicate.
    pub differences: Vec<DVec3>,
    /// The mean of d over channels is 0; NaN where both sides have no noise.
    pub p: f64,
    /// The same channel by channel.
    pub channels: [f64; 3],
    /// Whether L by such paths has a variance.
    pub variance: Variance,
}

impl Balance {
    pub(super) fn of(film: &TermFilm, pixel: usize, at: Vertex, emission: DVec3, variance: Variance) -> Self {
        let side = |slot: usize| -> Vec<DVec3> {
            (0..film.shape.replicates).map(|r| film.sum(pixel, r, slot) / film.count(pixel, r)).collect()
        };
        let (l, r) = (side(0), side(1));
        let differences: Vec<DVec3> = l.iter().zip(&r).map(|(l, r)| *l - *r).collect();
        let p = |m: Measured| if m.std_error == 0.0 { f64::NAN } else { two_sided_p(m.mean / m.std_error, m.dof) };
        let events = |slot: usize, replicates: &[DVec3]| {
            let sum: f64 = replicates.iter().enumerate().map(|(r, x)| x.element_sum() * film.count(pixel, r)).sum();
            let square = film.square(pixel, slot);
            Some(Events::equal(if square > 0.0 { sum * sum / square } else { 0.0 }))
        };
        let d = estimate(&differences);
        let mean = estimate(&differences.iter().map(|d| DVec3::splat(d.element_sum() / 3.0)).collect::<Vec<_>>());
        Self {
            at,
            emission,
            p: p(Measured::of(&mean, 0)),
            channels: [0, 1, 2].map(|c| p(Measured::of(&d, c))),
            left: Estimate { events: events(0, &l), ..estimate(&l) },
            right: Estimate { events: events(1, &r), ..estimate(&r) },
            differences,
            variance,
        }
    }

    /// What both sides rest on.
    pub fn evidence(&self) -> Evidence {
        let of = |side: &Estimate| Evidence::of_events(side.events.unwrap_or(Events::equal(0.0)));
        Evidence::of_variance(self.variance).and(of(&self.left)).and(of(&self.right))
    }

    /// Whether the point is judged by itself. Equal without noise is no test at all.
    pub fn judged(&self) -> bool {
        self.evidence().no_verdict.is_none() && !self.p.is_nan()
    }
}

/// The events behind the mean of one side over some points.
fn events<'a>(sides: impl Iterator<Item = &'a Estimate>) -> Events {
    let add = |(sum, square): (f64, f64), e: &Estimate| {
        let (m, n) = (e.mean.element_sum(), e.events.map_or(0.0, |e| e.mean));
        (sum + m, square + if n > 0.0 { m * m / n } else { 0.0 })
    };
    let (sum, square) = sides.fold((0.0, 0.0), add);
    Events::equal(if square > 0.0 { sum * sum / square } else { 0.0 })
}

/// What the mean over some points rests on.
pub fn evidence(balances: &[&Balance]) -> Evidence {
    let [left, right] = [events(balances.iter().map(|b| &b.left)), events(balances.iter().map(|b| &b.right))];
    let variance = balances.first().map_or(Variance::Finite, |b| b.variance);
    Evidence::of_variance(variance).and(Evidence::of_events(left)).and(Evidence::of_events(right))
}

/// The mean of d over some points, with the error of its replicates.
pub fn aggregate(balances: &[&Balance]) -> Estimate {
    let n = balances.len() as f64;
    let replicates = balances.first().map_or(0, |b| b.differences.len());
    let mean = |r: usize| balances.iter().map(|b| b.differences[r]).sum::<DVec3>() / n;
    estimate(&(0..replicates).map(mean).collect::<Vec<_>>())
}
