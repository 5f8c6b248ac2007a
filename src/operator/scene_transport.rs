//! The continuous operator T, sampled with rays in a scene.
//!
//! `(T L)(x, ω) = ∫ f(x, ω' → ω) L(ray(x, ω'), −ω') cos θ' dω'`
//!
//! For next-event estimation it is the same integral over the lights:
//!
//! `(T E)(x, ω) = ∫ f · E(y, y→x) · cos θ_x cos θ_y / r² · V(x, y) dA_y`.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | f cos θ'/p | weight of a step of [`SceneTransport::scatter`] | [`crate::scene::bsdf`] |
//! | p_A | density of the point y on the light, m⁻² | [`crate::scene::emitter`] |
//! | p_ω = p_A r²/cos θ_y | the same density per solid angle, sr⁻¹ | `solid_angle` here |
//! | V | 1 if nothing blocks the segment between x and y, else 0 | [`crate::scene::Scene::blocked`] |

use super::form_factor::Visibility;
use super::patches::SurfacePoint;
use super::transport::{self, Samples, Seen, Sensor, Step, Transport, Wave};
use crate::math::direction::Frame;
use crate::math::{Columns, Rgb, Rng, Streams};
use crate::scene::bsdf::{Bsdf, Sampling, TransportMode, diffuse, diffuse::Diffuse};
use crate::scene::{Camera, Rays, Scene, Vertex, VertexWave, cosine_directions, numbers};
use crate::scene::{connection, offset_origin, segment, solid_angle};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A scene with the method of sampling directions in it.
#[derive(Clone, Copy)]
pub struct SceneTransport<'a> {
    /// The surfaces and lights.
    pub scene: &'a Scene,
    /// Distribution from which [`Transport::scatter`] samples directions.
    pub sampling: Sampling,
}

/// Next-event connection from x to the light point y, without the visibility test.
#[derive(Clone, Copy)]
pub(crate) struct Connection {
    cos_x: f32,
    /// Density of y per solid angle at x.
    pdf: f32,
    /// cos θ_x/(π·pdf): the weight for albedo 1. It is 0 if the direction points below the surface.
    factor: f32,
}

/// `f cos θ_x cos θ_y / (r² p_A)` with f = 1/π, computed from the density per solid angle.
#[inline(always)]
pub(crate) fn connect_to(x: Vec3, n: Vec3, y: Vec3, m: Vec3, density: f32) -> Connection {
    let (_, r2, cos_x, cos_y) = connection(x, n, y, m);
    let pdf = solid_angle(density, r2, cos_y);
    let factor = FRAC_1_PI * cos_x / pdf;
    let faces = (cos_x > 0.0) & (cos_y > 0.0);
    Connection { cos_x, pdf, factor: if faces { factor } else { 0.0 } }
}

impl<'a> SceneTransport<'a> {
    /// The default transport of a scene: directions are sampled from the BSDF.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, sampling: Sampling::Bsdf }
    }
}

/// A direction sampled at a vertex; no ray has been traced yet.
pub(super) struct Departure {
    pub(super) direction: Vec3,
    /// The normal on the side of the surface from which the ray leaves.
    pub(super) normal: Vec3,
    pub(super) weight: Rgb,
    pub(super) pdf: f32,
    pub(super) delta: bool,
}

