//! A wave of paths: many paths that advance together, one vertex at a time, each with its throughput and its name.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x_v | state at vertex v | `state` |
//! | α | throughput: the product of the weights so far | `throughput` |
//! | (pixel, sample) | name of the path, and address of its random numbers | `pixel`, `sample` |
//!
//! Paths that end are removed, and the others move up without changing their order. So sums do not depend on the wave size.

use super::roulette::Roulette;
use super::technique::Technique;
use super::{Job, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Streams, pick};
use crate::operator::{Samples, Sensor, Transport, Wave};
use crate::terms::film::BLOCK;
use std::ops::Range;

/// The paths with which a wave starts: every sample of every pixel of a block.
#[derive(Clone, Debug)]
pub struct Batch {
    /// Key of the run's random stream.
    pub key: Key,
    /// Range of pixel numbers.
    pub pixels: Range<u32>,
    /// Range of sample numbers of each pixel.
    pub samples: Range<u32>,
}

impl Batch {
    /// Number of paths.
    pub fn len(&self) -> usize {
        self.pixels.len() * self.samples.len()
    }

    /// Returns true if the batch has no paths.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A wave of paths.
#[derive(Clone, Debug, Default)]
pub struct Paths<W> {
    /// Number of paths that have not ended.
    pub n: usize,
    /// States of the paths.
    pub state: W,
    /// Throughputs α of the paths.
    pub throughput: Columns,
    /// Pixels of the paths.
    pub pixel: Vec<u32>,
    /// Sample numbers of the paths.
    pub sample: Vec<u32>,
    /// Results of the last batched call.
    pub samples: Samples,
    key: Option<Key>,
    alive: Vec<u32>,
}

impl<W> Paths<W> {
    fn reserve<S>(&mut self, n: usize)
    where
        W: Wave<S>,
    {
        if self.pixel.len() < n {
            // whole packets, so that batched methods may write past the end
            let n = n.next_multiple_of(64);
            self.state.resize(n);
            (self.throughput, self.samples) = (Columns::new(n), Samples::new(n));
            (self.pixel, self.sample) = (vec![0; n], vec![0; n]);
        }
    }

    /// Starts the paths of a batch at the sensor, with throughput 1. Paths that see nothing are dropped, because all their
    /// terms are 0.
    pub fn start<T: Transport<Wave = W>, S: Sensor<T>>(&mut self, job: &Job<'_, T, S>)
    where
        W: Wave<T::State>,
    {
        let &Job { t, sensor, batch } = job;
        self.reserve(batch.len());
        (self.n, self.key) = (batch.len(), Some(batch.key));
        let (pixels, mut n) = (batch.pixels.clone(), 0);
        // block by block, so that the part of the film that is added to stays in the fastest cache
        for first in pixels.clone().step_by(BLOCK) {
            let block = first..pixels.end.min(first + BLOCK as u32);
            for s in batch.samples.clone() {
                for p in block.clone() {
                    (self.pixel[n], self.sample[n]) = (p, s);
                    n += 1;
                }
            }
        }
        let streams = streams(batch.key, &self.pixel[..self.n], &self.sample[..self.n], 0, Purpose::Start);
        sensor.start_wave(t, &mut self.state, streams, &mut self.alive);
        self.throughput.fill(self.n, t.lit());
        self.keep_names();
    }

    /// Copies some paths of another wave. The copies go on with the random numbers of another stream and with throughput α ·
    /// `share`.
    pub(crate) fn descend_from<S: Copy>(
        &mut self,
        parents: &Self,
        some: impl ExactSizeIterator<Item = usize>,
        key: Key,
        share: f32,
    ) where
        W: Wave<S>,
    {
        self.reserve(some.len());
        (self.n, self.key) = (some.len(), Some(key));
        for (to, from) in some.enumerate() {
            (self.pixel[to], self.sample[to]) = (parents.pixel[from], parents.sample[from]);
            self.state.set(to, parents.state.get(from));
            self.throughput.set(to, parents.throughput.get(from) * share);
        }
    }

    /// `samples.value[i] = E(x_v)`: the emission at the current vertex of path i.
    pub fn emission<T: Transport<Wave = W>>(&mut self, t: &T) {
        t.emission_wave(&mut self.state, self.n, &mut self.samples.value);
    }

    /// `samples[i]` = one sample of (T E)(x_v) for path i. The paths do not move.
    pub fn connect<T: Transport<Wave = W>>(&mut self, t: &T, v: usize) {
        if let Some(key) = self.key {
            let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Connect);
            t.connect_wave(&mut self.state, streams, &mut self.samples);
        }
    }

