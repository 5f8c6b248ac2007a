//! A render in progress, pass by pass: what is read from the film, what is kept of it, and when it ends.
//!
//! ```text
//! begin → [the film that was left] → pass → look → pass → look → … → finish
//! ```
//!
//! | what | place |
//! |---|---|
//! | callbacks of the caller | [`Watch`] |
//! | states that are kept, and the state in which a render was left | [`Keep`] |
//! | variances, early images, seconds | [`History`] |

use super::Settings;
use super::sampled::Sampled;
use crate::estimator::TermEstimator;
use crate::estimator::render::{Amount, Between, Render};
use crate::operator::patches::Patches;
use crate::operator::rays::{Rays, Rows};
use crate::operator::{Sensor, Transport};
use crate::progress::{Clock, Progress};
use crate::terms::history::{self, Early, History};
use crate::terms::statistics::Statistics;
use crate::terms::variance::{Snapshot, Stand};
use crate::terms::{Cost, Part, Series, TermFilm, Variance, World};
use std::ops::Range;
use std::time::{Duration, Instant};

/// A callback that gets the film after a pass. It returns the next number of samples per pixel at which to be called, in
/// addition to the usual ones.
pub type Look<'a> = &'a mut dyn FnMut(&TermFilm) -> Option<u32>;

/// Keeps the state of films, so that a later render can go on from it, and the rows of stored rays of a part.
pub trait Keep: Sync {
    /// The part of the films that is rendered.
    fn part(&self) -> Part;
    /// The state in which an earlier render left the film of that random stream. It is given once.
    fn left(&self, stream: &str) -> Option<(TermFilm, History)>;
    /// True if a state is to be kept now. It stays true until that is done.
    fn due(&self) -> bool;
    /// Keeps a state; `ended` tells that the render has come to its end, or was stopped.
    fn keep(&self, stream: &str, film: &TermFilm, history: &History, ended: bool);
    /// The rows of rays that all parts have traced on a mesh, if they have.
    fn rows(&self, _mesh: &str, _patches: &Patches, _per_row: usize) -> Option<Rays> {
        None
    }
    /// True if the rows of this part on a mesh are kept already.
    fn has_rows(&self, _mesh: &str) -> bool {
        false
    }
    /// Keeps the rows of this part on a mesh.
    fn keep_rows(&self, _mesh: &str, _rows: &Rows) {}
}

/// What accompanies a render.
#[derive(Default)]
pub struct Watch<'l> {
    /// The caller's callback.
    pub look: Option<Look<'l>>,
    /// Keeps states.
    pub keep: Option<&'l dyn Keep>,
    /// Keep early images.
    pub early: bool,
}

impl Watch<'_> {
    /// Nothing.
    pub const NONE: Self = Self { look: None, keep: None, early: false };
}

/// A render in progress.
pub(crate) struct Passes<'a, 'l> {
    progress: Progress<'a>,
    started: Instant,
    /// True if [`Passes::finish`] will be called: films are then read after each pass.
    read: bool,
    snapshots: Vec<Snapshot>,
    /// The seconds of the render, and the statistics of the film after the last pass.
    last: Option<(f64, Statistics)>,
    clock: Option<&'a Clock>,
    watch: Watch<'l>,
    stream: String,
    /// The film in which an earlier render was left.
    left: Option<TermFilm>,
    /// What is kept beside the film. Its seconds are those of earlier renders.
    history: History,
    /// Upper limit of the number of samples.
    spp: u32,
}

impl<'a, 'l> Passes<'a, 'l> {
    /// Passes that double, without a clock and without a callback, for callers that use the film itself.
    pub(crate) fn of(progress: Progress<'a>) -> Self {
        Self {
            progress,
            started: Instant::now(),
            read: false,
            snapshots: vec![],
            last: None,
            clock: None,
            watch: Watch::NONE,
            stream: String::new(),
            left: None,
            history: History::default(),
            spp: 0,
        }
    }

    /// The same with a callback after each pass.
    pub(crate) fn watched_by(mut self, look: Look<'l>) -> Self {
        self.watch.look = Some(look);
        self
    }

