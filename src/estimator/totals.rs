//! What a job of a render counts besides the sums on the film. Totals of jobs are added in any order: counts are integers, and
//! the largest of all contributions do not depend on the order.

use crate::terms::film::TermFilm;
use crate::terms::largest::Largest;

/// Totals that a job counts besides the part of the film that it fills.
pub(super) struct Totals {
    pub(super) rays: Vec<u64>,
    pub(super) non_finite: u64,
    pub(super) largest: Vec<Largest>,
}

impl Totals {
    pub(super) fn new(slots: usize) -> Self {
        Self { rays: vec![0; slots], non_finite: 0, largest: vec![Largest::default(); slots] }
    }

    /// Adds two totals. The result does not depend on the order.
    pub(super) fn plus(mut self, other: Self) -> Self {
        self.rays.iter_mut().zip(&other.rays).for_each(|(a, b)| *a += b);
        self.largest.iter_mut().zip(&other.largest).for_each(|(a, b)| a.merge(b));
        self.non_finite += other.non_finite;
        self
    }

    /// Adds the totals of a pass to the film.
    pub(super) fn add_to(&self, film: &mut TermFilm) {
        film.rays.iter_mut().zip(&self.rays).for_each(|(all, more)| *all += more);
        film.largest.iter_mut().zip(&self.largest).for_each(|(all, more)| all.merge(more));
        film.non_finite += self.non_finite;
    }
}
