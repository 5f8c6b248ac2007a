//! The discrete world: patches, form factors, terms, the solution, and their images through the camera.
//!
//! `T_h = diag(ρ) F` is a matrix or a set of stored rays ([`discretisation`](crate::engine::discretisation)), and
//! `L_h = (I − T_h)⁻¹ E`. A second mesh has a quarter of the patches and is twice as coarse. Seen along the same camera
//! rays, it gives the discretisation error |R_h − R_2h| of a result R. Every verdict adds this error to the Monte Carlo
//! error.

use crate::engine::Settings;
use crate::engine::by_rays::{self, Sampled, Title};
use crate::engine::discretisation::{Difference, Discretisation, Factors, SampledRows, Stored};
use crate::engine::known::coplanar::undecided;
pub use crate::engine::matrix_error::MatrixError;
use crate::engine::passes::{Keep, Watch};
use crate::engine::radius::{Radius, radii, sampled_noise};
use crate::engine::rows::{mesh, trace};
pub use crate::engine::unlit::Unlit;
use crate::engine::unlit::unlit;
use crate::estimator::Gather;
use crate::operator::SceneTransport;
use crate::operator::form_factor::{FormFactors, Invariants, VisibilitySampling};
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{Half, Hit, Light, Rays, Record, Solved, record};
use crate::progress::Progress;
use crate::scene::{Description, Scene};
use crate::solver::{Radiosity, Solution, residual, settle};
use crate::terms::{TermImage, World};
use glam::DVec3;

/// A scene as a matrix, with everything that is reported about it.
pub struct Matrix<R = Discretisation> {
    /// T_h with its patches.
    pub radiosity: R,
    /// `T_h^k E` per patch, for k = 0..=K.
    pub terms: Vec<Vec<DVec3>>,
    /// `L_h` per patch, with its residual.
    pub solution: Solution,
    /// Checks of F: closure, reciprocity, bounds.
    pub invariants: Invariants,
    /// Spectral radius per channel.
    pub spectral: [Spectral; 3],
    /// Spectral radius with its mesh width and noise. If there are many stored rays, the radii on unions of up to 16 and up
    /// to 4 patches come before it.
    pub radii: Vec<Radius>,
    /// ‖T_h‖₁ and ‖T_h‖∞ per channel. None for stored rays, whose columns are too noisy for the first norm.
    pub norms: Option<[(f64, f64); 3]>,
    /// Error bar of stored rays; None for a dense matrix.
    pub sampling: Option<SampledRows>,
    /// Surface means `Σ A_i (T_h^k E)_i / A`.
    pub surface: Vec<DVec3>,
    /// Sides that light never reaches. All fields above leave them out.
    pub unlit: Vec<Unlit>,
}

/// A channel with at least this spectral radius loses no light, as far as form factors can show.
const KEEPS_ALL: f64 = 1.0 - 1e-6;

/// The Neumann series of stored rays ends when the remainder is this small compared with the sum.
const LEFT: f64 = 1e-7;
/// The Neumann series of stored rays has at most this number of terms. If that is not enough, GMRES, another iterative solver,
/// takes over.
const MOST_STEPS: usize = 2000;
/// GMRES must bring the residual below this value, as in [`settle`].
const SETTLED: f64 = 1e-8;

/// Meshes a scene into about `patches` patches and solves it.
///
/// # Errors
/// See [`MatrixError`].
pub fn matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Matrix, MatrixError> {
    kept_matrix(description, scene, patches, settings, progress, None)
}

/// Like [`matrix`], with the rows of rays that all parts of a run have traced, if `keep` has them.
///
/// # Errors
/// See [`MatrixError`].
pub fn kept_matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    settings: &Settings,
    progress: Progress<'_>,
    keep: Option<&dyn Keep>,
) -> Result<Matrix, MatrixError> {
    Ok(match settings.factors {
        Factors::Dense => {
            let (k, grading) = (settings.max_bounces, settings.grading);
            dense_matrix(description, scene, patches, grading, k, progress)?.held_as(Discretisation::from)
        }
        Factors::Rays(n) => {
            let mesh = mesh(settings, patches);
            let patches = Patches::graded(description, patches, settings.grading)?;
            let kept = keep.and_then(|keep| keep.rows(&mesh, &patches, n as usize));
            stored(patches, kept, scene, n, settings, progress)?.held_as(Discretisation::from)
        }
    })
}

