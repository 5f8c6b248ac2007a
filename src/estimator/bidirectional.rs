//! Bidirectional path tracing: every strategy that finds a path from both ends, weighted so that each path counts once.
//!
//! A path z_0 … z_k of term k can be found with s = 0, 1, …, k + 1 of its vertices walked from the light. The other
//! t = k + 1 − s vertices are walked from the eye:
//!
//! | s | strategy | place |
//! |---|---|---|
//! | 0 | the eye's walk hits the light | `Pairs::hit` |
//! | 1 | the eye's walk connects to the light | `Pairs::connect` |
//! | 2 … k | a ray links the ends of the two walks | `Pairs::link` |
//! | k + 1 | the light's walk connects to the eye; it may add to any pixel (a splat) | `Pairs::splat` |
//!
//! ```text
//! X_k = Σ_s w_s · α_{t−1} S(x_{t−1}) V S(y_{s−1}) β_{s−1}        w_s = p_s / Σ_r p_r,  the balance heuristic over all k + 2 ways
//! ```
//!
//! Here α_{t−1} and β_{s−1} are the throughputs at the last vertices x_{t−1} and y_{s−1} of the eye's and the light's walk.
//! S is the scattering at a vertex towards the other one, and V is the geometry factor with visibility. The weights come
//! from `densities.rs`: `1/(1 + A + B)` with A for the ways that walk fewer vertices from the eye, B for
//! those that walk fewer from the light. Terms beyond K have their own paths, walked from the eye.
//! [`Pyramid`](super::Pyramid) records each strategy separately.
//!
//! The pairs of walks of a wave advance together. All vertices are stored, and each strategy is computed for the whole wave.
//! Reference: Lafortune and Willems, *Bi-directional Path Tracing* (1993); Veach and Guibas, *Bidirectional Estimators for
//! Light Transport* (1994); Veach (1997), ch. 10.

use super::densities::Walked;
use super::view::Views;
use super::walk::{LIGHT_STREAM, Walk, names};
use super::{Job, Paths, Plan, SingleTerm, Technique, TermEstimator, TermSink};
use crate::math::{Columns, Key, Purpose, Rgb};
use crate::operator::{Adjoint, Role, Sensor, Wave};

/// The bidirectional estimator. It always uses hits, connections and links. Of the plan's technique only `Power` matters: it
/// weights by squared densities.
#[derive(Clone, Debug, PartialEq)]
pub struct Bidirectional(pub Plan);

/// What one strategy found of one term, in columns: one entry for each path.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Vertices walked from the light.
    pub s: usize,
    /// The term k of the paths.
    pub k: usize,
    /// The pixels that receive the contributions.
    pub pixel: Vec<u32>,
    /// Sample numbers of the pairs of walks.
    pub sample: Vec<u32>,
    /// The contributions without their weights: as if this strategy were the only one.
    pub value: Columns,
    /// The weights of this strategy in multiple importance sampling.
    pub weight: Vec<f32>,
}

impl Found {
    fn clear(&mut self, s: usize, k: usize) {
        (self.s, self.k) = (s, k);
        self.pixel.clear();
        self.sample.clear();
        self.weight.clear();
    }

    fn push(&mut self, (pixel, sample): (u32, u32), value: Rgb, weight: f64) {
        self.value.set(self.pixel.len(), value);
        self.pixel.push(pixel);
        self.sample.push(sample);
        self.weight.push(weight as f32);
    }
}

/// Pairs of walks that are followed together. All of their vertices should fit into the second-level cache.
const WAVE: usize = 256;

/// A wave of pairs of walks.
struct Pairs<'a, T: Adjoint, S> {
    t: &'a T,
    sensor: &'a S,
    /// Key of the eye's walks and of the light's walks.
    keys: [Key; 2],
    /// K, the last term.
    last: usize,
    walk: Walk<T::Wave>,
    eye: Walked<T::Wave>,
    light: Walked<T::Wave>,
    /// States on lights that connections have chosen, and the weights of these steps.
    chosen: T::Wave,
    weight: Columns,
    views: Views<T::Wave>,
    /// The walks that a strategy is about.
    list: Vec<u32>,
    /// For each pair of ends: S S, the densities with which they step to each other, and V.
    scattering: Columns,
    toward_light: Vec<f32>,
    toward_eye: Vec<f32>,
    geometry: Vec<f32>,
    found: Found,
}