impl SceneTransport<'_> {
    /// Samples a direction at a vertex; `None` if the sample is zero.
    #[inline(always)]
    pub(super) fn depart(&self, at: &Vertex, mode: TransportMode, u: [f32; 4]) -> Option<Departure> {
        match self.scene.bsdf(at) {
            Bsdf::Black => None,
            Bsdf::Diffuse(Diffuse { reflectance }) => (reflectance != Rgb::ZERO).then(|| {
                let (direction, weight, pdf) = diffuse::sample(reflectance, at.n, self.sampling, [u[0], u[1]]);
                Departure { direction, normal: at.n, weight, pdf, delta: false }
            }),
            bsdf => {
                let frame = Frame::new(at.n);
                let s = bsdf.sample(frame.local(at.omega), self.sampling, mode, [u[0], u[1], u[2]])?;
                let normal = if s.wi.z > 0.0 { at.n } else { -at.n };
                Some(Departure { direction: frame.world(s.wi), normal, weight: s.weight, pdf: s.pdf, delta: s.delta })
            }
        }
    }

    /// f cos θ, the density of scattering, and the normal on that side, for the unit direction `to`. `None` if f cos θ is
    /// zero.
    #[inline(always)]
    pub(super) fn towards(&self, at: &Vertex, to: Vec3, mode: TransportMode) -> Option<(Rgb, f32, Vec3)> {
        let cos = at.n.dot(to);
        match self.scene.bsdf(at) {
            Bsdf::Black => None,
            Bsdf::Diffuse(Diffuse { reflectance }) => {
                (cos > 0.0).then(|| (reflectance * (FRAC_1_PI * cos), self.sampling.pdf(cos), at.n))
            }
            bsdf => {
                let frame = Frame::new(at.n);
                let (wo, wi) = (frame.local(at.omega), frame.local(to));
                let f = bsdf.eval(wo, wi, mode) * wi.z.abs();
                let normal = if wi.z > 0.0 { at.n } else { -at.n };
                (f != Rgb::ZERO).then(|| (f, bsdf.pdf(wo, wi, self.sampling), normal))
            }
        }
    }

    /// The densities of scattering and of next-event estimation for the state `found` that a ray from `at` has hit; `drawn`
    /// is the density with which the direction was sampled. If both techniques can find the state, both densities are
    /// computed for the pair of points, as a connection computes them. The reason: the ray started a little off the surface,
    /// and weights computed for two slightly different points would not sum to one.
    #[inline(always)]
    pub(crate) fn densities(&self, at: &Vertex, found: &Vertex, drawn: f32) -> (f32, f32) {
        let light = self.scene.light_pdf(at.p, found);
        if light == 0.0 || !found.on_surface() {
            return (drawn, light);
        }
        let (to, ..) = connection(at.p, Vec3::ZERO, found.p, Vec3::ZERO);
        let scatter = match self.scene.bsdf(at) {
            Bsdf::Diffuse(_) => Some(to.dot(at.n)).filter(|cos| *cos > 0.0).map(|cos| self.sampling.pdf(cos)),
            _ => self.towards(at, to, TransportMode::Radiance).map(|(_, pdf, _)| pdf),
        };
        (scatter.unwrap_or(drawn), light)
    }

    /// The step of a ray from `at` that arrives at `state`.
    #[inline(always)]
    pub(crate) fn step(&self, at: &Vertex, state: Vertex, weight: Rgb, pdf: f32, delta: bool) -> Step<Vertex> {
        let (pdf, other_pdf) = if delta { (pdf, 0.0) } else { self.densities(at, &state, pdf) };
        Step { state, weight, pdf, other_pdf }
    }

    /// A connection without the visibility test, and the normal on its side; `None` if its contribution is zero.
    #[inline(always)]
    pub(crate) fn propose(&self, at: &Vertex, u: [f32; 4]) -> Option<(Step<Vertex>, Vec3)> {
        if self.scene.lights.is_empty() || !at.on_surface() {
            return None;
        }
        let light = self.scene.sample_light(at, u)?;
        let (weight, scatter_pdf, normal) = match self.scene.bsdf(at) {
            // the same products in the same order as in a wave, so that the bits agree
            Bsdf::Diffuse(Diffuse { reflectance }) => {
                let cos = light.to.dot(at.n);
                let weight = reflectance * (FRAC_1_PI * cos / light.pdf);
                (cos > 0.0 && reflectance != Rgb::ZERO).then(|| (weight, self.sampling.pdf(cos), at.n))?
            }
            _ => {
                let (f, pdf, normal) = self.towards(at, light.to, TransportMode::Radiance)?;
                (f * (1.0 / light.pdf), pdf, normal)
            }
        };
        let other_pdf = if light.can_be_hit { scatter_pdf } else { 0.0 };
        Some((Step { state: light.state, weight, pdf: light.pdf, other_pdf }, normal))
    }
}