/// Like [`matrix`], but always as a dense matrix, for callers that need its entries.
///
/// # Errors
/// See [`MatrixError`].
pub fn dense_matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    grading: f64,
    max_bounces: usize,
    progress: Progress<'_>,
) -> Result<Matrix<Radiosity>, MatrixError> {
    dense(Patches::graded(description, patches, grading)?, scene, max_bounces, progress)
}

/// A coarse dense matrix without terms; None if the scene has no cheap one.
pub fn coarse(description: &Description, scene: &Scene) -> Option<Matrix<Radiosity>> {
    if scene.sides() > 400 || description.radiosity_suits().is_err() {
        return None;
    }
    dense_matrix(description, scene, 150, 1.0, 0, Progress::NONE).ok()
}

/// Like [`matrix`], but as `per_row` stored rays per patch, for callers that apply T once more.
///
/// # Errors
/// See [`MatrixError`].
pub fn sampled_matrix(
    description: &Description,
    scene: &Scene,
    patches: usize,
    per_row: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Matrix<Stored>, MatrixError> {
    let patches = Patches::graded(description, patches, settings.grading)?;
    stored(patches, None, scene, per_row, settings, progress)
}

/// The matrix of stored rays on a mesh: of those that are kept, or else of rays that are traced now.
fn stored(
    patches: Patches,
    kept: Option<Rays>,
    scene: &Scene,
    per_row: u32,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Matrix<Stored>, MatrixError> {
    let rays = kept.map_or_else(|| trace(&patches, scene, per_row, settings.seed, progress), Ok)?;
    by_rays(Stored { patches, rays }, settings.max_bounces)
}

fn dense(
    patches: Patches,
    scene: &Scene,
    max_bounces: usize,
    progress: Progress<'_>,
) -> Result<Matrix<Radiosity>, MatrixError> {
    progress.begin(&format!("form factors, {} patches", patches.len()), patches.len() as u64);
    let factors =
        FormFactors::new(&patches, scene, VisibilitySampling::default(), progress).map_err(|_| MatrixError::Stopped)?;
    let invariants = factors.invariants();
    let mut radiosity = Radiosity::new(patches, factors);
    let lit = radiosity.reached();
    let unlit = unlit(&radiosity.patches, &lit);
    radiosity.patches.darken(&lit);
    // in a closed region errors of F must neither lose nor create light
    let inside: Vec<bool> = lit.iter().map(|l| l.contains(&true)).collect();
    if closed(&radiosity.patches, scene, &inside, progress)? {
        radiosity.factors.close(&inside);
    }
    // LU succeeds for a matrix that is singular up to rounding, but its result is meaningless
    let spectral = radiosity.spectral_radius();
    loses(&radiosity.patches, &spectral)?;
    let terms = radiosity.terms(max_bounces);
    let solution = radiosity.solve().map_err(|_| MatrixError::Singular)?;
    let surface = terms.iter().map(|t| radiosity.patches.surface_mean(t)).collect();
    let norms = Some(radiosity.norms());
    let radii = vec![Radius::of(&radiosity.patches, &spectral, DVec3::ZERO)];
    Ok(Matrix { spectral, radii, norms, radiosity, terms, solution, invariants, sampling: None, surface, unlit })
}

/// Returns true if no ray from these patches leaves the scene or hits a side that takes no part in transport. 64 rays per patch
/// are tried.
fn closed(patches: &Patches, scene: &Scene, inside: &[bool], progress: Progress<'_>) -> Result<bool, MatrixError> {
    if scene.has_environment() || patches.len() > Hit::MOST {
        return Ok(false);
    }
    let rays = Rays::new(patches, scene, 64, 0, progress.silent()).map_err(|_| MatrixError::Stopped)?;
    let gone =
        |i: usize| rays.row(i).iter().flat_map(|half| half.iter()).filter(|h| **h == Hit::NOTHING).count() as u64;
    Ok((0..patches.len()).filter(|&i| inside[i]).map(gone).sum::<u64>() <= rays.lost)
}

/// Returns an error if a channel loses no light, or seems to lose none.
fn loses(patches: &Patches, spectral: &[Spectral; 3]) -> Result<(), MatrixError> {
    let Some((c, s)) = spectral.iter().enumerate().find(|(_, s)| s.radius >= KEEPS_ALL) else { return Ok(()) };
    let albedo = patches.iter().map(|p| p.reflectance[c]).fold(0.0, f64::max);
    Err(if albedo < KEEPS_ALL { MatrixError::Coarse { radius: s.radius, albedo } } else { MatrixError::Singular })
}

fn by_rays(mut stored: Stored, max_bounces: usize) -> Result<Matrix<Stored>, MatrixError> {
    let lit = Light { patches: &stored.patches, rays: &stored.rays }.reached();
    let unlit = unlit(&stored.patches, &lit);
    stored.patches.darken(&lit);
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
    // last, because the terms need most of the memory besides the rows
    let terms = light.terms(max_bounces);
    let surface = terms.iter().map(|t| stored.patches.surface_mean(t)).collect();
    let sampling = Some(sampling);
    Ok(Matrix {
        radiosity: stored,
        terms,
        solution,
        invariants,
        spectral,
        radii,
        norms: None,
        sampling,
        surface,
        unlit,
    })
}

fn solve_by_rays(light: &Light<'_>) -> Result<(Solution, [Spectral; 3], SampledRows), MatrixError> {
    let solved = light.solve(LEFT, MOST_STEPS);
    // the last term is close to the eigenvector of the largest eigenvalue; if the series has died out, start from ρ
    let died = (0..3).any(|c| solved.last.iter().all(|x| x[c] == 0.0));
    let albedo = || light.patches.iter().map(|p| record(p.reflectance)).collect::<Vec<Record>>();
    let spectral = light.spectral_radius(&if died { albedo() } else { solved.last.clone() }, 1e-7, 500);
    loses(light.patches, &spectral)?;
    let solved = settled(light, solved)?;
    let u: Vec<DVec3> = solved.radiance.iter().zip(light.patches.iter()).map(|(l, p)| *l - p.emission).collect();
    let noise = light.norm(&light.noise(&solved.radiance)) / light.norm(&u);
    let sampling = SampledRows { per_row: light.rays.per_row, noise, checks: light.checks(), steps: solved.steps };
    Ok((Solution { radiance: solved.radiance, residual: solved.residual }, spectral, sampling))
}

/// Returns the Neumann series if it has converged. If it was too long, solves the same system by GMRES, channel by channel.
fn settled(light: &Light<'_>, mut solved: Solved) -> Result<Solved, MatrixError> {
    if solved.steps < MOST_STEPS {
        return Ok(solved);
    }
    let direct = light.direct();
    for c in 0..3 {
        let rho = light.patches.iter().map(|p| p.reflectance[c]).collect();
        let d: Vec<f64> = direct.iter().map(|d| d[c]).collect();
        let operator = light.rays.operator(rho);
        let found = settle(&operator, &d).map_err(|_| MatrixError::Unsettled { residual: SETTLED })?;
        solved.steps += found.applications;
        solved.residual[c] = residual(&operator, &d, &found.x).iter().fold(0.0, |a: f64, r| a.max(r.abs()));
        for ((l, u), p) in solved.radiance.iter_mut().zip(found.x).zip(light.patches.iter()) {
            l[c] = u + p.emission[c];
        }
    }
    Ok(solved)
}

impl Matrix {
    /// Solves the same mesh with stored rays, and returns how far the reflected light is from that of this matrix.
    ///
    /// # Errors
    /// See [`MatrixError`].
    pub fn against_rays(
        &self,
        scene: &Scene,
        per_row: u32,
        seed: u64,
        progress: Progress<'_>,
    ) -> Result<Difference, MatrixError> {
        let patches = self.radiosity.patches();
        let rays = trace(patches, scene, per_row, seed, progress)?;
        let light = Light { patches, rays: &rays };
        let (solution, spectral, sampling) = solve_by_rays(&light)?;
        let pairs = self.solution.radiance.iter().zip(&solution.radiance);
        let apart: Vec<DVec3> = pairs.map(|(a, b)| *a - *b).collect();
        let u: Vec<DVec3> = self.solution.radiance.iter().zip(patches.iter()).map(|(l, p)| *l - p.emission).collect();
        Ok(Difference { of_u: light.norm(&apart) / light.norm(&u), spectral, sampling })
    }

    /// Renders the terms and the solution through the camera of the scene.
    pub fn through_camera(&self, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let gather = Gather::new(self.radiosity.patches(), &self.terms, &self.solution.radiance, settings.read_patches);
        let label = format!(
            "radiosity, {} patches{}{}",
            self.radiosity.patches().len(),
            self.sampling.map_or(String::new(), |s| format!(" of {} rays", s.per_row)),
            if settings.read_patches { ", read" } else { "" }
        );
        let title = Title { stream: "radiosity", world: World::Radiosity, label };
        let mut seen =
            by_rays::sample(&t, &scene.camera.cropped(settings.crop), &gather, title, settings, progress, Watch::NONE);
        seen.series.undecided = undecided(scene);
        seen
    }
}

impl Matrix<Radiosity> {
    /// Shows functions on the patches through the camera, after one more bounce: image i is `T fields[i]`, coloured by the
    /// albedos. An eigenfunction with eigenvalue λ appears smooth, and λ times as bright.
    pub fn paint(
        &self,
        scene: &Scene,
        fields: &[Vec<f64>],
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Vec<TermImage> {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let patches = &self.radiosity.patches;
        let nothing = vec![DVec3::ZERO; patches.len()];
        // slot s gathers from entry s − 1 of `terms`; slots 0 and 1 are the scene's own light
        let mut terms = vec![nothing.clone()];
        terms.extend(fields.iter().map(|f| f.iter().map(|v| DVec3::splat(*v)).collect()));
        terms.push(nothing.clone());
        let gather = Gather { patches, terms: &terms, tail: nothing, read_patches: false };
        let title = Title { stream: "modes", world: World::Radiosity, label: "modes".to_string() };
        let mut seen = by_rays::sample(&t, &scene.camera, &gather, title, settings, progress, Watch::NONE);
        seen.terms.drain(2..2 + fields.len()).collect()
    }
}

impl<R> Matrix<R> {
    /// The same result, with T stored in another form.
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
            unlit: self.unlit,
        }
    }
}

/// The fine matrix with its image, and the image of the coarse matrix.
pub struct Discrete {
    /// Matrix of the mesh that was asked for.
    pub matrix: Matrix,
    /// Image of that matrix through the camera.
    pub fine: Sampled,
    /// Image of the mesh that is twice as coarse, along the same camera rays.
    pub coarse: Sampled,
    /// Spectral radii, coarsest first: of two coarser meshes and of this one, or of unions of its patches and of this one.
    /// Only of this one if neither is possible.
    pub radii: Vec<Radius>,
}

/// Computes the whole discrete world: the fine and the coarse matrix, and their images. Rows of rays that `keep` has are not traced.
///
/// # Errors
/// See [`MatrixError`].
pub fn radiosity(
    description: &Description,
    scene: &Scene,
    settings: &Settings,
    progress: Progress<'_>,
    keep: Option<&dyn Keep>,
) -> Result<Discrete, MatrixError> {
    let one = |patches: usize| {
        let matrix = kept_matrix(description, scene, patches, settings, progress, keep)?;
        let picture = matrix.through_camera(scene, settings, progress);
        Ok::<_, MatrixError>((matrix, picture))
    };
    let (second, coarse) = one((settings.patches / 4).max(1))?;
    let (fine_matrix, fine) = one(settings.patches)?;
    let mut radii = fine_matrix.radii.clone();
    if fine_matrix.radiosity.dense().is_some() {
        let coarsest = matrix(description, scene, (settings.patches / 16).max(1), settings, progress)?;
        radii = coarsest.radii.into_iter().chain(second.radii).chain(radii).collect();
    }
    Ok(Discrete { matrix: fine_matrix, fine, coarse, radii })
}
