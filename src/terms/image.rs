//! Images of the terms: mean and standard error per pixel, and the number of events behind a pixel.

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
        let pixels = (0..film.shape.pixels()).into_par_iter().map(|p| film.pixel(p, slots.clone()));
        let (mean, std_error) = pixels.map(|(m, e)| (m.as_vec3().to_array(), e.as_vec3().to_array())).unzip();
        Self { mean, std_error }
    }
}

/// (Σ x)²/Σ x², the number of events, of the median pixel. Only pixels that hold a contribution to these slots count, and
/// half of them rest on fewer events. 0 if there is no such pixel.
pub fn events_of_pixels(film: &TermFilm, slots: Range<usize>) -> f64 {
    let of = |p: usize| {
        let sum = |s: usize| (0..film.shape.replicates).map(|r| film.sum(p, r, s).element_sum()).sum::<f64>();
        let square: f64 = slots.clone().map(|s| film.square(p, s)).sum();
        (square > 0.0).then(|| slots.clone().map(sum).sum::<f64>().powi(2) / square)
    };
    let mut all: Vec<f64> = (0..film.shape.pixels()).into_par_iter().filter_map(of).collect();
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}
