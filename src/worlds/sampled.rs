//! The continuous world: terms and path tracer, from rays to series and images.

use super::{
    Observer, Settings,
    coplanar::undecided,
    doubts::doubts,
    growth::{self, Growth},
    unsampled::unsampled,
};
use crate::estimator::render::{Amount, Watch, render};
use crate::estimator::{
    Bidirectional, Branching, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, TermEstimator,
};
use crate::math::Points;
use crate::operator::{Adjoint, SceneTransport, Sensor, Transport};
use crate::scene::Scene;
use crate::terms::functional::{Replicates, functionals, image_replicates};
use crate::terms::image::events_of_pixels;
use crate::terms::norms::{SquaredNorm, squared_norm};
use crate::terms::variance::{Snapshot, snapshot};
use crate::terms::{Cost, Estimate, Series, TermFilm, TermImage, Variance, World};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Which estimator of the terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// Each term from paths of its own.
    Single,
    /// All terms from the prefixes of one path.
    Prefix,
    /// All terms from one particle, walked from the light.
    Light,
    /// All terms from walks from both ends.
    Bidirectional,
    /// A tree of paths.
    Branching {
        /// Children of every vertex.
        children: u32,
    },
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single => f.write_str("single"),
            Self::Prefix => f.write_str("prefix"),
            Self::Light => f.write_str("light"),
            Self::Bidirectional => f.write_str("bidirectional"),
            Self::Branching { children } => write!(f, "branching {children}"),
        }
    }
}

/// What rays gave: means with errors, images, and how the errors fell.
#[derive(Clone, Debug)]
pub struct Sampled {
    /// Means and errors.
    pub series: Series,
    /// Images of T^k E, k = 0..=K; none for the path tracer.
    pub terms: Vec<TermImage>,
    /// Image of everything longer.
    pub tail: TermImage,
    /// Image of Σ_{k≤K}.
    pub sum: TermImage,
    /// The whole image.
    pub total: TermImage,
    /// The image mean by replicate, for covariances between terms.
    pub replicates: Replicates,
    /// Rays asked for, by slot.
    pub rays: Vec<u64>,
    /// Events of the pixel in the middle: of every slot, of the sum over k ≤ K, of the whole.
    pub pixel_events: Vec<f64>,
    /// Variances at 1, 2, 4, … samples per replicate.
    pub snapshots: Vec<Snapshot>,
    /// Squared L2 norms of the term images; none with fewer than three replicates.
    pub norms: Vec<Option<SquaredNorm>>,
    /// Least samples per pixel: fewer than asked for when interrupted.
    pub spp: u32,
    /// Why the tail and the whole have no error bar, where their variance is not known to be finite.
    pub doubt: Option<Growth>,
}

/// Every term by its own estimator.
pub fn terms(
    scene: &Scene,
    estimator: Estimator,
    settings: &Settings,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Sampled {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let amount = amount(settings, &estimator.to_string());
    let mut run = Run::new(&format!("terms, {estimator}"), scene.camera.size, settings, observer);
    let film = film(&t, &scene.camera, estimator, settings.plan(), amount, &mut run, stop);
    // a walk from the light has no use for a technique
    let technique = if estimator == Estimator::Light { String::new() } else { format!(", {}", settings.technique) };
    let label = format!("{estimator}{technique}{}", spread(settings.points));
    let result = run.finish(&film, World::Terms, label);
    let doubt = doubt(&t, Some(estimator), settings);
    annotated(result, scene, Some(estimator), settings).judged(doubt)
}

/// Whether what an estimator (`None` for the path tracer) says beyond its terms has a finite variance.
pub(crate) fn variance(t: &SceneTransport<'_>, estimator: Option<Estimator>, settings: &Settings) -> Variance {
    doubt(t, estimator, settings).map_or(Variance::Finite, |growth| growth.variance())
}

/// Why an estimator (`None` for the path tracer) has no error bar beyond its terms, if it has none.
pub(crate) fn doubt(t: &SceneTransport<'_>, estimator: Option<Estimator>, settings: &Settings) -> Option<Growth> {
    let roulette = settings.roulette_of(estimator);
    if growth::proved(t.scene, t.sampling, roulette) {
        return None;
    }
    match estimator {
        Some(Estimator::Light) => {
            let found = growth::growth(&growth::FromLight { t, roulette }, roulette.settled(), 2, settings.seed);
            (found.variance() != Variance::Finite).then_some(found)
        }
        _ => growth::doubt_from_eye(t, &t.scene.camera, roulette, settings),
    }
}

impl Sampled {
    /// The same without the error bars of the tail and of the whole, where there is a doubt.
    pub(crate) fn judged(mut self, doubt: Option<Growth>) -> Self {
        self.doubt = doubt;
        if let Some(d) = doubt {
            self.distrust(d.variance());
        }
        self
    }

    /// Takes back the error bars of the tail and of the whole, in numbers and in images.
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
    /// How the paths of an estimator (`None` for the path tracer) end.
    pub fn roulette_of(&self, estimator: Option<Estimator>) -> &Roulette {
        if estimator.is_some() { &self.roulette } else { &self.path_roulette }
    }
}

/// A result with what its estimator (`None` for the path tracer) cannot find in the scene, and where its paths are cut.
pub(super) fn annotated(
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

/// Any estimator of the terms over any transport, through any sensor.
pub(super) fn film<T: Adjoint>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: Estimator,
    plan: Plan,
    amount: Amount,
    watch: &mut impl Watch,
    stop: &AtomicBool,
) -> TermFilm {
    match estimator {
        Estimator::Prefix => render(t, sensor, &Prefix(plan), amount, watch, stop),
        Estimator::Single => render(t, sensor, &SingleTerm(plan), amount, watch, stop),
        Estimator::Light => render(t, sensor, &LightTracer(plan), amount, watch, stop),
        Estimator::Bidirectional => render(t, sensor, &Bidirectional(plan), amount, watch, stop),
        Estimator::Branching { children } => render(t, sensor, &Branching { plan, children }, amount, watch, stop),
    }
}

/// The full path tracer.
pub fn path(scene: &Scene, settings: &Settings, observer: &dyn Observer, stop: &AtomicBool) -> Sampled {
    let plan = Plan { roulette: settings.path_roulette.clone(), ..settings.plan() };
    let t = SceneTransport { scene, sampling: settings.sampling };
    let Settings { technique, path_roulette, points, .. } = settings;
    let label = format!("path tracer, {technique}, roulette {path_roulette}{}", spread(*points));
    let result = sample(&t, &scene.camera, &PathTracer(plan), "path", (World::Path, label), settings, observer, stop);
    let doubt = doubt(&t, None, settings);
    annotated(result, scene, None, settings).judged(doubt)
}

/// Replicates of a render of many samples.
const REPLICATES: u32 = 16;

/// The usual amount, from the stream of that name.
pub(super) fn amount(settings: &Settings, stream: &str) -> Amount {
    let amount = Amount::new(settings.spp, settings.key(stream, 1));
    Amount { key: settings.key(stream, amount.replicates), ..amount }
}

/// What a label says of points that are not the usual ones.
pub(super) fn spread(points: Points) -> &'static str {
    if points == Points::Sobol { ", Sobol points" } else { "" }
}

