//! One scene, solved in several ways, and the comparisons of the results.
//!
//! ```text
//! guide → terms → strategies → path tracer → matrix → norms over all surfaces → moments → radii, verdicts
//! ```
//!
//! | | place |
//! |---|---|
//! | settings of the run | [`Asked`], [`Settings`] |
//! | the work, in the order above | [`Run::solve`] |
//! | results | the fields of [`Run`] |
//! | images of the first samples | [`Run::early`] |
//! | how many paths the results without images get | `share` |
//! | comparison of two results | [`RunVerdict`] |
//! | rates, bounds and orders that follow | [`facts`] |

pub mod facts;
mod share;
mod verdicts;

use crate::engine::Settings;
use crate::engine::by_matrix::{self, Discrete, MatrixError};
use crate::engine::by_rays::{self, Estimator, Sampled};
use crate::engine::discretisation::Difference;
use crate::engine::guided::{self, Prepared};
use crate::engine::passes::{Keep, Watch};
use crate::engine::rows;
use crate::progress::Progress;
use crate::scene::bsdf::Sampling;
use crate::scene::{Description, Scene};
use crate::study::bounces::{Bounces, bounces};
use crate::study::lit::{Lit, lit};
use crate::study::roulette::{self, Radii};
use crate::study::strategies::{self, Strategy};
use crate::study::surface;
use crate::terms::functional::Replicates;
use crate::terms::history::Early;
use crate::terms::{Recorded, Variance, World};
use rayon::prelude::*;
use share::{Share, Together};
pub use verdicts::RunVerdict;

/// The results that a run computes.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The realisations of T: rays for the terms, rays for the path tracer, a matrix.
    pub worlds: Vec<World>,
    /// Estimators of the terms. The first one is compared with the path tracer and the matrix.
    pub estimators: Vec<Estimator>,
    /// Use the roulette schedule that is most efficient for this quantity instead of the one in the settings.
    pub optimal_roulette: Option<roulette::Aim>,
    /// Guide the paths by a radiosity solution with about this number of patches.
    pub guide: Option<usize>,
    /// Also render each strategy of the bidirectional estimator separately.
    pub strategies: bool,
    /// Also solve on the patches of the matrix with this number of stored rays per patch, and compare.
    pub against_rays: Option<u32>,
    /// Also solve on a third mesh, for the order of convergence.
    pub orders: bool,
    /// The estimators that measure the norms of the terms over all surfaces.
    pub surface: Vec<Estimator>,
    /// Also measure how many bounces are enough, and which bounce lights which surface.
    pub bounces: bool,
    /// Also record the moments of paths without roulette, if the terms are estimated by prefixes.
    pub moments: bool,
}

impl Default for Asked {
    /// All three results, the terms by prefixes.
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
            bounces: true,
            moments: true,
        }
    }
}

/// A scene, its settings and all results.
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
    /// The scene as plain data; the mesh is made from it.
    pub description: Description,
    /// The scene that rays are traced in.
    pub scene: Scene,
    /// The settings. If an optimal roulette was asked for, they hold the one that was found.
    pub settings: Settings,
    /// The results to compute.
    pub asked: Asked,
    /// The terms, one result for each estimator, in the order of [`Asked::estimators`].
    pub terms: Vec<Sampled>,
    /// The result of the path tracer.
    pub path: Option<Sampled>,
    /// The guide of the paths, if there is one.
    pub guide: Option<Prepared>,
    /// The result of the matrix.
    pub radiosity: Option<Discrete>,
    /// The difference between stored rays and the matrix.
    pub against_rays: Option<Difference>,
    /// The pictures of three meshes, coarse to fine, for the order of convergence; otherwise empty.
    pub meshes: Vec<Sampled>,
    /// Each strategy of the bidirectional estimator.
    pub strategies: Vec<Strategy>,
    /// ‖T^k E‖₁ over all surfaces, by estimator.
    pub surface: Vec<(Estimator, Replicates)>,
    /// The terms up to k = 100, which tell how many bounces are enough.
    pub bounces: Option<Bounces>,
    /// The terms of each surface, which tell which bounce lights it.
    pub lit: Vec<Lit>,
    /// Spectral radii that tell whether the variance of the path tracer is finite, if its roulette is constant.
    pub radii: Option<Radii>,
    /// Moments of paths without roulette.
    pub moments: Option<Recorded>,
    /// The comparisons of the results.
    pub verdicts: Vec<RunVerdict>,
}

