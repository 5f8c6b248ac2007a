//! Wrong on purpose: estimators that differ from the right one in one place, and what that does to the terms.
//!
//! ```text
//! r_k = T_k^wrong / T_k^right        c: the connection      c^(k−1): the bounce      c^k: the BSDF
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | X_k | one sample of a term, by a walk with hooks | [`walk`] |
//! | – | what may go wrong, and what is right | [`Mistake`] |
//! | r_k | signature of a mistake | [`Bug::ratio`], [`signature`] |
//! | p | is a render the right one? | [`judge`] |
//! | – | scene that shows it, and scene that cannot | [`Bug::exposed_by`], [`Bug::blind`] |
//!
//! | family | place |
//! |---|---|
//! | wrong constants | [`constants`] |
//! | Russian roulette | [`roulette`] |
//! | densities in the wrong measure | [`measures`] |
//! | directions | [`directions`] |
//! | shares of two techniques | [`mis_weights`] |
//! | lights | [`lights`] |
//! | mirrors and glass | [`specular`] |
//! | bookkeeping and display | [`bookkeeping`] |
//!
//! A furnace is blind to any error in *where* rays go; a scene with one light to how lights are chosen; a scene of Lambertian
//! surfaces to what happens at glass. Hence two scenes per member. References: Veach, *Robust Monte Carlo Methods for Light Transport Simulation*
//! (1997); Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed. 2023).

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
use crate::engine::by_rays::{self, Sampled};
use crate::estimator::{Plan, Roulette, Technique};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::World;

/// How the paths of a member end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ends {
    /// As the settings say.
    AsSet,
    /// With probability q at every vertex: what is wrong is roulette.
    Roulette(f64),
    /// At K: the wrong series need not converge.
    AtK,
}

/// A member of the zoo.
pub struct Bug {
    /// Its name, as the command line takes it.
    pub name: &'static str,
    /// What is wrong, in one line.
    pub what: &'static str,
    /// Where: the right formula and the wrong one.
    pub place: &'static str,
    /// What comes out instead, in closed form where it is known.
    pub expected: &'static str,
    /// The signature in words.
    pub signature: &'static str,
    /// r_k on the scene that shows it, where it is the same in every scene of that kind; nothing where it depends on the scene.
    pub ratio: fn(k: usize) -> Option<f64>,
    /// How it finds light.
    pub technique: Technique,
    /// How its paths end.
    pub ends: Ends,
    /// The scene that shows it.
    pub exposed_by: Stage,
    /// The scene that cannot; nothing where only the whole image is right, of every scene.
    pub blind: Option<Stage>,
    /// Samples per pixel of a picture of [`PIXELS`]² pixels that are enough to reject it.
    pub spp: u32,
    /// The one place where it is wrong.
    pub mistake: &'static dyn Mistake,
}

/// Width and height of the pictures that the declared sample sizes are for.
pub const PIXELS: u32 = 16;

/// Every member, family by family.
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

/// The member of that name.
///
/// ```
/// assert!(fredholm::zoo::find("double-emission").is_some());
/// assert!(fredholm::zoo::find("double-omission").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static Bug> {
    all().into_iter().find(|bug| bug.name == name)
}

impl Bug {
    /// The plan of its renderer, and of the right one that it is compared with.
    pub fn plan(&self, settings: &Settings) -> Plan {
        let roulette = match self.ends {
            Ends::AsSet => settings.roulette.clone(),
            Ends::Roulette(q) => Roulette::Constant { from: 0, q },
            Ends::AtK => Roulette::Never,
        };
        Plan { max_bounces: settings.max_bounces, technique: self.technique, roulette }
    }
}

/// What the wrong renderer gives: terms, tail, and `total`, which it would call its image.
pub fn render(bug: &Bug, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    of(&bug.plan(settings), bug.mistake, bug.name, scene, settings, progress)
}

/// What the right renderer of the same plan gives, from numbers of its own.
pub fn render_right(bug: &Bug, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
    of(&bug.plan(settings), &Right, "right", scene, settings, progress)
}

/// The walk of a plan with a mistake, through the camera of the scene; `stream` names its random numbers.
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
    let label = (World::Terms, format!("walk, {}", plan.technique));
    let mut result = by_rays::sample(&t, &scene.camera, &walk(), stream, label.clone(), settings, progress);
    if mistake.finishes() {
        // the image is no sum of its terms: the same paths again, of which only the sum is finished
        let whole = by_rays::sample(&t, &scene.camera, &walk::Whole(walk()), stream, label, settings, progress);
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
