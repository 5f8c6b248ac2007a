//! What every statistic of a film begins with: the mean of a pixel, and how far each replicate is from it.
//!
//! ```text
//! m = Σ_r S_r / N        d_r = (S_r − n_r m)/N        se² = R/(R−1) Σ_r d_r²
//! ```
//!
//! The film is read piece by piece in the order of its memory, all slots of a piece before the next piece, so that the
//! statistics of all slots together read it once. A piece is a part of one block of the film. Bands of rows are
//! independent jobs; their number does not depend on the number of threads, so neither does the order of any sum.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S_r, n_r | sum of replicate r at a pixel, and the number of its samples | [`TermFilm::sum`], [`TermFilm::count`] |
//! | N, R | samples of the pixel, number of replicates | |
//! | m, d_r | mean, deviation of replicate r; Σ_r d_r = 0 | [`Deviations`] |

use super::film::{BLOCK, Shape, TermFilm};
use super::part::Part;
use glam::DVec3;
use pulp::{Arch, Simd};
use std::ops::Range;

/// Number of bands of rows: one for each row of tiles of the [functionals](super::functional).
pub(super) const BANDS: usize = 16;

/// Neighbouring pixels of one block of a film.
pub(super) struct Piece<'a> {
    film: &'a TermFilm,
    /// The pixels.
    pub pixels: Range<usize>,
}

impl<'a> Piece<'a> {
    /// The pieces that neighbouring pixels consist of.
    pub(super) fn all(film: &'a TermFilm, pixels: Range<usize>) -> impl Iterator<Item = Self> {
        pieces(pixels).map(move |pixels| Self { film, pixels })
    }

    /// The shape of the film.
    pub(super) fn shape(&self) -> Shape {
        self.film.shape
    }

    /// True if the piece belongs to a part of the film.
    pub(super) fn is_in(&self, part: Part) -> bool {
        part.has(self.pixels.start / BLOCK)
    }

    /// Σ (r + g + b)² of the contributions to each pixel.
    pub(super) fn squares(&self, slot: usize) -> impl Iterator<Item = f64> {
        self.pixels.clone().map(move |p| self.film.square(p, slot))
    }

    /// Number of samples of a pixel. All pixels of a block have the same.
    pub(super) fn samples(&self) -> u32 {
        self.film.samples[self.pixels.start]
    }
}

/// The pixels of the pieces that neighbouring pixels consist of.
pub(super) fn pieces(pixels: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let blocks = pixels.start / BLOCK..pixels.end.div_ceil(BLOCK);
    // a film of few rows has bands without a pixel
    let blocks = if pixels.is_empty() { 0..0 } else { blocks };
    blocks.map(move |b| pixels.start.max(b * BLOCK)..pixels.end.min((b + 1) * BLOCK))
}

/// The pixels of each band of rows: row y of h belongs to band ⌊16 y/h⌋.
pub(super) fn bands(shape: Shape) -> Vec<Range<usize>> {
    let [w, h] = shape.size.map(|s| s as usize);
    let first = |band: usize| (band * h).div_ceil(BANDS) * w;
    (0..BANDS).map(|band| first(band)..first(band + 1)).collect()
}

/// Mean and deviations of a sum of slots at the pixels of a piece, three numbers for each pixel.
#[derive(Default)]
pub(super) struct Deviations {
    /// Number of replicates.
    pub replicates: usize,
    /// N.
    samples: f64,
    /// n_r.
    counts: Vec<f64>,
    /// The sums S_r of the slots that were added.
    added: Vec<f64>,
    /// Σ_r S_r.
    pub all: Vec<f64>,
    /// m.
    pub mean: Vec<f64>,
    /// d_r, replicate by replicate.
    pub of: Vec<f64>,
    /// Σ_r d_r².
    pub square: Vec<f64>,
}

impl Deviations {
    /// Begins with a piece, and with no slot.
    pub(super) fn begin(&mut self, piece: &Piece<'_>) {
        let (r, samples) = (piece.film.shape.replicates, piece.samples());
        let width = 3 * piece.pixels.len();
        self.replicates = r;
        self.samples = f64::from(samples);
        self.counts.clear();
        self.counts.extend((0..r as u32).map(|i| f64::from(samples / r as u32 + u32::from(i < samples % r as u32))));
        for v in [&mut self.all, &mut self.mean, &mut self.square] {
            v.resize(width, 0.0);
        }
        self.of.resize(r * width, 0.0);
        self.added.clear();
        self.added.resize(r * width, 0.0);
    }

