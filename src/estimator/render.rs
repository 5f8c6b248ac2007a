//! Renders an estimator through a sensor into a film: every pixel and every sample, in passes that double.
//!
//! ```text
//! pass 1: samples 0..R      pass 2: R..2R      pass 3: 2R..4R      …      last pass: …..N
//! ```
//!
//! Passes end at 1, 2, 4, … samples per replicate, and at other numbers if the caller asks for them. At the end of a pass
//! the film is complete: a preview can be shown, and the variance curve gets a point. Within a pass, blocks of pixels do
//! not depend on each other, and a job traces a few of them. The samples of a pixel are added in order by one thread, so the
//! sums have the same bits for any number of threads.
//!
//! A render may be left and taken up again: within a pass a block has all samples of the pass or none, and the blocks
//! that have none are done later. What a job adds is therefore always the same, and so are the bits of the film.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | N | samples per pixel | [`Amount::spp`] |
//! | R | number of replicates | [`Amount::replicates`] |
//! | | a film and how it goes on | `Render` |

use super::pass::Pass;
use super::totals::Totals;
use super::{Batch, Job, Paths, TermEstimator, TermSink, splats};
use crate::math::{Columns, Key};
use crate::operator::{Sensor, Transport};
use crate::progress::Progress;
use crate::terms::Part;
use crate::terms::film::{BLOCK, FilmBlocks, Shape, TermFilm};
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

/// Number of paths of a block that are traced together.
const WAVE: u32 = 1024;

/// Most blocks that are traced together. After some bounces few paths are left, and sixteen of them cost as much as one.
const TOGETHER: usize = 4;
/// Fewest jobs of a thread in a pass, so that all threads end at about the same time.
const JOBS: usize = 8;

impl TermSink for FilmBlocks<'_> {
    #[inline(always)]
    fn add(&mut self, slot: usize, pixel: &[u32], sample: &[u32], value: &Columns) {
        FilmBlocks::add(self, slot, pixel, sample, value);
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
    let film = amount.film(t, sensor, estimator);
    let render = Render { film, part: Part::WHOLE, due: &|| false };
    render.go_on(t, sensor, estimator, amount, progress, &mut Looking(look))
}

/// A render that is looked at, and never kept.
struct Looking<'a>(&'a mut dyn FnMut(&TermFilm, u32) -> u32);

impl Between for Looking<'_> {
    fn look(&mut self, film: &TermFilm, planned: u32) -> u32 {
        (self.0)(film, planned)
    }
    fn keep(&mut self, _: &TermFilm) {}
}

impl Amount {
    /// An empty film for these samples.
    pub fn film<T: Transport>(&self, _: &T, sensor: &impl Sensor<T>, estimator: &impl TermEstimator<T>) -> TermFilm {
        let shape = Shape { size: sensor.crop().size, slots: estimator.slots(), replicates: self.replicates };
        TermFilm::empty(shape, estimator.splats())
    }

    /// The end of the pass that follows after `done` samples.
    fn next(&self, done: u32) -> u32 {
        let mut end = (self.replicates as u32).min(self.spp);
        while end <= done && end < self.spp {
            end = end.saturating_mul(2);
        }
        end.min(self.spp)
    }
}

/// True if a render that has ended after `done` samples can go on to the same bits as one that never ended. Paths are computed in
/// groups, and the order of a group decides in which order numbers are added; so no group may be cut. `pixels` are those of the whole
/// picture.
pub fn ends_a_group(done: u32, pixels: u32, replicates: usize, shared: bool) -> bool {
    // the pass within which it ended
    let mut start = replicates as u32;
    while start <= done / 2 {
        start *= 2;
    }
    let start = if start > done { 0 } else { start };
    (done - start).is_multiple_of(if shared { splats::deep(pixels) } else { at_once(pixels) })
}

/// A film, and how its render goes on.
pub(crate) struct Render<'a> {
    /// The film so far: empty, or as an earlier render left it.
    pub film: TermFilm,
    /// The part of the film that is rendered.
    pub part: Part,
    /// Asked by every job: true if the film is to be kept now. It stays true until the film is kept.
    pub due: &'a (dyn Fn() -> bool + Sync),
}

/// What is done between and within passes.
pub(crate) trait Between {
    /// Called after a complete pass with the planned number of samples after the next one. Returns the number that it shall reach.
    fn look(&mut self, film: &TermFilm, planned: u32) -> u32;
    /// Called within a pass if the film is to be kept, and at the end of a render that was stopped there.
    fn keep(&mut self, film: &TermFilm);
}