    /// Moves the paths from x_v to x_{v+1} and multiplies their throughputs by the weights. Paths that are absorbed or leave
    /// the scene end.
    pub fn scatter<T: Transport<Wave = W>>(&mut self, t: &T, v: usize)
    where
        W: Wave<T::State>,
    {
        if let Some(key) = self.key {
            let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Scatter);
            t.scatter_wave(&mut self.state, streams, &mut self.samples, &mut self.alive);
            // states and samples are at the front already
            self.keep_names();
            self.throughput.multiply(&self.samples.value, self.n);
        }
    }

    /// Russian roulette at vertex v: the survivors' throughputs grow by 1/(1 − q).
    pub fn roulette<T: Transport<Wave = W>>(&mut self, t: &T, v: usize, schedule: &Roulette)
    where
        W: Wave<T::State>,
    {
        if !schedule.sleeps(v) {
            self.survive(v, |state, i, throughput, u| {
                let q = schedule.q(t, v, throughput, &state.get(i));
                if q > 0.0 { (u >= q).then(|| throughput * (1.0 / (1.0 - q))) } else { Some(throughput) }
            });
        }
    }

    /// Roulette with any rule. `throughput` gets the states, the index of a path, its throughput and a uniform number. It
    /// returns the throughput with which the path goes on, or nothing if the path ends.
    pub(crate) fn survive<S>(&mut self, v: usize, mut throughput: impl FnMut(&mut W, usize, Rgb, f32) -> Option<Rgb>)
    where
        W: Wave<S>,
    {
        let Some(key) = self.key else { return };
        let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Roulette);
        for i in 0..self.n {
            let u = streams.rng(i).one();
            if let Some(alpha) = throughput(&mut self.state, i, self.throughput.get(i), u) {
                self.throughput.set(i, alpha);
                self.alive.push(i as u32);
            }
        }
        self.compact();
    }

    /// The random stream with which the paths go on.
    pub(crate) fn key(&self) -> Option<Key> {
        self.key
    }

    /// Adds the emission at the vertices that the paths have hit to a slot, weighted by the technique and the throughput.
    pub fn score_hits(&mut self, technique: Technique, slot: usize, sink: &mut impl TermSink) {
        technique.score_hits(&mut self.samples, &self.throughput, self.n);
        self.add(slot, sink);
    }

    /// Adds the connections to a slot, weighted by the technique and the throughput.
    pub fn score_connections(&mut self, technique: Technique, slot: usize, sink: &mut impl TermSink) {
        technique.score_connections(&mut self.samples, &self.throughput, self.n);
        self.add(slot, sink);
    }

    /// Adds `samples` to a slot without any weight.
    pub fn add(&self, slot: usize, sink: &mut impl TermSink) {
        sink.add(slot, &self.pixel[..self.n], &self.sample[..self.n], &self.samples.value);
    }

    fn compact<S>(&mut self)
    where
        W: Wave<S>,
    {
        if self.alive.len() < self.n {
            self.state.keep(&self.alive);
            pick::keep(&mut self.samples.pdf, &self.alive);
            pick::keep(&mut self.samples.other_pdf, &self.alive);
        }
        self.keep_names();
    }

    /// Keeps the throughputs, pixels and samples of the paths that are alive.
    fn keep_names(&mut self) {
        if self.alive.len() < self.n {
            self.throughput.keep(&self.alive);
            pick::keep(&mut self.pixel, &self.alive);
            pick::keep(&mut self.sample, &self.alive);
            self.n = self.alive.len();
        }
        self.alive.clear();
    }
}

fn streams<'a>(key: Key, pixel: &'a [u32], sample: &'a [u32], bounce: usize, purpose: Purpose) -> Streams<'a> {
    Streams { key, pixel, sample, bounce, purpose }
}
