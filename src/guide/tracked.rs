//! A transport whose states also store the facts about their path that roulette and splitting need.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u(x_0) | radiance expected of the path at its start, 0 if unknown | [`Track::start`] |
//! | siblings | number of walks into which the path has split | [`Track::siblings`] |
//!
//! Everything else is passed on to the wrapped transport, with the same random numbers and the same bits.

use super::expected::Expecting;
use crate::math::{Columns, Rgb, Rng, Streams, pick};
use crate::operator::{Samples, Sensor, Step, Transport, Wave};
use crate::scene::Crop;

/// A state together with facts about its path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Track<X> {
    /// The state.
    pub x: X,
    /// Radiance expected of the path at its start, 0 if unknown.
    pub start: f32,
    /// Number of walks into which its path has split.
    pub siblings: u32,
}

/// A transport of tracked states.
#[derive(Clone, Copy, Debug)]
pub struct Tracked<'a, T>(pub &'a T);

/// A wave of tracked states.
#[derive(Clone, Debug, Default)]
pub struct TrackedWave<W> {
    /// The states.
    pub states: W,
    /// Radiance expected of each path at its start.
    pub start: Vec<f32>,
    /// Number of walks into which each path has split.
    pub siblings: Vec<u32>,
}

impl<X: Copy, W: Wave<X>> Wave<Track<X>> for TrackedWave<W> {
    fn resize(&mut self, n: usize) {
        self.states.resize(n);
        self.start.resize(n, 0.0);
        self.siblings.resize(n, 1);
    }
    fn get(&self, i: usize) -> Track<X> {
        Track { x: self.states.get(i), start: self.start[i], siblings: self.siblings[i] }
    }
    fn set(&mut self, i: usize, state: Track<X>) {
        self.states.set(i, state.x);
        (self.start[i], self.siblings[i]) = (state.start, state.siblings);
    }
    fn keep(&mut self, indices: &[u32]) {
        self.states.keep(indices);
        pick::keep(&mut self.start, indices);
        pick::keep(&mut self.siblings, indices);
    }
}

impl<T: Expecting> Transport for Tracked<'_, T> {
    type State = Track<T::State>;
    type Wave = TrackedWave<T::Wave>;

    fn emission(&self, at: &Self::State) -> Rgb {
        self.0.emission(&at.x)
    }
    fn scatter(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>> {
        self.0.scatter(&at.x, rng).map(|s| at.then(s))
    }
    fn connect(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>> {
        self.0.connect(&at.x, rng).map(|s| at.then(s))
    }
    fn albedo(&self, at: &Self::State) -> Rgb {
        self.0.albedo(&at.x)
    }
    fn lit(&self) -> Rgb {
        self.0.lit()
    }
    fn last_resort(&self) -> Option<(usize, f32)> {
        self.0.last_resort()
    }
    fn connects_to_all(&self) -> bool {
        self.0.connects_to_all()
    }
    fn emission_wave(&self, wave: &mut Self::Wave, n: usize, value: &mut Columns) {
        self.0.emission_wave(&mut wave.states, n, value);
    }
    fn connect_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples) {
        self.0.connect_wave(&mut wave.states, streams, out);
    }
    fn scatter_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        self.0.scatter_wave(&mut wave.states, streams, out, alive);
        pick::keep(&mut wave.start, alive);
        pick::keep(&mut wave.siblings, alive);
    }
}

impl<X> Track<X> {
    /// Carries the facts about the path over to the next state.
    fn then(&self, s: Step<X>) -> Step<Self> {
        let state = Self { x: s.state, start: self.start, siblings: self.siblings };
        Step { state, weight: s.weight, pdf: s.pdf, other_pdf: s.other_pdf }
    }

    /// The tracked state at the start of a path.
    fn begin<T: Expecting<State = X>>(t: &T, x: X) -> Self {
        Self { start: t.expected(&x).unwrap_or_default().all, siblings: 1, x }
    }
}

/// A sensor whose paths start with tracked states.
pub struct TrackedSensor<'a, S>(pub &'a S);

impl<'a, T: Expecting, S: Sensor<T>> Sensor<Tracked<'a, T>> for TrackedSensor<'_, S> {
    fn size(&self) -> [u32; 2] {
        self.0.size()
    }
    fn crop(&self) -> Crop {
        self.0.crop()
    }
    fn start(&self, t: &Tracked<'a, T>, pixel: u32, rng: &mut Rng) -> Option<Track<T::State>> {
        self.0.start(t.0, pixel, rng).map(|x| Track::begin(t.0, x))
    }
    fn start_wave(&self, t: &Tracked<'a, T>, wave: &mut TrackedWave<T::Wave>, streams: Streams, alive: &mut Vec<u32>) {
        self.0.start_wave(t.0, &mut wave.states, streams, alive);
        for i in 0..alive.len() {
            wave.set(i, Track::begin(t.0, wave.states.get(i)));
        }
    }
}
