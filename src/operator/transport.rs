//! T in a form that can be sampled, one state at a time or a wave (a batch of states) at once.
//!
//! `(T L)(x) = E[ weight · L(x') ]`, where [`Transport::scatter`] samples x' from the kernel of T. If L = E,
//! [`Transport::connect`] can sample x' from the support of E instead (next-event estimation).
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x | state: a place and the direction in which radiance leaves it | [`Transport::State`] |
//! | E(x) | emission | [`Transport::emission`] |
//! | x → x', weight | one sampled application of T | [`Step`] |
//! | p, p° | densities of the technique that chose x' and of the other technique, in the same measure | [`Step::pdf`], [`Step::other_pdf`] |
//!
//! Every estimator is written once, for any type that implements this trait. A scene implements it with rays. A matrix
//! implements it with a random walk on its rows (von Neumann and Ulam; Forsythe and Leibler 1950); there `T^k E` is known up
//! to rounding. References for the operators: Arvo, *Analytic Methods for Simulated Light Transport* (1995); Veach, *Robust
//! Monte Carlo Methods* (1997), ch. 4.

use crate::math::{Columns, Rgb, Rng, Streams};
use crate::scene::Crop;

/// One sample of the kernel of T: the new state, its weight and its densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The state x' to which the walk moves, or at which the connection ends.
    pub state: S,
    /// Kernel of T divided by the density `pdf`.
    pub weight: Rgb,
    /// Density with which this technique chose `state`.
    pub pdf: f32,
    /// Density with which the other technique would have chosen `state`, in the same measure. It is 0 if the other technique
    /// cannot choose it: after a delta vertex, or for a light without area.
    pub other_pdf: f32,
}

/// The operator T in a form that can be sampled.
pub trait Transport: Sync {
    /// A place and a direction for which the radiance is estimated.
    type State: Copy;
    /// A batch of states; `Vec<State>` is sufficient.
    type Wave: Wave<Self::State>;

    /// E(x): the exact emission at a state.
    fn emission(&self, at: &Self::State) -> Rgb;
    /// Samples the kernel of T at `at`. Returns `None` if the sample contributes zero, because the path was absorbed or left
    /// the scene.
    fn scatter(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>>;
    /// Samples the support of E: a next-event connection from `at`. Returns `None` if it contributes zero, because it is
    /// blocked or an end faces away.
    fn connect(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>>;
    /// An upper bound on (T 1)(x), per channel.
    fn albedo(&self, at: &Self::State) -> Rgb;

    /// The throughput with which a path starts: 1 in every colour channel in which something emits, 0 in the others.
    fn lit(&self) -> Rgb {
        Rgb::ONE
    }

    /// A lower limit on the termination probability q, as `(vertex, q)`: from that vertex on, a path ends with probability
    /// at least q. It applies to Russian roulette by albedo or by throughput, which may never end a path where albedos
    /// are 1. `None` where it is not needed, or where no q is known that keeps the variance finite.
    fn last_resort(&self) -> Option<(usize, f32)> {
        None
    }

    /// The probability that a walk is absorbed at `at`, if the transport defines one for each state. `None` if Russian
    /// roulette decides.
    fn absorption(&self, _at: &Self::State) -> Option<f32> {
        None
    }

    /// Returns true if [`Transport::connect`] finds all of E from every state, which requires that no vertex is a delta
    /// vertex. A light hit by scattering then need not be counted.
    fn connects_to_all(&self) -> bool {
        true
    }

    /// Sets `value[i] = E(state i)` for i < `n`. An override of this method or of the next two must return the same bits as
    /// the default.
    fn emission_wave(&self, wave: &mut Self::Wave, n: usize, value: &mut Columns) {
        for i in 0..n {
            value.set(i, self.emission(&wave.get(i)));
        }
    }

    /// Sets `out.value[i]` to one sample of (T E)(state i), with both densities. The states do not change.
    fn connect_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples) {
        connect_one_by_one(self, wave, streams, out);
    }

    /// Scatters every state. The indices of the paths that continue are pushed to `alive` in ascending order. Their new states
    /// move to the front of the wave in this order, and so do the weights and densities of their steps in `out`.
    fn scatter_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        scatter_one_by_one(self, wave, streams, out, alive);
    }
}

/// Default implementation of [`Transport::connect_wave`]: one state after the other.
pub(crate) fn connect_one_by_one<T: Transport + ?Sized>(
    t: &T,
    wave: &mut T::Wave,
    streams: Streams,
    out: &mut Samples,
) {
    for i in 0..streams.len() {
        match t.connect(&wave.get(i), &mut streams.rng(i)) {
            Some(s) => out.set(i, s.weight * t.emission(&s.state), s.pdf, s.other_pdf),
            None => out.set(i, Rgb::ZERO, 1.0, 0.0),
        }
    }
}

