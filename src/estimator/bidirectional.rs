//! Bidirectional path tracing: every strategy that finds a path from both ends, weighted so that each path counts once.
//!
//! A path z_0 … z_k of term k can be found with s = 0, 1, …, k + 1 of its vertices walked from the light. The other
//! t = k + 1 − s vertices are walked from the eye:
//!
//! | s | strategy | |
//! |---|---|---|
//! | 0 | the eye's walk hits the light | `scatter` |
//! | 1 | the eye's walk connects to the light | `connect` |
//! | 2 … k | a ray links the ends of the two walks | |
//! | k + 1 | the light's walk connects to the eye | it may add to any pixel (a splat): [`light_tracer`](super::light_tracer) |
//!
//! ```text
//! X_k = Σ_s w_s · α_{t−1} S(x_{t−1}) V S(y_{s−1}) β_{s−1}        w_s = p_s / Σ_r p_r,  the balance heuristic over all k + 2 ways
//! ```
//!
//! Here α_{t−1} and β_{s−1} are the throughputs at the last vertices x_{t−1} and y_{s−1} of the eye's and the light's walk.
//! S is the scattering at a vertex towards the other one, and V is the geometry factor with visibility. The densities p_r
//! come from [`densities`](super::densities). Terms beyond K have their own paths, walked from the eye. [`Pyramid`] records
//! each strategy separately. Reference: Lafortune and Willems, *Bi-directional Path Tracing* (1993); Veach and Guibas,
//! *Bidirectional Estimators for Light Transport* (1994); Veach (1997), ch. 10.

use super::densities::{Node, PathDensities};
use super::light_tracer::LIGHT_STREAM;
use super::{Batch, Job, Paths, Plan, SingleTerm, Technique, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{Adjoint, Role, Sensor};

/// The bidirectional estimator. It always uses hits, connections and links. Of the plan's technique only `Power` matters: it
/// weights by squared densities.
#[derive(Clone, Debug, PartialEq)]
pub struct Bidirectional(pub Plan);

/// The contribution of one strategy that found one path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrategyValue {
    /// Vertices walked from the light.
    pub s: usize,
    /// The term k of the path.
    pub k: usize,
    /// The pixel that receives the contribution.
    pub pixel: u32,
    /// The contribution without its weight: as if this strategy were the only one.
    pub value: Rgb,
    /// The weight of this strategy in multiple importance sampling.
    pub weight: f32,
}

impl Bidirectional {
    /// Calls `found` for everything that one pair of walks finds, and `rays` with the slot of each ray.
    // long, because all strategies share the vertices and densities of the two walks
    pub fn find<T: Adjoint>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        (key, pixel, sample): (Key, u32, u32),
        mut found: impl FnMut(StrategyValue),
        mut rays: impl FnMut(usize),
    ) {
        let last = self.0.max_bounces;
        let squared = self.0.technique == Technique::Power;
        let [w, h] = sensor.size();
        let share = 1.0 / (w * h) as f32;
        let eye_numbers = |v: usize, purpose: Purpose| Rng::at(key, pixel, sample, v, purpose);
        let light_key = key.branch(LIGHT_STREAM);
        let light_numbers = |v: usize, purpose: Purpose| Rng::at(light_key, pixel, sample, v, purpose);

        // the two walks
        let mut eye = vec![];
        rays(0);
        if let Some(start) = sensor.start(t, pixel, &mut eye_numbers(0, Purpose::Start)) {
            let density = sensor.density(t, &start) * share;
            eye.push(Node::new(start, Rgb::ONE, density));
            super::densities::walk(t, &mut eye, last, Role::Radiance, |v| eye_numbers(v, Purpose::Scatter), &mut rays);
        }
        let mut light = vec![];
        if let Some((start, density)) = t.emit(&mut light_numbers(0, Purpose::Start)) {
            light.push(Node::new(start, Rgb::splat(1.0 / density), density));
            super::densities::walk(
                t,
                &mut light,
                last,
                Role::Emission,
                |v| light_numbers(v, Purpose::Scatter),
                &mut rays,
            );
        }

        // s = 0: the eye's walk hits a light
        for (k, x) in eye.iter().enumerate() {
            let e = t.emission(&x.state);
            if e != Rgb::ZERO {
                let weight = PathDensities::new(t, &eye[..=k], &[], None).weight(squared);
                found(StrategyValue { s: 0, k, pixel, value: x.throughput * e, weight });
            }
        }
        // s = 1: it connects to a newly chosen point on a light
        for (v, x) in eye.iter().take(last).enumerate() {
            rays(v + 1);
            if let Some(c) = t.connect(&x.state, &mut eye_numbers(v, Purpose::Connect)) {
                let y = Node::new(c.state, Rgb::ONE, t.emit_density(&c.state));
                let weight = PathDensities::new(t, &eye[..=v], std::slice::from_ref(&y), None).weight(squared);
                found(StrategyValue {
                    s: 1,
                    k: v + 1,
                    pixel,
                    value: x.throughput * c.weight * t.emission(&c.state),
                    weight,
                });
            }
        }
        // s = 2 … k: the walks are linked
        for (i, x) in eye.iter().enumerate() {
            for (j, y) in light.iter().enumerate().skip(1).take(last.saturating_sub(i + 1)) {
                let k = i + j + 1;
                let here = t.toward(&x.state, &y.state, Role::Radiance).value;
                let there = t.toward(&y.state, &x.state, Role::Flux).value;
                let value = x.throughput * here * there * y.throughput;
                if value != Rgb::ZERO {
                    rays(k);
                    let link = t.link(&x.state, &y.state);
                    if link > 0.0 {
                        let weight = PathDensities::new(t, &eye[..=i], &light[..=j], None).weight(squared);
                        found(StrategyValue { s: j + 1, k, pixel, value: value * link, weight });
                    }
                }
            }
        }
        // s = k + 1: the light's walk connects to the eye
        for (k, y) in light.iter().enumerate() {
            let Some(seen) = sensor.project(t, &y.state) else { continue };
            let role = if k == 0 { Role::Emission } else { Role::Flux };
            let value = y.throughput * t.toward(&y.state, &seen.eye, role).value * seen.importance;
            if value != Rgb::ZERO {
                rays(k);
                if sensor.sees(t, &y.state) {
                    let first = (seen.eye, seen.density * share);
                    let weight = PathDensities::new(t, &[], &light[..=k], Some(first)).weight(squared);
                    found(StrategyValue { s: k + 1, k, pixel: seen.pixel, value: value * share, weight });
                }
            }
        }
    }

    /// Calls `found` for everything that a batch finds, with the sample number. Returns the number of rays of each term.
    fn batch<T: Adjoint>(
        &self,
        t: &T,
        sensor: &impl Sensor<T>,
        batch: &Batch,
        mut found: impl FnMut(StrategyValue, u32),
    ) -> Vec<usize> {
        let mut rays = vec![0; self.0.max_bounces + 1];
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                self.find(t, sensor, (batch.key, pixel, sample), |f| found(f, sample), |k| rays[k] += 1);
            }
        }
        rays
    }
}

