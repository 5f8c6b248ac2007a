//! Variance against samples per pixel, from the snapshots of one render.
//!
//! `V(n) = mean over pixels and channels of se²(n)`, with the standard error of the [film](super::film) after n samples.
//!
//! The error of V(n) itself is that of a variance with R − 1 degrees of freedom in every pixel and channel, pixels being
//! independent: `Var V = Σ 2 se⁴/(R+1) / count²`. It takes the replicates as normal; with heavy tails it is too small.

use super::film::TermFilm;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A variance with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variance {
    /// Averaged over pixels and channels.
    pub value: f64,
    /// Per channel, averaged over pixels.
    pub channels: DVec3,
    /// Standard error of `value`.
    pub std_error: f64,
}

/// The variances at one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Samples per pixel so far.
    pub spp: u32,
    /// Of each slot.
    pub slots: Vec<Variance>,
    /// Of the sum over all slots.
    pub total: Variance,
}

/// The variances of a film as it stands.
pub fn snapshot(film: &TermFilm) -> Snapshot {
    let slots = film.shape.slots;
    let one = |range: Range<usize>| variance(film, range);
    Snapshot { spp: film.least_samples(), slots: (0..slots).map(|s| one(s..s + 1)).collect(), total: one(0..slots) }
}

fn variance(film: &TermFilm, slots: Range<usize>) -> Variance {
    let (pixels, replicates) = (film.shape.pixels(), film.shape.replicates as f64);
    // chunks of a fixed size, added in order: the same bits for any number of threads
    let chunk = |c: usize| {
        let squares = (c * 1024..((c + 1) * 1024).min(pixels)).map(|p| film.pixel(p, slots.clone()).1.powf(2.0));
        squares.fold((DVec3::ZERO, 0.0), |(v, f), se2| (v + se2, f + se2.length_squared()))
    };
    let sums: Vec<(DVec3, f64)> = (0..pixels.div_ceil(1024)).into_par_iter().map(chunk).collect();
    let (first, fourth) = sums.iter().fold((DVec3::ZERO, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    let channels = first / pixels as f64;
    let count = 3.0 * pixels as f64;
    Variance {
        value: channels.element_sum() / 3.0,
        channels,
        std_error: (2.0 * fourth / (replicates + 1.0)).sqrt() / count,
    }
}
