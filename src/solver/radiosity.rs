//! The discrete world as one value: patches, form factors, three channels.
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
//! | M | diag(ρ²/s) F: second moments of a walk with survival s | [`Radiosity::second_moment_radius`] |
//! | | diag(ρ⁴/s³) F: moments of fourth order | [`Radiosity::fourth_moment_radius`] |

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

/// A scene as a matrix.
#[derive(Clone, Debug)]
pub struct Radiosity {
    /// The basis.
    pub patches: Patches,
    /// The geometry.
    pub factors: FormFactors,
}

/// L with its check.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Radiance per patch.
    pub radiance: Vec<DVec3>,
    /// max |E − (I − T) L| per channel.
    pub residual: DVec3,
}

impl Radiosity {
    /// Joins a mesh with its form factors.
    ///
    /// # Panics
    /// If they are of different size.
    pub fn new(patches: Patches, factors: FormFactors) -> Self {
        assert_eq!(patches.len(), factors.n, "form factors of another mesh");
        Self { patches, factors }
    }

    /// E of channel 0, 1 or 2.
    pub fn emission(&self, channel: usize) -> Vec<f64> {
        self.patches.iter().map(|p| p.emission[channel]).collect()
    }

    /// ρ of channel 0, 1 or 2.
    pub fn reflectance(&self, channel: usize) -> Vec<f64> {
        self.patches.iter().map(|p| p.reflectance[channel]).collect()
    }

    /// T_h of channel 0, 1 or 2.
    pub fn operator(&self, channel: usize) -> PatchOperator<'_> {
        PatchOperator::new(&self.factors, self.reflectance(channel))
    }

    /// Whether light reaches each patch, per channel.
    pub fn reached(&self) -> Vec<[bool; 3]> {
        let channel = |c: usize| {
            let sees = |i: usize, sends: &[bool]| self.factors.row(i).iter().zip(sends).any(|(f, s)| *s && *f > 0.0);
            let p = &self.patches;
            reached(p.len(), |i| p[i].emission[c] > 0.0, |i| p[i].reflectance[c] > 0.0, sees)
        };
        let [r, g, b] = [0, 1, 2].map(channel);
        r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
    }

    /// T_h^k E for k = 0 ..= `k_max`: one vector over the patches per k.
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

    /// L_h by LU.
    ///
    /// # Errors
    /// [`Singular`] where a channel keeps all its light.
    pub fn solve(&self) -> Result<Solution, Singular> {
        let mut out = Solution { radiance: vec![DVec3::ZERO; self.patches.len()], residual: DVec3::ZERO };
        for channel in 0..3 {
            let solved = direct::solve(&self.operator(channel), &self.emission(channel))?;
            out.residual[channel] = solved.residual;
            out.radiance.iter_mut().zip(solved.x).for_each(|(l, x)| l[channel] = x);
        }
        Ok(out)
    }

    /// E − (I − T) x per channel, largest magnitude.
    pub fn residual(&self, x: &[DVec3]) -> DVec3 {
        let one = |c: usize| {
            let values: Vec<f64> = x.iter().map(|x| x[c]).collect();
            direct::residual(&self.operator(c), &self.emission(c), &values)
        };
        DVec3::new(one(0), one(1), one(2))
    }

    /// r(T_h) per channel, to 10⁻¹² per step.
    pub fn spectral_radius(&self) -> [Spectral; 3] {
        [0, 1, 2].map(|c| spectral_radius(&self.factors, &self.reflectance(c), 1e-12, 2000))
    }

    /// r(M) per channel for walks that survive every bounce with probability `survival`; they have finite variance if
    /// it is below 1 (and, in a connected scene where everything emits, only then).
    pub fn second_moment_radius(&self, survival: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let w: Vec<f64> = self.reflectance(c).iter().map(|r| r * r / survival).collect();
            spectral_radius(&self.factors, &w, 1e-12, 2000).radius
        })
    }

    /// r(diag(ρ⁴/s³) F) per channel: below 1 moments of fourth order are finite, without which a measured variance has an
    /// infinite variance itself.
    pub fn fourth_moment_radius(&self, survival: f64) -> [f64; 3] {
        [0, 1, 2].map(|c| {
            let w: Vec<f64> = self.reflectance(c).iter().map(|r| r.powi(4) / survival.powi(3)).collect();
            spectral_radius(&self.factors, &w, 1e-12, 2000).radius
        })
    }

    /// ‖T_h‖₁ and ‖T_h‖∞ per channel, exact for the matrix.
    pub fn norms(&self) -> [(f64, f64); 3] {
        [0, 1, 2].map(|c| {
            let t = self.operator(c);
            (t.norm_1(), t.norm_inf())
        })
    }
}