/// Default implementation of [`Transport::scatter_wave`]: one state after the other.
pub(crate) fn scatter_one_by_one<T: Transport + ?Sized>(
    t: &T,
    wave: &mut T::Wave,
    streams: Streams,
    out: &mut Samples,
    alive: &mut Vec<u32>,
) {
    for i in 0..streams.len() {
        if let Some(s) = t.scatter(&wave.get(i), &mut streams.rng(i)) {
            wave.set(alive.len(), s.state);
            out.set(alive.len(), s.weight, s.pdf, s.other_pdf);
            alive.push(i as u32);
        }
    }
}

/// A batch of states.
pub trait Wave<S>: Default + Send {
    /// Changes the number of states to `n`.
    fn resize(&mut self, n: usize);
    /// Returns state `i`.
    fn get(&self, i: usize) -> S;
    /// Replaces state `i`.
    fn set(&mut self, i: usize, state: S);
    /// Keeps only the states listed in `indices` (ascending), in the same order: state `j` becomes the old state
    /// `indices[j]`.
    fn keep(&mut self, indices: &[u32]);
}

impl<S: Copy + Default + Send> Wave<S> for Vec<S> {
    fn resize(&mut self, n: usize) {
        Vec::resize(self, n, S::default());
    }
    fn get(&self, i: usize) -> S {
        self[i]
    }
    fn set(&mut self, i: usize, state: S) {
        self[i] = state;
    }
    fn keep(&mut self, indices: &[u32]) {
        for (j, &i) in indices.iter().enumerate() {
            self[j] = self[i as usize];
        }
    }
}

/// Results of a batched method: one value and two densities per path.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// A radiance or a weight, per path.
    pub value: Columns,
    /// Density with which the technique that chose the sample (BSDF sampling or next-event estimation) produces it.
    pub pdf: Vec<f32>,
    /// Density of the other technique for the same sample.
    pub other_pdf: Vec<f32>,
}

impl Samples {
    /// Room for the results of `n` paths.
    pub fn new(n: usize) -> Self {
        Self { value: Columns::new(n), pdf: vec![1.0; n], other_pdf: vec![0.0; n] }
    }

    /// Replaces sample `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, value: Rgb, pdf: f32, other_pdf: f32) {
        self.value.set(i, value);
        self.pdf[i] = pdf;
        self.other_pdf[i] = other_pdf;
    }
}

/// A state projected onto a sensor: the pixel that sees it, its importance and its density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen<S> {
    /// Number of the pixel that sees the state.
    pub pixel: u32,
    /// A state at the position of the sensor, for methods that need the neighbour of a state.
    pub eye: S,
    /// Importance W divided by the cosine at the state; the geometry between sensor and state is included.
    pub importance: f32,
    /// Density with which a path of that pixel starts at the state, in the measure of the state.
    pub density: f32,
}

/// The starts of paths, for any transport: one state per pair (pixel, sample), or `None` where the radiance is zero.
pub trait Sensor<T: Transport>: Sync {
    /// Width and height in pixels; pixels are numbered row by row.
    fn size(&self) -> [u32; 2];
    /// The pixels that a film holds.
    fn crop(&self) -> Crop {
        Crop::whole(self.size())
    }
    /// Samples the first state of one path of `pixel`.
    fn start(&self, t: &T, pixel: u32, rng: &mut Rng) -> Option<T::State>;
    /// The pixel that sees a state if nothing blocks the view. `None` if no pixel does, or if paths from the light cannot be
    /// connected to this sensor.
    fn project(&self, _t: &T, _at: &T::State) -> Option<Seen<T::State>> {
        None
    }
    /// Density with which a path starts at a state, for the pixel that sees it, in the measure of the state.
    fn density(&self, t: &T, at: &T::State) -> f32 {
        self.project(t, at).map_or(0.0, |seen| seen.density)
    }
    /// Returns true if nothing blocks the view from the sensor to a state that [`Sensor::project`] maps to a pixel.
    fn sees(&self, _t: &T, _at: &T::State) -> bool {
        true
    }
    /// Removes from `list` every state of a wave that is hidden from the sensor. The result must be that of
    /// [`Sensor::sees`].
    fn sees_wave(&self, t: &T, wave: &mut T::Wave, list: &mut Vec<u32>) {
        list.retain(|&i| self.sees(t, &wave.get(i as usize)));
    }
    /// Samples the first states of a wave. The indices of the paths that have one are pushed to `alive` in ascending order, and
    /// their states move to the front of the wave in this order.
    fn start_wave(&self, t: &T, wave: &mut T::Wave, streams: Streams, alive: &mut Vec<u32>) {
        start_one_by_one(self, t, wave, streams, alive);
    }
}

/// Default implementation of [`Sensor::start_wave`]: one path after the other.
pub(crate) fn start_one_by_one<T: Transport, W: Sensor<T> + ?Sized>(
    sensor: &W,
    t: &T,
    wave: &mut T::Wave,
    streams: Streams,
    alive: &mut Vec<u32>,
) {
    for i in 0..streams.len() {
        if let Some(state) = sensor.start(t, streams.pixel[i], &mut streams.rng(i)) {
            wave.set(alive.len(), state);
            alive.push(i as u32);
        }
    }
}
