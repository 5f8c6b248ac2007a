//! A path tracer that traces one path at a time, written as in the lecture. Every step that a [`Mistake`] can replace is a
//! method call.
//!
//! ```text
//! α ← 1, x ← the point seen through the pixel;         X_0 ← E(x)
//! for k = 1, 2, …
//!     y ← a light point, ω its direction:             X_k ← X_k + α w_c f(ω) cos θ_x E(y) V/p_ω
//!     a random number below q: stop;                  α ← α/(1 − q)
//!     ω ← a direction:                                α ← α f(ω) cos θ/p,    x ← ray(x, ω)
//!                                                     X_k ← X_k + α w_s E(x)
//! ```
//!
//! This code is deliberately independent of the other estimators, for surfaces and lights. It uses the same addresses of
//! random numbers as [`Prefix`](crate::estimator::Prefix). Without a mistake, both therefore give the same terms for every
//! path, up to rounding (`tests/zoo.rs`). Reference: Kajiya, *The Rendering Equation* (1986).

use super::mistake::{Connection, Mistake};
use crate::estimator::{Batch, Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::direction::Frame;
use crate::math::{Columns, Key, Purpose, Rgb, Rng};
use crate::operator::{SceneTransport, Sensor, Transport};
use crate::scene::bsdf::dielectric::Dielectric;
use crate::scene::bsdf::{Bsdf, TransportMode, diffuse::Diffuse};
use crate::scene::{LightSample, Vertex, VertexWave, connection, offset_origin};
use glam::Vec3;

/// The path tracer with a mistake.
pub struct Walk<'a> {
    /// Number of terms, technique to find light, and roulette.
    pub plan: Plan,
    /// The mistake.
    pub mistake: &'a dyn Mistake,
}

/// The same path tracer with one slot: only the sum of all terms is stored, after [`Mistake::finish`].
pub struct Whole<'a>(pub Walk<'a>);

/// A direction that was sampled or is evaluated. `value` is f cos θ/p for a sampled direction and f for an evaluated one;
/// `pdf` is its density, `normal` the normal on its side.
struct Scattered {
    to: Vec3,
    normal: Vec3,
    value: Rgb,
    pdf: f32,
    delta: bool,
}

