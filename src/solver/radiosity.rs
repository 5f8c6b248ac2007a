//! A scene as a radiosity matrix: patches, form factors and three colour channels in one value.
//!
//! ```text
//! T_h^k E,  L_h = (I − T_h)⁻¹ E        mean over all surfaces  Σᵢ Aᵢ xᵢ / A
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T_h | diag(ρ) F of one channel | [`Radiosity::operator`] |
//! | E | emission per patch | [`Radiosity::emission`] |
//! | A | area of all reflecting sides, covered or not | [`Patches::surface_mean`] |
//! | M | diag(ρ²/s) F: second moments of a random walk with survival probability s | [`Radiosity::second_moment_radius`] |
//! | | diag(ρ⁴/s³) F: fourth moments of the same walk | [`Radiosity::fourth_moment_radius`] |

use super::{
    direct::{self, Singular},
    neumann::Neumann,
};
use crate::operator::{
    form_factor::FormFactors,
    matrix::{PatchOperator, Spectral, reached, spectral_radius},
    patches::Patches,
};
use glam::DVec3;
use rayon::prelude::*;

/// A scene as a radiosity matrix.
#[derive(Clone, Debug)]
pub struct Radiosity {
    /// The patches, on each of which the radiance is constant.
    pub patches: Patches,
    /// The form factors of the patches.
    pub factors: FormFactors,
}

/// The solution L with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Radiance per patch.
    pub radiance: Vec<DVec3>,
    /// The residual max |E − (I − T) L| per channel.
    pub residual: DVec3,
}

impl Radiosity {
    /// Combines a mesh with its form factors.
    ///
    /// # Panics
    /// If they have different numbers of patches.
    pub fn new(patches: Patches, factors: FormFactors) -> Self {
        assert_eq!(patches.len(), factors.n, "the form factors belong to another mesh");
        Self { patches, factors }
    }

    /// E per patch for channel 0, 1 or 2.
    pub fn emission(&self, channel: usize) -> Vec<f64> {
        self.patches.iter().map(|p| p.emission[channel]).collect()
    }

    /// ρ per patch for channel 0, 1 or 2.
    pub fn reflectance(&self, channel: usize) -> Vec<f64> {
        self.patches.iter().map(|p| p.reflectance[channel]).collect()
    }

    /// The operator T_h for channel 0, 1 or 2.
    pub fn operator(&self, channel: usize) -> PatchOperator<'_> {
        PatchOperator::new(&self.factors, self.reflectance(channel))
    }

    /// For each patch and channel, whether light reaches it.
    pub fn reached(&self) -> Vec<[bool; 3]> {
        let channel = |c: usize| {
            let sees = |i: usize, sends: &[bool]| self.factors.row(i).iter().zip(sends).any(|(f, s)| *s && *f > 0.0);
            let p = &self.patches;
            reached(p.len(), |i| p[i].emission[c] > 0.0, |i| p[i].reflectance[c] > 0.0, sees)
        };
        let [r, g, b] = [0, 1, 2].map(channel);
        r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
    }

    /// The terms T_h^k E for k = 0 ..= `k_max`: one vector over the patches per k.
    pub fn terms(&self, k_max: usize) -> Vec<Vec<DVec3>> {
        let mut terms = vec![vec![DVec3::ZERO; self.patches.len()]; k_max + 1];
        for channel in 0..3 {
            let operator = self.operator(channel);
            for (term, values) in terms.iter_mut().zip(Neumann::new(&operator, self.emission(channel))) {
                term.iter_mut().zip(values).for_each(|(t, v)| t[channel] = v);
            }
        }
        terms
    }

    /// The solution L_h, by LU factorisation.
    ///
    /// # Errors
    /// [`Singular`] if, in some channel, a part of the scene neither absorbs light nor lets it escape.
    pub fn solve(&self) -> Result<Solution, Singular> {
        let one = |c: usize| direct::solve(&self.operator(c), &self.emission(c));
        let solved = (0..3).into_par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
        let mut out = Solution { radiance: vec![DVec3::ZERO; self.patches.len()], residual: DVec3::ZERO };
        for (channel, solved) in solved.into_iter().enumerate() {
            out.residual[channel] = solved.residual;
            out.radiance.iter_mut().zip(solved.x).for_each(|(l, x)| l[channel] = x);
        }
        Ok(out)
    }

    /// Largest magnitude of E − (I − T) x over the patches, per channel.
    pub fn residual(&self, x: &[DVec3]) -> DVec3 {
        let one = |c: usize| {
            let values: Vec<f64> = x.iter().map(|x| x[c]).collect();
            direct::residual(&self.operator(c), &self.emission(c), &values)
        };
        DVec3::new(one(0), one(1), one(2))
    }

    /// The spectral radius r(T_h) per channel, to a relative change of 10⁻¹² per step.
    pub fn spectral_radius(&self) -> [Spectral; 3] {
        [0, 1, 2].map(|c| spectral_radius(&self.factors, &self.reflectance(c), 1e-12, 2000))
    }

    /// The spectral radius r(M) per channel for walks that survive every bounce with probability `survival`. The walks have
    /// finite variance if r(M) is below 1. In a connected scene in which everything emits, the variance is finite only then.
    pub fn second_moment_radius(&self, survival: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let w: Vec<f64> = self.reflectance(c).iter().map(|r| r * r / survival).collect();
            spectral_radius(&self.factors, &w, 1e-12, 2000).radius
        })
    }

    /// The spectral radius r(diag(ρ⁴/s³) F) per channel. If it is below 1, the fourth moments are finite. Otherwise a
    /// variance measured from samples has an infinite variance itself.
    pub fn fourth_moment_radius(&self, survival: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let w: Vec<f64> = self.reflectance(c).iter().map(|r| r.powi(4) / survival.powi(3)).collect();
            spectral_radius(&self.factors, &w, 1e-12, 2000).radius
        })
    }

    /// The norms (‖T_h‖₁, ‖T_h‖∞) per channel; they are exact for the matrix.
    pub fn norms(&self) -> [(f64, f64); 3] {
        [0, 1, 2].map(|c| {
            let t = self.operator(c);
            (t.norm_1(), t.norm_inf())
        })
    }
}
