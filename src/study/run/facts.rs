//! Values that follow from the results of a run: rates, bounds and orders of convergence.
//!
//! | | place |
//! |---|---|
//! | observed rate of ‖T^k E‖₁, fitted | [`Run::observed_rate`] |
//! | guaranteed: ‖T‖₁ ≤ max albedo, and the bound of the tail that follows | [`Run::guaranteed_rate`], [`Run::tail_bound`] |
//! | order of convergence in h | [`Run::order`] |

use super::Run;
use crate::engine::by_rays::{Estimator, Sampled};
use crate::stats::{NoRate, Outcome, Rate, TermMeans, observed_rate};
use crate::terms::functional::Replicates;
use glam::DVec3;

impl Run {
    /// All results with images: the terms, the path tracer, the matrix seen through the camera.
    pub fn results(&self) -> impl Iterator<Item = &Sampled> {
        self.sampled().chain(self.radiosity.as_ref().map(|r| &r.fine))
    }

    /// The results of Monte Carlo in the scene: the terms and the path tracer.
    pub fn sampled(&self) -> impl Iterator<Item = &Sampled> {
        self.terms.iter().chain(&self.path)
    }

    /// Returns true if there is no result because the work was stopped early.
    pub fn is_empty(&self) -> bool {
        self.results().next().is_none()
    }

    /// Samples per pixel that all results have; fewer than asked for if the work was stopped.
    pub fn spp(&self) -> u32 {
        self.results().map(|s| s.spp).min().unwrap_or(0)
    }

    /// The outcome of all comparisons: they differ if any does, and agree if all do. None if nothing was compared.
    pub fn outcome(&self) -> Option<Outcome> {
        let outcomes = || self.verdicts.iter().map(|v| v.comparison.outcome);
        outcomes().next()?;
        Some(if outcomes().any(|o| o == Outcome::Differs) {
            Outcome::Differs
        } else if outcomes().all(|o| o == Outcome::Agrees) {
            Outcome::Agrees
        } else {
            Outcome::Inconclusive
        })
    }

    /// Returns true if two results differ, or if a sample was not finite.
    pub fn failed(&self) -> bool {
        self.outcome() == Some(Outcome::Differs) || self.results().any(|s| s.series.cost.non_finite > 0)
    }

    /// ‖T^k E‖₁ over all surfaces, each term from separate paths.
    pub fn norms(&self) -> Option<&Replicates> {
        self.surface.iter().find(|s| s.0 == Estimator::Single).map(|s| &s.1)
    }

    /// The fitted rate at which ‖T^k E‖₁, averaged over the channels, falls, or the reason why none could be fitted.
    pub fn observed_rate(&self) -> Option<Result<Rate, NoRate>> {
        self.norms().map(|norms| observed_rate(&TermMeans::from(norms)))
    }

    /// The same rate in one channel.
    pub fn observed_rate_in(&self, channel: usize) -> Option<Result<Rate, NoRate>> {
        self.norms().map(|norms| observed_rate(&TermMeans::channel(norms, channel)))
    }

    /// The channel in which the terms fall most slowly: by the spectral radius of the matrix, or else by the largest albedo.
    pub fn slowest_channel(&self) -> usize {
        let radii = self.radiosity.as_ref().map(|r| DVec3::from_array(r.matrix.spectral.each_ref().map(|s| s.radius)));
        radii.unwrap_or(self.guaranteed_rate()).max_position()
    }

    /// The largest albedo of each channel, a bound of ‖T‖₁.
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

    /// The bound of everything longer than K that follows from ‖T‖₁ ≤ g: g/(1 − g) ‖T^K E‖₁ for each channel, NaN where g = 1.
    pub fn tail_bound(&self) -> Option<DVec3> {
        let g = self.guaranteed_rate();
        let last = |norms: &Replicates| norms.mean[norms.mean.len() - 2];
        self.norms().map(|norms| DVec3::select(g.cmplt(DVec3::ONE), g / (1.0 - g) * last(norms), DVec3::NAN))
    }

    /// ‖T_h^k E‖₁ per area for k = 0..=K: means of the matrix's terms over all surfaces, averaged over the channels. None
    /// without a matrix.
    pub fn norms_of_matrix(&self) -> Option<Vec<f64>> {
        let of = |means: &Vec<DVec3>| means.iter().map(|v| v.element_sum() / 3.0).collect();
        self.radiosity.as_ref().map(|r| of(&r.matrix.surface))
    }

    /// The same in one channel.
    pub fn norms_of_matrix_in(&self, channel: usize) -> Option<Vec<f64>> {
        self.radiosity.as_ref().map(|r| r.matrix.surface.iter().map(|v| v[channel]).collect())
    }

    /// The order in h in which the mean of an image converges, with its standard error, from three meshes: of term k, or of
    /// the whole. With a, b, c the means on meshes of width 4h, 2h, h the order is log₂ |(a − b)/(b − c)|. All meshes are read
    /// along the same camera rays, so the noise of a difference comes from the differences of the replicates. Nothing without
    /// three meshes; not finite where the differences tell no order.
    pub fn order(&self, k: Option<usize>) -> Option<(f64, f64)> {
        let [coarsest, coarse, fine] = self.meshes.as_slice() else { return None };
        let grey = |v: DVec3| v.element_sum() / 3.0;
        // term k, or the sum of all slots
        let of = |slots: &[DVec3]| k.map_or_else(|| grey(slots.iter().sum()), |k| grey(slots[k]));
        let [a, b, c] = [coarsest, coarse, fine].map(|mesh| of(&mesh.replicates.mean));
        let replicates = coarsest.replicates.deviation.len() as f64;
        let deviations = coarsest.replicates.deviation.iter().zip(&coarse.replicates.deviation);
        let squares = deviations.zip(&fine.replicates.deviation).map(|((x, y), z)| {
            let [x, y, z] = [x, y, z].map(|d| of(d));
            ((x - y) / (a - b) - (y - z) / (b - c)).powi(2)
        });
        let error = (squares.sum::<f64>() * replicates / (replicates - 1.0)).sqrt() / std::f64::consts::LN_2;
        Some((((a - b) / (b - c)).abs().log2(), error))
    }

    /// |R_h − R_2h| of term k or of the whole, averaged over the channels: how much the mean of the image changed from the
    /// second mesh to the finest.
    pub fn last_change(&self, k: Option<usize>) -> Option<f64> {
        let r = self.radiosity.as_ref()?;
        let of = |f: &crate::terms::Functional| k.map_or(f.total.mean, |k| f.terms[k].mean);
        let change = (of(r.fine.series.image()) - of(r.coarse.series.image())).abs();
        Some(change.element_sum() / 3.0)
    }
}
