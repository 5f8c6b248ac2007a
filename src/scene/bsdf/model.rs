//! The interface of every BSDF: the same methods as [`Bsdf`](super::Bsdf), in the same local directions.

use super::world::{Departure, Towards};
use super::{BsdfSample, Sampling, TransportMode};
use crate::math::{Rgb, direction::Frame};
use glam::Vec3;

/// The BSDF of one side of a surface at a point.
pub trait Model: Copy {
    /// f(ω_o, ω_i) without its delta part, sr⁻¹.
    #[inline(always)]
    fn eval(&self, _wo: Vec3, _wi: Vec3, _mode: TransportMode) -> Rgb {
        Rgb::ZERO
    }
    /// A sampled direction; `None` if light is absorbed or no direction is possible. `u[0]` and `u[1]` choose the direction,
    /// `u[2]` chooses between parts of f.
    fn sample(&self, wo: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<BsdfSample>;
    /// Density of [`Self::sample`] without delta parts, sr⁻¹.
    #[inline(always)]
    fn pdf(&self, _wo: Vec3, _wi: Vec3, _sampling: Sampling) -> f32 {
        0.0
    }
    /// ∫ f cos θ_i dω_i including the delta part, or an upper bound of it.
    #[inline(always)]
    fn albedo(&self, _wo: Vec3) -> Rgb {
        self.max_albedo()
    }
    /// The largest albedo over all directions.
    fn max_albedo(&self) -> Rgb;
    /// Returns true if f has a part other than a delta, so that connections to lamps can be made.
    #[inline(always)]
    fn connects(&self) -> bool {
        true
    }
    /// Returns true if f has a delta part.
    #[inline(always)]
    fn has_delta(&self) -> bool {
        false
    }
    /// Returns true if f transmits light to the other side by a part that is not a delta.
    #[inline(always)]
    fn transmits(&self) -> bool {
        false
    }
    /// The same BSDF with another reflectance of its diffuse part, which a texture gives.
    #[must_use]
    #[inline(always)]
    fn with_reflectance(self, _reflectance: Rgb) -> Self {
        self
    }

    /// [`Self::sample`] in world coordinates. An override may be faster, but means the same.
    #[inline(always)]
    fn depart(&self, n: Vec3, omega: Vec3, sampling: Sampling, mode: TransportMode, u: [f32; 3]) -> Option<Departure> {
        let frame = Frame::new(n);
        let s = self.sample(frame.local(omega), sampling, mode, u)?;
        let normal = if s.wi.z > 0.0 { n } else { -n };
        Some(Departure { direction: frame.world(s.wi), normal, weight: s.weight, pdf: s.pdf, delta: s.delta })
    }
    /// f cos θ_i and [`Self::pdf`] in world coordinates; `None` if f cos θ_i is zero.
    #[inline(always)]
    fn towards(&self, n: Vec3, omega: Vec3, to: Vec3, sampling: Sampling, mode: TransportMode) -> Option<Towards> {
        let frame = Frame::new(n);
        let (wo, wi) = (frame.local(omega), frame.local(to));
        let value = self.eval(wo, wi, mode) * wi.z.abs();
        let normal = if wi.z > 0.0 { n } else { -n };
        // not `bool::then`: its closure would not be compiled for the lanes
        if value == Rgb::ZERO { None } else { Some(Towards { value, pdf: self.pdf(wo, wi, sampling), normal }) }
    }
    /// The same for radiance from a direction that was drawn with density `pdf`: the value is divided by it.
    #[inline(always)]
    fn connect(&self, n: Vec3, omega: Vec3, to: Vec3, pdf: f32, sampling: Sampling) -> Option<Towards> {
        let t = self.towards(n, omega, to, sampling, TransportMode::Radiance)?;
        Some(Towards { value: t.value * (1.0 / pdf), ..t })
    }
    /// Calls the visitor with this BSDF. A BSDF that is one of several formulas passes the visitor on to the one that it is,
    /// so that the choice is made once and not for each path.
    #[inline(always)]
    fn welcome<V: Visitor>(&self, visitor: V) -> V::Out {
        visitor.visit(self)
    }
}

/// Work that is compiled for each BSDF separately.
pub trait Visitor {
    /// Result of the work.
    type Out;
    /// Does the work with this BSDF.
    fn visit<M: Model>(self, f: &M) -> Self::Out;
}

/// A sample that does not follow f: a direction of the hemisphere with the density of `sampling`, or of the whole sphere if
/// the surface transmits.
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

/// Density over the hemisphere of a direction sampled by [`sample_blindly`] on a surface that does not transmit.
#[inline(always)]
pub(super) fn blind_pdf(wi: Vec3, sampling: Sampling) -> f32 {
    if wi.z > 0.0 { sampling.pdf(wi.z) } else { 0.0 }
}
