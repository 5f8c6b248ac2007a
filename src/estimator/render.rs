//! From an estimator and a sensor to a film: every pixel, every sample, in passes that double.
//!
//! Passes end at 1, 2, 4, … samples per replicate, and where somebody asks for it: there the film is complete, a preview can be shown, and the variance
//! curve has a point. Inside a pass blocks of pixels are independent jobs. A pixel's samples are added in order by one
//! thread, so the sums are the same bits for any number of threads.

use super::{Batch, Job, Paths, TermEstimator, TermSink};
use crate::math::{Columns, Key, Rgb};
use crate::operator::{Sensor, Transport};
use crate::progress::Progress;
use crate::terms::film::{BLOCK, FilmBlock, Shape, TermFilm};
use crate::terms::largest::Largest;
use rayon::prelude::*;

/// How much to render.
#[derive(Clone, Copy, Debug)]
pub struct Amount {
    /// Samples per pixel.
    pub spp: u32,
    /// Independent replicates; `min(16, spp)` is usual.
    pub replicates: usize,
    /// The stream.
    pub key: Key,
}

impl Amount {
    /// The usual number of replicates.
    pub fn new(spp: u32, key: Key) -> Self {
        Self { spp, replicates: spp.clamp(1, 16) as usize, key }
    }
}

/// Paths of a wave.
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

/// Renders into a new film. When it is stopped, what has been done so far comes back: every pixel then holds some number of
/// samples, and all means are still unbiased.
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

/// The same, where somebody looks at the film after every complete pass, and says how many samples per pixel there shall be after the
/// next one, given what is planned; no more than there are: the render ends. It is then the same, bit for bit, as one of the
/// samples it has reached.
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

/// What of the film one job fills: sums, squares, counts.
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
    // the first pass is always finished, so that every pixel holds something
    let may_stop = samples.start > 0;
    // what is larger than this is kept; every block that is done raises it for the others
    let floors = Largest::floors(&film.largest);
    let job = |paths: &mut Paths<T::Wave>, (i, ((sums, squares), counts)): (usize, Part)| {
        if may_stop && progress.stopped() {
            return Totals::new(shape.slots);
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
        return splat(t, sensor, estimator, key, samples, film, progress);
    }
    let parts = sums.zip(squares).zip(counts).enumerate().map_init(Paths::default, job);
    let totals = parts.reduce(|| Totals::new(shape.slots), Totals::plus);
    film.rays.iter_mut().zip(&totals.rays).for_each(|(all, more)| *all += more);
    film.largest.iter_mut().zip(&totals.largest).for_each(|(all, more)| all.merge(more));
    film.non_finite += totals.non_finite;
}

/// What a job counts beside the film that it fills.
struct Totals {
    rays: Vec<u64>,
    non_finite: u64,
    largest: Vec<Largest>,
}

impl Totals {
    fn new(slots: usize) -> Self {
        Self { rays: vec![0; slots], non_finite: 0, largest: vec![Largest::default(); slots] }
    }

    /// None of these depends on the order.
    fn plus(mut self, other: Self) -> Self {
        self.rays.iter_mut().zip(&other.rays).for_each(|(a, b)| *a += b);
        self.largest.iter_mut().zip(&other.largest).for_each(|(a, b)| a.merge(b));
        self.non_finite += other.non_finite;
        self
    }
}

/// What one job adds to the film, wherever.
#[derive(Default)]
struct Splats {
    /// Slot, pixel, sample, value.
    list: Vec<(u32, u32, u32, Rgb)>,
    rays: Vec<u64>,
}

impl TermSink for Splats {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            let v = value.get(i);
            if v != Rgb::ZERO {
                self.list.push((slot as u32, pixel[i], sample[i], v));
            }
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        self.rays[slot] += rays as u64;
    }
}

/// Blocks whose splats are held at once.
const AT_ONCE: usize = 32;

/// A pass of an estimator that adds to any pixel: blocks run side by side, and their splats are added in the order of the blocks.
#[allow(clippy::too_many_arguments)] // as its caller
fn splat<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    key: Key,
    samples: std::ops::Range<u32>,
    film: &mut TermFilm,
    progress: Progress<'_>,
) {
    let (shape, pixels) = (film.shape, film.shape.pixels() as u32);
    let blocks: Vec<u32> = (0..pixels).step_by(BLOCK).collect();
    // a sample that is left half-way would darken every pixel, so that it is all or nothing; the first pass is always
    // finished, so that every replicate holds something: of empty ones the errors would be 0
    let may_stop = samples.start > 0;
    for sample in samples {
        if may_stop && progress.stopped() {
            return;
        }
        for some in blocks.chunks(AT_ONCE) {
            let job = |paths: &mut Paths<T::Wave>, &first: &u32| {
                let mut splats = Splats { rays: vec![0; shape.slots], ..Splats::default() };
                let pixels = first..(first + BLOCK as u32).min(pixels);
                progress.advance(u64::from(pixels.end - pixels.start));
                let batch = &Batch { key, pixels, samples: sample..sample + 1 };
                estimator.sample(&Job { t, sensor, batch }, paths, &mut splats);
                splats
            };
            let done: Vec<Splats> = some.par_iter().map_init(Paths::default, job).collect();
            for splats in done {
                splats.list.iter().for_each(|&(slot, pixel, sample, v)| film.splat(slot, pixel, sample, v));
                film.rays.iter_mut().zip(&splats.rays).for_each(|(all, more)| *all += more);
            }
        }
        film.samples.iter_mut().for_each(|n| *n += 1);
    }
}