impl<'a, T: Adjoint, S: Sensor<T>> Pairs<'a, T, S> {
    fn new(job: &Job<'a, T, S>, plan: &Plan) -> Self {
        let n = WAVE.min(job.batch.len()).next_multiple_of(64);
        let (last, squared) = (plan.max_bounces, plan.technique == Technique::Power);
        let mut chosen = T::Wave::default();
        chosen.resize(n);
        let [toward_light, toward_eye, geometry] = [(); 3].map(|()| vec![0.0; n]);
        Self {
            t: job.t,
            sensor: job.sensor,
            keys: [job.batch.key, job.batch.key.branch(LIGHT_STREAM)],
            last,
            walk: Walk::new(n),
            eye: Walked::new(n, last, Role::Radiance, squared),
            light: Walked::new(n, last, Role::Flux, squared),
            chosen,
            weight: Columns::new(n),
            views: Views::new(n),
            list: vec![],
            scattering: Columns::new(n),
            toward_light,
            toward_eye,
            geometry,
            found: Found { value: Columns::new(n), ..Found::default() },
        }
    }

    /// Walks the pairs with these names, and calls `found` for each strategy of each term, and `rays` with a term and the
    /// number of rays traced for it.
    fn follow(
        &mut self,
        names: (&[u32], &[u32]),
        found: &mut impl FnMut(&mut Found),
        rays: &mut impl FnMut(usize, usize),
    ) {
        let (t, [eye_key, light_key]) = (self.t, self.keys);
        // the eye's walks
        self.eye.clear();
        rays(0, names.0.len());
        self.walk.start_at_sensor(t, self.sensor, eye_key, names);
        let share = self.share();
        self.eye.store(t, &self.walk, 0, |i| self.sensor.density(t, &self.walk.state.get(i)) * share);
        for v in 0..=self.last {
            self.hit(v);
            found(&mut self.found);
            if v < self.last {
                rays(v + 1, self.walk.n);
                self.connect(v);
                found(&mut self.found);
                rays(v + 1, self.walk.n);
                self.eye.step(t, &mut self.walk, eye_key, Role::Radiance, v);
            }
        }
        // the light's walks
        self.light.clear();
        self.walk.start_at_lights(t, light_key, names);
        self.light.store(t, &self.walk, 0, |i| self.walk.steps.density[i]);
        for v in 0..=self.last {
            rays(v, self.splat(v));
            found(&mut self.found);
            if v < self.last {
                rays(v + 1, self.walk.n);
                let role = if v == 0 { Role::Emission } else { Role::Flux };
                self.light.step(t, &mut self.walk, light_key, role, v);
            }
        }
        // links between them
        for i in 0..self.last {
            for j in 1..self.last - i {
                rays(i + j + 1, self.link(i, j, names));
                found(&mut self.found);
            }
        }
    }

    /// A path starts at a given pixel; the densities are those of a path that may start at any pixel.
    fn share(&self) -> f32 {
        let [w, h] = self.sensor.size();
        1.0 / (w * h) as f32
    }

    /// s = 0: vertex x_k lies on a light.
    fn hit(&mut self, k: usize) {
        let Self { t, walk, eye, found, .. } = self;
        found.clear(0, k);
        for i in 0..walk.n {
            let (x, w) = (walk.state.get(i), walk.place[i] as usize);
            let e = t.emission(&x);
            if e != Rgb::ZERO {
                let behind = k.checked_sub(1).map(|v| eye.vertices[v].state.get(w));
                let connect = behind.map_or(0.0, |behind| t.connect_density(&behind, &x));
                let before = behind.map_or(0.0, |behind| t.toward(&x, &behind, Role::Emission).density);
                let a = eye.fewer_than_all(w, k + 1, connect, t.emit_density(&x), before);
                found.push((walk.pixel[i], walk.sample[i]), walk.throughput.get(i) * e, 1.0 / (1.0 + a));
            }
        }
    }

