//! The adjoint of T: walks from the lights, `(T*)^s W`, and the densities needed to find a path from both ends.
//!
//! A path of term k is z_0 … z_k: z_0 is the state that the eye sees, z_k lies on the light. Its contribution to a pixel is
//!
//! ```text
//! W(z_0) · S_0 V_01 S_1 V_12 … V_{k−1,k} E(z_k)        S_v: scattering at z_v, with its cosine        V: geometry between two
//! ```
//!
//! The identity `⟨W, T^k E⟩ = ⟨(T*)^k W, E⟩` says that both directions of walking compute the same number.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | y_0, p(y_0) | the state where light starts, and its density | [`Adjoint::emit`] |
//! | z → z' | one step of a walk from either end | [`Adjoint::walk`] |
//! | S, or E cos θ; density of the step | value and density for a given pair of states | [`Adjoint::toward`] |
//! | V/r² | visibility over squared distance between the ends of two walks | [`Adjoint::link`] |
//! | W | importance: how strongly a pixel responds to light from a state that it sees | [`Sensor::project`](super::Sensor::project) |
//!
//! Densities are per unit of the state's own measure: area on a surface, solid angle for the sky, probability for a point
//! light, for a direction light or for a row of a matrix. Reference: Veach (1997), ch. 8 and 10; Arvo (1995), ch. 6.

use super::{Transport, Wave};
use crate::math::{Columns, Rgb, Rng, Streams, pick};

/// The quantity that a walk transports when it leaves a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Emitted light: the first step from a light.
    Emission,
    /// Scattered light on a walk from the lights: T*.
    Flux,
    /// Radiance on a walk from the eye: T.
    Radiance,
}

/// One sampled step of a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdjointStep<S> {
    /// The state at the end of the step; its direction points back to the start of the step.
    pub state: S,
    /// Kernel divided by density.
    pub weight: Rgb,
    /// Density of the step in the measure of `state`; for a delta step, the value of [`Adjoint::delta_density`].
    pub density: f32,
    /// For a delta step, the probability with which it was chosen; otherwise `None`.
    pub delta: Option<f32>,
}

/// Value and density of the step from one given state to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Toward {
    /// Scattering times cosine, or emission times cosine. Delta components are left out.
    pub value: Rgb,
    /// Density with which [`Adjoint::walk`] steps to the other state, in the measure of that state.
    pub density: f32,
}

/// The steps of a wave of walks: [`AdjointStep`] in columns, without the states.
#[derive(Clone, Debug, Default)]
pub struct Steps {
    /// Kernel divided by density.
    pub weight: Columns,
    /// Density of the step; for a start at a light, the density of the start.
    pub density: Vec<f32>,
    /// For a delta step, the probability with which it was chosen; 0 for every other step.
    pub choice: Vec<f32>,
    /// False if nobody reads the densities of steps; they need not be computed then.
    pub wanted: bool,
}

impl Steps {
    /// Room for the steps of `n` walks.
    pub fn new(n: usize) -> Self {
        Self { weight: Columns::new(n), density: vec![0.0; n], choice: vec![0.0; n], wanted: true }
    }

    /// Keeps only the steps listed in `indices` (ascending).
    pub fn keep(&mut self, indices: &[u32]) {
        self.weight.keep(indices);
        pick::keep(&mut self.density, indices);
        pick::keep(&mut self.choice, indices);
    }
}

