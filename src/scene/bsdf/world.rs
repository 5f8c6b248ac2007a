//! The BSDF in world coordinates: one step of a path away from a vertex, and the weight of a given direction.
//!
//! ```text
//! depart    ω_i sampled with density p          weight f |cos θ_i|/p
//! towards   ω_i given                           f |cos θ_i|, p
//! connect   ω_i given, drawn with density q     weight f |cos θ_i|/q, p
//! ```
//!
//! | notation | type | place |
//! |---|---|---|
//! | n, ω_o | unit vectors of the vertex | arguments `n`, `omega` |
//! | ω_i | unit vector in which the path goes on | [`Departure::direction`], argument `to` |
//! | side of the surface on which ω_i lies | its normal, n or −n | [`Departure::normal`], [`Towards::normal`] |
//!
//! A wave of paths and a single path use the same functions, so that both give the same bits.

use super::{Model, Sampling, TransportMode};
use crate::math::{Rgb, direction::Frame};
use glam::Vec3;

/// A direction sampled at a vertex; no ray has been traced yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// ω_i, a unit vector.
    pub direction: Vec3,
    /// The normal on the side of the surface from which the ray leaves.
    pub normal: Vec3,
    /// f |cos θ_i|/p.
    pub weight: Rgb,
    /// p; for a delta direction the probability of choosing it.
    pub pdf: f32,
    /// True if the direction came from a delta part.
    pub delta: bool,
}

/// What a BSDF says of a given direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Towards {
    /// f |cos θ_i|, or that divided by the density of a connection.
    pub value: Rgb,
    /// Density with which sampling would have chosen the direction, sr⁻¹.
    pub pdf: f32,
    /// The normal on the side of the surface on which the direction lies.
    pub normal: Vec3,
}

/// A sampled direction in world coordinates.
#[inline(always)]
pub(super) fn depart(
    f: &impl Model,
    n: Vec3,
    omega: Vec3,
    sampling: Sampling,
    mode: TransportMode,
    u: [f32; 3],
) -> Option<Departure> {
    let frame = Frame::new(n);
    let s = f.sample(frame.local(omega), sampling, mode, u)?;
    let normal = if s.wi.z > 0.0 { n } else { -n };
    Some(Departure { direction: frame.world(s.wi), normal, weight: s.weight, pdf: s.pdf, delta: s.delta })
}

/// f |cos θ_i|, p and the side for the unit direction `to`; `None` if f cos θ_i is zero.
#[inline(always)]
pub(super) fn towards(
    f: &impl Model,
    n: Vec3,
    omega: Vec3,
    to: Vec3,
    sampling: Sampling,
    mode: TransportMode,
) -> Option<Towards> {
    let frame = Frame::new(n);
    let (wo, wi) = (frame.local(omega), frame.local(to));
    let value = f.eval(wo, wi, mode) * wi.z.abs();
    let normal = if wi.z > 0.0 { n } else { -n };
    // not `bool::then`: its closure would not be compiled for the lanes
    if value == Rgb::ZERO { None } else { Some(Towards { value, pdf: f.pdf(wo, wi, sampling), normal }) }
}
