//! Renders an estimator through a sensor into a film: every pixel and every sample, in passes that double.
//!
//! Passes end at 1, 2, 4, … samples per replicate, and at other numbers if the caller asks for them. At the end of a pass
//! the film is complete: a preview can be shown, and the variance curve gets a point. Within a pass, blocks of pixels are
//! independent jobs. The samples of a pixel are added in order by one thread, so the sums have the same bits for any number
//! of threads.

use super::totals::Totals;
use super::{Batch, Job, Paths, TermEstimator, TermSink, splats};
use crate::math::{Columns, Key};
use crate::operator::{Sensor, Transport};
use crate::progress::Progress;
use crate::terms::film::{BLOCK, FilmBlock, Shape, TermFilm};
use crate::terms::largest::Largest;
use rayon::prelude::*;

/// Amount of samples to render.
#[derive(Clone, Copy, Debug)]
pub struct Amount {
    /// Samples per pixel.
    pub spp: u32,
    /// Independent replicates; the smaller of [`Amount::REPLICATES`] and `spp` is usual.
    pub replicates: usize,
    /// Key of the random stream.
    pub key: Key,
}

impl Amount {
    /// The usual number of replicates of a pixel with many samples.
    pub const REPLICATES: u32 = 16;

    /// An amount with the usual number of replicates.
    pub fn new(spp: u32, key: Key) -> Self {
        Self { spp, replicates: spp.clamp(1, Self::REPLICATES) as usize, key }
    }
}

/// Sums in a page of memory.
const PAGE: usize = 4096 / size_of::<f64>();

/// Number of paths of a wave.
const WAVE: u32 = 1024;

impl TermSink for FilmBlock<'_> {
    #[inline(always)]
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        FilmBlock::add(self, slot, pixel, sample, value);
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        self.rays[slot] += rays as u64;
    }
}

/// Renders into a new film. If it is stopped, it returns what has been done so far. Pixels may then hold different numbers
/// of samples, and all means are still unbiased.
pub fn render<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    amount: Amount,
    progress: Progress<'_>,
) -> TermFilm {
    render_in_passes(t, sensor, estimator, amount, progress, &mut |film, planned| {
        progress.film(film);
        planned
    })
}

/// Renders like [`render()`], and calls `look` after every complete pass. `look` gets the film and the planned number of
/// samples per pixel after the next pass. It returns the number that the next pass shall reach. If that is no more than
/// there already are, the render ends. The film is then the same, bit for bit, as that of a render with the number of
/// samples reached.
pub fn render_in_passes<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    amount: Amount,
    progress: Progress<'_>,
    look: &mut dyn FnMut(&TermFilm, u32) -> u32,
) -> TermFilm {
    let shape = Shape { size: sensor.size(), slots: estimator.slots(), replicates: amount.replicates };
    let mut film = TermFilm::new(shape);
    let (mut done, mut until) = (0, (amount.replicates as u32).min(amount.spp));
    while done < until && !(done > 0 && progress.stopped()) {
        pass(t, sensor, estimator, amount.key, done..until, &mut film, progress);
        done = until;
        if !progress.stopped() {
            until = look(&film, done.saturating_mul(2).min(amount.spp)).min(amount.spp);
        }
    }
    film
}

/// The part of the film that one job fills: sums, squares, sample counts.
type Part<'a> = ((&'a mut [f64], &'a mut [f64]), &'a mut [u32]);

#[allow(clippy::too_many_arguments)] // one call site; a struct of them would only rename the list
fn pass<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    key: Key,
    samples: std::ops::Range<u32>,
    film: &mut TermFilm,
    progress: Progress<'_>,
) {
    let shape = film.shape;
    let sums = film.sums.par_chunks_mut(BLOCK * shape.per_pixel());
    let squares = film.squares.par_chunks_mut(BLOCK * shape.slots);
    let counts = film.samples.par_chunks_mut(BLOCK);
    // the first pass always finishes, so that every pixel holds samples
    let may_stop = samples.start > 0;
    // only contributions above these floors are kept; every finished block raises the floors for the others
    let floors = Largest::floors(&film.largest);
    let job = |paths: &mut Paths<T::Wave>, (i, ((sums, squares), counts)): (usize, Part)| {
        if may_stop && progress.stopped() {
            return Totals::new(shape.slots);
        }
        if !may_stop {
            // memory is written before it is read, or every page is brought in twice
            sums.iter_mut().step_by(PAGE).for_each(|s| *s = 0.0);
        }
        let first = (i * BLOCK) as u32;
        let pixels = first..first + counts.len() as u32;
        let largest = floors.iter().map(Largest::above).collect();
        let rays = vec![0; shape.slots];
        let mut block = FilmBlock { shape, first, pixels: pixels.len(), sums, squares, largest, non_finite: 0, rays };
        let at_once = WAVE / BLOCK as u32 * (BLOCK / pixels.len()) as u32;
        for s in samples.clone().step_by(at_once as usize) {
            let batch = Batch { key, pixels: pixels.clone(), samples: s..(s + at_once).min(samples.end) };
            estimator.sample(&Job { t, sensor, batch: &batch }, paths, &mut block);
        }
        counts.iter_mut().for_each(|n| *n += samples.len() as u32);
        progress.advance(samples.len() as u64 * u64::from(pixels.end - pixels.start));
        block.largest.iter().zip(&floors).for_each(|(l, floor)| l.tell(floor));
        Totals { rays: block.rays, non_finite: block.non_finite, largest: block.largest }
    };
    if estimator.splats() {
        film.shared = true;
        return splats::pass(t, sensor, estimator, key, samples, film, progress);
    }
    let parts = sums.zip(squares).zip(counts).enumerate().map_init(Paths::default, job);
    let totals = parts.reduce(|| Totals::new(shape.slots), Totals::plus);
    totals.add_to(film);
}
