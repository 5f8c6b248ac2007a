//! What is remembered of the passes of a render beside its film: variances after each pass, images of the first samples, seconds.
//!
//! ```text
//! n = 16, 64, 256, … < N samples per pixel:    T¹E, T²E, Σ TᵏE
//! ```
//!
//! Early images are what a reader sees while the noise falls. They are copies of the film after a pass, so the images of n samples
//! are made of the first n samples of the final image.

use super::film::{BLOCK, Shape, TermFilm};
use super::part::Part;
use super::variance::Stand;
use std::ops::Range;

/// What is remembered of a render.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// What the variances after each pass follow from.
    pub stands: Vec<Stand>,
    /// Images of the first samples.
    pub early: Vec<Early>,
    /// Seconds of work.
    pub seconds: f64,
}

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

impl History {
    /// Puts the parts of a render together; None unless they have the same passes. The parts of a shared film remember only their
    /// seconds: a replicate alone is no image, and has no variance.
    pub fn together(parts: &[(Part, &Self)], shape: Shape, shared: bool) -> Option<Self> {
        let (_, first) = parts.first()?;
        let seconds = parts.iter().map(|(_, h)| h.seconds).sum();
        if shared {
            return Some(Self { seconds, ..Self::default() });
        }
        let alike = |h: &Self| h.stands.len() == first.stands.len() && h.early.len() == first.early.len();
        if !parts.iter().all(|(_, h)| alike(h)) {
            return None;
        }
        let stand = |i: usize| {
            let of: Vec<_> = parts.iter().map(|(part, h)| (*part, &h.stands[i])).collect();
            Stand::together(&of, shape)
        };
        let stands = (0..first.stands.len()).map(stand).collect::<Option<_>>()?;
        let mut early = first.early.clone();
        for (part, h) in parts {
            let both = early.iter_mut().zip(&h.early);
            both.for_each(|(to, from)| to.take(*part, from));
        }
        Some(Self { stands, early, seconds })
    }
}

/// Images are kept of the terms k = 1, 2.
const TERMS: usize = 2;
/// Larger films keep no early images: they would fill the memory.
const PIXELS: usize = 1 << 18;

/// The slots of which early images are kept after this pass. They are kept if the number of samples is 16 times a power of 4 and a
/// later pass will follow.
pub fn kept(film: &TermFilm, planned: u32) -> Option<Range<usize>> {
    let spp = film.samples_of(Part::WHOLE).end;
    let is_one = spp >= 16 && spp.is_power_of_two() && spp.trailing_zeros().is_multiple_of(2);
    let Shape { slots, .. } = film.shape;
    // the last slot is the tail
    let kept = is_one && spp < planned && slots > 1 && film.shape.pixels() <= PIXELS;
    kept.then(|| 1..(1 + TERMS).min(slots - 1))
}

impl Early {
    /// The images after so many samples: of the terms that are [`kept`]; the last one is of all terms and the tail.
    pub fn new(spp: u32, mut images: Vec<Vec<[f32; 3]>>) -> Self {
        let whole = images.pop().unwrap_or_default();
        Self { spp, terms: images, whole }
    }

    /// All its images.
    pub fn images(&self) -> impl Iterator<Item = &Vec<[f32; 3]>> {
        self.terms.iter().chain([&self.whole])
    }

    /// Takes the pixels of one part from the same images of that part.
    fn take(&mut self, part: Part, other: &Self) {
        for (to, from) in self.terms.iter_mut().chain([&mut self.whole]).zip(other.images()) {
            let blocks = to.chunks_mut(BLOCK).zip(from.chunks(BLOCK)).enumerate();
            blocks.filter(|(b, _)| part.has(*b)).for_each(|(_, (to, from))| to.copy_from_slice(from));
        }
    }
}
