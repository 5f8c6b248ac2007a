//! T as something that can be sampled, one state at a time or a wave of states at once.
//!
//! `(T L)(x) = E[ weight · L(x') ]`, where x' is drawn by [`Transport::scatter`] from the kernel, or, where L = E, by
//! [`Transport::connect`] from the support of E (next-event estimation).
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x | state: where radiance is asked for, and in which direction it leaves | [`Transport::State`] |
//! | E(x) | emission | [`Transport::emission`] |
//! | x → x', weight | one factor of T | [`Step`] |
//! | p, p° | density of the technique used and of the other one, in one measure | [`Step::pdf`], [`Step::other_pdf`] |
//!
//! Estimators are written once over this trait. A scene implements it with rays, a matrix with a random walk on its rows
//! (von Neumann and Ulam; Forsythe and Leibler 1950), where `T^k E` is known to rounding. Reference for the operators:
//! Arvo, *Analytic Methods for Simulated Light Transport* (1995); Veach, *Robust Monte Carlo Methods* (1997), ch. 4.

use crate::math::{Columns, Rgb, Rng, Streams, columns};

/// One sample of the kernel of T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// Where the walk goes, or where the connection ends.
    pub state: S,
    /// Kernel over density.
    pub weight: Rgb,
    /// Density with which this technique chose `state`.
    pub pdf: f32,
    /// Density with which the other technique would have chosen it, in the same measure; 0 if it could not: after a delta
    /// vertex, or for a light without area.
    pub other_pdf: f32,
}

/// T as something that can be sampled.
pub trait Transport: Sync {
    /// Where radiance is asked for.
    type State: Copy;
    /// Many states; `Vec<State>` will do.
    type Wave: Wave<Self::State>;

    /// E(x): emission, exactly.
    fn emission(&self, at: &Self::State) -> Rgb;
    /// Samples the kernel of T at `at`; nothing when the sample is zero (absorbed, or gone).
    fn scatter(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>>;
    /// Samples the support of E; nothing when the sample is zero (blocked, facing away).
    fn connect(&self, at: &Self::State, rng: &mut Rng) -> Option<Step<Self::State>>;
    /// A bound on (T 1)(x).
    fn albedo(&self, at: &Self::State) -> Rgb;

    /// 1 in the channels in which anything emits, 0 in the others: what a path carries at its start.
    fn lit(&self) -> Rgb {
        Rgb::ONE
    }

    /// From which vertex on, and with which probability at least, a path ends that goes by its albedo or its throughput: where albedos
    /// may be 1, and q is known to keep the variance finite.
    fn last_resort(&self) -> Option<(usize, f32)> {
        None
    }

    /// The probability that a walk is absorbed at `at`, where that is a property of the place; elsewhere roulette decides.
    fn absorption(&self, _at: &Self::State) -> Option<f32> {
        None
    }

    /// Whether [`Transport::connect`] finds all of E from every state: no delta vertices, so that hits need not be looked at.
    fn connects_to_all(&self) -> bool {
        true
    }

    /// `value[i] = E(state i)`. An override of this or the next two must give the same bits as the default.
    fn emission_wave(&self, wave: &mut Self::Wave, n: usize, value: &mut Columns) {
        for i in 0..n {
            value.set(i, self.emission(&wave.get(i)));
        }
    }

    /// `out.value[i]` = one sample of (T E)(state i), with both densities; the states stay.
    fn connect_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples) {
        connect_one_by_one(self, wave, streams, out);
    }

    /// State i moves on and `out.value[i]` is its weight; the indices of paths that live are pushed to `alive`, ascending.
    fn scatter_wave(&self, wave: &mut Self::Wave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        scatter_one_by_one(self, wave, streams, out, alive);
    }
}

/// The default of [`Transport::connect_wave`].
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

/// The default of [`Transport::scatter_wave`].
pub(crate) fn scatter_one_by_one<T: Transport + ?Sized>(
    t: &T,
    wave: &mut T::Wave,
    streams: Streams,
    out: &mut Samples,
    alive: &mut Vec<u32>,
) {
    for i in 0..streams.len() {
        if let Some(s) = t.scatter(&wave.get(i), &mut streams.rng(i)) {
            wave.set(i, s.state);
            out.set(i, s.weight, s.pdf, s.other_pdf);
            alive.push(i as u32);
        }
    }
}

/// Many states.
pub trait Wave<S>: Default + Send {
    /// Room for `n` states.
    fn resize(&mut self, n: usize);
    /// State `i`.
    fn get(&self, i: usize) -> S;
    /// Replaces state `i`.
    fn set(&mut self, i: usize, state: S);
    /// Stable compaction: state `j` becomes the old state `indices[j]`, ascending.
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
        columns::keep(self, indices);
    }
}

/// What a batched method gives back for each path.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// A radiance or a weight.
    pub value: Columns,
    /// Density of the technique used.
    pub pdf: Vec<f32>,
    /// Density of the other technique.
    pub other_pdf: Vec<f32>,
}

impl Samples {
    /// Room for `n`.
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

/// A state as a sensor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen<S> {
    /// By which pixel.
    pub pixel: u32,
    /// Stands for the sensor where a state's neighbour is asked for.
    pub eye: S,
    /// W over the cosine at the state, with the geometry between.
    pub importance: f32,
    /// Density with which a path of that pixel starts there, in the measure of the state.
    pub density: f32,
}

/// Where paths start, over any transport: one state per (pixel, sample), or nothing where radiance is zero.
pub trait Sensor<T: Transport>: Sync {
    /// Width and height; pixels are numbered row by row.
    fn size(&self) -> [u32; 2];
    /// The start of one path.
    fn start(&self, t: &T, pixel: u32, rng: &mut Rng) -> Option<T::State>;
    /// The pixel that sees a state, were nothing between; nothing for a sensor that light cannot be led to.
    fn project(&self, _t: &T, _at: &T::State) -> Option<Seen<T::State>> {
        None
    }
    /// Density with which a path of the pixel that sees it starts at a state, in the measure of the state.
    fn density(&self, t: &T, at: &T::State) -> f32 {
        self.project(t, at).map_or(0.0, |seen| seen.density)
    }
    /// Whether nothing stands between the sensor and a state that it projects to a pixel.
    fn sees(&self, _t: &T, _at: &T::State) -> bool {
        true
    }
    /// The starts of a wave; indices of those that exist are pushed to `alive`, ascending.
    fn start_wave(&self, t: &T, wave: &mut T::Wave, streams: Streams, alive: &mut Vec<u32>) {
        start_one_by_one(self, t, wave, streams, alive);
    }
}

/// The default of [`Sensor::start_wave`].
pub(crate) fn start_one_by_one<T: Transport, W: Sensor<T> + ?Sized>(
    sensor: &W,
    t: &T,
    wave: &mut T::Wave,
    streams: Streams,
    alive: &mut Vec<u32>,
) {
    for i in 0..streams.len() {
        if let Some(state) = sensor.start(t, streams.pixel[i], &mut streams.rng(i)) {
            wave.set(i, state);
            alive.push(i as u32);
        }
    }
}
