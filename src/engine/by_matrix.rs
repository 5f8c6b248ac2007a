//! The discrete world: patches, form factors, terms, solve, and the picture of them through the camera.
//!
//! `T_h = diag(ρ) F` as a matrix or as stored rays ([`discretisation`](crate::engine::discretisation)), `L_h = (I − T_h)⁻¹ E`. A second mesh with a quarter of the patches, twice as coarse, read along the
//! same camera rays, gives the discretisation error |R_h − R_2h| that stands beside the Monte Carlo error in every verdict.

use crate::engine::Settings;
use crate::engine::by_rays;
use crate::engine::by_rays::Sampled;
use crate::engine::discretisation::{Difference, Discretisation, Factors, SampledRows, Stored};
use crate::engine::known::coplanar::undecided;
pub use crate::engine::matrix_error::MatrixError;
use crate::engine::radius::{Radius, radii, sampled_noise};
pub use crate::engine::unlit::Unlit;
use crate::engine::unlit::unlit;
use crate::estimator::Gather;
use crate::operator::SceneTransport;
use crate::operator::form_factor::{FormFactors, Invariants, VisibilitySampling};
use crate::operator::matrix::Spectral;
use crate::operator::patches::Patches;
use crate::operator::rays::{Half, Hit, Light, Rays, Record, Solved, record};
use crate::progress::Progress;
use crate::scene::{Description, Scene, SceneError};
use crate::solver::{Radiosity, Solution, residual, settle};
use crate::terms::{TermImage, World};
use glam::DVec3;

/// A scene as a matrix, with everything that is printed about it.
pub struct Matrix<R = Discretisation> {
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
    pub sampling: Option<SampledRows>,
    /// Surface means `Σ A_i (T_h^k E)_i / A`.
    pub surface: Vec<DVec3>,
    /// What light never reaches, and what all of the above leaves out.
    pub unlit: Vec<Unlit>,
}

/// From this spectral radius on a channel keeps all its light, as far as form factors can tell.
const KEEPS_ALL: f64 = 1.0 - 1e-6;

