//! The continuous world: terms and path tracer by rays, from the scene to series and images.

use crate::engine::Settings;
pub use crate::engine::estimator::{Begins, Estimator};
use crate::engine::known::coplanar::undecided;
use crate::engine::known::doubts::doubts;
use crate::engine::known::growth::{self, Growth};
use crate::engine::known::unsampled::unsampled;
use crate::estimator::render::{Amount, render_in_passes};
use crate::estimator::{
    Bidirectional, Branching, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, TermEstimator,
};
use crate::operator::{Adjoint, SceneTransport, Sensor, Transport};
use crate::progress::{Clock, Progress};
use crate::scene::Scene;
use crate::terms::functional::Replicates;
use crate::terms::norms::SquaredNorm;
use crate::terms::statistics::Statistics;
use crate::terms::variance::{Snapshot, snapshot};
use crate::terms::{Cost, Estimate, Series, TermFilm, TermImage, TileSums, Variance, World};
use std::time::{Duration, Instant};

/// Result of a render by rays: means with errors, images, and variances against samples.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// Means and errors.
    pub series: Series,
    /// Images of T^k E, for k = 0..=K; empty for the path tracer.
    pub terms: Vec<TermImage>,
    /// Image of the tail: everything longer than K.
    pub tail: TermImage,
    /// Image of Σ_{k≤K} T^k E.
    pub sum: TermImage,
    /// The whole image.
    pub total: TermImage,
    /// The image mean by replicate, from which covariances between terms follow.
    pub replicates: Replicates,
    /// Sums over tiles by replicate, from which the means of blocks of tiles follow with their errors.
    pub tiles: TileSums,
    /// Rays requested, by slot.
    pub rays: Vec<u64>,
    /// Number of events behind the median pixel: of every slot, of the sum over k ≤ K, and of the whole.
    pub pixel_events: Vec<f64>,
    /// Variances at 1, 2, 4, … samples per replicate.
    pub snapshots: Vec<Snapshot>,
    /// Squared L2 norms of the term images; none with fewer than three replicates.
    pub norms: Vec<Option<SquaredNorm>>,
    /// Smallest number of samples of a pixel: fewer than requested if the render was interrupted.
    pub spp: u32,
    /// Measured growth of the variance of long paths, if that variance is not known to be finite. The tail and the whole
    /// then have no error bar.
    pub doubt: Option<Growth>,
}

/// Renders every term with the given estimator.
pub fn terms(scene: &Scene, estimator: Estimator, settings: &Settings, progress: Progress<'_>) -> Sampled {
    watched(scene, Some(estimator), settings, progress, None)
}

/// Renders with the full path tracer.
pub fn path(scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    watched(scene, None, settings, progress, None)
}

/// A callback that gets the film after a pass. It returns the next number of samples per pixel at which to be called, in
/// addition to the usual ones.
pub type Look<'a> = &'a mut dyn FnMut(&TermFilm) -> Option<u32>;

/// Renders the terms, or the path tracer if no estimator is given, with a callback after each pass.
pub fn watched(
    scene: &Scene,
    estimator: Option<Estimator>,
    settings: &Settings,
    progress: Progress<'_>,
    look: Option<Look<'_>>,
) -> Sampled {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let (camera, points) = (&scene.camera, spread(settings));
    let stream = estimator.map_or("path".into(), |e| e.to_string());
    let (amount, clock) = (amount(settings, &stream), settings.time.map(Clock::start));
    let what = estimator.map_or("path".into(), |e| format!("terms, {e}"));
    let mut passes = Passes::begin(&what, camera.size, settings, progress, clock.as_ref());
    passes.look_on = look;
    let Settings { technique, path_roulette, .. } = settings;
    let result = match estimator {
        Some(estimator) => {
            let film = film(&t, camera, estimator, settings.plan(), amount, &mut passes);
            // walks from the light ignore the technique
            let technique =
                if estimator.begins() == Begins::AtLight { String::new() } else { format!(", {technique}") };
            passes.finish(&film, World::Terms, format!("{estimator}{technique}{points}"))
        }
        None => {
            let path = PathTracer(Plan { roulette: path_roulette.clone(), ..settings.plan() });
            let film = passes.render(&t, camera, &path, amount);
            passes.finish(&film, World::Path, format!("path tracer, {technique}, roulette {path_roulette}{points}"))
        }
    };
    let doubt = doubt(&t, estimator, settings);
    annotated(result, scene, estimator, settings).judged(doubt)
}

