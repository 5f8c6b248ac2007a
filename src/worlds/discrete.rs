//! The discrete world: patches, form factors, terms, solve, and the picture of them through the camera.
//!
//! `T_h = diag(ρ) F` as a matrix or as stored rays ([`realisation`](super::realisation)), `L_h = (I − T_h)⁻¹ E`. A second mesh with a quarter of the patches, twice as coarse, read along the
//! same camera rays, gives the discretisation error |R_h − R_2h| that stands beside the Monte Carlo error in every verdict.

use super::coplanar::undecided;
use super::radius::{Radius, radii, sampled_noise};
use super::realisation::{Difference, Factors, Realisation, Sampling as RaySampling, Stored};
use super::{Observer, Settings, sampled, sampled::Sampled};
use crate::estimator::Gather;
use crate::operator::SceneTransport;
use crate::operator::form_factor::{FormFactors, Invariants, Sampling, Watch};
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{Half, Hit, Light, Rays, Record, record};
use crate::scene::{Description, Scene, SceneError};
use crate::solver::{Radiosity, Solution};
use crate::terms::{TermImage, World};
use glam::DVec3;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// A scene as a matrix, with everything that is printed about it.
pub struct Matrix<R = Realisation> {
    /// Patches and form factors.
    pub radiosity: R,
    /// `T_h^k E` per patch, k = 0..=K.
    pub terms: Vec<Vec<DVec3>>,
    /// `L_h` per patch, with its residual.
    pub solution: Solution,
    /// Closure, reciprocity, bounds of F.
    pub invariants: Invariants,
    /// Spectral radius per channel.
    pub spectral: [Spectral; 3],
    /// The same with its width and noise; of many stored rays before it on unions of up to 16 and up to 4 patches.
    pub radii: Vec<Radius>,
    /// ‖T_h‖₁ and ‖T_h‖∞ per channel of a dense matrix; columns of stored rays are too noisy for the first.
    pub norms: Option<[(f64, f64); 3]>,
    /// The error bar of stored rays.
    pub sampling: Option<RaySampling>,
    /// Surface means `Σ A_i (T_h^k E)_i / A`.
    pub surface: Vec<DVec3>,
}

/// From this spectral radius on a channel keeps all its light, as far as form factors can tell.
const KEEPS_ALL: f64 = 1.0 - 1e-6;

/// Why there is no matrix.
#[derive(Debug, thiserror::Error)]
pub enum MatrixError {
    /// The scene cannot be meshed.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// `I − T_h` is singular: a channel keeps all its light.
    #[error(
        "error: a channel keeps all its light, so L = E + T L has no solution\nhelp: lower a reflectance below 1, or look at the first terms alone with --worlds terms,path --roulette none"
    )]
    Singular,
    /// Interrupted.
    #[error("interrupted")]
    Stopped,
}

/// The Neumann series of stored rays ends when what is left is this small against the sum.
const LEFT: f64 = 1e-7;
/// Or after so many steps; the residual then tells.
const MOST_STEPS: usize = 2000;

/// Meshes a scene into about `patches` patches and solves it.
///
/// # Errors
/// See [`MatrixError`].
pub fn matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    settings: &Settings,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Matrix, MatrixError> {
    Ok(match settings.factors {
        Factors::Dense => {
            let (k, grading) = (settings.max_bounces, settings.grading);
            dense_matrix(description, scene, patches, grading, k, observer, stop)?.held_as(Realisation::from)
        }
        Factors::Rays(n) => {
            sampled_matrix(description, scene, patches, n, settings, observer, stop)?.held_as(Realisation::from)
        }
    })
}

/// The same as a dense matrix, for what asks for its entries.
///
/// # Errors
/// See [`MatrixError`].
pub fn dense_matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    grading: f64,
    max_bounces: usize,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Matrix<Radiosity>, MatrixError> {
    dense(Patches::graded(description, patches, grading)?, scene, max_bounces, observer, stop)
}

/// The same as `per_row` stored rays, for what applies T once more.
///
/// # Errors
/// See [`MatrixError`].
pub fn sampled_matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    per_row: u32,
    settings: &Settings,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Matrix<Stored>, MatrixError> {
    let patches = Patches::graded(description, patches, settings.grading)?;
    let rays = trace(&patches, scene, per_row, settings.seed, observer, stop)?;
    by_rays(Stored { patches, rays }, settings.max_bounces)
}

/// Passes the highest count of rows on.
fn rows(observer: &dyn Observer) -> impl Fn(usize, usize) + Sync + '_ {
    let last = Mutex::new(0);
    move |done: usize, _: usize| {
        let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if done > *last {
            observer.advance((done - *last) as u64);
            *last = done;
        }
    }
}

