//! What follows from a run: rates, bounds and orders.
//!
//! | | place |
//! |---|---|
//! | observed rate of ‖T^k E‖₁, fitted | [`Run::observed_rate`] |
//! | guaranteed: ‖T‖₁ ≤ max albedo, and what it says of the tail | [`Run::guaranteed_rate`], [`Run::tail_bound`] |
//! | order of convergence in h | [`Run::order`] |

use super::Run;
use crate::engine::by_rays::{Estimator, Sampled};
use crate::stats::{NoRate, Outcome, Rate, TermMeans, observed_rate};
use crate::terms::Series;
use crate::terms::functional::Replicates;
use glam::DVec3;

impl Run {
    /// Every result: the terms, the path tracer, the matrix through the camera.
    pub fn results(&self) -> impl Iterator<Item = &Sampled> {
        self.sampled().chain(self.radiosity.as_ref().map(|r| &r.fine))
    }

    /// The results of rays in the scene: the terms and the path tracer.
    pub fn sampled(&self) -> impl Iterator<Item = &Sampled> {
        self.terms.iter().chain(&self.path)
    }

    /// Whether nothing was found, because the work was stopped before.
    pub fn is_empty(&self) -> bool {
        self.results().next().is_none()
    }

    /// Samples per pixel that every result has: fewer than asked for when stopped.
    pub fn spp(&self) -> u32 {
        self.results().map(|s| s.spp).min().unwrap_or(0)
    }

    /// Whether a difference was proved, or a sample was not finite.
    pub fn failed(&self) -> bool {
        let differs = self.verdicts.iter().any(|v| v.comparison.outcome == Outcome::Differs);
        differs || self.results().any(|s| s.series.cost.non_finite > 0)
    }

    /// ‖T^k E‖₁ over all surfaces, each term from paths of its own.
    pub fn norms(&self) -> Option<&Replicates> {
        self.surface.iter().find(|s| s.0 == Estimator::Single).map(|s| &s.1)
    }

    /// The rate at which ‖T^k E‖₁ falls, or why none could be fitted.
    pub fn observed_rate(&self) -> Option<Result<Rate, NoRate>> {
        self.norms().map(|norms| observed_rate(&TermMeans::from(norms)))
    }

    /// The rate at which ‖T^k E‖₁ falls in one channel, or why none could be fitted.
    pub fn observed_rate_in(&self, channel: usize) -> Option<Result<Rate, NoRate>> {
        self.norms().map(|norms| observed_rate(&TermMeans::channel(norms, channel)))
    }

    /// The channel in which the terms fall most slowly: by the spectral radius of the matrix, or else by the largest albedo.
    pub fn slowest_channel(&self) -> usize {
        let radii = self.radiosity.as_ref().map(|r| DVec3::from_array(r.matrix.spectral.each_ref().map(|s| s.radius)));
        radii.unwrap_or(self.guaranteed_rate()).max_position()
    }

    /// max albedo, which ‖T‖₁ does not exceed, by channel.
    pub fn guaranteed_rate(&self) -> DVec3 {
        self.scene.max_albedo().as_dvec3()
    }

    /// For all light and for indirect light (k ≥ 2), returns true if the largest albedo bounds what a truncated series leaves out:
    /// of all light only if every light is a surface, and never where glass changes the radiance by the square of its index.
    pub fn bounds_from(&self) -> [bool; 2] {
        let glass = self.description.materials.iter().any(|m| m.bsdf.lets_through());
        let on_surfaces = self.description.lights.is_empty();
        [on_surfaces && !glass, !glass]
    }

    /// What ‖T‖₁ ≤ g leaves for everything longer than K: g/(1 − g) ‖T^K E‖₁, NaN where g = 1.
    pub fn tail_bound(&self) -> Option<DVec3> {
        let g = self.guaranteed_rate();
        let last = |norms: &Replicates| norms.mean[norms.mean.len() - 2];
        self.norms().map(|norms| DVec3::select(g.cmplt(DVec3::ONE), g / (1.0 - g) * last(norms), DVec3::NAN))
    }

    /// Surface means of the terms of the matrix, averaged over channels.
    pub fn norms_of_matrix(&self) -> Option<Vec<f64>> {
        let of = |means: &Vec<DVec3>| means.iter().map(|v| v.element_sum() / 3.0).collect();
        self.radiosity.as_ref().map(|r| of(&r.matrix.surface))
    }

    /// The order in h in which the mean of an image converges, from three meshes; of term k, or of the whole. Nothing
    /// without three meshes; not finite where their differences tell none.
    pub fn order(&self, k: Option<usize>) -> Option<f64> {
        let [coarsest, coarse, fine] = self.meshes.as_slice() else { return None };
        let grey = |s: &Series| {
            let f = s.image();
            k.map_or(f.total.mean, |k| f.terms[k].mean).element_sum() / 3.0
        };
        let (a, b, c) = (grey(coarsest), grey(coarse), grey(fine));
        Some(((a - b) / (b - c)).abs().log2())
    }
}