impl Run {
    /// A run that is not solved yet.
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
            bounces: None,
            lit: vec![],
            radii: None,
            moments: None,
            verdicts: vec![],
        }
    }

    /// Computes everything that was asked for. If it is stopped early, it holds the results so far.
    ///
    /// # Errors
    /// If the scene has no matrix, or no mesh for a guide.
    pub fn solve(&mut self, progress: Progress<'_>) -> Result<(), MatrixError> {
        self.solve_kept(progress, None)
    }

    /// The same; the states of the films of terms and path tracer are kept, and go on from those in which they were left. Rows of
    /// stored rays that `keep` has are not traced.
    ///
    /// # Errors
    /// As of [`Run::solve`].
    pub fn solve_kept(&mut self, progress: Progress<'_>, keep: Option<&dyn Keep>) -> Result<(), MatrixError> {
        if !self.prepare(progress)? {
            return Ok(());
        }
        self.by_rays(progress, keep);
        if self.wants(World::Radiosity) && !progress.stopped() {
            self.by_matrix(progress, keep)?;
        }
        self.aside(progress);
        if !self.is_empty() {
            self.judge();
        }
        Ok(())
    }

    /// Renders the films and traces the stored rays of the part of `keep`, which then holds them, and does nothing else.
    ///
    /// # Errors
    /// If the scene has no matrix, or no mesh for a guide.
    pub fn part(&mut self, progress: Progress<'_>, keep: &dyn Keep) -> Result<(), MatrixError> {
        if self.wants(World::Radiosity) {
            let Self { description, scene, settings, .. } = &*self;
            unless_stopped(rows::keep_rows(description, scene, settings, progress, keep))?;
        }
        if progress.stopped() {
            return Ok(());
        }
        if self.prepare(progress)? {
            self.by_rays(progress, Some(keep));
        }
        Ok(())
    }

    /// Chooses the roulette and builds the guide. Returns false if that was stopped.
    fn prepare(&mut self, progress: Progress<'_>) -> Result<bool, MatrixError> {
        if let Some(aim) = self.asked.optimal_roulette
            && let Some(best) = roulette::optimal(&self.scene, &self.settings, aim, progress)
        {
            (self.settings.roulette, self.settings.path_roulette) = (best.roulette.clone(), best.roulette);
        }
        if let Some(patches) = self.asked.guide {
            self.guide = guided::prepare(&self.description, patches, &self.settings, progress)?;
            // without the guide the result would be another one
            return Ok(self.guide.is_some());
        }
        Ok(true)
    }

    /// Width and height of the pictures in pixels: of the camera's, or of the part of it that is rendered.
    pub fn size(&self) -> [u32; 2] {
        self.settings.crop.map_or(self.scene.camera.size, |crop| crop.size)
    }

    /// Images of the first samples of the first result in [`Run::terms`].
    pub fn early(&self) -> &[Early] {
        self.terms.first().map_or(&[], |t| &t.early)
    }

    /// Returns true if this realisation of T is asked for.
    pub fn wants(&self, world: World) -> bool {
        self.asked.worlds.contains(&world)
    }

    /// Computes the terms, the strategies and the path tracer.
    fn by_rays(&mut self, progress: Progress<'_>, keep: Option<&dyn Keep>) {
        let (scene, settings) = (&self.scene, &self.settings);
        let estimators = if self.wants(World::Terms) { self.asked.estimators.as_slice() } else { &[] };
        // the last estimator is the fastest, so the first preview appears early
        for &estimator in estimators.iter().rev() {
            if !progress.stopped() {
                // only the images of the first estimator are shown
                let watch = || Watch { early: estimators.first() == Some(&estimator), keep, look: None };
                let guided = self.guide.as_ref().and_then(|g| g.terms(scene, estimator, settings, progress, watch()));
                let result =
                    guided.unwrap_or_else(|| by_rays::watched(scene, Some(estimator), settings, progress, watch()));
                self.terms.insert(0, result);
            }
        }
        if self.asked.strategies && !progress.stopped() {
            self.strategies = strategies::strategies(scene, settings, progress);
        }
        if self.wants(World::Path) && !progress.stopped() {
            let watch = Watch { keep, ..Watch::NONE };
            self.path = Some(match &self.guide {
                Some(guide) => guide.path(scene, settings, progress, watch),
                None => by_rays::watched(scene, None, settings, progress, watch),
            });
        }
    }

    /// Computes the matrix, stored rays on its patches, and a coarser mesh.
    fn by_matrix(&mut self, progress: Progress<'_>, keep: Option<&dyn Keep>) -> Result<(), MatrixError> {
        let (description, scene, settings) = (&self.description, &self.scene, &self.settings);
        let Some(found) = unless_stopped(by_matrix::radiosity(description, scene, settings, progress, keep))? else {
            return Ok(());
        };
        if let (Some(rays), false) = (self.asked.against_rays, progress.stopped()) {
            self.against_rays = unless_stopped(found.matrix.against_rays(scene, rays, settings.seed, progress))?;
        }
        if self.asked.orders && !progress.stopped() {
            let patches = (settings.patches / 16).max(1);
            let coarsest = unless_stopped(by_matrix::matrix(description, scene, patches, settings, progress))?;
            if let Some(coarsest) = coarsest.map(|m| m.through_camera(scene, settings, progress)) {
                self.meshes = vec![coarsest, found.coarse.clone(), found.fine.clone()];
            }
        }
        self.radiosity = Some(found);
        Ok(())
    }

    /// Computes the results without images: norms over surfaces, long terms, light by surface, moments.
    fn aside(&mut self, progress: Progress<'_>) {
        if !self.wants(World::Terms) {
            return;
        }
        let (description, scene, settings) = (&self.description, &self.scene, &self.settings);
        let reached = self.terms.iter().map(|t| t.spp).min().unwrap_or(0).clamp(1, settings.spp.max(1));
        let rays = self.terms.iter().map(|t| t.series.cost.rays).min().unwrap_or(0);
        let share = Share::of(self.size(), reached, rays, settings.max_bounces);
        // where the paths of the run never end by roulette, the scene may keep all its light, and these paths would not end either
        let longer = self.asked.bounces && settings.roulette.ends();
        let prefixes = self.asked.moments && self.asked.estimators.contains(&Estimator::Prefix);
        // left out if there are few samples, or if the moments of that many terms would fill the memory
        let moments = prefixes && settings.spp >= 64 && settings.max_bounces <= 64;
        let work = Together(progress);
        progress.begin("surfaces, long terms, moments", share.all(self.asked.surface.len(), longer, moments));
        let inner = Progress::to(&work);
        let inner = progress.stop_flag().map_or(inner, |flag| inner.stopped_by(flag));
        let goes_on = |asked: bool| asked && !inner.stopped();
        let norms = || {
            let one = |&e: &Estimator| {
                (!inner.stopped()).then(|| (e, surface::norms(scene, e, share.norms, settings, inner)))
            };
            self.asked.surface.par_iter().filter_map(one).collect()
        };
        let bounces = || goes_on(longer).then(|| bounces(scene, share.bounces, settings, inner)).flatten();
        let lit = || if goes_on(longer) { lit(description, scene, share.lit, settings, inner) } else { vec![] };
        let (samples, pixels) = share.moments(settings.spp);
        let moments =
            || goes_on(moments).then(|| roulette::pilot_of(scene, settings, samples, pixels, inner)).flatten();
        // each of these has less work for several threads than all of them together
        let ((norms, moments), (bounces, lit)) =
            rayon::join(|| rayon::join(norms, moments), || rayon::join(bounces, lit));
        (self.surface, self.moments, self.bounces, self.lit) = (norms, moments, bounces, lit);
    }

    /// Compares the results, and removes error bars whose variance is infinite.
    fn judge(&mut self) {
        self.radii = self.moments_of_path();
        // the matrix sees every place where light is trapped; random walks may have missed it
        if self.radii.and_then(|r| r.variance()) == Some(Variance::Infinite) {
            let alike = self.settings.roulette == self.settings.path_roulette;
            let terms = self.terms.iter_mut().filter(|_| alike);
            self.path.iter_mut().chain(terms).for_each(|s| s.distrust(Variance::Infinite));
        }
        self.verdicts = verdicts::verdicts(&self.terms, self.path.as_ref(), self.radiosity.as_ref());
    }

    /// Spectral radii that decide whether the variance of the path tracer is finite. They come from the matrix; a coarse one
    /// is enough. Without a matrix the largest albedo gives a bound.
    fn moments_of_path(&self) -> Option<Radii> {
        let q = roulette::constant(&self.settings.path_roulette)?;
        // the matrix and the bound assume cosine-distributed directions and no guide
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

/// Turns the error "stopped" into no result.
fn unless_stopped<T>(result: Result<T, MatrixError>) -> Result<Option<T>, MatrixError> {
    match result {
        Ok(found) => Ok(Some(found)),
        Err(MatrixError::Stopped) => Ok(None),
        Err(e) => Err(e),
    }
}
