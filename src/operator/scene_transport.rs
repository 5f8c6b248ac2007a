//! The continuous world: T sampled with rays in a scene.
//!
//! `(T L)(x, ω) = ∫ f(x, ω' → ω) L(ray(x, ω'), −ω') cos θ' dω'`
//!
//! and for next-event estimation the same integral over the lights,
//!
//! `(T E)(x, ω) = ∫ f · E(y, y→x) · cos θ_x cos θ_y / r² · V(x, y) dA_y`.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | f cos θ'/p | weight of [`SceneTransport::scatter`] | [`crate::scene::bsdf`] |
//! | p_A | density of the light point, m⁻² | [`crate::scene::emitter`] |
//! | p_ω = p_A r²/cos θ_y | the same in solid angle | `solid_angle` here |
//! | V | nothing between | [`crate::scene::Scene::blocked`] |

use super::transport::{Sensor, Step, Transport, Wave};
use crate::math::{Rgb, Rng};
use crate::scene::bsdf::diffuse::{self, Sampling};
use crate::scene::{Camera, Scene, SurfaceSensor, Vertex, VertexWave};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// A scene, and how its directions are drawn.
#[derive(Clone, Copy)]
pub struct SceneTransport<'a> {
    /// The surfaces and lights.
    pub scene: &'a Scene,
    /// How [`Transport::scatter`] draws directions.
    pub sampling: Sampling,
}

impl<'a> SceneTransport<'a> {
    /// The usual one: directions suit the surface.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, sampling: Sampling::Bsdf }
    }
}

/// The change of measure: a density per area at y, seen from a point at distance r, per solid angle.
#[inline(always)]
pub(crate) fn solid_angle(per_area: f32, r2: f32, cos_y: f32) -> f32 {
    per_area * r2 / cos_y
}

/// A connection from x (normal n) to y (normal m): unit direction, distance squared, cosines at both ends.
#[inline(always)]
pub(crate) fn connection(x: Vec3, n: Vec3, y: Vec3, m: Vec3) -> (Vec3, f32, f32, f32) {
    let d = y - x;
    let r2 = d.x * d.x + d.y * d.y + d.z * d.z;
    let d = d * (1.0 / r2.sqrt());
    (d, r2, d.x * n.x + d.y * n.y + d.z * n.z, -(d.x * m.x + d.y * m.y + d.z * m.z))
}

impl Transport for SceneTransport<'_> {
    type State = Vertex;
    type Wave = VertexWave;

    #[inline(always)]
    fn emission(&self, at: &Vertex) -> Rgb {
        self.scene.emission(at.side)
    }

    #[inline(always)]
    fn scatter(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let albedo = self.scene.albedo(at.side);
        if albedo == Rgb::ZERO {
            return None;
        }
        let u = rng.four();
        let (d, weight, pdf) = diffuse::sample(albedo, at.n, self.sampling, [u[0], u[1]]);
        let state = self.scene.trace(self.scene.lift(at.p, at.n), d)?;
        let (_, r2, _, cos_y) = connection(at.p, at.n, state.p, state.n);
        let other_pdf = solid_angle(self.scene.light_density(state.side), r2, cos_y);
        Some(Step { state, weight, pdf, other_pdf })
    }

    #[inline(always)]
    fn connect(&self, at: &Vertex, rng: &mut Rng) -> Option<Step<Vertex>> {
        let albedo = self.scene.albedo(at.side);
        if albedo == Rgb::ZERO || self.scene.lights.is_empty() {
            return None;
        }
        let u = rng.four();
        let side = 2 * self.scene.lights.choose([u[0], u[1]]);
        let (y, m) = self.scene.point(side, [u[2], u[3]]);
        let (d, r2, cos_x, cos_y) = connection(at.p, at.n, y, m);
        if cos_x <= 0.0 || cos_y <= 0.0 || self.scene.blocked(at.p, at.n, y, m) {
            return None;
        }
        let pdf = solid_angle(self.scene.light_density(side), r2, cos_y);
        let weight = albedo * (FRAC_1_PI * cos_x / pdf);
        let state = Vertex { p: y, n: m, omega: -d, side };
        Some(Step { state, weight, pdf, other_pdf: self.sampling.pdf(cos_x) })
    }

    #[inline(always)]
    fn albedo(&self, at: &Vertex) -> Rgb {
        self.scene.albedo(at.side)
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
        t.scene.trace(self.origin, self.direction(pixel, [u[0], u[1]]))
    }
}

/// The surface sensor drawn as a strip of equal pixels, each of them the whole surface: more pixels, more threads.
pub struct SurfaceStrip {
    /// What is seen.
    pub sensor: SurfaceSensor,
    /// Number of pixels.
    pub pixels: u32,
}

impl Sensor<SceneTransport<'_>> for SurfaceStrip {
    fn size(&self) -> [u32; 2] {
        [self.pixels, 1]
    }
    fn start(&self, t: &SceneTransport, _pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        Some(self.sensor.vertex(t.scene, rng))
    }
}
