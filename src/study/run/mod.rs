//! One scene, solved in every way that is asked for, and what the ways say of each other.
//!
//! ```text
//! guide → terms → strategies → path tracer → matrix → norms over all surfaces → moments → radii, verdicts
//! ```
//!
//! | | place |
//! |---|---|
//! | what to do | [`Asked`], [`Settings`] |
//! | the work, in that order | [`Run::solve`] |
//! | what was found | the fields of [`Run`] |
//! | one world held against another | [`RunVerdict`] |
//! | what follows from it: rates, bounds, orders | [`facts`] |

pub mod facts;
mod verdicts;

use crate::engine::Settings;
use crate::engine::by_matrix::{self, Discrete, MatrixError};
use crate::engine::by_rays::{self, Estimator, Sampled};
use crate::engine::discretisation::Difference;
use crate::engine::guided::{self, Prepared};
use crate::progress::Progress;
use crate::scene::bsdf::Sampling;
use crate::scene::{Description, Scene};
use crate::study::roulette::{self, Radii};
use crate::study::strategies::{self, Strategy};
use crate::study::surface;
use crate::terms::functional::Replicates;
use crate::terms::{Recorded, Series, Variance, World};
pub use verdicts::RunVerdict;

/// What a run is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// Which realisations of T.
    pub worlds: Vec<World>,
    /// Estimators of the terms; the first is the one that is compared with the other worlds.
    pub estimators: Vec<Estimator>,
    /// The schedule with the most efficiency, in place of those of the settings.
    pub optimal_roulette: Option<roulette::Aim>,
    /// A guide of about so many patches.
    pub guide: Option<usize>,
    /// Every strategy of the bidirectional estimator.
    pub strategies: bool,
    /// So many stored rays a row on the patches of the matrix, to see how far they are from it.
    pub against_rays: Option<u32>,
    /// A third mesh, for the order of convergence.
    pub orders: bool,
    /// Estimators of the norms of the terms over all surfaces.
    pub surface: Vec<Estimator>,
    /// Moments of paths without roulette, where the terms are estimated by prefixes.
    pub moments: bool,
}

impl Default for Asked {
    /// All worlds, the terms by prefixes.
    fn default() -> Self {
        Self {
            worlds: World::ALL.to_vec(),
            estimators: vec![Estimator::Prefix],
            optimal_roulette: None,
            guide: None,
            strategies: false,
            against_rays: None,
            orders: false,
            surface: vec![Estimator::Single, Estimator::Prefix],
            moments: true,
        }
    }
}

/// A scene, how it is solved, and everything that was found.
///
/// ```
/// use fredholm::engine::Settings;
/// use fredholm::progress::Progress;
/// use fredholm::scene::{Scene, load};
/// use fredholm::stats::Outcome;
/// use fredholm::study::run::{Asked, Run};
///
/// let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
/// let room = load::scene("cornell", &options)?.description;
/// let scene = Scene::new(&room);
/// let settings = Settings { spp: 64, max_bounces: 3, patches: 60, ..Settings::default() };
///
/// // the series, the path tracer and the matrix
/// let mut run = Run::new(room, scene, settings, Asked::default());
/// run.solve(Progress::NONE)?;
/// assert_eq!(run.results().count(), 3);
/// assert!(run.verdicts.iter().all(|v| v.comparison.outcome != Outcome::Differs));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Run {
    /// The scene as data, for the mesh.
    pub description: Description,
    /// The scene for rays.
    pub scene: Scene,
    /// How it is solved; with an optimal roulette as found.
    pub settings: Settings,
    /// What is found out.
    pub asked: Asked,
    /// The terms by every estimator asked for, in that order.
    pub terms: Vec<Sampled>,
    /// The path tracer.
    pub path: Option<Sampled>,
    /// What guided both, if anything did.
    pub guide: Option<Prepared>,
    /// The matrix.
    pub radiosity: Option<Discrete>,
    /// How far stored rays are from it.
    pub against_rays: Option<Difference>,
    /// Three meshes, coarse to fine, for the order of convergence.
    pub meshes: Vec<Series>,
    /// Every strategy of the bidirectional estimator.
    pub strategies: Vec<Strategy>,
    /// ‖T^k E‖₁ by estimator.
    pub surface: Vec<(Estimator, Replicates)>,
    /// Whether the moments of the path tracer are finite, where its roulette is constant.
    pub radii: Option<Radii>,
    /// Moments of paths without roulette.
    pub moments: Option<Recorded>,
    /// What the worlds say of each other.
    pub verdicts: Vec<RunVerdict>,
}

impl Run {
    /// Nothing is solved yet.
    pub fn new(description: Description, scene: Scene, settings: Settings, asked: Asked) -> Self {
        Self {
            description,
            scene,
            settings,
            asked,
            terms: vec![],
            path: None,
            guide: None,
            radiosity: None,
            against_rays: None,
            meshes: vec![],
            strategies: vec![],
            surface: vec![],
            radii: None,
            moments: None,
            verdicts: vec![],
        }
    }