fn dense(
    patches: Patches,
    scene: &Scene,
    max_bounces: usize,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Matrix<Radiosity>, MatrixError> {
    observer.begin(&format!("form factors, {} patches", patches.len()), patches.len() as u64);
    let progress = rows(observer);
    let watch = Watch { progress: Some(&progress), stop: Some(stop) };
    let factors = FormFactors::new(&patches, scene, Sampling::default(), watch).map_err(|_| MatrixError::Stopped)?;
    let invariants = factors.invariants();
    let radiosity = Radiosity::new(patches, factors);
    // LU of a matrix that is singular but for rounding succeeds, and means nothing
    let spectral = radiosity.spectral_radius();
    if spectral.iter().any(|s| s.radius >= KEEPS_ALL) {
        return Err(MatrixError::Singular);
    }
    let terms = radiosity.terms(max_bounces);
    let solution = radiosity.solve().map_err(|_| MatrixError::Singular)?;
    let surface = terms.iter().map(|t| radiosity.patches.surface_mean(t)).collect();
    let norms = Some(radiosity.norms());
    let radii = vec![Radius::of(&radiosity.patches, &spectral, DVec3::ZERO)];
    Ok(Matrix { spectral, radii, norms, radiosity, terms, solution, invariants, sampling: None, surface })
}

fn trace(
    patches: &Patches,
    scene: &Scene,
    per_row: u32,
    seed: u64,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Rays, MatrixError> {
    if patches.len() > Hit::MOST {
        let e = SceneError::new(format!("{} patches, and rows of rays hold {} at most", patches.len(), Hit::MOST));
        return Err(e.help("fewer --patches; of many triangles every side is one patch at least").into());
    }
    observer.begin(&format!("{per_row} rays from each of {} patches", patches.len()), patches.len() as u64);
    let progress = rows(observer);
    let watch = Watch { progress: Some(&progress), stop: Some(stop) };
    Rays::new(patches, scene, per_row as usize, seed, watch).map_err(|_| MatrixError::Stopped)
}

fn by_rays(stored: Stored, max_bounces: usize) -> Result<Matrix<Stored>, MatrixError> {
    let light = Light { patches: &stored.patches, rays: &stored.rays };
    let (solution, spectral, sampling) = solve_by_rays(&light)?;
    let c = sampling.checks;
    let invariants = Invariants {
        closure: (1.0 - c.row_sum_min).abs().max((1.0 - c.row_sum_max).abs()),
        row_sum_min: c.row_sum_min,
        row_sum_max: c.row_sum_max,
        reciprocity: c.reciprocity,
        smallest: 0.0,
        largest: c.largest,
    };
    let noise = sampled_noise(&light, &spectral);
    let radii = radii(&stored.patches, &spectral, noise, |x| light.bounce(x, Half::Both));
    // last, for they are most of the memory beside the rows
    let terms = light.terms(max_bounces);
    let surface = terms.iter().map(|t| stored.patches.surface_mean(t)).collect();
    let sampling = Some(sampling);
    Ok(Matrix { radiosity: stored, terms, solution, invariants, spectral, radii, norms: None, sampling, surface })
}

fn solve_by_rays(light: &Light<'_>) -> Result<(Solution, [Spectral; 3], RaySampling), MatrixError> {
    let solved = light.solve(LEFT, MOST_STEPS);
    // the last term is close to the top mode; where the series has died out, start from ρ
    let died = (0..3).any(|c| solved.last.iter().all(|x| x[c] == 0.0));
    let albedo = || light.patches.iter().map(|p| record(p.reflectance)).collect::<Vec<Record>>();
    let spectral = light.spectral_radius(&if died { albedo() } else { solved.last }, 1e-7, 500);
    if spectral.iter().any(|s| s.radius >= KEEPS_ALL) {
        return Err(MatrixError::Singular);
    }
    let u: Vec<DVec3> = solved.radiance.iter().zip(light.patches.iter()).map(|(l, p)| *l - p.emission).collect();
    let noise = light.norm(&light.noise(&solved.radiance)) / light.norm(&u);
    let sampling = RaySampling { per_row: light.rays.per_row, noise, checks: light.checks(), steps: solved.steps };
    Ok((Solution { radiance: solved.radiance, residual: solved.residual }, spectral, sampling))
}

impl Matrix {
    /// The same mesh by stored rays, and how far the reflected light is from this one.
    ///
    /// # Errors
    /// See [`MatrixError`].
    pub fn against_rays(
        &self,
        scene: &Scene,
        per_row: u32,
        seed: u64,
        observer: &dyn Observer,
        stop: &AtomicBool,
    ) -> Result<Difference, MatrixError> {
        let patches = self.radiosity.patches();
        let rays = trace(patches, scene, per_row, seed, observer, stop)?;
        let light = Light { patches, rays: &rays };
        let (solution, spectral, sampling) = solve_by_rays(&light)?;
        let pairs = self.solution.radiance.iter().zip(&solution.radiance);
        let apart: Vec<DVec3> = pairs.map(|(a, b)| *a - *b).collect();
        let u: Vec<DVec3> = self.solution.radiance.iter().zip(patches.iter()).map(|(l, p)| *l - p.emission).collect();
        Ok(Difference { of_u: light.norm(&apart) / light.norm(&u), spectral, sampling })
    }

    /// The terms and the solution through the camera of the scene.
    pub fn through_camera(
        &self,
        scene: &Scene,
        settings: &Settings,
        observer: &dyn Observer,
        stop: &AtomicBool,
    ) -> Sampled {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let gather = Gather::new(self.radiosity.patches(), &self.terms, &self.solution.radiance, settings.read_patches);
        let label = format!(
            "radiosity, {} patches{}{}",
            self.radiosity.patches().len(),
            self.sampling.map_or(String::new(), |s| format!(" of {} rays", s.per_row)),
            if settings.read_patches { ", read" } else { "" }
        );
        let world = (World::Radiosity, label);
        let mut seen = sampled::sample(&t, &scene.camera, &gather, "radiosity", world, settings, observer, stop);
        seen.series.undecided = undecided(scene);
        seen
    }
}

impl Matrix<Radiosity> {
    /// Functions on the patches through the camera, after one more bounce: the image i shows `T fields[i]`, in colours as
    /// albedos are. A mode of eigenvalue λ is seen smooth, and λ times as bright.
    pub fn paint(
        &self,
        scene: &Scene,
        fields: &[Vec<f64>],
        settings: &Settings,
        observer: &dyn Observer,
        stop: &AtomicBool,
    ) -> Vec<TermImage> {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let patches = &self.radiosity.patches;
        let nothing = vec![DVec3::ZERO; patches.len()];
        // slot s gathers from what stands at s − 1; slots 0 and 1 are the scene's own light
        let mut terms = vec![nothing.clone()];
        terms.extend(fields.iter().map(|f| f.iter().map(|v| DVec3::splat(*v)).collect()));
        terms.push(nothing.clone());
        let gather = Gather { patches, terms: &terms, tail: nothing, read_patches: false };
        let world = (World::Radiosity, "modes".to_string());
        let mut seen = sampled::sample(&t, &scene.camera, &gather, "modes", world, settings, observer, stop);
        seen.terms.drain(2..2 + fields.len()).collect()
    }
}

impl<R> Matrix<R> {
    /// The same, with T held in another way.
    fn held_as<S>(self, form: impl FnOnce(R) -> S) -> Matrix<S> {
        Matrix {
            radiosity: form(self.radiosity),
            terms: self.terms,
            solution: self.solution,
            invariants: self.invariants,
            spectral: self.spectral,
            radii: self.radii,
            norms: self.norms,
            sampling: self.sampling,
            surface: self.surface,
        }
    }
}

/// The fine matrix and its picture, and the picture of the coarse one.
pub struct Discrete {
    /// The mesh asked for.
    pub matrix: Matrix,
    /// Through the camera.
    pub fine: Sampled,
    /// The mesh twice as coarse, along the same rays.
    pub coarse: Sampled,
    /// Spectral radii, coarsest first: of this mesh and of two coarser ones, or of unions of its patches; of this one alone
    /// where neither will do.
    pub radii: Vec<Radius>,
}

/// The whole discrete world.
///
/// # Errors
/// See [`MatrixError`].
pub fn radiosity(
    description: &Description,
    scene: &Scene,
    settings: &Settings,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Discrete, MatrixError> {
    let one = |patches: usize| {
        let matrix = matrix(description, scene, patches, settings, observer, stop)?;
        let picture = matrix.through_camera(scene, settings, observer, stop);
        Ok::<_, MatrixError>((matrix, picture))
    };
    let (second, coarse) = one((settings.patches / 4).max(1))?;
    let (fine_matrix, fine) = one(settings.patches)?;
    let mut radii = fine_matrix.radii.clone();
    if fine_matrix.radiosity.dense().is_some() {
        let coarsest = matrix(description, scene, (settings.patches / 16).max(1), settings, observer, stop)?;
        radii = coarsest.radii.into_iter().chain(second.radii).chain(radii).collect();
    }
    Ok(Discrete { matrix: fine_matrix, fine, coarse, radii })
}
