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
use crate::scene::bsdf::{Bsdf, Departure, Sampling, Towards, TransportMode, diffuse::Diffuse};
use crate::scene::{Camera, Crop, Scene, Vertex, VertexWave, connection, offset_origin};
use glam::Vec3;

/// A scene with the method of sampling directions in it.
#[derive(Clone, Copy)]
pub struct SceneTransport<'a> {
    /// The surfaces and lights.
    pub scene: &'a Scene,
    /// Distribution from which [`Transport::scatter`] samples directions.
    pub sampling: Sampling,
}

impl<'a> SceneTransport<'a> {
    /// The default transport of a scene: directions are sampled from the BSDF.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, sampling: Sampling::Bsdf }
    }
}

impl SceneTransport<'_> {
    /// Samples a direction at a vertex; `None` if the sample is zero.
    #[inline(always)]
    pub(super) fn depart(&self, at: &Vertex, mode: TransportMode, u: [f32; 4]) -> Option<Departure> {
        self.scene.bsdf(at).depart(at.n, at.omega, self.sampling, mode, [u[0], u[1], u[2]])
    }

    /// f cos θ, the density of scattering, and the normal on that side, for the unit direction `to`. `None` if f cos θ is
    /// zero.
    #[inline(always)]
    pub(super) fn towards(&self, at: &Vertex, to: Vec3, mode: TransportMode) -> Option<Towards> {
        self.scene.bsdf(at).towards(at.n, at.omega, to, self.sampling, mode)
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
        let scatter = self.towards(at, to, TransportMode::Radiance).map(|t| t.pdf);
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
        let found = self.scene.bsdf(at).connect(at.n, at.omega, light.to, light.pdf, self.sampling)?;
        let other_pdf = if light.can_be_hit { found.pdf } else { 0.0 };
        Some((Step { state: light.state, weight: found.value, pdf: light.pdf, other_pdf }, found.normal))
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
        self.emission_of_wave(wave, n, value);
    }

    fn connect_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples) {
        if !self.scene.in_waves() {
            return transport::connect_one_by_one(self, wave, streams, out);
        }
        self.connect_by_wave(wave, streams, out);
    }

    fn scatter_wave(&self, wave: &mut VertexWave, streams: Streams, out: &mut Samples, alive: &mut Vec<u32>) {
        if !self.scene.in_waves() {
            return transport::scatter_one_by_one(self, wave, streams, out, alive);
        }
        self.scatter_by_wave(wave, streams, out, alive);
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
    fn crop(&self) -> Crop {
        self.crop
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
        if !t.scene.in_waves() {
            return transport::start_one_by_one(self, t, wave, streams, alive);
        }
        t.start_by_wave(self, wave, streams, alive);
    }
}
