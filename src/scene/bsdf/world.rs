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
//! The functions are [`Model::depart`](super::Model::depart), [`Model::towards`](super::Model::towards) and
//! [`Model::connect`](super::Model::connect). A wave of paths and a single path use the same functions, so that both give the
//! same bits.

use crate::math::Rgb;
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