/// Tells whether the tail and total of an estimator (`None` for the path tracer) have a finite variance.
pub(crate) fn variance(t: &SceneTransport<'_>, estimator: Option<Estimator>, settings: &Settings) -> Variance {
    doubt(t, estimator, settings).map_or(Variance::Finite, |growth| growth.variance())
}

/// The growth that was measured, if the tail and total of an estimator (`None` for the path tracer) have no valid error bar;
/// otherwise None.
pub(crate) fn doubt(t: &SceneTransport<'_>, estimator: Option<Estimator>, settings: &Settings) -> Option<Growth> {
    let roulette = settings.roulette_of(estimator);
    if growth::proved(t.scene, t.sampling, roulette) {
        return None;
    }
    match estimator {
        Some(e) if e.begins() == Begins::AtLight => {
            growth::doubt(&growth::FromLight { t, roulette }, roulette.settled(), settings)
        }
        _ => growth::doubt_from_eye(t, &t.scene.camera, roulette, settings),
    }
}

impl Sampled {
    /// Takes away the error bars of the tail and of the whole if there is a doubt about their variance.
    pub(crate) fn judged(mut self, doubt: Option<Growth>) -> Self {
        self.doubt = doubt;
        if let Some(d) = doubt {
            self.distrust(d.variance());
        }
        self
    }

    /// Replaces the error bars of the tail and of the whole by ∞ or NaN, in numbers and in images.
    pub fn distrust(&mut self, variance: Variance) {
        self.series.judge(variance);
        if let Some(instead) = variance.instead() {
            for image in [&mut self.tail, &mut self.total] {
                image.std_error.iter_mut().for_each(|e| *e = [instead as f32; 3]);
            }
        }
    }
}

impl Settings {
    /// Roulette schedule of an estimator (`None` for the path tracer).
    pub fn roulette_of(&self, estimator: Option<Estimator>) -> &Roulette {
        if estimator.is_some() { &self.roulette } else { &self.path_roulette }
    }
}

/// Adds to a result which light its estimator (`None` for the path tracer) cannot find in the scene, its doubts, and whether
/// its paths are cut at K.
pub(crate) fn annotated(
    mut result: Sampled,
    scene: &Scene,
    estimator: Option<Estimator>,
    settings: &Settings,
) -> Sampled {
    result.series.unsampled = unsampled(scene, estimator, settings.technique);
    result.series = result.series.doubted(doubts(scene, estimator, settings));
    result.series.undecided = undecided(scene);
    if !settings.roulette_of(estimator).ends() {
        cut(&mut result.series, settings);
    }
    result
}

/// Renders any estimator of the terms over any transport, through any sensor.
pub(crate) fn film<T: Adjoint>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: Estimator,
    plan: Plan,
    amount: Amount,
    passes: &mut Passes<'_, '_>,
) -> TermFilm {
    match estimator {
        Estimator::Prefix => passes.render(t, sensor, &Prefix(plan), amount),
        Estimator::Single => passes.render(t, sensor, &SingleTerm(plan), amount),
        Estimator::Light => passes.render(t, sensor, &LightTracer(plan), amount),
        Estimator::Bidirectional => passes.render(t, sensor, &Bidirectional(plan), amount),
        Estimator::Branching { children } => passes.render(t, sensor, &Branching { plan, children }, amount),
    }
}

/// The samples of a run, with the random stream of that name.
pub(crate) fn amount(settings: &Settings, stream: &str) -> Amount {
    let replicates = settings.replicates_of(settings.spp) as usize;
    Amount { spp: settings.spp, replicates, key: settings.key(stream, replicates) }
}

/// Words that a label gets for points and replicates other than the usual ones.
pub(crate) fn spread(settings: &Settings) -> String {
    settings.spread().iter().map(|words| format!(", {words}")).collect()
}

/// Marks a result whose paths are cut at K because no roulette ends them: its label says so, and its tail is not estimated.
pub(crate) fn cut(series: &mut Series, settings: &Settings) {
    series.label += &format!(", k ≤ {} only", settings.max_bounces);
    series.functionals.iter_mut().for_each(|f| f.tail = Estimate::NONE);
}

/// Renders any estimator through any sensor.
pub(crate) fn sample<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    stream: &str,
    (world, label): (World, String),
    settings: &Settings,
    progress: Progress<'_>,
) -> Sampled {
    let clock = settings.time.map(Clock::start);
    let mut passes = Passes::begin(stream, sensor.size(), settings, progress, clock.as_ref());
    let film = passes.render(t, sensor, estimator, amount(settings, stream));
    passes.finish(&film, world, label)
}

