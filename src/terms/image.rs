//! Images of the terms: mean and standard error per pixel, and the number of events behind a pixel.

use super::deviations::{Deviations, Piece, bands};
use super::film::TermFilm;
use rayon::prelude::*;
use std::ops::Range;

/// One image with its standard error, row by row from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TermImage {
    /// Mean radiance.
    pub mean: Vec<[f32; 3]>,
    /// Standard error of the mean; NaN with one replicate.
    pub std_error: Vec<[f32; 3]>,
}

impl TermImage {
    /// The image of the sum over some slots of a film.
    pub fn of(film: &TermFilm, slots: Range<usize>) -> Self {
        let band = |pixels: Range<usize>| {
            let (mut image, mut d) = (Self::default(), Deviations::default());
            for piece in Piece::all(film, pixels) {
                d.begin(&piece);
                d.slots(&piece, slots.clone());
                image.piece(&d);
            }
            image
        };
        let all: Vec<Self> = bands(film.shape).into_par_iter().map(band).collect();
        Self::of_bands(all.iter())
    }

    /// Appends the pixels of a piece.
    pub(super) fn piece(&mut self, d: &Deviations) {
        for (mean, error) in d.pixels() {
            self.mean.push(mean.as_vec3().to_array());
            self.std_error.push(error.as_vec3().to_array());
        }
    }

    /// Puts the bands of an image together.
    pub(super) fn of_bands<'a>(bands: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let all = |of: fn(&Self) -> &[[f32; 3]]| bands.clone().map(of).collect::<Vec<_>>().concat();
        Self { mean: all(|i| &i.mean), std_error: all(|i| &i.std_error) }
    }
}

/// The mean images of the slots of a film, without errors: enough for a preview.
pub fn means(film: &TermFilm, slots: Range<usize>) -> Vec<Vec<[f32; 3]>> {
    let of = |slot: usize| {
        let (mut means, mut sums) = (Vec::with_capacity(film.shape.pixels()), vec![]);
        // in the order of the memory: the pixels of a replicate are neighbours
        for piece in Piece::all(film, 0..film.shape.pixels()) {
            sums.clear();
            sums.resize(3 * piece.pixels.len(), 0.0);
            for r in 0..film.shape.replicates {
                sums.iter_mut().zip(film.row(&piece.pixels, r, slot)).for_each(|(sum, s)| *sum += s);
            }
            let n = f64::from(piece.samples());
            means.extend(sums.as_chunks::<3>().0.iter().map(|sum| sum.map(|s| (s / n) as f32)));
        }
        means
    };
    slots.into_par_iter().map(of).collect()
}

/// The median of (Σ x)²/Σ x², the number of events of a pixel. Only pixels that hold a contribution count, and half of them rest
/// on fewer events. 0 if there is no such pixel.
#[derive(Clone, Default)]
pub(super) struct PixelEvents(Vec<f64>);

impl PixelEvents {
    /// Adds a pixel with its Σ x and Σ x².
    pub(super) fn push(&mut self, sum: f64, square: f64) {
        if square > 0.0 {
            self.0.push(sum * sum / square);
        }
    }

    /// The median over the pixels of all bands.
    pub(super) fn median<'a>(bands: impl Iterator<Item = &'a Self>) -> f64 {
        let mut all = bands.map(|e| e.0.as_slice()).collect::<Vec<_>>().concat();
        if all.is_empty() {
            return 0.0;
        }
        let middle = all.len() / 2;
        *all.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// The mean of a pixel as its definition says, for a film whose last block is not full.
    #[test]
    fn means_are_sums_over_the_replicates_divided_by_the_samples() {
        let slots: Vec<Vec<DVec3>> =
            (1..4).map(|s| (0..150).map(|p| DVec3::new(0.1, 0.7, 1.3) * f64::from(s * (p + 1))).collect()).collect();
        let film = TermFilm::exact([15, 10], &slots);
        for (i, image) in means(&film, 1..3).iter().enumerate() {
            for (p, found) in image.iter().enumerate() {
                let sum: DVec3 = (0..film.shape.replicates).map(|r| film.sum(p, r, 1 + i)).sum();
                assert_eq!(*found, (sum / f64::from(film.samples[p])).as_vec3().to_array());
            }
        }
    }
}
