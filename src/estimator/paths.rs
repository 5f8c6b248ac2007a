//! A wave of paths: what each carries besides its state.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x_v | state at vertex v | `state` |
//! | α | throughput: the product of the weights so far | `throughput` |
//! | (pixel, sample) | the path's name, and its address for random numbers | `pixel`, `sample` |
//!
//! Paths that end are compacted away; the order of those that stay never changes, so sums do not depend on the wave size.

use super::branching::lineage;
use super::roulette::Roulette;
use super::technique::Technique;
use super::{Job, TermSink};
use crate::math::{Columns, Key, Purpose, Streams, columns};
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
    /// What was expected of each path at its start, 0 where nobody knows.
    expected: Vec<f32>,
    /// Into how many the path of each has split.
    siblings: Vec<u32>,
    /// Who has split at the last roulette, and into how many.
    splits: Vec<(u32, u32)>,
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
            (self.expected, self.siblings) = (vec![0.0; n], vec![1; n]);
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
        self.siblings.fill(1);
        self.compact();
        for i in 0..self.n {
            self.expected[i] = t.expected(&self.state.get(i)).unwrap_or_default().all;
        }
    }

    /// Copies of the paths of a wave, which go on with the numbers of another stream and throughput α · `share`.
    pub(super) fn descend_from<S: Copy>(&mut self, parents: &Self, key: Key, share: f32)
    where
        W: Wave<S>,
    {
        self.reserve(parents.n);
        (self.n, self.key) = (parents.n, Some(key));
        self.pixel[..self.n].copy_from_slice(&parents.pixel[..self.n]);
        self.sample[..self.n].copy_from_slice(&parents.sample[..self.n]);
        self.expected[..self.n].copy_from_slice(&parents.expected[..self.n]);
        self.siblings[..self.n].copy_from_slice(&parents.siblings[..self.n]);
        for i in 0..self.n {
            self.state.set(i, parents.state.get(i));
            self.throughput.set(i, parents.throughput.get(i) * share);
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

    /// Russian roulette at vertex v: the survivors' throughputs grow by 1/(1 − q); none splits.
    pub fn roulette<T: Transport<Wave = W>>(&mut self, t: &T, v: usize, schedule: &Roulette)
    where
        W: Wave<T::State>,
    {
        self.end_or_split(t, v, schedule, false);
    }

    /// The same, but where q < 0 a path goes on as several: the first of them here, the others by [`Self::copies`].
    pub(super) fn split<T: Transport<Wave = W>>(&mut self, t: &T, v: usize, schedule: &Roulette)
    where
        W: Wave<T::State>,
    {
        self.end_or_split(t, v, schedule, true);
    }

    fn end_or_split<T: Transport<Wave = W>>(&mut self, t: &T, v: usize, schedule: &Roulette, split: bool)
    where
        W: Wave<T::State>,
    {
        self.splits.clear();
        if schedule.sleeps(v) {
            return;
        }
        let Some(key) = self.key else { return };
        for i in 0..self.n {
            let streams = streams(key, &self.pixel[..self.n], &self.sample[..self.n], v, Purpose::Roulette);
            let throughput = self.throughput.get(i);
            let q = schedule.q(t, v, throughput, &self.state.get(i), self.expected[i]);
            let q = if split { q } else { q.max(0.0) };
            let (copies, weight) = Roulette::copies(q, streams.rng(i).one(), self.siblings[i]);
            if copies > 0 {
                self.throughput.set(i, throughput * weight);
                self.siblings[i] *= copies;
                if copies > 1 {
                    self.splits.push((self.alive.len() as u32, copies));
                }
                self.alive.push(i as u32);
            }
        }
        self.compact();
    }

    /// Copy `c` ≥ 1 of every path that has split into more than `c` at vertex v; nothing if there is none.
    pub(super) fn copies<S: Copy>(&self, v: usize, c: u32) -> Option<Self>
    where
        W: Wave<S>,
    {
        let of: Vec<usize> = self.splits.iter().filter(|(_, n)| *n > c).map(|(i, _)| *i as usize).collect();
        let mut copy = Self { key: Some(lineage(self.key?, v, c, Roulette::MOST)), ..Self::default() };
        copy.reserve(of.len());
        copy.n = of.len();
        for (to, &from) in of.iter().enumerate() {
            copy.state.set(to, self.state.get(from));
            copy.throughput.set(to, self.throughput.get(from));
            (copy.pixel[to], copy.sample[to]) = (self.pixel[from], self.sample[from]);
            (copy.expected[to], copy.siblings[to]) = (self.expected[from], self.siblings[from]);
        }
        (!of.is_empty()).then_some(copy)
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
            columns::keep(&mut self.expected, alive);
            columns::keep(&mut self.siblings, alive);
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
