//! Convergence in the patch width h: solutions of the matrix on finer and finer meshes, compared with the terms from rays.
//!
//! ```text
//! e_h = φ(T_h^k E) − φ(T^k E)        ‖R_h − R‖² over the image, without the noise of either
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | h | width of a patch: root of the mean patch area, in m | [`Mesh::h`] |
//! | R_h | image of the matrix solution through the camera | [`Mesh::picture`] |
//! | R | images of the terms from rays | [`Refinement::truth`] |
//! | φ | image mean of a term, or of all indirect light | [`Quantity`] |
//! | ‖·‖² | mean over pixels and channels of d² − s_h² − s²: d = R_h − R, and s_h, s are the standard errors; unbiased | [`Refinement::image_error`] |
//!
//! All meshes are viewed along the same camera rays, so that differences between them come from the meshes alone. The terms
//! k = 0 and k = 1 need no matrix, because they are read directly from E. They serve as controls.

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

/// The results on one mesh.
pub struct Mesh {
    /// Number of patches.
    pub patches: usize,
    /// √(area/patches), metres.
    pub h: f64,
    /// The terms seen through the camera.
    pub picture: Sampled,
    /// Spectral radius of each channel.
    pub radius: Radius,
    /// Leading eigenvalues of one channel, if requested.
    pub spectrum: Option<Ends>,
    /// Wall-clock seconds for form factors, terms and solve.
    pub seconds: f64,
}

/// The largest and the smallest eigenvalues of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Ends {
    /// The largest eigenvalues in falling order, and the most negative ones in rising order.
    pub values: [Vec<Ritz>; 2],
    /// Half width of the band of eigenvalues that edges between surfaces produce ([`essential_band`]).
    pub band: f64,
    /// Index of the channel, 0, 1 or 2: the one with the largest spectral radius.
    pub channel: usize,
}

/// Largest number of applications of T for the eigenvalues, and the tolerance to which they are computed.
const STEPS: usize = 200;
const TOLERANCE: f64 = 1e-5;

fn ends(radiosity: &Radiosity, radius: DVec3, count: usize) -> Ends {
    let channel = radius.max_position();
    let t = radiosity.operator(channel);
    let band = essential_band(&radiosity.patches, &radiosity.factors, &t.rho).half_width;
    Ends { values: leading(&t, &t.weight(), count, TOLERANCE, STEPS), band, channel }
}

/// Meshes, coarsest first, and the terms from rays.
pub struct Refinement {
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// The terms from rays.
    pub truth: Sampled,
}

/// The quantity that is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The term T^k E.
    Term(usize),
    /// Σ_{k ≥ 2} T^k E: all indirect light, the part for which the matrix is needed.
    Indirect,
}

impl Quantity {
    /// All quantities: the terms k = 0..=K with K = `max_bounces`, and the indirect light L − E.
    pub fn all(max_bounces: usize) -> Vec<Self> {
        (0..=max_bounces).map(Self::Term).chain([Self::Indirect]).collect()
    }

    /// Estimate of the image mean of this quantity.
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
    /// e_h of the image mean, averaged over channels, and its standard error, which includes the noise of both renders. The
    /// error is NaN where it is not known.
    pub fn mean_error(&self, mesh: &Mesh, quantity: Quantity) -> (f64, f64) {
        let [a, b] = [&mesh.picture, &self.truth].map(|s| quantity.mean(s));
        let evidence = Evidence::of(&a).and(Evidence::of(&b));
        let grey = |v: DVec3| v.element_sum() / 3.0;
        // channels of one path are correlated: the mean of their errors bounds the error of the mean
        let error = grey(a.std_error).hypot(grey(b.std_error));
        (grey(a.mean - b.mean), if evidence.no_error.is_none() { error } else { f64::NAN })
    }

    /// ‖R_h − R‖/‖R‖ of term k over the image, with the noise of both subtracted, and its standard error; both are relative.
    /// If the estimated square is negative, the root is returned with a negative sign. It then means that the difference is
    /// not larger than the noise.
    pub fn image_error(&self, mesh: &Mesh, k: usize) -> (f64, f64) {
        let [a, b] = [&mesh.picture, &self.truth].map(|s| &s.terms[k]);
        let replicates = self.truth.series.image().total.replicates as f64;
        let (mut sum, mut variance, mut size, mut n) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..a.mean.len() {
            for c in 0..3 {
                let [x, y, s, t] = [a.mean[i][c], b.mean[i][c], a.std_error[i][c], b.std_error[i][c]].map(f64::from);
                let (d2, s2) = ((x - y).powi(2), s * s + t * t);
                sum += d2 - s2;
                // variance of d²: 2 s⁴ + 4 δ² s²; of s² from R replicates: 2 s⁴/(R − 1)
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

/// Solves on meshes with about the requested numbers of patches, coarsest first, and renders the terms from rays with
/// `settings.spp` samples per pixel. If `eigenvalues` is not 0, that many leading eigenvalues of either sign are computed
/// for dense matrices.
///
/// # Errors
/// See [`MatrixError`]. If interrupted, the meshes that were finished are returned.
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