    /// Computes mean and deviations of one slot.
    pub(super) fn slot(&mut self, piece: &Piece<'_>, slot: usize) {
        let rows: Vec<&[f64]> = (0..self.replicates).map(|r| piece.film.row(&piece.pixels, r, slot)).collect();
        self.spread(&rows);
    }

    /// Adds a slot to the sum of slots.
    pub(super) fn add(&mut self, piece: &Piece<'_>, slot: usize) {
        let width = self.mean.len();
        for (r, added) in self.added.chunks_mut(width).enumerate() {
            added.iter_mut().zip(piece.film.row(&piece.pixels, r, slot)).for_each(|(a, s)| *a += s);
        }
    }

    /// Computes mean and deviations of the slots that were added.
    pub(super) fn sum(&mut self) {
        let added = std::mem::take(&mut self.added);
        let rows: Vec<&[f64]> = added.chunks(self.mean.len()).collect();
        self.spread(&rows);
        self.added = added;
    }

    /// Computes mean and deviations of the sums `rows[r]`.
    fn spread(&mut self, rows: &[&[f64]]) {
        let Self { samples, counts, all, mean, of, square, .. } = self;
        spread(Spread { rows, samples: *samples, counts, all, mean, of, square });
    }

    /// The same for some neighbouring slots.
    pub(super) fn slots(&mut self, piece: &Piece<'_>, slots: Range<usize>) {
        if slots.len() == 1 {
            return self.slot(piece, slots.start);
        }
        self.added.fill(0.0);
        slots.for_each(|s| self.add(piece, s));
        self.sum();
    }

    /// d_r.
    pub(super) fn replicate(&self, r: usize) -> &[f64] {
        &self.of[r * self.mean.len()..][..self.mean.len()]
    }

    /// N/n_r.
    pub(super) fn scale(&self, r: usize) -> f64 {
        self.samples / self.counts[r]
    }

    /// Copies the mean of each pixel.
    pub(super) fn copy_means(&self, to: &mut [[f32; 3]]) {
        to.iter_mut().zip(self.mean.as_chunks::<3>().0).for_each(|(to, m)| *to = m.map(|v| v as f32));
    }

    /// Mean and standard error of each pixel.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let (mean, square) = (self.mean.as_chunks().0.iter(), self.square.as_chunks().0.iter());
        let r = self.replicates as f64;
        let error = move |square: [f64; 3]| (DVec3::from_array(square) * (r / (r - 1.0))).map(f64::sqrt);
        mean.zip(square).map(move |(m, s)| (DVec3::from_array(*m), error(*s)))
    }
}

/// What [`spread`] reads and writes.
struct Spread<'a> {
    rows: &'a [&'a [f64]],
    samples: f64,
    counts: &'a [f64],
    all: &'a mut [f64],
    mean: &'a mut [f64],
    of: &'a mut [f64],
    square: &'a mut [f64],
}

#[pulp::with_simd(spread = Arch::new())]
#[inline(always)]
fn spread_with_simd<'a, S: Simd>(_simd: S, job: Spread<'a>) {
    let Spread { rows, samples, counts, all, mean, of, square } = job;
    let width = all.len();
    let (mean, square) = (&mut mean[..width], &mut square[..width]);
    all.fill(0.0);
    for row in rows {
        all.iter_mut().zip(*row).for_each(|(a, s)| *a += s);
    }
    for i in 0..width {
        mean[i] = all[i] / samples;
    }
    square.fill(0.0);
    // a product for every replicate takes less time than a division
    let each = 1.0 / samples;
    for ((row, count), of) in rows.iter().zip(counts).zip(of.chunks_exact_mut(width)) {
        let (row, of) = (&row[..width], &mut of[..width]);
        for i in 0..width {
            let d = (row[i] - mean[i] * count) * each;
            of[i] = d;
            square[i] += d * d;
        }
    }
}

impl TermFilm {
    /// Mean and standard error at one pixel of the sum over some slots.
    pub fn pixel(&self, pixel: usize, slots: Range<usize>) -> (DVec3, DVec3) {
        let (piece, mut d) = (Piece { film: self, pixels: pixel..pixel + 1 }, Deviations::default());
        d.begin(&piece);
        d.slots(&piece, slots);
        d.pixels().next().unwrap_or((DVec3::NAN, DVec3::NAN))
    }
}
