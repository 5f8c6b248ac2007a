//! The zoo: a collection of estimators that are wrong on purpose. Each *member* differs from the correct estimator in one
//! place. The zoo shows how each mistake changes the terms.
//!
//! ```text
//! r_k = T_k^wrong / T_k^right        c: the connection      c^(k−1): the bounce      c^k: the BSDF
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_k | one sample of a term, by a path tracer with replaceable steps | [`walk`] |
//! | – | the steps that a mistake may replace, with their correct versions | [`Mistake`] |
//! | r_k | signature of a mistake: its effect on each term | [`Bug::ratio`], [`signature`] |
//! | p | p-value of "this render is correct" | [`judge`] |
//! | – | a scene that shows the mistake, and a scene that does not | [`Bug::exposed_by`], [`Bug::blind`] |
//!
//! | family | place |
//! |---|---|
//! | wrong constants | [`constants`] |
//! | Russian roulette | [`roulette`] |
//! | densities in the wrong measure | [`measures`] |
//! | directions | [`directions`] |
//! | weights of two techniques (MIS) | [`mis_weights`] |
//! | lights | [`lights`] |
//! | mirrors and glass | [`specular`] |
//! | bookkeeping and display | [`bookkeeping`] |
//!
//! Every scene hides some mistakes. In a furnace, errors in the *directions* of rays have no effect. With one light, a wrong
//! choice among lights has no effect. With Lambertian surfaces only, errors at glass have no effect. Each member therefore
//! names two scenes. References: Veach, *Robust Monte Carlo Methods for Light Transport Simulation* (1997); Pharr, Jakob,
//! Humphreys, *Physically Based Rendering* (4th ed. 2023).

pub mod bookkeeping;
pub mod constants;
pub mod directions;
pub mod judge;
pub mod lights;
pub mod measures;
pub mod mis_weights;
pub mod mistake;
pub mod roulette;
pub mod signature;
pub mod specular;
pub mod stage;
pub mod walk;

pub use mistake::{Mistake, Right};
pub use stage::Stage;
pub use walk::Walk;

use crate::engine::Settings;
use crate::engine::by_rays::{self, Sampled, Title};
use crate::engine::passes::Watch;
use crate::estimator::{Plan, Roulette, Technique};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::World;

/// Rule by which the paths of a member are terminated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// As given in the settings.
    AsSet,
    /// Russian roulette with probability of termination q at every vertex. Used by members whose mistake is in the roulette.
    Roulette(f64),
    /// After K bounces, without roulette, because the wrong series may diverge.
    AtK,
}

/// One member of the zoo: an estimator with one mistake.
pub struct Bug {
    /// Name, as given on the command line.
    pub name: &'static str,
    /// Description of the mistake, in one line.
    pub what: &'static str,
    /// The step that is wrong, with the correct formula and the wrong one.
    pub place: &'static str,
    /// The wrong result, in closed form where it is known.
    pub expected: &'static str,
    /// How the mistake shows in the ratios r_k = T_k wrong / T_k correct.
    pub signature: &'static str,
    /// r_k on the scene that shows the mistake. None if the value depends on the scene.
    pub ratio: fn(k: usize) -> Option<f64>,
    /// Technique by which it finds light.
    pub technique: Technique,
    /// Rule by which its paths end.
    pub ends: Ends,
    /// A scene that shows the mistake.
    pub exposed_by: Stage,
    /// A scene that does not show it. None if only the whole image is correct, on every scene.
    pub blind: Option<Stage>,
    /// Samples per pixel at which the mistake is detected in an image of [`PIXELS`]² pixels.
    pub spp: u32,
    /// The step of the path tracer that this member replaces.
    pub mistake: &'static dyn Mistake,
}

/// Width and height of the images for which [`Bug::spp`] is declared.
pub const PIXELS: u32 = 16;

/// All members, family by family.
pub fn all() -> Vec<&'static Bug> {
    let families: [&'static [Bug]; 8] = [
        &constants::BUGS,
        &roulette::BUGS,
        &measures::BUGS,
        &directions::BUGS,
        &mis_weights::BUGS,
        &lights::BUGS,
        &specular::BUGS,
        &bookkeeping::BUGS,
    ];
    families.into_iter().flatten().collect()
}

/// The member with the given name.
///
/// ```
/// assert!(fredholm::zoo::find("double-emission").is_some());
/// assert!(fredholm::zoo::find("double-omission").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static Bug> {
    all().into_iter().find(|bug| bug.name == name)
}

impl Bug {
    /// The plan of its renderer. The correct renderer with which it is compared uses the same plan.
    pub fn plan(&self, settings: &Settings) -> Plan {
        let roulette = match self.ends {
            Ends::AsSet => settings.roulette.clone(),
            Ends::Roulette(q) => Roulette::Constant { from: 0, q },
            Ends::AtK => Roulette::Never,
        };
        Plan { max_bounces: settings.max_bounces, technique: self.technique, roulette }
    }
}

/// Renders with the mistake: terms, tail, and in `total` what the wrong renderer would output as its image.
pub fn render(bug: &Bug, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    of(&bug.plan(settings), bug.mistake, bug.name, scene, settings, progress)
}

/// Renders correctly with the same plan, from independent random numbers.
pub fn render_right(bug: &Bug, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    of(&bug.plan(settings), &Right, "right", scene, settings, progress)
}

/// Renders the camera image of a scene with a given mistake. `stream` names the random numbers, so that different streams
/// are independent.
pub fn of(
    plan: &Plan,
    mistake: &dyn Mistake,
    stream: &str,
    scene: &Scene,
    settings: &Settings,
    progress: Progress<'_>,
) -> Sampled {
    let t = SceneTransport { scene, sampling: settings.sampling };
    let walk = || Walk { plan: plan.clone(), mistake };
    let title = || Title { stream, world: World::Terms, label: format!("walk, {}", plan.technique) };
    let mut result = by_rays::sample(&t, &scene.camera, &walk(), title(), settings, progress, Watch::NONE);
    if mistake.finishes() {
        // this image is not the sum of its terms: trace the same paths again, and apply `finish` to their sum
        let whole = by_rays::sample(&t, &scene.camera, &walk::Whole(walk()), title(), settings, progress, Watch::NONE);
        result.total = whole.total;
        for (f, w) in result.series.functionals.iter_mut().zip(whole.series.functionals) {
            f.total = w.total;
        }
    }
    if !plan.roulette.ends() {
        by_rays::cut(&mut result.series, settings);
    }
    result
}