/// The Neumann series of stored rays ends when what is left is this small against the sum.
const LEFT: f64 = 1e-7;
/// Or after so many steps; GMRES takes over then.
const MOST_STEPS: usize = 2000;
/// What GMRES must bring the residual below, as [`settle`] has it.
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
    Ok(match settings.factors {
        Factors::Dense => {
            let (k, grading) = (settings.max_bounces, settings.grading);
            dense_matrix(description, scene, patches, grading, k, progress)?.held_as(Discretisation::from)
        }
        Factors::Rays(n) => {
            sampled_matrix(description, scene, patches, n, settings, progress)?.held_as(Discretisation::from)
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
    progress: Progress<'_>,
) -> Result<Matrix<Radiosity>, MatrixError> {
    dense(Patches::graded(description, patches, grading)?, scene, max_bounces, progress)
}

/// A coarse one without terms, where the scene has one that costs little.
pub fn coarse(description: &Description, scene: &Scene) -> Option<Matrix<Radiosity>> {
    if scene.sides() > 400 || description.radiosity_suits().is_err() {
        return None;
    }
    dense_matrix(description, scene, 150, 1.0, 0, Progress::NONE).ok()
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
    progress: Progress<'_>,
) -> Result<Matrix<Stored>, MatrixError> {
    let patches = Patches::graded(description, patches, settings.grading)?;
    let rays = trace(&patches, scene, per_row, settings.seed, progress)?;
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
    // where nothing leaves, no light may be lost or made by errors of F
    let inside: Vec<bool> = lit.iter().map(|l| l.contains(&true)).collect();
    if closed(&radiosity.patches, scene, &inside, progress)? {
        radiosity.factors.close(&inside);
    }
    // LU of a matrix that is singular but for rounding succeeds, and means nothing
    let spectral = radiosity.spectral_radius();
    loses(&radiosity.patches, &spectral)?;
    let terms = radiosity.terms(max_bounces);
    let solution = radiosity.solve().map_err(|_| MatrixError::Singular)?;
    let surface = terms.iter().map(|t| radiosity.patches.surface_mean(t)).collect();
    let norms = Some(radiosity.norms());
    let radii = vec![Radius::of(&radiosity.patches, &spectral, DVec3::ZERO)];
    Ok(Matrix { spectral, radii, norms, radiosity, terms, solution, invariants, sampling: None, surface, unlit })
}

/// Whether no ray from these patches leaves the scene, or meets what takes no part: 64 are tried from each.
fn closed(patches: &Patches, scene: &Scene, inside: &[bool], progress: Progress<'_>) -> Result<bool, MatrixError> {
    if scene.has_environment() || patches.len() > Hit::MOST {
        return Ok(false);
    }
    let rays = Rays::new(patches, scene, 64, 0, progress.silent()).map_err(|_| MatrixError::Stopped)?;
    let gone =
        |i: usize| rays.row(i).iter().flat_map(|half| half.iter()).filter(|h| **h == Hit::NOTHING).count() as u64;
    Ok((0..patches.len()).filter(|&i| inside[i]).map(gone).sum::<u64>() <= rays.lost)
}

/// Refuses what keeps all its light, or seems to.
fn loses(patches: &Patches, spectral: &[Spectral; 3]) -> Result<(), MatrixError> {
    let Some((c, s)) = spectral.iter().enumerate().find(|(_, s)| s.radius >= KEEPS_ALL) else { return Ok(()) };
    let albedo = patches.iter().map(|p| p.reflectance[c]).fold(0.0, f64::max);
    Err(if albedo < KEEPS_ALL { MatrixError::Coarse { radius: s.radius, albedo } } else { MatrixError::Singular })
}

fn trace(
    patches: &Patches,
    scene: &Scene,
    per_row: u32,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Rays, MatrixError> {
    if patches.len() > Hit::MOST {
        let e = SceneError::new(format!("{} patches, and rows of rays hold {} at most", patches.len(), Hit::MOST));
        return Err(e.help("fewer --patches; of many triangles every side is one patch at least").into());
    }
    progress.begin(&format!("{per_row} rays from each of {} patches", patches.len()), patches.len() as u64);
    Rays::new(patches, scene, per_row as usize, seed, progress).map_err(|_| MatrixError::Stopped)
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
    // last, for they are most of the memory beside the rows
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
    // the last term is close to the top mode; where the series has died out, start from ρ
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

/// The Neumann series if it has come to its end; where it is too long, the same system by GMRES, channel by channel.
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
    /// The same mesh by stored rays, and how far the reflected light is from this one.
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

    /// The terms and the solution through the camera of the scene.
    pub fn through_camera(&self, scene: &Scene, settings: &Settings, progress: Progress<'_>) -> Sampled {
        let t = SceneTransport { scene, sampling: settings.sampling };
        let gather = Gather::new(self.radiosity.patches(), &self.terms, &self.solution.radiance, settings.read_patches);
        let label = format!(
            "radiosity, {} patches{}{}",
            self.radiosity.patches().len(),
            self.sampling.map_or(String::new(), |s| format!(" of {} rays", s.per_row)),
            if settings.read_patches { ", read" } else { "" }
        );
        let world = (World::Radiosity, label);
        let mut seen = by_rays::sample(&t, &scene.camera, &gather, "radiosity", world, settings, progress);
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
        progress: Progress<'_>,
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
        let mut seen = by_rays::sample(&t, &scene.camera, &gather, "modes", world, settings, progress);
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
            unlit: self.unlit,
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
    progress: Progress<'_>,
) -> Result<Discrete, MatrixError> {
    let one = |patches: usize| {
        let matrix = matrix(description, scene, patches, settings, progress)?;
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
