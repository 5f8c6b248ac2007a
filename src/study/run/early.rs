//! Images of the first samples of a run: what a reader sees while the noise falls.
//!
//! ```text
//! n = 16, 64, 256, … < N samples per pixel:    T¹E, T²E, Σ TᵏE
//! ```
//!
//! They are copies of the film after a pass, so the images of n samples are made of the first n samples of the final image.

use crate::terms::{TermFilm, image};

/// The images after a number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Early {
    /// Samples per pixel.
    pub spp: u32,
    /// The images of the terms k = 1, 2, …, as far as they are kept.
    pub terms: Vec<Vec<[f32; 3]>>,
    /// The image of all terms and the tail.
    pub whole: Vec<[f32; 3]>,
}

/// Images are kept of the terms k = 1, 2.
const TERMS: usize = 2;
/// Larger films keep no early images: they would fill the memory.
const PIXELS: usize = 1 << 18;

/// Copies the film of a pass, if its number of samples is 16 times a power of 4 and a later pass will follow.
pub(super) fn copied(film: &TermFilm, planned: u32, all: &mut Vec<Early>) {
    let spp = film.least_samples();
    let is_one = spp >= 16 && spp.is_power_of_two() && spp.trailing_zeros().is_multiple_of(2);
    let slots = film.shape.slots;
    if !is_one || spp >= planned || slots < 2 || film.shape.pixels() > PIXELS {
        return;
    }
    let mut slots = image::means(film, 0..slots);
    let mut whole = vec![[0.0; 3]; film.shape.pixels()];
    for slot in &slots {
        whole.iter_mut().zip(slot).for_each(|(sum, v)| (0..3).for_each(|c| sum[c] += v[c]));
    }
    // the last slot is the tail
    slots.pop();
    slots.truncate(1 + TERMS);
    slots.remove(0);
    all.push(Early { spp, terms: slots, whole });
}
