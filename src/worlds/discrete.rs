//! The discrete world: patches, form factors, terms, solve, and the picture of them through the camera.
//!
//! `T_h = diag(ρ) F`, `L_h = (I − T_h)⁻¹ E`. A second mesh with a quarter of the patches, twice as coarse, read along the
//! same camera rays, gives the discretisation error |R_h − R_2h| that stands beside the Monte Carlo error in every verdict.

use super::{Observer, Settings, sampled, sampled::Sampled};
use crate::estimator::Gather;
use crate::operator::SceneTransport;
use crate::operator::form_factor::{FormFactors, Invariants, Sampling, Watch};
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::scene::{Description, Scene, SceneError};
use crate::solver::{Radiosity, Solution};
use crate::terms::{TermImage, World};
use glam::DVec3;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// A scene as a matrix, with everything that is printed about it.
pub struct Matrix {
    /// Patches and form factors.
    pub radiosity: Radiosity,
    /// `T_h^k E` per patch, k = 0..=K.
    pub terms: Vec<Vec<DVec3>>,
    /// `L_h` per patch, with its residual.
    pub solution: Solution,
    /// Closure, reciprocity, bounds of F.
    pub invariants: Invariants,
    /// Spectral radius per channel.
    pub spectral: [Spectral; 3],
    /// ‖T_h‖₁ and ‖T_h‖∞ per channel.
    pub norms: [(f64, f64); 3],
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

/// Meshes a scene into about `patches` patches and solves it.
///
/// # Errors
/// See [`MatrixError`].
pub fn matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    max_bounces: usize,
    observer: &dyn Observer,
    stop: &AtomicBool,
) -> Result<Matrix, MatrixError> {
    let patches = Patches::new(description, patches)?;
    observer.begin(&format!("form factors, {} patches", patches.len()), patches.len() as u64);
    let last = Mutex::new(0);
    let progress = |done: usize, _: usize| {
        let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if done > *last {
            observer.advance((done - *last) as u64);
            *last = done;
        }
    };
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
    let surface = terms.iter().map(|t| radiosity.surface_mean(t)).collect();
    Ok(Matrix { spectral, norms: radiosity.norms(), radiosity, terms, solution, invariants, surface })
}

impl Matrix {
    /// The terms and the solution through the camera of the scene.
    pub fn through_camera(
        &self,
        scene: &Scene,
        settings: &Settings,
        observer: &dyn Observer,
        stop: &AtomicBool,
    ) -> Sampled {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let gather = Gather::new(&self.radiosity.patches, &self.terms, &self.solution.radiance, settings.read_patches);
        let label = format!(
            "radiosity, {} patches{}",
            self.radiosity.patches.len(),
            if settings.read_patches { ", read" } else { "" }
        );
        sampled::sample(&t, &scene.camera, &gather, "radiosity", (World::Radiosity, label), settings, observer, stop)
    }
}

impl Matrix {
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

/// The fine matrix and its picture, and the picture of the coarse one.
pub struct Discrete {
    /// The mesh asked for.
    pub matrix: Matrix,
    /// Through the camera.
    pub fine: Sampled,
    /// The mesh twice as coarse, along the same rays.
    pub coarse: Sampled,
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
        let matrix = matrix(description, scene, patches, settings.max_bounces, observer, stop)?;
        let picture = matrix.through_camera(scene, settings, observer, stop);
        Ok::<_, MatrixError>((matrix, picture))
    };
    let (_, coarse) = one((settings.patches / 4).max(1))?;
    let (matrix, fine) = one(settings.patches)?;
    Ok(Discrete { matrix, fine, coarse })
}
