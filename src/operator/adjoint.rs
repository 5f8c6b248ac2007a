//! T walked from the lights: `(T*)^s W`, and everything a path needs to be found from both ends.
//!
//! A path of term k is z_0 … z_k, from what the eye sees to the light. Its contribution to a pixel is
//!
//! ```text
//! W(z_0) · S_0 V_01 S_1 V_12 … V_{k−1,k} E(z_k)        S_v: scattering at z_v, with its cosine        V: geometry between two
//! ```
//!
//! and `⟨W, T^k E⟩ = ⟨(T*)^k W, E⟩`: the same number whichever end the walk starts from.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | y_0, p(y_0) | where light starts, with its density | [`Adjoint::emit`] |
//! | z → z' | one step from either end | [`Adjoint::walk`] |
//! | S, or E cos θ; density of going there | both for a given pair | [`Adjoint::toward`] |
//! | V/r² | geometry between two ends | [`Adjoint::link`] |
//! | W | the pixel that sees a state, and how strongly | [`Sensor::project`](super::Sensor::project) |
//!
//! Densities are per unit of the state's own measure: area on a surface, solid angle for the sky, probability for a point
//! light, a direction or a row of a matrix. Reference: Veach (1997), ch. 8 and 10; Arvo (1995), ch. 6.

use super::Transport;
use crate::math::{Rgb, Rng};

/// What a walk carries when it leaves a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Light leaves its source.
    Emission,
    /// Light that has been scattered: T*.
    Flux,
    /// Radiance is asked for: T.
    Radiance,
}

/// One step of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjointStep<S> {
    /// Where it arrived, asked from where it left.
    pub state: S,
    /// Kernel over density.
    pub weight: Rgb,
    /// Density of the step in the measure of `state`; of a delta step as [`Adjoint::delta_density`] has it.
    pub density: f32,
    /// Of a delta step, the probability that it was chosen.
    pub delta: Option<f32>,
}

/// What goes from a state towards another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Toward {
    /// Scattering with its cosine, or emission with its cosine. Without delta parts.
    pub value: Rgb,
    /// Density with which [`Adjoint::walk`] goes there, in the measure of the other state.
    pub density: f32,
}

/// T walked from the lights.
pub trait Adjoint: Transport {
    /// A state where light starts, and its density.
    fn emit(&self, rng: &mut Rng) -> Option<(Self::State, f32)>;
    /// The density with which [`Self::emit`] starts at a state.
    fn emit_density(&self, at: &Self::State) -> f32;
    /// The density with which [`Transport::connect`] chooses `at` from `from`, in the measure of `at`.
    fn connect_density(&self, from: &Self::State, at: &Self::State) -> f32;
    /// One step: scattering for [`Role::Radiance`], its adjoint for the others. Light does not walk into the sky.
    fn walk(&self, at: &Self::State, role: Role, rng: &mut Rng) -> Option<AdjointStep<Self::State>>;
    /// What goes from `at` to `to`; `at` has been asked from where its walk came from.
    fn toward(&self, at: &Self::State, to: &Self::State, role: Role) -> Toward;
    /// Stands for the density of a delta step from `at` to `to` chosen with probability `choice`; `at` has been asked from
    /// where its walk came from. The delta function, which is the same from both ends, is left out.
    fn delta_density(&self, at: &Self::State, to: &Self::State, choice: f32) -> f32;
    /// The same place, asked from another.
    fn facing(&self, at: &Self::State, other: &Self::State) -> Self::State;
    /// Geometry between the ends of two walks; 0 where one does not see the other.
    fn link(&self, eye: &Self::State, light: &Self::State) -> f32;

    /// Density of walking from `at` to `to`, having come from `from`.
    fn density(&self, from: &Self::State, at: &Self::State, to: &Self::State, role: Role) -> f32 {
        self.toward(&self.facing(at, from), to, role).density
    }
}
