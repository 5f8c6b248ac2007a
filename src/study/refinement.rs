//! Convergence in h: the matrix on finer and finer meshes, held against rays.
//!
//! ```text
//! e_h = φ(T_h^k E) − φ(T^k E)        ‖R_h − R‖² over the image, without the noise of either
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | h | width of a patch, the root of the mean area, m | [`Mesh::h`] |
//! | R_h | the matrix through the camera | [`Mesh::picture`] |
//! | R | the terms from rays | [`Refinement::truth`] |
//! | φ | image mean of a term, or of all indirect light | [`Quantity`] |
//! | ‖·‖² | mean over pixels and channels of d² − s_h² − s², unbiased | [`Refinement::image_error`] |
//!
//! All meshes are read along the same camera rays, so that what changes from one to the next is the mesh. T⁰ and T¹ are no
//! question to a matrix (what is read is E itself) and serve as controls.

use crate::engine::Settings;
use crate::engine::by_matrix::{self, MatrixError};
use crate::engine::by_rays::{self, Estimator, Sampled};
use crate::engine::radius::Radius;
use crate::operator::edges::essential_band;
use crate::operator::matrix::{Ritz, leading};
use crate::progress::Progress;
use crate::scene::{Description, Scene};
use crate::solver::Radiosity;
use crate::stats::Evidence;
use crate::terms::Estimate;
use glam::DVec3;
use std::time::Instant;

/// One mesh.
pub struct Mesh {
    /// Patches.
    pub patches: usize,
    /// √(area/patches), metres.
    pub h: f64,
    /// Through the camera.
    pub picture: Sampled,
    /// Spectral radius per channel.
    pub radius: Radius,
    /// Leading eigenvalues of one channel, where they were asked for.
    pub spectrum: Option<Ends>,
    /// Seconds for form factors, terms and solve.
    pub seconds: f64,
}

/// The ends of the spectrum of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Ends {
    /// The largest eigenvalues, falling, and the most negative, rising.
    pub values: [Vec<Ritz>; 2],
    /// Half width of the band of the edges.
    pub band: f64,
    /// 0, 1 or 2: that of the largest spectral radius.
    pub channel: usize,
}

/// Applications of T that eigenvalues may take, and how well they are known.
const STEPS: usize = 200;
const TOLERANCE: f64 = 1e-5;

fn ends(radiosity: &Radiosity, radius: DVec3, count: usize) -> Ends {
    let channel = radius.max_position();
    let t = radiosity.operator(channel);
    let band = essential_band(&radiosity.patches, &radiosity.factors, &t.rho).half_width;
    Ends { values: leading(&t, &t.weight(), count, TOLERANCE, STEPS), band, channel }
}

/// Meshes, coarsest first, and the truth.
pub struct Refinement {
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// The terms from rays.
    pub truth: Sampled,
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// T^k E.
    Term(usize),
    /// Σ k ≥ 2: all that a matrix is asked for.
    Indirect,
}

impl Quantity {
    /// The terms k = 0..=K, and all indirect light.
    pub fn all(max_bounces: usize) -> Vec<Self> {
        (0..=max_bounces).map(Self::Term).chain([Self::Indirect]).collect()
    }

    /// Of the image mean.
    pub fn mean(self, s: &Sampled) -> Estimate {
        let slots = s.replicates.mean.len();
        match self {
            Self::Term(k) => s.replicates.estimate(k..k + 1),
            Self::Indirect => {
                let e = s.replicates.estimate(2.min(slots)..slots);
                Estimate { std_error: s.series.variance.instead().map_or(e.std_error, DVec3::splat), ..e }
            }
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Term(k) => write!(f, "T{k}"),
            Self::Indirect => f.write_str("k ≥ 2"),
        }
    }
}

impl Refinement {
    /// e_h of the image mean, averaged over channels, and its standard error: that of both renders. NaN where it is not known.
    pub fn mean_error(&self, mesh: &Mesh, quantity: Quantity) -> (f64, f64) {
        let [a, b] = [&mesh.picture, &self.truth].map(|s| quantity.mean(s));
        let evidence = Evidence::of(&a).and(Evidence::of(&b));
        let grey = |v: DVec3| v.element_sum() / 3.0;
        // channels of one path move together: the mean of their errors bounds the error of the mean
        let error = grey(a.std_error).hypot(grey(b.std_error));
        (grey(a.mean - b.mean), if evidence.no_error.is_none() { error } else { f64::NAN })
    }

    /// ‖R_h − R‖/‖R‖ of term k over the image with the noise of both taken out, and its standard error, both relative; negative squares
    /// come back as a negative root, which says that noise is all there is.
    pub fn image_error(&self, mesh: &Mesh, k: usize) -> (f64, f64) {
        let [a, b] = [&mesh.picture, &self.truth].map(|s| &s.terms[k]);
        let replicates = self.truth.series.image().total.replicates as f64;
        let (mut sum, mut variance, mut size, mut n) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..a.mean.len() {
            for c in 0..3 {
                let [x, y, s, t] = [a.mean[i][c], b.mean[i][c], a.std_error[i][c], b.std_error[i][c]].map(f64::from);
                let (d2, s2) = ((x - y).powi(2), s * s + t * t);
                sum += d2 - s2;
                // of d²: 2 s⁴ + 4 δ² s²; of s² from R replicates: 2 s⁴/(R − 1)
                variance += 2.0 * s2 * s2 * (1.0 + 1.0 / (replicates - 1.0)) + 4.0 * (d2 - s2).max(0.0) * s2;
                size += y * y - t * t;
                n += 1.0;
            }
        }
        let norm = (size / n).max(0.0).sqrt();
        let (square, error) = (sum / n, variance.sqrt() / n);
        let root = square.abs().sqrt() * square.signum();
        (root / norm, 0.5 * error / (square.abs().max(error).sqrt() * norm))
    }
}

/// Solves on about as many patches as asked for, coarsest first, and renders the truth with `spp` samples per pixel. Of
/// dense matrices the `eigenvalues` leading eigenvalues of either sign are found, if that is not 0.
///
/// # Errors
/// See [`MatrixError`]; what was finished before an interruption comes back.
pub fn refine(
    description: &Description,
    scene: &Scene,
    patches: &[usize],
    eigenvalues: usize,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Refinement, MatrixError> {
    let truth = by_rays::terms(scene, Estimator::Prefix, settings, progress);
    let mut meshes = vec![];
    for &n in patches {
        if progress.stopped() {
            break;
        }
        let started = Instant::now();
        let matrix = match by_matrix::matrix(description, scene, n, settings, progress) {
            Ok(m) => m,
            Err(MatrixError::Stopped) => break,
            Err(e) => return Err(e),
        };
        let seconds = started.elapsed().as_secs_f64();
        let picture = matrix.through_camera(scene, settings, progress);
        let Some(&radius) = matrix.radii.last() else { continue };
        let spectrum = matrix.radiosity.dense().filter(|_| eigenvalues > 0).map(|r| ends(r, radius.value, eigenvalues));
        let patches = matrix.radiosity.patches().len();
        meshes.push(Mesh { patches, h: radius.h, picture, radius, spectrum, seconds });
    }
    Ok(Refinement { meshes, truth })
}