    /// Finds out everything that was asked for. Stopped early, it holds what there is by then.
    ///
    /// # Errors
    /// If the scene has no matrix, or no mesh for a guide.
    pub fn solve(&mut self, progress: Progress<'_>) -> Result<(), MatrixError> {
        if let Some(aim) = self.asked.optimal_roulette
            && let Some(best) = roulette::optimal(&self.scene, &self.settings, aim, progress)
        {
            (self.settings.roulette, self.settings.path_roulette) = (best.roulette.clone(), best.roulette);
        }
        if let Some(patches) = self.asked.guide {
            self.guide = guided::prepare(&self.description, patches, &self.settings, progress)?;
            // without its guide the run would not be the one that was asked for
            if self.guide.is_none() {
                return Ok(());
            }
        }
        self.by_rays(progress);
        if self.wants(World::Radiosity) && !progress.stopped() {
            self.by_matrix(progress)?;
        }
        self.aside(progress);
        if !self.is_empty() {
            self.judge();
        }
        Ok(())
    }

    /// Whether a world is asked for.
    pub fn wants(&self, world: World) -> bool {
        self.asked.worlds.contains(&world)
    }

    /// Terms, strategies and the path tracer.
    fn by_rays(&mut self, progress: Progress<'_>) {
        let (scene, settings) = (&self.scene, &self.settings);
        let estimators = if self.wants(World::Terms) { self.asked.estimators.as_slice() } else { &[] };
        // the quick estimator first, so that there is something to see
        for &estimator in estimators.iter().rev() {
            if !progress.stopped() {
                let guided = self.guide.as_ref().and_then(|g| g.terms(scene, estimator, settings, progress));
                let result = guided.unwrap_or_else(|| by_rays::terms(scene, estimator, settings, progress));
                self.terms.insert(0, result);
            }
        }
        if self.asked.strategies && !progress.stopped() {
            self.strategies = strategies::strategies(scene, settings, progress);
        }
        if self.wants(World::Path) && !progress.stopped() {
            self.path = Some(match &self.guide {
                Some(guide) => guide.path(scene, settings, progress),
                None => by_rays::path(scene, settings, progress),
            });
        }
    }

    /// The matrix, stored rays on its patches, and a coarser mesh.
    fn by_matrix(&mut self, progress: Progress<'_>) -> Result<(), MatrixError> {
        let (description, scene, settings) = (&self.description, &self.scene, &self.settings);
        let Some(found) = unless_stopped(by_matrix::radiosity(description, scene, settings, progress))? else {
            return Ok(());
        };
        if let (Some(rays), false) = (self.asked.against_rays, progress.stopped()) {
            self.against_rays = unless_stopped(found.matrix.against_rays(scene, rays, settings.seed, progress))?;
        }
        if self.asked.orders && !progress.stopped() {
            let patches = (settings.patches / 16).max(1);
            let coarsest = unless_stopped(by_matrix::matrix(description, scene, patches, settings, progress))?;
            if let Some(coarsest) = coarsest.map(|m| m.through_camera(scene, settings, progress)) {
                self.meshes = vec![coarsest.series, found.coarse.series.clone(), found.fine.series.clone()];
            }
        }
        self.radiosity = Some(found);
        Ok(())
    }

    /// What the terms look like without a camera, and without roulette.
    fn aside(&mut self, progress: Progress<'_>) {
        if !self.wants(World::Terms) {
            return;
        }
        let Settings { spp, max_bounces, .. } = self.settings;
        let reached = self.terms.iter().map(|t| t.spp).min().unwrap_or(0);
        let paths = reached.min(spp).max(1).saturating_mul(1024).min(1 << 22);
        for &estimator in &self.asked.surface {
            if !progress.stopped() {
                let norms = surface::norms(&self.scene, estimator, paths, &self.settings, progress);
                self.surface.push((estimator, norms));
            }
        }
        // 3 % of the run; none where that is less than two samples, or where moments of so many slots would fill the memory
        let prefixes = self.asked.moments && self.asked.estimators.contains(&Estimator::Prefix);
        if prefixes && spp >= 64 && max_bounces <= 64 && !progress.stopped() {
            self.moments = roulette::pilot(&self.scene, &self.settings, (spp / 32).min(16), progress);
        }
    }

    /// What the results say of each other, and of their own errors.
    fn judge(&mut self) {
        self.radii = self.moments_of_path();
        // a matrix knows more than walkers that may have missed where light is trapped
        if self.radii.and_then(|r| r.variance()) == Some(Variance::Infinite) {
            let alike = self.settings.roulette == self.settings.path_roulette;
            let terms = self.terms.iter_mut().filter(|_| alike);
            self.path.iter_mut().chain(terms).for_each(|s| s.distrust(Variance::Infinite));
        }
        self.verdicts = verdicts::verdicts(&self.terms, self.path.as_ref(), self.radiosity.as_ref());
    }

    /// Whether the variance of the path tracer is finite can be known from the matrix; a coarse one will do. Where there is
    /// none, the largest albedo gives a bound.
    fn moments_of_path(&self) -> Option<Radii> {
        let q = roulette::constant(&self.settings.path_roulette)?;
        // both speak of directions drawn by the cosine, without a guide
        if self.path.is_none() || self.guide.is_some() || self.settings.sampling == Sampling::Uniform {
            return None;
        }
        if let Some(matrix) = self.radiosity.as_ref().and_then(|r| r.matrix.radiosity.dense()) {
            return Some(Radii::new(Some(matrix), &self.scene, q));
        }
        let coarse = by_matrix::coarse(&self.description, &self.scene);
        Some(Radii::new(coarse.as_ref().map(|m| &m.radiosity), &self.scene, q))
    }
}

/// Work that was stopped is no error.
fn unless_stopped<T>(result: Result<T, MatrixError>) -> Result<Option<T>, MatrixError> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(MatrixError::Stopped) => Ok(None),
        Err(e) => Err(e),
    }
}
