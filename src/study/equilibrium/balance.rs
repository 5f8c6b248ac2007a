//! Both sides of the rendering equation at single points, and the [evidence](crate::stats::evidence) behind them: how many
//! samples contributed.

use crate::scene::Vertex;
use crate::stats::{Evidence, Measured, estimate, two_sided_p};
use crate::terms::{Estimate, Events, TermFilm, Variance};
use glam::DVec3;

/// Both sides of L = E + T L at one point.
#[derive(Clone, Debug)]
pub struct Balance {
    /// The point with its direction.
    pub at: Vertex,
    /// E, known exactly.
    pub emission: DVec3,
    /// Estimate of L.
    pub left: Estimate,
    /// Estimate of E + T L.
    pub right: Estimate,
    /// The differences d = L − (E + T L), one per replicate.
    pub differences: Vec<DVec3>,
    /// p-value of the hypothesis that the mean of d over the channels is 0. NaN if both sides have no noise.
    pub p: f64,
    /// The same p-value for each channel separately.
    pub channels: [f64; 3],
    /// States whether the estimator of L has finite variance.
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

    /// The evidence behind both sides, combined: the weaker one decides.
    pub fn evidence(&self) -> Evidence {
        let of = |side: &Estimate| Evidence::of_events(side.events.unwrap_or(Events::equal(0.0)));
        Evidence::of_variance(self.variance).and(of(&self.left)).and(of(&self.right))
    }

    /// Returns true if the point gets its own test. Points at which both sides have no noise get none, because their
    /// equality tests nothing.
    pub fn judged(&self) -> bool {
        self.evidence().no_verdict.is_none() && !self.p.is_nan()
    }
}

/// The number of equal contributions (events) that would carry the mean of one side over several points.
fn events<'a>(sides: impl Iterator<Item = &'a Estimate>) -> Events {
    let add = |(sum, square): (f64, f64), e: &Estimate| {
        let (m, n) = (e.mean.element_sum(), e.events.map_or(0.0, |e| e.mean));
        (sum + m, square + if n > 0.0 { m * m / n } else { 0.0 })
    };
    let (sum, square) = sides.fold((0.0, 0.0), add);
    Events::equal(if square > 0.0 { sum * sum / square } else { 0.0 })
}

/// The evidence behind the mean over several points.
pub fn evidence(balances: &[&Balance]) -> Evidence {
    let [left, right] = [events(balances.iter().map(|b| &b.left)), events(balances.iter().map(|b| &b.right))];
    let variance = balances.first().map_or(Variance::Finite, |b| b.variance);
    Evidence::of_variance(variance).and(Evidence::of_events(left)).and(Evidence::of_events(right))
}

/// The mean of d over several points, with the standard error from its replicates.
pub fn aggregate(balances: &[&Balance]) -> Estimate {
    let n = balances.len() as f64;
    let replicates = balances.first().map_or(0, |b| b.differences.len());
    let mean = |r: usize| balances.iter().map(|b| b.differences[r]).sum::<DVec3>() / n;
    estimate(&(0..replicates).map(mean).collect::<Vec<_>>())
}