impl Render<'_> {
    /// Renders until there are all samples, until `look` wants no more, or until it is stopped.
    pub(crate) fn go_on<T: Transport>(
        self,
        t: &T,
        sensor: &impl Sensor<T>,
        estimator: &impl TermEstimator<T>,
        amount: Amount,
        progress: Progress<'_>,
        between: &mut impl Between,
    ) -> TermFilm {
        let Self { mut film, part, due } = self;
        let samples = film.samples_of(part);
        let mut done = samples.start;
        // blocks that are further than others wait for them
        let mut until = amount.next(done).max(samples.end);
        // a film that was left between two passes is looked at first
        if done > 0 && samples.is_empty() {
            until = between.look(&film, until).min(amount.spp);
        }
        // the first pass of a whole film is never stopped, so that every pixel holds samples
        let stops = |done: u32| (done > 0 || !part.is_whole()) && progress.stopped();
        while done < until && !stops(done) {
            pass(t, sensor, estimator, Pass { key: amount.key, until, part, due }, &mut film, progress);
            if film.samples_of(part).start < until {
                between.keep(&film);
                continue;
            }
            done = until;
            if !progress.stopped() {
                until = between.look(&film, amount.next(done)).min(amount.spp);
            }
        }
        film
    }
}

/// Number of samples of a pixel that are computed together, in a picture of so many pixels. It is the same for each pixel, in every
/// block and every crop, so that they get the same bits.
fn at_once(pixels: u32) -> u32 {
    let block = BLOCK as u32;
    WAVE / block * (block / pixels).max(1)
}

/// Brings all blocks of a part to the number of samples of the pass, unless it is stopped or pauses.
fn pass<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    pass: Pass<'_>,
    film: &mut TermFilm,
    progress: Progress<'_>,
) {
    if film.shared {
        return splats::pass(t, sensor, estimator, pass, film, progress);
    }
    let shape = film.shape;
    let together = (shape.blocks() / (JOBS * rayon::current_num_threads())).clamp(1, TOGETHER);
    let pixels = together * BLOCK;
    let sums = film.sums.chunks_mut(pixels * shape.per_pixel());
    let squares = film.squares.chunks_mut(pixels * shape.slots);
    let counts = film.samples.chunks_mut(pixels);
    let Pass { key, until, part, due } = pass;
    let ([width, height], crop) = (sensor.size(), sensor.crop());
    let at_once = at_once(width * height);
    // only contributions above these floors are kept; every finished job raises the floors for the others
    let floors = Largest::floors(&film.largest);
    let job = |paths: &mut Paths<T::Wave>, mut blocks: Blocks| {
        let mut totals = Totals::new(shape.slots);
        while let Some(Blocks { first, both, counts }) = blocks.next(part, shape) {
            let first = (first * BLOCK) as u32;
            let samples = counts[0]..until;
            let stops = || (samples.start > 0 || !part.is_whole()) && progress.stopped() || due();
            if samples.is_empty() || stops() {
                continue;
            }
            let largest = floors.iter().map(Largest::above).collect();
            let mut film = FilmBlocks::new(shape, false, first, both, largest, samples.start == 0);
            for (own, pixels) in crop.rows(first..first + counts.len() as u32, width) {
                film.first = pixels.start - (own - first);
                for s in samples.clone().step_by(at_once as usize) {
                    let batch = Batch { key, pixels: pixels.clone(), samples: s..(s + at_once).min(samples.end) };
                    estimator.sample(&Job { t, sensor, batch: &batch }, paths, &mut film);
                }
            }
            counts.iter_mut().for_each(|n| *n += samples.len() as u32);
            progress.advance(samples.len() as u64 * counts.len() as u64);
            film.largest.iter().zip(&floors).for_each(|(l, floor)| l.tell(floor));
            totals = totals.plus(Totals { rays: film.rays, non_finite: film.non_finite, largest: film.largest });
        }
        totals
    };
    // every thread takes the next blocks, so that all of them end together
    let blocks = sums.zip(squares).zip(counts).enumerate().map(|(i, ((sums, squares), counts))| Blocks {
        first: i * together,
        both: [sums, squares],
        counts,
    });
    let parts = blocks.par_bridge().map_init(Paths::default, job);
    let totals = parts.reduce(|| Totals::new(shape.slots), Totals::plus);
    totals.add_to(film);
}

/// Neighbouring blocks: the number of the first, sums and squares, sample counts.
struct Blocks<'a> {
    first: usize,
    both: [&'a mut [f64]; 2],
    counts: &'a mut [u32],
}

impl<'a> Blocks<'a> {
    /// Takes off the next blocks of a part that are traced together. They are whole and have the same number of samples, or there is only
    /// one. The bits do not depend on what is traced together.
    fn next(&mut self, part: Part, shape: Shape) -> Option<Self> {
        loop {
            let first = self.first;
            let alike = |(i, c): &(usize, &[u32])| c.len() == BLOCK && c[0] == self.counts[0] && part.has(first + i);
            let blocks = self.counts.chunks(BLOCK).enumerate().take_while(alike).count().max(1);
            let pixels = (blocks * BLOCK).min(self.counts.len());
            if pixels == 0 {
                return None;
            }
            let per_pixel = [shape.per_pixel(), shape.slots];
            let [sums, squares] = &mut self.both;
            let sums = sums.split_off_mut(..pixels * per_pixel[0])?;
            let squares = squares.split_off_mut(..pixels * per_pixel[1])?;
            let counts = self.counts.split_off_mut(..pixels)?;
            self.first += blocks;
            if part.has(first) {
                return Some(Self { first, both: [sums, squares], counts });
            }
        }
    }
}