/// Paths that no roulette ends are cut at K: says so, and that nothing is known about what is longer.
pub(crate) fn cut(series: &mut Series, settings: &Settings) {
    series.label += &format!(", k ≤ {} only", settings.max_bounces);
    series.functionals.iter_mut().for_each(|f| f.tail = Estimate::NONE);
}

/// Any estimator through any sensor.
#[allow(clippy::too_many_arguments)] // the list of what a render is; a struct would only rename it
pub(crate) fn sample<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    stream: &str,
    (world, label): (World, String),
    settings: &Settings,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Sampled {
    let amount = amount(settings, stream);
    let mut run = Run::new(stream, sensor.size(), settings, observer);
    let film = render(t, sensor, estimator, amount, &mut run, stop);
    run.finish(&film, world, label)
}

/// A render under way.
pub(super) struct Run<'a> {
    observer: &'a dyn Observer,
    started: Instant,
    snapshots: Vec<Snapshot>,
    /// How long it may take, and how many milliseconds of that have been reported.
    time: Option<(Duration, AtomicU64)>,
}

impl<'a> Run<'a> {
    pub(super) fn new(what: &str, size: [u32; 2], settings: &Settings, observer: &'a dyn Observer) -> Self {
        let paths = u64::from(size[0]) * u64::from(size[1]) * u64::from(settings.spp);
        observer.begin(what, settings.time.map_or(paths, |t| t.as_millis() as u64));
        let time = settings.time.map(|t| (t, AtomicU64::new(0)));
        Self { observer, started: Instant::now(), snapshots: vec![], time }
    }

    pub(super) fn finish(self, film: &TermFilm, world: World, label: String) -> Sampled {
        let slots = film.shape.slots;
        let paths = film.samples.iter().map(|&n| u64::from(n)).sum();
        let cost = Cost {
            paths,
            rays: film.rays.iter().sum(),
            non_finite: film.non_finite,
            seconds: self.started.elapsed().as_secs_f64(),
        };
        let image = |s: usize| TermImage::of(film, s..s + 1);
        let parts = (0..slots).map(|s| s..s + 1).chain([0..slots - 1, 0..slots]);
        Sampled {
            series: Series {
                world,
                label,
                functionals: functionals(film),
                cost,
                unsampled: vec![],
                doubts: vec![],
                undecided: None,
                variance: Variance::Finite,
            },
            doubt: None,
            terms: (0..slots - 1).map(image).collect(),
            tail: if slots > 1 { image(slots - 1) } else { TermImage::default() },
            sum: if slots > 1 { TermImage::of(film, 0..slots - 1) } else { TermImage::default() },
            total: TermImage::of(film, 0..slots),
            replicates: image_replicates(film),
            rays: film.rays.clone(),
            pixel_events: parts.map(|p| events_of_pixels(film, p)).collect(),
            snapshots: self.snapshots,
            norms: (0..slots - 1).map(|s| squared_norm(film, s)).collect(),
            spp: film.least_samples(),
        }
    }
}

impl Watch for Run<'_> {
    fn paths(&self, paths: u64) {
        match &self.time {
            None => self.observer.advance(paths),
            Some((_, reported)) => {
                let now = self.started.elapsed().as_millis() as u64;
                self.observer.advance(now.saturating_sub(reported.fetch_max(now, Ordering::Relaxed)));
            }
        }
    }
    /// As many samples of whole replicates as fit into the time at the speed so far; the decision does not look at any value, so that
    /// means stay unbiased, and every pixel gets the same number.
    fn until(&self, done: u32, planned: u32) -> u32 {
        let planned = self.observer.stop(done).filter(|&n| n > done).map_or(planned, |n| planned.min(n));
        let Some((time, _)) = &self.time else { return planned };
        let each = self.started.elapsed().as_secs_f64() / f64::from(done);
        let fits = (time.as_secs_f64() / each) as u32;
        // a pass that would leave less than a quarter for the last one takes it along
        let until = if f64::from(fits) < 1.25 * f64::from(planned) { fits } else { planned };
        until / REPLICATES * REPLICATES
    }
    fn pass(&mut self, film: &TermFilm) {
        self.observer.preview(film);
        if film.shape.replicates > 1 {
            self.snapshots.push(snapshot(film));
        }
    }
}