    /// Begins a render, or takes it up again: `what` is its name for people, `stream` that of its random numbers. The clock, if
    /// there is one, limits its time.
    pub(crate) fn begin(
        (what, stream): (&str, &str),
        size: [u32; 2],
        settings: &Settings,
        progress: Progress<'a>,
        clock: Option<&'a Clock>,
        watch: Watch<'l>,
    ) -> Self {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let (part, left) = (part(&watch), watch.keep.and_then(|keep| keep.left(stream)));
        let before = left.as_ref().map_or(0, |(film, _)| film.samples.iter().map(|&n| u64::from(n)).sum());
        let paths = (pixels * u64::from(settings.spp) / u64::from(part.of)).saturating_sub(before);
        progress.begin(what, clock.map_or(paths, |c| c.time.as_millis() as u64));
        let progress = clock.map_or(progress, |clock| progress.by_clock(clock));
        let mut passes = Self { read: true, clock, watch, spp: settings.spp, ..Self::of(progress) };
        passes.stream = stream.into();
        if let Some((film, history)) = left {
            passes.take_up(film, history);
        }
        passes
    }

    /// Goes on from the state in which a render was left. A render that ends now would not have looked at its last pass.
    fn take_up(&mut self, film: TermFilm, mut history: History) {
        let samples = film.samples_of(part(&self.watch));
        let looked_at = |spp: u32| if samples.is_empty() { spp < samples.start } else { spp <= samples.start };
        history.stands.retain(|s| looked_at(s.spp) && is_usual(s.spp, &film));
        history.early.retain(|e| looked_at(e.spp) && is_usual(e.spp, &film));
        if part(&self.watch).is_whole() {
            self.snapshots = history.stands.iter().map(|s| s.snapshot(film.shape)).collect();
        }
        (self.left, self.history) = (Some(film), history);
    }

    /// The result of the render. The film is not needed any more.
    pub(crate) fn finish(self, film: TermFilm, world: World, label: String) -> Sampled {
        let slots = film.shape.slots;
        self.keep(&film, true);
        let now = self.seconds();
        // a film that was stopped within a pass has not been read yet, and a part of a film never is
        let (seconds, read) = match self.last {
            Some(read) => read,
            None if part(&self.watch).is_whole() => (now, Statistics::of(&film)),
            None => (now, Statistics::default()),
        };
        let paths = film.samples.iter().map(|&n| u64::from(n)).sum();
        let cost = Cost { paths, rays: film.rays.iter().sum(), non_finite: film.non_finite, seconds };
        let Statistics { images, mut events, norms, functionals, replicates, tiles, .. } = read;
        let mut images = images.into_iter();
        let terms = images.by_ref().take(slots - 1).collect();
        let mut next = || images.next().unwrap_or_default();
        // without terms the only image is the whole
        let [tail, sum] = if slots > 1 { [next(), next()] } else { Default::default() };
        if slots == 1 {
            let whole = events.first().copied().unwrap_or(0.0);
            events.extend([0.0, whole]);
        }
        let (rays, spp) = (film.rays.clone(), film.least_samples());
        // giving hundreds of megabytes back to the system takes a while, for which nobody has to wait
        rayon::spawn(move || drop(film));
        Sampled {
            series: Series {
                world,
                label,
                functionals,
                cost,
                unsampled: vec![],
                doubts: vec![],
                undecided: None,
                variance: Variance::Finite,
            },
            doubt: None,
            terms,
            tail,
            sum,
            total: next(),
            replicates,
            tiles,
            rays,
            pixel_events: events,
            snapshots: self.snapshots,
            early: self.history.early,
            norms,
            spp,
        }
    }
}

/// True if every longer render has a pass that ends after so many samples.
fn is_usual(spp: u32, film: &TermFilm) -> bool {
    let replicates = film.shape.replicates as u32;
    spp.is_multiple_of(replicates) && (spp / replicates).is_power_of_two()
}

/// The part of the film that is rendered.
fn part(watch: &Watch<'_>) -> Part {
    watch.keep.map_or(Part::WHOLE, Keep::part)
}