/// A transport that can also be walked from the lights.
pub trait Adjoint: Transport {
    /// Samples a state where light starts, and returns it with its density.
    fn emit(&self, rng: &mut Rng) -> Option<(Self::State, f32)>;
    /// The density with which [`Self::emit`] starts at a state.
    fn emit_density(&self, at: &Self::State) -> f32;
    /// The density with which [`Transport::connect`] chooses `at` from `from`, in the measure of `at`.
    fn connect_density(&self, from: &Self::State, at: &Self::State) -> f32;
    /// One step of a walk: scattering for [`Role::Radiance`], its adjoint for the other roles. Light never walks into the
    /// sky.
    fn walk(&self, at: &Self::State, role: Role, rng: &mut Rng) -> Option<AdjointStep<Self::State>>;
    /// Value and density of the step from `at` to `to`. The direction of `at` must point to the previous state of its walk.
    fn toward(&self, at: &Self::State, to: &Self::State, role: Role) -> Toward;
    /// The factor of the delta function in the density of a delta step from `at` to `to`, where `choice` is the probability
    /// of choosing the step. The delta function itself is left out because it is the same from both ends. The direction of
    /// `at` must point to the previous state of its walk.
    fn delta_density(&self, at: &Self::State, to: &Self::State, choice: f32) -> f32;
    /// The state `at` with its direction turned towards `other`.
    fn facing(&self, at: &Self::State, other: &Self::State) -> Self::State;
    /// The geometry factor between the last states of two walks; 0 if they do not see each other.
    fn link(&self, eye: &Self::State, light: &Self::State) -> f32;

    /// Density of the step from `at` to `to` on a walk that came from `from`.
    #[inline(always)]
    fn density(&self, from: &Self::State, at: &Self::State, to: &Self::State, role: Role) -> f32 {
        self.toward(&self.facing(at, from), to, role).density
    }

    /// [`Adjoint::toward`] between the last states of two walks: from the eye's to the light's, and back.
    #[inline(always)]
    fn both_ways(&self, eye: &Self::State, light: &Self::State) -> (Toward, Toward) {
        (self.toward(eye, light, Role::Radiance), self.toward(light, eye, Role::Flux))
    }

    /// Returns true if scattering at this state does not depend on where the walk came from, as on a Lambertian surface: then
    /// [`Adjoint::density`] is the same for every `from` on the side of the state.
    fn forgets(&self, _at: &Self::State) -> bool {
        false
    }

    /// Samples a start at a light for every walk i of a wave, and its density. The indices of the walks that have one are
    /// pushed to `alive` in ascending order. An override of this method or of the next three must return the same bits as the
    /// default, which handles one walk after the other.
    fn emit_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Steps, alive: &mut Vec<u32>) {
        for i in 0..streams.len() {
            if let Some((state, density)) = self.emit(&mut streams.rng(i)) {
                wave.set(i, state);
                out.density[i] = density;
                alive.push(i as u32);
            }
        }
    }

    /// One step of every walk i: the new state replaces the old one. Densities are set where `out.wanted` is true. The indices
    /// of the walks that continue are pushed to `alive` in ascending order.
    fn walk_wave(&self, wave: &mut Self::Wave, role: Role, streams: Streams, out: &mut Steps, alive: &mut Vec<u32>) {
        for i in 0..streams.len() {
            if let Some(s) = self.walk(&wave.get(i), role, &mut streams.rng(i)) {
                wave.set(i, s.state);
                out.weight.set(i, s.weight);
                (out.density[i], out.choice[i]) = (s.density, s.delta.unwrap_or(0.0));
                alive.push(i as u32);
            }
        }
    }

    /// Connects every state i to a newly chosen state on a light, as [`Transport::connect`] does: the state is stored in
    /// `found`, and the weight of the step in `weight`. The indices of the connections are pushed to `alive` in ascending
    /// order.
    fn choose_wave(
        &self,
        wave: &mut Self::Wave,
        streams: Streams,
        found: &mut Self::Wave,
        weight: &mut Columns,
        alive: &mut Vec<u32>,
    ) {
        for i in 0..streams.len() {
            if let Some(s) = self.connect(&wave.get(i), &mut streams.rng(i)) {
                found.set(i, s.state);
                weight.set(i, s.weight);
                alive.push(i as u32);
            }
        }
    }

    /// Sets `factor[i]` to [`Adjoint::link`] of the pair (eye i, light i) for every i in `list`, and removes the pairs that
    /// do not see each other from the list. `scratch` is a wave whose states are not used.
    fn link_wave(
        &self,
        eye: &Self::Wave,
        light: &Self::Wave,
        _scratch: &mut Self::Wave,
        list: &mut Vec<u32>,
        factor: &mut [f32],
    ) {
        list.retain(|&i| {
            let i = i as usize;
            factor[i] = self.link(&eye.get(i), &light.get(i));
            factor[i] > 0.0
        });
    }
}