/// Computes the connections of a wave. On entry `rays.o`, `rays.d` and `rays.t` hold the light points, their normals and
/// their densities. On exit `rays.o` and `rays.d` are shadow segments, `rays.t` is the weight for albedo 1, `rays.cosine`
/// the cosine at x, and `out.pdf` the density.
#[pulp::with_simd(connections = pulp::Arch::new())]
#[inline(always)]
fn connections_with_simd<'a, S: pulp::Simd>(
    _simd: S,
    p: &'a Columns,
    normal: &'a Columns,
    rays: &'a mut Rays,
    out: &'a mut Samples,
    n: usize,
) {
    let (px, py, pz) = (&p.x[..n], &p.y[..n], &p.z[..n]);
    let (nx, ny, nz) = (&normal.x[..n], &normal.y[..n], &normal.z[..n]);
    let (ox, oy, oz) = (&mut rays.o.x[..n], &mut rays.o.y[..n], &mut rays.o.z[..n]);
    let (dx, dy, dz) = (&mut rays.d.x[..n], &mut rays.d.y[..n], &mut rays.d.z[..n]);
    let (t, cosine, pdf) = (&mut rays.t[..n], &mut rays.cosine[..n], &mut out.pdf[..n]);
    for i in 0..n {
        let (x, n) = (Vec3::new(px[i], py[i], pz[i]), Vec3::new(nx[i], ny[i], nz[i]));
        let (y, m) = (Vec3::new(ox[i], oy[i], oz[i]), Vec3::new(dx[i], dy[i], dz[i]));
        let c = connect_to(x, n, y, m, t[i]);
        let (o, d) = segment(x, n, y, m);
        (ox[i], oy[i], oz[i]) = (o.x, o.y, o.z);
        (dx[i], dy[i], dz[i]) = (d.x, d.y, d.z);
        (t[i], cosine[i], pdf[i]) = (c.factor, c.cos_x, c.pdf);
    }
}

impl Transport for SceneTransport<'_> {
    type State = Vertex;
    type Wave = VertexWave;

    #[inline(always)]
    fn emission(&self, at: &Vertex) -> Rgb {
        self.scene.light(at)
    }

    #[inline(always)]
    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let d = self.depart(at, TransportMode::Radiance, rng.four())?;
        let state = self.scene.look(offset_origin(at.p, d.normal), d.direction)?;
        Some(self.step(at, state, d.weight, d.pdf, d.delta))
    }

    #[inline(always)]
    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let (step, normal) = self.propose(at, rng.four())?;
        (!self.scene.blocked(at.p, normal, step.state.p, step.state.n)).then_some(step)
    }

    #[inline(always)]
    fn albedo(&self, at: &Vertex) -> Rgb {
        match self.scene.bsdf(at) {
            Bsdf::Diffuse(Diffuse { reflectance }) => reflectance,
            bsdf => bsdf.albedo(Frame::new(at.n).local(at.omega)),
        }
    }

    fn lit(&self) -> Rgb {
        self.scene.lit()
    }

    fn last_resort(&self) -> Option<(usize, f32)> {
        self.scene.last_resort()
    }

    fn connects_to_all(&self) -> bool {
        !self.scene.any_delta_surface()
    }

    fn emission_wave(&self, wave: &mut VertexWave, n: usize, value: &mut Columns) {
        if !self.scene.in_packets() {
            return (0..n).for_each(|i| value.set(i, self.scene.light(&wave.get(i))));
        }
        for (i, &side) in wave.side[..n].iter().enumerate() {
            value.set(i, self.scene.emission(side));
        }
    }

    /// In a small scene of flat surfaces, this generates the random numbers in bulk and traces the shadow rays in packets.
    /// The bits are the same.
    fn connect_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples) {
        if !self.scene.in_packets() {
            return transport::connect_one_by_one(self, wave, streams, out);
        }
        numbers(streams, &mut wave.rays.u);
        self.scene.light_points(&mut wave.rays, streams.len());
        self.connect_packets(wave, streams.len(), out, 1.0);
    }

    /// In a small scene of flat surfaces, this generates the random numbers in bulk and traces the rays in packets. The bits
    /// are the same.
    fn scatter_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        if !self.scene.in_packets() || self.sampling == Sampling::Uniform {
            return transport::scatter_one_by_one(self, wave, streams, out, alive);
        }
        numbers(streams, &mut wave.rays.u);
        self.scatter_packets(wave, streams.len(), out, alive, |_, _| 1.0, 1.0);
    }
}

