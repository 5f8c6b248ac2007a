//! The continuous world with the discrete one as its guide: the same terms, but with more rays in directions from which much
//! light comes.
//!
//! `L_h → p(ω) → T^k E`: the coarse matrix solution L_h gives the density p of directions. The scene alone decides what the
//! rays hit, so the result stays unbiased.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Estimator, Sampled, Title, annotated, spread};
use crate::engine::known::growth::{self, FromEye, Growth};
use crate::engine::passes::Watch;
use crate::estimator::{Branching, Plan, Prefix, Roulette, SingleTerm};
use crate::guide::tracked::{Track, Tracked, TrackedSensor};
use crate::guide::{self, ByExpectation, Guide, GuidedTransport, Recipe};
use crate::math::{Key, names::named};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::{Description, Scene, SceneError, Vertex};
use crate::terms::World;
use std::fmt;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// Source of the density of directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guiding {
    /// The BSDF of the surface alone.
    #[default]
    Bsdf,
    /// The matrix over patches, as a guide.
    Radiosity,
}

impl Guiding {
    /// All sources.
    pub const ALL: [Self; 2] = [Self::Bsdf, Self::Radiosity];
}

impl fmt::Display for Guiding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Bsdf { "bsdf" } else { "radiosity" })
    }
}

impl FromStr for Guiding {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        named(&Self::ALL, name)
    }
}

/// Default number of patches of a guide.
pub const PATCHES: usize = 4000;

/// A guide, with its settings and its cost.
pub struct Prepared {
    /// The guide.
    pub guide: Guide,
    /// The settings from which it was built.
    pub recipe: Recipe,
    /// The time that this took.
    pub time: Duration,
}

/// Builds the guide of a scene from about `patches` patches; None if stopped. Its random numbers have a separate stream,
/// which depends on the seed alone.
///
/// # Errors
/// If the scene cannot be meshed.
pub fn prepare(
    description: &Description,
    patches: usize,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Option<Prepared>, SceneError> {
    let started = Instant::now();
    // if nothing connects to the lamps, rays must find them
    let recipe = Recipe { patches, emission: !settings.technique.connects(), ..Recipe::default() };
    let key = Key::new(settings.seed, "guide");
    let guide = Guide::new(description, recipe, key, progress)?;
    Ok(guide.map(|guide| Prepared { guide, recipe, time: started.elapsed() }))
}

impl Prepared {
    /// The guided transport in a scene.
    pub fn transport<'a>(&'a self, scene: &'a Scene, settings: &Settings) -> GuidedTransport<'a> {
        GuidedTransport { scene: SceneTransport { scene, sampling: settings.sampling }, guide: &self.guide }
    }

    /// The settings with the time that is left after the guide's preparation.
    fn rest(&self, settings: &Settings) -> Settings {
        Settings { time: settings.time.map(|t| t.saturating_sub(self.time)), ..settings.clone() }
    }

    fn label(&self, name: &str, settings: &Settings) -> String {
        let patches = self.guide.len();
        format!("{name}, {}{}, guided by {patches} patches", settings.technique, spread(settings))
    }

    /// Renders every term with the given estimator; None for an estimator that walks from the light.
    pub fn terms(
        &self,
        scene: &Scene,
        estimator: Estimator,
        settings: &Settings,
        progress: Progress<'_>,
        watch: Watch<'_>,
    ) -> Option<Sampled> {
        let (t, settings) = (self.transport(scene, settings), &self.rest(settings));
        let (plan, camera, stream) =
            (settings.plan(), &scene.camera.cropped(settings.crop), by_rays::stream(Some(estimator), true));
        let label = self.label(&estimator.to_string(), settings);
        let title = Title { stream: &stream, world: World::Terms, label };
        let end = settings.by_expectation.filter(|_| estimator == Estimator::Prefix);
        let result = match (estimator, end) {
            (Estimator::Prefix, Some(end)) => {
                let (t, camera) = (Tracked(&t), TrackedSensor(camera));
                let Plan { max_bounces, technique, .. } = plan;
                let prefix = guide::Prefix { max_bounces, technique, end };
                by_rays::sample(&t, &camera, &prefix, title, settings, progress, watch)
            }
            (Estimator::Prefix, None) => by_rays::sample(&t, camera, &Prefix(plan), title, settings, progress, watch),
            (Estimator::Single, _) => by_rays::sample(&t, camera, &SingleTerm(plan), title, settings, progress, watch),
            (Estimator::Branching { children }, _) => {
                let tree = Branching { plan, children };
                by_rays::sample(&t, camera, &tree, title, settings, progress, watch)
            }
            (Estimator::Light | Estimator::Bidirectional, _) => return None,
        };
        let doubt = doubt(&t, end, settings.roulette_of(Some(estimator)), settings);
        Some(annotated(result, scene, Some(estimator), settings).judged(doubt))
    }

    /// Renders with the full path tracer.
    pub fn path(&self, scene: &Scene, settings: &Settings, progress: Progress<'_>, watch: Watch<'_>) -> Sampled {
        let (t, settings) = (self.transport(scene, settings), &self.rest(settings));
        let (roulette, end) = (&settings.path_roulette, settings.by_expectation);
        let how = end.map_or(roulette.to_string(), |end| end.to_string());
        let label = self.label("path tracer", settings) + &format!(", roulette {how}");
        let title = Title { stream: &by_rays::stream(None, true), world: World::Path, label };
        let path = guide::PathTracer { plan: Plan { roulette: roulette.clone(), ..settings.plan() }, end };
        let result = by_rays::sample(&t, &scene.camera.cropped(settings.crop), &path, title, settings, progress, watch);
        let doubt = doubt(&t, end, roulette, settings);
        annotated(result, scene, None, settings).judged(doubt)
    }
}

/// Growth of the variance with a guide. It is always measured, because nothing is proved about the weights of a guide.
fn doubt(
    t: &GuidedTransport<'_>,
    end: Option<ByExpectation>,
    roulette: &Roulette,
    settings: &Settings,
) -> Option<Growth> {
    let camera = &t.scene.scene.camera;
    match end {
        Some(end) => {
            let q = |v: usize, throughput, at: &Track<Vertex>| end.q(t, v, throughput, &at.x, at.start);
            let walk = FromEye { t: &Tracked(t), sensor: &TrackedSensor(camera), q };
            growth::doubt(&walk, end.from(), settings)
        }
        None if roulette.ends() => growth::doubt_from_eye(t, camera, roulette, settings),
        None => None,
    }
}