    /// s = 1: vertex x_v is connected to a newly chosen state on a light.
    fn connect(&mut self, v: usize) {
        let Self { t, walk, eye, light, found, .. } = self;
        found.clear(1, v + 1);
        self.list.clear();
        let mut state = std::mem::take(&mut walk.state);
        let streams = walk.streams(self.keys[0], v, Purpose::Connect);
        t.choose_wave(&mut state, streams, &mut self.chosen, &mut self.weight, &mut self.list);
        walk.state = state;
        for &i in &self.list {
            let i = i as usize;
            let (x, y, w) = (walk.state.get(i), self.chosen.get(i), walk.place[i] as usize);
            let back = eye.back(*t, w, v, &x, &y);
            let a = eye.fewer(w, v + 1, t.toward(&y, &x, Role::Emission).density, back);
            // relative to a walk that starts at y: its way is 1, this way is κ
            let emit = t.emit_density(&y);
            let kappa = light.ratio(t.connect_density(&x, &y), emit);
            let b = light.ratio(t.toward(&x, &y, Role::Radiance).density, emit);
            let value = walk.throughput.get(i) * self.weight.get(i) * t.emission(&y);
            found.push((walk.pixel[i], walk.sample[i]), value, kappa / (kappa + a + b));
        }
    }

    /// s = k + 1: vertex y_k is connected to the eye. Returns the number of rays.
    fn splat(&mut self, k: usize) -> usize {
        let Self { t, walk, light, views, found, .. } = self;
        found.clear(k + 1, k);
        let rays = views.connect(*t, self.sensor, walk, if k == 0 { Role::Emission } else { Role::Flux });
        for &i in &views.list {
            let i = i as usize;
            let w = walk.place[i] as usize;
            let back = light.back(*t, w, k, &walk.state.get(i), &views.eye.get(i));
            let b = light.fewer(w, k + 1, views.density[i], back);
            found.push((views.pixel[i], walk.sample[i]), views.value.get(i), 1.0 / (1.0 + b));
        }
        rays
    }

    /// s = j + 1: vertices x_i and y_j are linked. Returns the number of rays.
    fn link(&mut self, i: usize, j: usize, names: (&[u32], &[u32])) -> usize {
        let Self { t, eye, light, found, scattering, toward_light, toward_eye, .. } = self;
        found.clear(j + 1, i + j + 1);
        let (from, to) = (&eye.vertices[i], &light.vertices[j]);
        self.list.clear();
        for w in 0..names.0.len() {
            if eye.length[w] as usize > i && light.length[w] as usize > j {
                let (x, y) = (from.state.get(w), to.state.get(w));
                let (here, there) = t.both_ways(&x, &y);
                let value = from.throughput.get(w) * here.value * there.value * to.throughput.get(w);
                if value != Rgb::ZERO {
                    scattering.set(w, value);
                    (toward_light[w], toward_eye[w]) = (here.density, there.density);
                    self.list.push(w as u32);
                }
            }
        }
        let rays = self.list.len();
        t.link_wave(&from.state, &to.state, &mut self.chosen, &mut self.list, &mut self.geometry);
        for &w in &self.list {
            let w = w as usize;
            let (x, y) = (from.state.get(w), to.state.get(w));
            let a = eye.fewer(w, i + 1, toward_eye[w], eye.back(*t, w, i, &x, &y));
            let b = light.fewer(w, j + 1, toward_light[w], light.back(*t, w, j, &y, &x));
            let value = scattering.get(w) * self.geometry[w];
            found.push((names.0[w], names.1[w]), value, 1.0 / (1.0 + a + b));
        }
        rays
    }
}

impl Bidirectional {
    /// Calls `found` for everything that a batch of pairs of walks finds: once for each wave, strategy and term. Calls `rays`
    /// with a term and the number of rays traced for it.
    pub fn find<T: Adjoint, S: Sensor<T>>(
        &self,
        job: &Job<'_, T, S>,
        mut found: impl FnMut(&mut Found),
        mut rays: impl FnMut(usize, usize),
    ) {
        let (pixel, sample) = names(job.batch);
        let mut pairs = Pairs::new(job, &self.0);
        for names in pixel.chunks(WAVE).zip(sample.chunks(WAVE)) {
            pairs.follow(names, &mut found, &mut rays);
        }
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
        let mut rays = vec![0; self.0.max_bounces + 1];
        let add = |f: &mut Found| {
            f.value.scale(&f.weight, f.weight.len());
            sink.add(f.k, &f.pixel, &f.sample, &f.value);
        };
        self.find(job, add, |k, n| rays[k] += n);
        rays.iter().enumerate().for_each(|(k, &n)| sink.rays(k, n));
        // beyond K only walks from the eye go on, and they must also find lights without area
        let technique = if self.0.technique == Technique::Power { Technique::Power } else { Technique::Mis };
        SingleTerm(Plan { technique, ..self.0.clone() }).tail(job, paths, sink);
    }
}
