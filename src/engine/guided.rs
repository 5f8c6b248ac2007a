//! The continuous world with the discrete one as its guide: the same terms, from directions that know where the light is.
//!
//! `L_h → p(ω) → T^k E`: the matrix of some hundred patches decides where rays look, the scene decides what they see.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Estimator, Sampled, annotated, spread};
use crate::engine::known::growth::{self, FromEye, Growth};
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

/// What tells rays where to look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guiding {
    /// The surface alone.
    #[default]
    Bsdf,
    /// The matrix over patches.
    Radiosity,
}

impl Guiding {
    /// All of them.
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

/// Patches of a guide unless told otherwise.
pub const PATCHES: usize = 4000;

/// A guide, and what it cost.
pub struct Prepared {
    /// Where to look.
    pub guide: Guide,
    /// How it was made.
    pub recipe: Recipe,
    /// How long that took.
    pub time: Duration,
}

/// Makes the guide of a scene from about so many patches; nothing when stopped. Its numbers have a stream of their own, so it depends
/// on the seed alone.
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
    // where nothing connects to the lamps, rays must find them
    let recipe = Recipe { patches, emission: !settings.technique.connects(), ..Recipe::default() };
    let key = Key::new(settings.seed, "guide");
    let guide = Guide::new(description, recipe, key, progress)?;
    Ok(guide.map(|guide| Prepared { guide, recipe, time: started.elapsed() }))
}

impl Prepared {
    /// The guided walk in a scene.
    pub fn transport<'a>(&'a self, scene: &'a Scene, settings: &Settings) -> GuidedTransport<'a> {
        GuidedTransport { scene: SceneTransport { scene, sampling: settings.sampling }, guide: &self.guide }
    }

    /// The settings with the time that is left after the guide's preparation.
    fn rest(&self, settings: &Settings) -> Settings {
        Settings { time: settings.time.map(|t| t.saturating_sub(self.time)), ..settings.clone() }
    }

    fn label(&self, name: &str, settings: &Settings) -> String {
        let patches = self.guide.len();
        format!("{name}, {}{}, guided by {patches} patches", settings.technique, spread(settings.points))
    }

    /// Every term by its own estimator; nothing for one that walks from the light.
    pub fn terms(
        &self,
        scene: &Scene,
        estimator: Estimator,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Option<Sampled> {
        let (t, settings) = (self.transport(scene, settings), &self.rest(settings));
        let (plan, camera, stream) = (settings.plan(), &scene.camera, format!("guided {estimator}"));
        let name = (World::Terms, self.label(&estimator.to_string(), settings));
        let end = settings.by_expectation.filter(|_| estimator == Estimator::Prefix);
        let result = match (estimator, end) {
            (Estimator::Prefix, Some(end)) => {
                let (t, camera) = (Tracked(&t), TrackedSensor(camera));
                let Plan { max_bounces, technique, .. } = plan;
                let prefix = guide::Prefix { max_bounces, technique, end };
                by_rays::sample(&t, &camera, &prefix, &stream, name, settings, progress)
            }
            (Estimator::Prefix, None) => by_rays::sample(&t, camera, &Prefix(plan), &stream, name, settings, progress),
            (Estimator::Single, _) => by_rays::sample(&t, camera, &SingleTerm(plan), &stream, name, settings, progress),
            (Estimator::Branching { children }, _) => {
                let tree = Branching { plan, children };
                by_rays::sample(&t, camera, &tree, &stream, name, settings, progress)
            }
            (Estimator::Light | Estimator::Bidirectional, _) => return None,
        };
        let doubt = doubt(&t, end, settings.roulette_of(Some(estimator)), settings);
        Some(annotated(result, scene, Some(estimator), settings).judged(doubt))
    }

    /// The full path tracer.
    pub fn path(&self, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
        let (t, settings) = (self.transport(scene, settings), &self.rest(settings));
        let (roulette, end) = (&settings.path_roulette, settings.by_expectation);
        let how = end.map_or(roulette.to_string(), |end| end.to_string());
        let name = (World::Path, self.label("path tracer", settings) + &format!(", roulette {how}"));
        let path = guide::PathTracer { plan: Plan { roulette: roulette.clone(), ..settings.plan() }, end };
        let result = by_rays::sample(&t, &scene.camera, &path, "guided path", name, settings, progress);
        let doubt = doubt(&t, end, roulette, settings);
        annotated(result, scene, None, settings).judged(doubt)
    }
}

/// A guide's weights are what they are: whether they grow is measured.
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
