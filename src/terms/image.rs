//! Images of the terms: mean and standard error per pixel.

use super::film::TermFilm;
use rayon::prelude::*;
use std::ops::Range;

/// One image with its standard error, row by row from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TermImage {
    /// Mean radiance.
    pub mean: Vec<[f32; 3]>,
    /// Its standard error; NaN where there is one replicate.
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
