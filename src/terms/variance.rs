//! Variance as a function of the samples per pixel, from the snapshots of one render.
//!
//! `V(n) = mean over pixels and channels of se²(n)`, with the standard error of the [film](super::film) after n samples.
//!
//! The error of V(n) comes from leaving out replicates, see [`scatter`](super::scatter). So it accounts for the dependence
//! between the colours of a pixel, and for heavy tails. It needs three replicates.

use super::film::TermFilm;
use super::scatter::Scatter;
use glam::DVec3;

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

/// The variances of a film in its present state.
pub fn snapshot(film: &TermFilm) -> Snapshot {
    let slots = film.shape.slots;
    let ranges = (0..slots).map(|s| s..s + 1).chain(std::iter::once(0..slots));
    let scatter: Vec<Scatter> = ranges.map(|r| Scatter::of(film, r, None)).collect();
    let (total, slots) = (Variance::from(&scatter[slots]), scatter[..slots].iter().map(Variance::from).collect());
    Snapshot { spp: film.least_samples(), slots, total, scatter }
}
