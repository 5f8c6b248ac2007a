//! A pass of an estimator that adds to any pixel: contributions are collected, sorted by place, and then added to the film.
//!
//! ```text
//! jobs of about 1000 paths → lists, each sorted by part of the film → parts, each sorted by block and slot → film
//! ```
//!
//! Jobs run in parallel, and so do the parts. Each part adds the contributions of the jobs in the order of the jobs, so the
//! sums have the same bits for any number of threads. Sorting also has a reason in the hardware: contributions that come in
//! the order of the film need few memory accesses.

use super::pass::Pass;
use super::totals::Totals;
use super::{Batch, Job, Paths, TermEstimator, TermSink};
use crate::math::{Columns, Rgb};
use crate::operator::{Sensor, Transport};
use crate::progress::Progress;
use crate::terms::film::{BLOCK, FilmBlocks, Shape, TermFilm};
use crate::terms::largest::Largest;
use rayon::prelude::*;

/// Number of paths of a job.
const JOB: u32 = 1024;
/// Jobs whose contributions are held in memory at once.
const AT_ONCE: usize = 32;
/// Number of parts of a large film.
const PARTS: usize = 64;

/// One contribution.
#[derive(Clone, Copy, Default)]
struct Splat {
    slot: u32,
    pixel: u32,
    sample: u32,
    value: Rgb,
}

/// The contributions of one job, sorted by part once the job is done.
struct Splats {
    list: Vec<Splat>,
    /// The first contribution to each part, and the number of all.
    starts: Vec<u32>,
    rays: Vec<u64>,
}

impl TermSink for Splats {
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        for i in 0..pixel.len() {
            let value = value.get(i);
            if value != Rgb::ZERO {
                self.list.push(Splat { slot: slot as u32, pixel: pixel[i], sample: sample[i], value });
            }
        }
    }
    fn rays(&mut self, slot: usize, rays: usize) {
        self.rays[slot] += rays as u64;
    }
}

/// Sorts by a key below `keys`. Entries with the same key keep their order. Returns the start of each key's entries in the
/// sorted list, and their number as the last entry.
fn sort(list: &mut Vec<Splat>, keys: usize, key: impl Fn(&Splat) -> usize) -> Vec<u32> {
    let mut starts = vec![0; keys + 1];
    list.iter().for_each(|s| starts[key(s) + 1] += 1);
    (0..keys).for_each(|k| starts[k + 1] += starts[k]);
    let mut next = starts.clone();
    let mut sorted = vec![Splat::default(); list.len()];
    for s in list.iter() {
        let to = &mut next[key(s)];
        sorted[*to as usize] = *s;
        *to += 1;
    }
    *list = sorted;
    starts
}

/// Number of samples of a film of so many pixels that a job computes together.
pub(super) fn deep(pixels: u32) -> u32 {
    (JOB / pixels).max(1)
}

/// Brings every pixel to the number of samples of the pass. If it is stopped or pauses, each sample is done completely or not at
/// all, because a half-finished sample would darken every pixel. A part of the film gets the samples of its replicates, and
/// counts the others as done.
pub(super) fn pass<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    pass: Pass<'_>,
    film: &mut TermFilm,
    progress: Progress<'_>,
) {
    assert_eq!(film.shape.size, sensor.size(), "paths that add to any pixel need the whole picture");
    let (pixels, replicates) = (film.shape.pixels() as u32, film.shape.replicates);
    let Pass { key, until, part, due } = pass;
    let (wide, deep) = (JOB.min(pixels), if part.is_whole() { deep(pixels) } else { 1 });
    // samples that are done together; on a large film only one, so that a stop does not take long
    let together = (JOB * AT_ONCE as u32 / pixels).max(1);
    let samples = film.samples[0]..until;
    // the first pass of a whole film is never stopped, because replicates without samples would give errors of 0
    let may_stop = samples.start > 0 || !part.is_whole();
    for first in samples.clone().step_by(together as usize) {
        if may_stop && progress.stopped() || due() {
            return;
        }
        let some = first..(first + together).min(samples.end);
        let batch =
            |s: u32, p: u32| Batch { key, pixels: p..(p + wide).min(pixels), samples: s..(s + deep).min(some.end) };
        let own = |s: &u32| part.has(*s as usize % replicates);
        let batches = some.clone().step_by(deep as usize).filter(own);
        let batches: Vec<Batch> =
            batches.flat_map(|s| (0..pixels).step_by(wide as usize).map(move |p| batch(s, p))).collect();
        for batches in batches.chunks(AT_ONCE) {
            let job = |paths: &mut Paths<T::Wave>, batch: &Batch| {
                let rays = vec![0; film.shape.slots];
                let mut splats = Splats { list: vec![], starts: vec![], rays };
                estimator.sample(&Job { t, sensor, batch }, paths, &mut splats);
                splats.starts = sort(&mut splats.list, PARTS, |s| s.pixel as usize / self::part(film.shape));
                progress.advance(batch.len() as u64);
                splats
            };
            let jobs: Vec<Splats> = batches.par_iter().map_init(Paths::default, job).collect();
            add(&jobs, film);
        }
        film.samples.iter_mut().for_each(|n| *n += some.len() as u32);
    }
}