impl<T: Adjoint> TermEstimator<T> for Bidirectional {
    fn slots(&self) -> usize {
        self.0.max_bounces + 2
    }

    fn splats(&self) -> bool {
        true
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, paths: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let mut value = Columns::new(1);
        let rays = self.batch(t, sensor, batch, |f, sample| {
            value.set(0, f.value * f.weight);
            sink.add(f.k, &[f.pixel], &[sample], &value);
        });
        rays.iter().enumerate().for_each(|(k, &n)| sink.rays(k, n));
        // beyond K only walks from the eye go on, and they must also find lights without area
        let technique = if self.0.technique == Technique::Power { Technique::Power } else { Technique::Mis };
        SingleTerm(Plan { technique, ..self.0.clone() }).tail(job, paths, sink);
    }
}

/// The bidirectional estimator with a separate slot for each strategy, along the same walks. Slot (k, s) holds w_s times
/// what strategy s found of term k, so the slots of a term add up to it. The same number of slots follows without weights:
/// what each strategy would give as the only one.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid(pub Plan);

impl Pyramid {
    /// The weighted slot of strategy s of term k.
    pub fn slot(k: usize, s: usize) -> usize {
        // terms before k have 2 + 3 + … + (k + 1) strategies
        k * (k + 3) / 2 + s
    }

    /// Number of strategies of all terms k ≤ K. Slot i is weighted, slot `len + i` is the same without the weight.
    pub fn len(max_bounces: usize) -> usize {
        Self::slot(max_bounces + 1, 0)
    }

    /// All pairs (k, s), in the order of the slots.
    pub fn strategies(max_bounces: usize) -> impl Iterator<Item = (usize, usize)> {
        (0..=max_bounces).flat_map(|k| (0..=k + 1).map(move |s| (k, s)))
    }
}

impl<T: Adjoint> TermEstimator<T> for Pyramid {
    fn slots(&self) -> usize {
        2 * Self::len(self.0.max_bounces)
    }

    fn splats(&self) -> bool {
        true
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let &Job { t, sensor, batch } = job;
        let behind = Self::len(self.0.max_bounces);
        let mut column = Columns::new(1);
        Bidirectional(self.0.clone()).batch(t, sensor, batch, |f, sample| {
            let slot = Self::slot(f.k, f.s);
            for (slot, value) in [(slot, f.value * f.weight), (slot + behind, f.value)] {
                column.set(0, value);
                sink.add(slot, &[f.pixel], &[sample], &column);
            }
        });
    }
}