impl Walk<'_> {
    /// Adds the terms of one path from `start` to `slots` (K + 2 of them), and the number of rays of each slot to `rays`.
    pub fn terms(
        &self,
        t: &SceneTransport,
        start: Vertex,
        key: Key,
        (pixel, sample): (u32, u32),
        slots: &mut [Rgb],
        rays: &mut [u64],
    ) {
        let Self { plan: Plan { max_bounces, technique, roulette }, mistake } = self;
        let (pixel, sample) = mistake.address(pixel, sample);
        let numbers = |vertex: usize, purpose: Purpose| Rng::at(key, pixel, sample, vertex, purpose);
        let hits = technique.hits(t);
        let mut score = |k: usize, value: Rgb| {
            if let Some(slot) = mistake.slot(k, *max_bounces) {
                slots[slot] += value;
            }
        };

        score(0, t.emission(&start));
        let (mut throughput, mut x) = (t.lit(), start);
        for k in 1.. {
            let (v, slot) = (k - 1, k.min(max_bounces + 1));
            if k > *max_bounces && !roulette.ends() {
                break;
            }
            // roulette: q is the probability of termination
            let q = roulette.q(t, v, throughput, &x);
            let dies = || q > 0.0 && numbers(v, Purpose::Roulette).one() < q;
            if mistake.roulette_before_light() && dies() {
                break;
            }

            // light sampling
            if technique.connects() {
                rays[slot] += 1;
                if let Some(value) = self.connect(t, &x, numbers(v, Purpose::Connect).four()) {
                    score(k, throughput * value);
                }
            }
            if k == *max_bounces && !hits && !roulette.ends() {
                break;
            }
            if !mistake.roulette_before_light() && dies() {
                break;
            }
            if q > 0.0 {
                throughput *= mistake.survivor(1.0 - q);
            }

            // the next vertex; its emission counts if the technique counts hits
            rays[slot] += 1;
            let Some(s) = self.scatter(t, &x, numbers(v, Purpose::Scatter).four()) else { break };
            let Some(next) = t.scene.look(offset_origin(x.p, s.normal), s.to) else { break };
            throughput *= s.value;
            if hits {
                let (pdf, other) = if s.delta { (s.pdf, 0.0) } else { t.densities(&x, &next, s.pdf) };
                score(k, throughput * mistake.hit_share(*technique, pdf, other) * t.emission(&next));
            }
            x = next;
        }
    }

    /// The contribution `w_c f cos θ_x E(y) V/p_ω` of the light point that the four random numbers select.
    fn connect(&self, t: &SceneTransport, at: &Vertex, u: [f32; 4]) -> Option<Rgb> {
        let (scene, mistake) = (t.scene, self.mistake);
        if scene.lights.is_empty() || !at.on_surface() {
            return None;
        }
        let LightSample { state, to, pdf, can_be_hit } = mistake.light(scene, at, mistake.light_numbers(scene, u))?;

        // geometry; for a point sampled by area, the density per solid angle is p_A r²/cos θ_y
        let (_, r2, _, towards) = connection(at.p, at.n, state.p, state.n);
        let by_area = state.on_surface() && scene.cone_pdf(at.p, &state).is_none();
        let per_area = by_area.then(|| scene.light_density(state.side));
        let cos_y = if state.on_surface() { mistake.facing(towards) } else { 1.0 };
        let per_angle = per_area.map_or(pdf, |p| p * r2 / cos_y);
        if !(cos_y > 0.0 && per_angle > 0.0 && per_angle < f32::INFINITY) {
            return Some(mistake.averted());
        }

        let s = self.towards(t, at, to)?;
        let c = Connection { light: state, r2, cos_x: s.normal.dot(to), cos_y, per_area, per_angle };
        let side = if towards < 0.0 { -state.n } else { state.n };
        if !mistake.visible(scene, at.p, s.normal, state.p, side) {
            return None;
        }
        let share = mistake.connection_share(self.plan.technique, &c, if can_be_hit { s.pdf } else { 0.0 });
        let weight = s.value * (mistake.receiver_cosine(c.cos_x) / mistake.density(&c));
        Some(mistake.connection(weight * t.emission(&state) * share))
    }

    /// f for a given direction, and the density with which BSDF sampling would choose that direction.
    fn towards(&self, t: &SceneTransport, at: &Vertex, to: Vec3) -> Option<Scattered> {
        let cosine = at.n.dot(to);
        let (value, pdf) = match t.scene.bsdf(at) {
            Bsdf::Diffuse(Diffuse { reflectance }) => {
                let f = if cosine > 0.0 { self.mistake.lambert(reflectance) } else { Rgb::ZERO };
                (f, t.sampling.pdf(cosine))
            }
            bsdf => {
                let frame = Frame::new(at.n);
                let (wo, wi) = (frame.local(at.omega), frame.local(to));
                (bsdf.eval(wo, wi, TransportMode::Radiance), bsdf.pdf(wo, wi, t.sampling))
            }
        };
        let normal = if cosine > 0.0 { at.n } else { -at.n };
        (value != Rgb::ZERO).then_some(Scattered { to, normal, value, pdf, delta: false })
    }

    /// Samples a direction, with the weight f cos θ/p.
    fn scatter(&self, t: &SceneTransport, at: &Vertex, u: [f32; 4]) -> Option<Scattered> {
        let frame = Frame::new(at.n);
        let s = match t.scene.bsdf(at) {
            Bsdf::Diffuse(Diffuse { reflectance }) => {
                let (to, pdf) = self.mistake.direction(at.n, t.sampling, [u[0], u[1]]);
                let value = self.mistake.bounce(self.mistake.lambert(reflectance), at.n.dot(to), pdf);
                return (value != Rgb::ZERO).then_some(Scattered { to, normal: at.n, value, pdf, delta: false });
            }
            Bsdf::Dielectric(Dielectric::Smooth(glass)) => self.mistake.glass(&glass, frame.local(at.omega), u[2])?,
            bsdf => bsdf.sample(frame.local(at.omega), t.sampling, TransportMode::Radiance, [u[0], u[1], u[2]])?,
        };
        let normal = if s.wi.z > 0.0 { at.n } else { -at.n };
        Some(Scattered { to: frame.world(s.wi), normal, value: s.weight, pdf: s.pdf, delta: s.delta })
    }

    /// Traces all paths of a batch and passes the terms of each to `keep`. Paths that see nothing are left out. Returns the
    /// rays of each slot.
    fn each<'s>(
        &self,
        t: &SceneTransport<'s>,
        sensor: &impl Sensor<SceneTransport<'s>>,
        batch: &Batch,
        mut keep: impl FnMut(u32, u32, &[Rgb]),
    ) -> Vec<u64> {
        let n = self.plan.max_bounces + 2;
        let (mut slots, mut rays) = (vec![Rgb::ZERO; n], vec![0; n]);
        for sample in batch.samples.clone() {
            for pixel in batch.pixels.clone() {
                let (p, s) = self.mistake.address(pixel, sample);
                rays[0] += 1;
                if let Some(start) = sensor.start(t, pixel, &mut Rng::at(batch.key, p, s, 0, Purpose::Start)) {
                    slots.fill(Rgb::ZERO);
                    self.terms(t, start, batch.key, (pixel, sample), &mut slots, &mut rays);
                    keep(pixel, sample, &slots);
                }
            }
        }
        rays
    }
}

/// Adds one value to the sink.
fn add(sink: &mut impl TermSink, slot: usize, pixel: u32, sample: u32, value: Rgb) {
    if value != Rgb::ZERO {
        let mut column = Columns::new(1);
        column.set(0, value);
        sink.add(slot, &[pixel], &[sample], &column);
    }
}

impl<'s> TermEstimator<SceneTransport<'s>> for Walk<'_> {
    fn slots(&self) -> usize {
        self.plan.max_bounces + 2
    }

    fn sample<S: Sensor<SceneTransport<'s>>>(
        &self,
        job: &Job<'_, SceneTransport<'s>, S>,
        _: &mut Paths<VertexWave>,
        sink: &mut impl TermSink,
    ) {
        let &Job { t, sensor, batch } = job;
        let rays = self.each(t, sensor, batch, |pixel, sample, slots| {
            for (slot, &value) in slots.iter().enumerate() {
                add(sink, slot, pixel, sample, self.mistake.finish(value));
            }
        });
        rays.iter().enumerate().for_each(|(slot, &n)| sink.rays(slot, n as usize));
    }
}

impl<'s> TermEstimator<SceneTransport<'s>> for Whole<'_> {
    fn slots(&self) -> usize {
        1
    }

    fn sample<S: Sensor<SceneTransport<'s>>>(
        &self,
        job: &Job<'_, SceneTransport<'s>, S>,
        _: &mut Paths<VertexWave>,
        sink: &mut impl TermSink,
    ) {
        let &Job { t, sensor, batch } = job;
        let rays = self.0.each(t, sensor, batch, |pixel, sample, slots| {
            add(sink, 0, pixel, sample, self.0.mistake.finish(slots.iter().sum()));
        });
        sink.rays(0, rays.iter().sum::<u64>() as usize);
    }
}
