//! What a BSDF answers, whatever it is: the same questions as [`Bsdf`](super::Bsdf), in the same local directions.

use super::{BsdfSample, Sampling, TransportMode};
use crate::math::Rgb;
use glam::Vec3;

/// One side of a surface at a point.
pub trait Model: Copy {
    /// f(ω_o, ω_i), sr⁻¹, without its delta part.
    #[inline(always)]
    fn eval(&self, _wo: Vec3, _wi: Vec3, _mode: TransportMode) -> Rgb {
        Rgb::ZERO
    }
    /// A direction; none where there is none to go to. `u[0]`, `u[1]` choose it, `u[2]` chooses between parts.
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample>;
    /// Density of [`Self::sample`], delta parts excepted, sr⁻¹.
    #[inline(always)]
    fn pdf(&self, _wo: Vec3, _wi: Vec3, _sampling: Sampling) -> f32 {
        0.0
    }
    /// ∫ f cos θ_i dω_i with its delta part, or an upper bound of it.
    #[inline(always)]
    fn albedo(&self, _wo: Vec3) -> Rgb {
        self.max_albedo()
    }
    /// The largest albedo of any direction.
    fn max_albedo(&self) -> Rgb;
    /// Whether f has a part that connections can find.
    #[inline(always)]
    fn connects(&self) -> bool {
        true
    }
    /// Whether f has a delta part.
    #[inline(always)]
    fn has_delta(&self) -> bool {
        false
    }
    /// Whether f reaches the other side without a delta.
    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }
    /// The same with another reflectance of the diffuse part, where a texture gives it.
    #[must_use]
    fn with_reflectance(self, _reflectance: Rgb) -> Self {
        self
    }
}

/// A draw that does not follow f: a direction of the hemisphere as `sampling` has it, or of the sphere where the surface transmits.
#[inline(always)]
pub(super) fn sample_blindly(
    f: &impl Model,
    wo: Vec3,
    sampling: Sampling,
    mode: TransportMode,
    u: [f32; 3],
) -> Option<BsdfSample> {
    let up = sampling.direction([u[0], u[1]]);
    let wi = if f.transmits() && u[2] >= 0.5 { -up } else { up };
    BsdfSample::of(wi, f.eval(wo, wi, mode), f.pdf(wo, wi, sampling))
}

/// Its density over the hemisphere.
#[inline(always)]
pub(super) fn blind_pdf(wi: Vec3, sampling: Sampling) -> f32 {
    if wi.z > 0.0 { sampling.pdf(wi.z) } else { 0.0 }
}