/// Number of pixels of a part of the film: whole blocks.
fn part(shape: Shape) -> usize {
    shape.pixels().div_ceil(PARTS).next_multiple_of(BLOCK)
}

/// Adds the contributions of some jobs to the film.
fn add(jobs: &[Splats], film: &mut TermFilm) {
    let (shape, part, each) = (film.shape, part(film.shape), film.squares_per_pixel());
    let floors = Largest::floors(&film.largest);
    let parts = film.sums.par_chunks_mut(part * shape.per_pixel()).zip(film.squares.par_chunks_mut(part * each));
    let parts = parts.enumerate().map(|(i, (sums, squares))| {
        let mut list = vec![];
        for job in jobs {
            list.extend_from_slice(&job.list[job.starts[i] as usize..job.starts[i + 1] as usize]);
        }
        let blocks = sums.len().div_ceil(BLOCK * shape.per_pixel());
        let first = i * part;
        let at = |s: &Splat| (s.pixel as usize - first) / BLOCK * shape.slots + s.slot as usize;
        let starts = sort(&mut list, blocks * shape.slots, at);
        let mut totals = Totals::new(shape.slots);
        totals.largest = floors.iter().map(Largest::above).collect();
        let (mut pixel, mut sample, mut value) = (vec![], vec![], Columns::default());
        let blocks = sums.chunks_mut(BLOCK * shape.per_pixel()).zip(squares.chunks_mut(BLOCK * each));
        for ((block, (sums, squares)), starts) in
            blocks.enumerate().zip(starts.windows(shape.slots + 1).step_by(shape.slots))
        {
            let largest = std::mem::take(&mut totals.largest);
            let first = (first + block * BLOCK) as u32;
            let mut block = FilmBlocks::new(shape, true, first, [sums, squares], largest, false);
            for slot in 0..shape.slots {
                let list = &list[starts[slot] as usize..starts[slot + 1] as usize];
                pixel.clear();
                sample.clear();
                pixel.extend(list.iter().map(|s| s.pixel));
                sample.extend(list.iter().map(|s| s.sample));
                [&mut value.x, &mut value.y, &mut value.z].into_iter().for_each(Vec::clear);
                value.x.extend(list.iter().map(|s| s.value.x));
                value.y.extend(list.iter().map(|s| s.value.y));
                value.z.extend(list.iter().map(|s| s.value.z));
                block.add(slot, &pixel, &sample, &value);
            }
            totals.non_finite += block.non_finite;
            totals.largest = block.largest;
        }
        totals.largest.iter().zip(&floors).for_each(|(l, floor)| l.tell(floor));
        totals
    });
    let totals = parts.reduce(|| Totals::new(shape.slots), Totals::plus);
    totals.add_to(film);
    for job in jobs {
        film.rays.iter_mut().zip(&job.rays).for_each(|(all, more)| *all += more);
    }
}