impl Passes<'_, '_> {
    pub(crate) fn render<T: Transport>(
        &mut self,
        t: &T,
        sensor: &impl Sensor<T>,
        estimator: &impl TermEstimator<T>,
        amount: Amount,
    ) -> TermFilm {
        let (progress, keep) = (self.progress, self.watch.keep);
        let film = self.left.take().unwrap_or_else(|| amount.film(t, sensor, estimator));
        let render = Render { film, part: part(&self.watch), due: &|| keep.is_some_and(Keep::due) };
        render.go_on(t, sensor, estimator, amount, progress, self)
    }

    /// Seconds so far, of earlier renders of the same film as well.
    fn seconds(&self) -> f64 {
        self.history.seconds + self.started.elapsed().as_secs_f64()
    }

    /// Keeps the state of the film.
    fn keep(&self, film: &TermFilm, ended: bool) {
        if let Some(keep) = self.watch.keep {
            keep.keep(&self.stream, film, &History { seconds: self.seconds(), ..self.history.clone() }, ended);
        }
    }

    /// The number of samples that fits into the time at the speed so far, as a multiple of the number of replicates. The
    /// decision looks at no value, so means stay unbiased, and every pixel gets the same number.
    fn in_time(&self, time: Duration, film: &TermFilm, planned: u32) -> u32 {
        let (done, elapsed) = (film.least_samples(), self.started.elapsed().as_secs_f64());
        let each = self.seconds() / f64::from(done);
        let fits = (f64::from(done) + (time.as_secs_f64() - elapsed) / each) as u32;
        // if a pass would leave less than a quarter of itself for the last one, the last one is included in it
        let until = if f64::from(fits) < 1.25 * f64::from(planned) { fits } else { planned };
        let replicates = film.shape.replicates as u32;
        until / replicates * replicates
    }
}

impl Between for Passes<'_, '_> {
    /// Decides how far the next pass goes, and stores the variances. After the last pass the film is read once for all
    /// statistics.
    fn look(&mut self, film: &TermFilm, planned: u32) -> u32 {
        self.progress.film(film);
        let part = part(&self.watch);
        let done = film.samples_of(part).start;
        let asked = self.watch.look.as_mut().and_then(|look| look(film));
        let planned = asked.map_or(planned, |n| planned.min(n));
        let until = self.clock.map_or(planned, |clock| self.in_time(clock.time, film, planned));
        if !self.read {
            return until;
        }
        // a replicate alone is no image, and has no variance
        let apart = film.shared && !part.is_whole();
        let early = if self.watch.early && !apart { history::kept(film, self.spp) } else { None };
        if until <= done && part.is_whole() {
            self.last = Some((self.seconds(), Statistics::of(film)));
        }
        // the bits of a run that is kept must not depend on where it was stopped
        let exists = self.watch.keep.is_none() || until <= done || is_usual(done, film);
        self.store(film, part, film.shape.replicates > 1 && !apart && exists, early);
        until
    }

    fn keep(&mut self, film: &TermFilm) {
        Passes::keep(self, film, false);
    }
}

impl Passes<'_, '_> {
    /// After a pass, stores the variances of the film if they are wanted, and early images of some slots. The film is read once for
    /// both; after the last pass the variances have been read with all other statistics.
    fn store(&mut self, film: &TermFilm, part: Part, mut variances: bool, early: Option<Range<usize>>) {
        if let (Some((_, read)), true) = (&self.last, variances) {
            self.snapshots.push(read.snapshot.clone());
            variances = false;
        }
        if !variances && early.is_none() {
            return;
        }
        let (stand, images) = Stand::with_images(film, part, early);
        if !images.is_empty() {
            self.history.early.push(Early::new(film.samples_of(Part::WHOLE).end, images));
        }
        if !variances {
            return;
        }
        if part.is_whole() {
            self.snapshots.push(stand.snapshot(film.shape));
        }
        if self.watch.keep.is_some() {
            self.history.stands.push(stand);
        }
    }
}
