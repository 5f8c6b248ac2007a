//! The continuous world: terms and path tracer by rays, from the scene to series and images.

use crate::engine::Settings;
pub use crate::engine::estimator::{Begins, Estimator, stream};
use crate::engine::known::coplanar::undecided;
use crate::engine::known::doubts::doubts;
use crate::engine::known::growth::{self, Growth};
use crate::engine::known::unsampled::unsampled;
use crate::engine::passes::{Passes, Watch};
pub use crate::engine::sampled::Sampled;
use crate::estimator::render::Amount;
use crate::estimator::{
    Bidirectional, Branching, LightTracer, PathTracer, Plan, Prefix, Roulette, SingleTerm, TermEstimator,
};
use crate::operator::{Adjoint, SceneTransport, Sensor, Transport};
use crate::progress::{Clock, Progress};
use crate::scene::Scene;
use crate::terms::{Estimate, Series, TermFilm, Variance, World};

/// Renders every term with the given estimator.
pub fn terms(scene: &Scene, estimator: Estimator, settings: &Settings, progress: Progress<'_>) -> Sampled {
    watched(scene, Some(estimator), settings, progress, Watch::NONE)
}

/// Renders with the full path tracer.
pub fn path(scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    watched(scene, None, settings, progress, Watch::NONE)
}

/// Renders the terms, or the path tracer if no estimator is given, and is watched while it does.
pub fn watched(
    scene: &Scene,
    estimator: Option<Estimator>,
    settings: &Settings,
    progress: Progress<'_>,
    watch: Watch<'_>,
) -> Sampled {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let (camera, points) = (&scene.camera.cropped(settings.crop), spread(settings));
    let stream = stream(estimator, false);
    let (amount, clock) = (amount(settings, &stream), settings.time.map(Clock::start));
    let what = estimator.map_or("path".into(), |e| format!("terms, {e}"));
    let mut passes = Passes::begin((&what, &stream), camera.crop.size, settings, progress, clock.as_ref(), watch);
    let Settings { technique, path_roulette, .. } = settings;
    let result = match estimator {
        Some(estimator) => {
            let film = film(&t, camera, estimator, settings.plan(), amount, &mut passes);
            // walks from the light ignore the technique
            let technique =
                if estimator.begins() == Begins::AtLight { String::new() } else { format!(", {technique}") };
            passes.finish(film, World::Terms, format!("{estimator}{technique}{points}"))
        }
        None => {
            let path = PathTracer(Plan { roulette: path_roulette.clone(), ..settings.plan() });
            let film = passes.render(&t, camera, &path, amount);
            passes.finish(film, World::Path, format!("path tracer, {technique}, roulette {path_roulette}{points}"))
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

/// What a result is called: the name of its random stream, its world and its label.
pub(crate) struct Title<'a> {
    pub stream: &'a str,
    pub world: World,
    pub label: String,
}

/// Renders any estimator through any sensor.
pub(crate) fn sample<T: Transport>(
    t: &T,
    sensor: &impl Sensor<T>,
    estimator: &impl TermEstimator<T>,
    Title { stream, world, label }: Title<'_>,
    settings: &Settings,
    progress: Progress<'_>,
    watch: Watch<'_>,
) -> Sampled {
    let clock = settings.time.map(Clock::start);
    let mut passes = Passes::begin((stream, stream), sensor.crop().size, settings, progress, clock.as_ref(), watch);
    let film = passes.render(t, sensor, estimator, amount(settings, stream));
    passes.finish(film, world, label)
}
