//! A wave of paths: what each carries besides its state.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x_v | state at vertex v | `state` |
//! | α | throughput: the product of the weights so far | `throughput` |
//! | (pixel, sample) | the path's name, and its address for random numbers | `pixel`, `sample` |
//!
//! Paths that end are compacted away; the order of those that stay never changes, so sums do not depend on the wave size.

use super::roulette::Roulette;
use super::technique::Technique;
use super::{Job, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Streams, columns};
use crate::operator::{Samples, Sensor, Transport, Wave};
use std::ops::Range;

/// The block of paths that a wave starts as: every sample of every pixel.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The run's stream.
    pub key: Key,
    /// Pixels, by number.
    pub pixels: Range<u32>,
    /// Samples of each.
    pub samples: Range<u32>,
}

impl Batch {
    /// Number of paths.
    pub fn len(&self) -> usize {
        self.pixels.len() * self.samples.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A wave of paths.
#[derive(Clone, Debug, Default)]
pub struct Paths<W> {
    /// Paths alive.
    pub n: usize,
    /// Their states.
    pub state: W,
    /// Their throughputs α.
    pub throughput: Columns,
    /// Their pixels.
    pub pixel: Vec<u32>,
    /// Their sample numbers.
    pub sample: Vec<u32>,
    /// What the last batched call gave back.
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
            // whole packets, so that batched methods may run past the end
            let n = n.next_multiple_of(64);
            self.state.resize(n);
            (self.throughput, self.samples) = (Columns::new(n), Samples::new(n));
            (self.pixel, self.sample) = (vec![0; n], vec![0; n]);
        }
    }

    /// Starts the paths of a batch at the sensor, with throughput 1. Paths that see nothing are dropped: all their terms are 0.
    pub fn start<T: Transport<Wave = W>, S: Sensor<T>>(&mut self, job: &Job<'_, T, S>)
    where
        W: Wave<T::State>,
    {
        let &Job { t, sensor, batch } = job;
        self.reserve(batch.len());
        (self.n, self.key) = (batch.len(), Some(batch.key));
        let names = batch.samples.clone().flat_map(|s| batch.pixels.clone().map(move |p| (p, s)));
        for (i, (p, s)) in names.enumerate() {
            (self.pixel[i], self.sample[i]) = (p, s);
        }
        let streams = streams(batch.key, &self.pixel[..self.n], &self.sample[..self.n], 0, Purpose::Start);
        sensor.start_wave(t, &mut self.state, streams, &mut self.alive);
        self.throughput.fill(self.n, t.lit());
        self.compact();
    }

    /// Copies of some paths of a wave, which go on with the numbers of another stream and throughput α · `share`.
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

    /// `samples.value[i] = E(x_v)`, emission where the paths are.
    pub fn emission<T: Transport<Wave = W>>(&mut self, t: &T) {
        t.emission_wave(&mut self.state, self.n, &mut self.samples.value);
    }

    /// `samples[i]` = one sample of (T E)(x_v) from every path, which stays where it is.
    pub fn connect<T: Transport<Wave = W>>(&mut self, t: &T, v: usize) {
        if let Some(key) = self.key {
            let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Connect);
            t.connect_wave(&mut self.state, streams, &mut self.samples);
        }
    }

    /// x_v → x_{v+1}; the throughputs take up the weights, and paths that are absorbed or gone end.
    pub fn scatter<T: Transport<Wave = W>>(&mut self, t: &T, v: usize)
    where
        W: Wave<T::State>,
    {
        if let Some(key) = self.key {
            let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Scatter);
            t.scatter_wave(&mut self.state, streams, &mut self.samples, &mut self.alive);
            self.throughput.multiply(&self.samples.value, self.n);
            self.compact();
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

    /// The throughput with which each path goes on, given its state and a uniform number; nothing: it ends.
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

    /// The stream that the paths go on with.
    pub(crate) fn key(&self) -> Option<Key> {
        self.key
    }

    /// Scores emission on arrival: weighted by the technique and by the throughput, into a slot.
    pub fn score_hits(&mut self, technique: Technique, slot: usize, sink: &mut impl TermSink) {
        technique.weigh_hits(&mut self.samples, self.n);
        self.samples.value.multiply(&self.throughput, self.n);
        self.add(slot, sink);
    }

    /// Scores connections: weighted by the technique and by the throughput, into a slot.
    pub fn score_connections(&mut self, technique: Technique, slot: usize, sink: &mut impl TermSink) {
        technique.weigh_connections(&mut self.samples, self.n);
        self.samples.value.multiply(&self.throughput, self.n);
        self.add(slot, sink);
    }

    /// Adds the samples as they are to a slot.
    pub fn add(&self, slot: usize, sink: &mut impl TermSink) {
        sink.add(slot, &self.pixel[..self.n], &self.sample[..self.n], &self.samples.value);
    }

    fn compact<S>(&mut self)
    where
        W: Wave<S>,
    {
        if self.alive.len() < self.n {
            let alive = &self.alive;
            self.state.keep(alive);
            self.throughput.keep(alive);
            columns::keep(&mut self.pixel, alive);
            columns::keep(&mut self.sample, alive);
            columns::keep(&mut self.samples.pdf, alive);
            columns::keep(&mut self.samples.other_pdf, alive);
            self.n = alive.len();
        }
        self.alive.clear();
    }
}

fn streams<'a>(key: Key, pixel: &'a [u32], sample: &'a [u32], bounce: usize, purpose: Purpose) -> Streams<'a> {
    Streams { key, pixel, sample, bounce, purpose }
}
