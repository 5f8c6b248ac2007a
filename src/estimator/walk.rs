//! A wave of walks from either end: many walks that advance together, one vertex at a time.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x_v or y_v | state at vertex v of a walk from the eye or from the light | `state` |
//! | α or β | throughput: the product of the weights so far; a walk from the light starts with 1/p(y_0) | `throughput` |
//! | (pixel, sample) | name of the walk, and address of its random numbers | `pixel`, `sample` |
//!
//! Walks that end are removed, and the others move up without changing their order. `place` says where a walk was at the
//! start, so that data about all walks of the wave can stay where they are. [`Paths`](super::Paths) is the same for paths
//! that find light by [`Transport`](crate::operator::Transport) alone, and needs no densities.

use super::Batch;
use crate::math::{Columns, Key, Purpose, Rgb, Streams, pick};
use crate::operator::{Adjoint, Role, Sensor, Steps, Wave};

/// Index of the random stream for walks from the light.
pub(super) const LIGHT_STREAM: u32 = 0x4c49_4748;

/// The (pixel, sample) of all paths of a batch, in columns.
pub(super) fn names(batch: &Batch) -> (Vec<u32>, Vec<u32>) {
    batch.samples.clone().flat_map(|s| batch.pixels.clone().map(move |p| (p, s))).unzip()
}

/// A wave of walks.
pub(super) struct Walk<W> {
    /// Number of walks that have not ended.
    pub(super) n: usize,
    pub(super) state: W,
    pub(super) throughput: Columns,
    pub(super) pixel: Vec<u32>,
    pub(super) sample: Vec<u32>,
    /// Number of each walk in the wave as it started.
    pub(super) place: Vec<u32>,
    /// The last step of each walk.
    pub(super) steps: Steps,
    alive: Vec<u32>,
}

impl<W> Walk<W> {
    /// Room for `n` walks.
    pub(super) fn new<S>(n: usize) -> Self
    where
        W: Wave<S>,
    {
        // whole packets, so that batched methods may write past the end
        let n = n.next_multiple_of(64);
        let mut state = W::default();
        state.resize(n);
        let [pixel, sample, place] = [(); 3].map(|()| vec![0; n]);
        Self { n: 0, state, throughput: Columns::new(n), pixel, sample, place, steps: Steps::new(n), alive: vec![] }
    }

    fn name(&mut self, pixel: &[u32], sample: &[u32]) {
        self.n = pixel.len();
        self.pixel[..self.n].copy_from_slice(pixel);
        self.sample[..self.n].copy_from_slice(sample);
        self.place[..self.n].iter_mut().zip(0..).for_each(|(place, i)| *place = i);
    }

    /// The random streams of the walks at vertex `vertex`.
    pub(super) fn streams(&self, key: Key, vertex: usize, purpose: Purpose) -> Streams<'_> {
        streams(key, &self.pixel[..self.n], &self.sample[..self.n], vertex, purpose)
    }

    /// Starts walks with these names at the sensor, with throughput 1.
    pub(super) fn start_at_sensor<T: Adjoint<Wave = W>>(
        &mut self,
        t: &T,
        sensor: &impl Sensor<T>,
        key: Key,
        (pixel, sample): (&[u32], &[u32]),
    ) where
        W: Wave<T::State>,
    {
        self.name(pixel, sample);
        let streams = streams(key, pixel, sample, 0, Purpose::Start);
        sensor.start_wave(t, &mut self.state, streams, &mut self.alive);
        self.throughput.fill(self.n, Rgb::ONE);
        // the states are at the front already
        self.keep_names();
    }

    /// Starts walks with these names at the lights, with throughput 1/p(y_0).
    pub(super) fn start_at_lights<T: Adjoint<Wave = W>>(&mut self, t: &T, key: Key, (pixel, sample): (&[u32], &[u32]))
    where
        W: Wave<T::State>,
    {
        self.name(pixel, sample);
        let streams = streams(key, pixel, sample, 0, Purpose::Start);
        t.emit_wave(&mut self.state, streams, &mut self.steps, &mut self.alive);
        self.compact();
        for i in 0..self.n {
            self.throughput.set(i, Rgb::splat(1.0 / self.steps.density[i]));
        }
    }

    /// Moves the walks from vertex v to vertex v + 1.
    pub(super) fn step<T: Adjoint<Wave = W>>(&mut self, t: &T, key: Key, role: Role, v: usize)
    where
        W: Wave<T::State>,
    {
        let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Scatter);
        t.walk_wave(&mut self.state, role, streams, &mut self.steps, &mut self.alive);
        self.throughput.multiply(&self.steps.weight, self.n);
        self.compact();
    }

    /// Russian roulette at vertex v. `q` gets a walk and its place, and returns the probability of termination.
    pub(super) fn roulette<S>(&mut self, key: Key, v: usize, mut q: impl FnMut(&W, usize, usize) -> f32)
    where
        W: Wave<S>,
    {
        for i in 0..self.n {
            let q = q(&self.state, i, self.place[i] as usize);
            if q > 0.0 {
                if self.streams(key, v, Purpose::Roulette).rng(i).one() < q {
                    continue;
                }
                self.throughput.set(i, self.throughput.get(i) / (1.0 - q));
            }
            self.alive.push(i as u32);
        }
        self.compact();
    }

    fn compact<S>(&mut self)
    where
        W: Wave<S>,
    {
        if self.alive.len() < self.n {
            self.state.keep(&self.alive);
        }
        self.keep_names();
    }

    /// Keeps everything but the states of the walks that are alive.
    fn keep_names(&mut self) {
        if self.alive.len() < self.n {
            let alive = &self.alive;
            self.throughput.keep(alive);
            self.steps.keep(alive);
            for names in [&mut self.pixel, &mut self.sample, &mut self.place] {
                pick::keep(names, alive);
            }
            self.n = alive.len();
        }
        self.alive.clear();
    }
}

fn streams<'a>(key: Key, pixel: &'a [u32], sample: &'a [u32], bounce: usize, purpose: Purpose) -> Streams<'a> {
    Streams { key, pixel, sample, bounce, purpose }
}
