//! Variance as a function of the samples per pixel, from the snapshots of one render.
//!
//! `V(n) = mean over pixels and channels of se²(n)`, with the standard error of the [film](super::film) after n samples.
//!
//! The error of V(n) comes from leaving out replicates, see [`scatter`](super::scatter). So it accounts for the dependence
//! between the colours of a pixel, and for heavy tails. It needs three replicates.

use super::deviations::{Deviations, Piece, bands};
use super::film::TermFilm;
use super::scatter::{Scatter, Sums};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A variance with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variance {
    /// Mean over pixels and channels.
    pub value: f64,
    /// Mean over pixels, for each channel.
    pub channels: DVec3,
    /// Standard error of `value`; NaN with fewer than three replicates.
    pub std_error: f64,
}

impl From<&Scatter> for Variance {
    fn from(s: &Scatter) -> Self {
        Self { value: s.variance(), channels: s.channels, std_error: s.variance_error() }
    }
}

/// The variances at one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Samples per pixel so far.
    pub spp: u32,
    /// Variance of each slot.
    pub slots: Vec<Variance>,
    /// Variance of the sum over all slots.
    pub total: Variance,
    /// Scatter of the replicates: of each slot, then of the sum.
    pub scatter: Vec<Scatter>,
}

impl Snapshot {
    /// The variances after `spp` samples per pixel from the scatter of each slot, then of the sum over all slots.
    pub(super) fn new(spp: u32, scatter: Vec<Scatter>) -> Self {
        let variances: Vec<Variance> = scatter.iter().map(Variance::from).collect();
        let (slots, total) = (variances[..scatter.len() - 1].to_vec(), variances[scatter.len() - 1]);
        Self { spp, slots, total, scatter }
    }
}

/// The variances of a film in its present state. The film is read once for all of them.
pub fn snapshot(film: &TermFilm) -> Snapshot {
    let (slots, replicates) = (film.shape.slots, film.shape.replicates);
    let band = |pixels: Range<usize>| {
        let (mut sums, mut d) = (vec![Sums::new(replicates, false); slots + 1], Deviations::default());
        for piece in Piece::all(film, pixels) {
            d.begin(&piece);
            let mut all = 0.0;
            for (s, sums) in sums[..slots].iter_mut().enumerate() {
                d.slot(&piece, s);
                let added = piece.squares(s).sum();
                sums.piece(&d, added);
                d.add(&piece, s);
                all += added;
            }
            d.sum();
            sums[slots].piece(&d, all);
        }
        sums
    };
    let bands: Vec<Vec<Sums>> = bands(film).into_par_iter().map(band).collect();
    let range = |i: usize| if i < slots { i..i + 1 } else { 0..slots };
    let scatter = |i: usize| Sums::scatter(bands.iter().map(|b| &b[i]), film, range(i));
    Snapshot::new(film.least_samples(), (0..=slots).map(scatter).collect())
}
