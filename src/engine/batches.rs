//! One side of a comparison batch by batch: a way of rendering, one batch at a time.
//!
//! Batch i is a complete image of `settings.spp` samples per pixel. It uses stream i of its way of rendering and its seed,
//! so batches are independent and identically distributed. Errors come from the scatter of the batches, because a single
//! batch has none.

use crate::engine::Settings;
use crate::engine::by_rays::{Estimator, film, variance};
use crate::engine::known::coplanar::undecided;
use crate::engine::known::doubts::doubts;
use crate::engine::known::unsampled::unsampled;
use crate::engine::passes::Passes;
use crate::estimator::render::{Amount, render};
use crate::estimator::{PathTracer, Plan};
use crate::operator::SceneTransport;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::terms::functional::functionals;
use crate::terms::{Cost, Estimate, Functional, Series, World};

/// One way of rendering.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// The estimator of the terms; None for the path tracer.
    pub estimator: Option<Estimator>,
    /// The settings; `spp` is the number of samples per pixel of one batch.
    pub settings: Settings,
}

/// Result of one batch.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Image mean, regions, projections.
    pub functionals: Vec<Functional>,
    /// Paths started.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Samples that were not finite.
    pub non_finite: u64,
}

impl Side {
    /// Label for tables, which begins with the estimator and the technique: `prefix, mis`.
    pub fn label(&self) -> String {
        let Settings { technique, roulette, path_roulette, max_bounces, .. } = &self.settings;
        let cut = |ends: bool| if ends { String::new() } else { format!(", k ≤ {max_bounces} only") };
        match self.estimator {
            // walks from the light ignore the technique
            Some(Estimator::Light) => format!("light{}", cut(roulette.ends())),
            Some(e) => format!("{e}, {technique}, roulette {roulette}{}", cut(roulette.ends())),
            None => format!("path tracer, {technique}, roulette {path_roulette}{}", cut(path_roulette.ends())),
        }
    }

    /// Returns true if paths end by roulette. Otherwise nothing longer than K is estimated.
    fn ends(&self) -> bool {
        if self.estimator.is_some() { self.settings.roulette.ends() } else { self.settings.path_roulette.ends() }
    }

    /// Renders batch `index`. `name` separates the random streams of two sides that render in the same way.
    pub fn batch(&self, scene: &Scene, name: &str, index: u32) -> Batch {
        let settings = &self.settings;
        let stream = self.estimator.map_or("path".into(), |e| e.to_string());
        let key = settings.key(&format!("batches, {name}: {stream}"), 1).branch(index);
        let amount = Amount { spp: settings.spp, replicates: 1, key };
        let t = SceneTransport { scene, sampling: settings.sampling };
        let film = match self.estimator {
            Some(estimator) => {
                film(&t, &scene.camera, estimator, settings.plan(), amount, &mut Passes::of(Progress::NONE))
            }
            None => {
                let plan = Plan { roulette: settings.path_roulette.clone(), ..settings.plan() };
                render(&t, &scene.camera, &PathTracer(plan), amount, Progress::NONE)
            }
        };
        let mut functionals = functionals(&film);
        if !self.ends() {
            functionals.iter_mut().for_each(|f| f.tail = Estimate::NONE);
        }
        Batch {
            functionals,
            paths: film.samples.iter().map(|&n| u64::from(n)).sum(),
            rays: film.rays.iter().sum(),
            non_finite: film.non_finite,
        }
    }

    /// A result without numbers. It lists the paths that this way of rendering cannot find in a scene, and the doubts about
    /// its samples. Its cost is that of one batch.
    pub fn limits(&self, scene: &Scene) -> Series {
        let unsampled = unsampled(scene, self.estimator, self.settings.technique);
        let [w, h] = scene.camera.size.map(u64::from);
        let paths = w * h * u64::from(self.settings.spp);
        let t = SceneTransport { scene, sampling: self.settings.sampling };
        Series {
            world: if self.estimator.is_some() { World::Terms } else { World::Path },
            label: self.label(),
            functionals: vec![],
            cost: Cost { paths, ..Cost::default() },
            unsampled,
            doubts: doubts(scene, self.estimator, &self.settings),
            undecided: undecided(scene),
            variance: variance(&t, self.estimator, &self.settings),
        }
    }
}