/// A render in progress, pass by pass.
pub(crate) struct Passes<'a, 'l> {
    progress: Progress<'a>,
    started: Instant,
    /// True if [`Passes::finish`] will be called: films are then read after each pass.
    read: bool,
    snapshots: Vec<Snapshot>,
    /// The seconds of the render, and the statistics of the film after the last pass.
    last: Option<(f64, Statistics)>,
    clock: Option<&'a Clock>,
    /// The caller's callback.
    look_on: Option<Look<'l>>,
}

impl<'a, 'l> Passes<'a, 'l> {
    /// Passes that double, without a clock and without a callback, for callers that use the film itself.
    pub(crate) fn of(progress: Progress<'a>) -> Self {
        let started = Instant::now();
        Self { progress, started, read: false, snapshots: vec![], last: None, clock: None, look_on: None }
    }

    /// The same with a callback after each pass.
    pub(crate) fn watched_by(self, look: Look<'l>) -> Self {
        Self { look_on: Some(look), ..self }
    }

    /// Begins a render. The clock, if there is one, limits its time.
    pub(crate) fn begin(
        what: &str,
        size: [u32; 2],
        settings: &Settings,
        progress: Progress<'a>,
        clock: Option<&'a Clock>,
    ) -> Self {
        let paths = u64::from(size[0]) * u64::from(size[1]) * u64::from(settings.spp);
        progress.begin(what, clock.map_or(paths, |c| c.time.as_millis() as u64));
        let progress = clock.map_or(progress, |clock| progress.by_clock(clock));
        Self { read: true, clock, ..Self::of(progress) }
    }

    /// The result of the render.
    pub(crate) fn finish(self, film: &TermFilm, world: World, label: String) -> Sampled {
        let slots = film.shape.slots;
        // a film that was stopped within a pass has not been read yet
        let (seconds, read) = self.last.unwrap_or_else(|| (self.started.elapsed().as_secs_f64(), Statistics::of(film)));
        let paths = film.samples.iter().map(|&n| u64::from(n)).sum();
        let cost = Cost { paths, rays: film.rays.iter().sum(), non_finite: film.non_finite, seconds };
        let Statistics { images, mut events, norms, functionals, replicates, tiles, .. } = read;
        let mut images = images.into_iter();
        let terms = images.by_ref().take(slots - 1).collect();
        let mut next = || images.next().unwrap_or_default();
        // without terms the only image is the whole
        let [tail, sum] = if slots > 1 { [next(), next()] } else { Default::default() };
        if slots == 1 {
            events.extend([0.0, events[0]]);
        }
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
            rays: film.rays.clone(),
            pixel_events: events,
            snapshots: self.snapshots,
            norms,
            spp: film.least_samples(),
        }
    }
}

impl Passes<'_, '_> {
    pub(crate) fn render<T: Transport>(
        &mut self,
        t: &T,
        sensor: &impl Sensor<T>,
        estimator: &impl TermEstimator<T>,
        amount: Amount,
    ) -> TermFilm {
        let progress = self.progress;
        render_in_passes(t, sensor, estimator, amount, progress, &mut |film, planned| self.look(film, planned))
    }

    /// Called after a pass: decides how far the next pass goes, and stores a snapshot of the variances. After the last pass
    /// the film is read once for all statistics.
    fn look(&mut self, film: &TermFilm, planned: u32) -> u32 {
        self.progress.film(film);
        let done = film.least_samples();
        let asked = self.look_on.as_mut().and_then(|look| look(film));
        let planned = asked.map_or(planned, |n| planned.min(n));
        let until = self.clock.map_or(planned, |clock| self.in_time(clock.time, film, planned));
        if !self.read {
            return until;
        }
        if until <= done {
            self.last = Some((self.started.elapsed().as_secs_f64(), Statistics::of(film)));
        }
        if film.shape.replicates > 1 {
            self.snapshots.push(self.last.as_ref().map_or_else(|| snapshot(film), |(_, read)| read.snapshot.clone()));
        }
        until
    }

    /// The number of samples that fits into the time at the speed so far, as a multiple of the number of replicates. The
    /// decision looks at no value, so means stay unbiased, and every pixel gets the same number.
    fn in_time(&self, time: Duration, film: &TermFilm, planned: u32) -> u32 {
        let each = self.started.elapsed().as_secs_f64() / f64::from(film.least_samples());
        let fits = (time.as_secs_f64() / each) as u32;
        // if a pass would leave less than a quarter of itself for the last one, the last one is included in it
        let until = if f64::from(fits) < 1.25 * f64::from(planned) { fits } else { planned };
        let replicates = film.shape.replicates as u32;
        until / replicates * replicates
    }
}