impl SceneTransport<'_> {
    /// Connects a wave to the light points in `wave.rays`, in packets. `share` is the probability of sampling by the cosine,
    /// as a factor of the density of scattering.
    #[inline(always)]
    pub(crate) fn connect_packets(&self, wave: &mut VertexWave, n: usize, out: &mut Samples, share: f32) {
        connections(&wave.p, &wave.n, &mut wave.rays, out, n);
        let mut shadow = 0;
        for i in 0..n {
            let albedo = self.scene.albedo(wave.side[i]);
            let factor = wave.rays.t[i];
            if factor > 0.0 && albedo != Rgb::ZERO {
                out.value.set(i, albedo * factor * self.scene.emission(2 * wave.rays.prim[i]));
                out.other_pdf[i] = self.sampling.pdf(wave.rays.cosine[i]) * share;
                wave.rays.list[shadow] = i as u32;
                shadow += 1;
            } else {
                out.set(i, Rgb::ZERO, 1.0, 0.0);
            }
        }
        self.scene.block_packets(&mut wave.rays, shadow);
        for &i in &wave.rays.list[..shadow] {
            if wave.rays.prim[i as usize] != 0 {
                out.set(i as usize, Rgb::ZERO, 1.0, 0.0);
            }
        }
    }

    /// Scatters a wave with the random numbers in `wave.rays.u`, in packets. `ratio(out, i)` is the density of the i-th pair
    /// of numbers divided by that of cosine sampling. `share` is the part of cosine sampling in that density.
    #[inline(always)]
    pub(crate) fn scatter_packets(
        &self,
        wave: &mut VertexWave,
        n: usize,
        out: &mut Samples,
        alive: &mut Vec<u32>,
        ratio: impl Fn(&Samples, usize) -> f32,
        share: f32,
    ) {
        let VertexWave { p, n: normals, omega, side, rays } = wave;
        cosine_directions(normals, &rays.u, &mut rays.d, &mut rays.cosine, n);
        for i in 0..n {
            rays.o.set(i, offset_origin(p.get(i), normals.get(i)));
        }
        let cosine = std::mem::take(&mut rays.cosine);
        self.scene.trace_packets(rays, n, |i, state| {
            let albedo = self.scene.albedo(side[i]);
            if albedo != Rgb::ZERO {
                let weight = albedo * (1.0 / ratio(out, i));
                let at = Vertex { p: p.get(i), n: normals.get(i), omega: omega.get(i), side: side[i] };
                let s = self.step(&at, state, weight, self.sampling.pdf(cosine[i]), false);
                p.set(i, state.p);
                normals.set(i, state.n);
                omega.set(i, state.omega);
                side[i] = state.side;
                out.set(i, s.weight, s.pdf * share, s.other_pdf);
                alive.push(i as u32);
            }
        });
        rays.cosine = cosine;
    }
}

impl Visibility for Scene {
    fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool {
        let f = |p: SurfacePoint| (p.position.as_vec3(), p.normal.as_vec3());
        let ((p, n), (q, m)) = (f(a), f(b));
        !self.blocked(p, n, q, m)
    }
}

impl Wave<Vertex> for VertexWave {
    fn resize(&mut self, n: usize) {
        VertexWave::resize(self, n);
    }
    #[inline(always)]
    fn get(&self, i: usize) -> Vertex {
        VertexWave::get(self, i)
    }
    #[inline(always)]
    fn set(&mut self, i: usize, state: Vertex) {
        VertexWave::set(self, i, state);
    }
    fn keep(&mut self, indices: &[u32]) {
        VertexWave::keep(self, indices);
    }
}

impl Sensor<SceneTransport<'_>> for Camera {
    fn size(&self) -> [u32; 2] {
        self.size
    }
    #[inline(always)]
    fn start(&self, t: &SceneTransport, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        let u = rng.four();
        let (o, d) = self.ray(pixel, [u[0], u[1]]);
        t.scene.look(o, d)
    }
    #[inline(always)]
    fn project(&self, t: &SceneTransport, at: &Vertex) -> Option<Seen<Vertex>> {
        self.see(t, at)
    }
    fn density(&self, t: &SceneTransport, at: &Vertex) -> f32 {
        self.start_density(t, at)
    }
    fn sees(&self, t: &SceneTransport, at: &Vertex) -> bool {
        self.unhidden(t, at)
    }
    fn sees_wave(&self, t: &SceneTransport, wave: &mut VertexWave, list: &mut Vec<u32>) {
        self.all_unhidden(t, wave, list);
    }
    fn start_wave(&self, t: &SceneTransport, wave: &mut VertexWave, streams: Streams, alive: &mut Vec<u32>) {
        if !t.scene.in_packets() {
            return transport::start_one_by_one(self, t, wave, streams, alive);
        }
        numbers(streams, &mut wave.rays.u);
        let VertexWave { p, n, omega, side, rays } = wave;
        for i in 0..streams.len() {
            let (o, d) = self.ray(streams.pixel[i], [rays.u[0][i], rays.u[1][i]]);
            rays.o.set(i, o);
            rays.d.set(i, d);
        }
        t.scene.trace_packets(rays, streams.len(), |i, state| {
            p.set(i, state.p);
            n.set(i, state.n);
            omega.set(i, state.omega);
            side[i] = state.side;
            alive.push(i as u32);
        });
    }
}
