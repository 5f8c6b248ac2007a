//! The factors of T for rays in a scene: f from the BSDF, cos θ from the direction, p from the technique that sampled the
//! direction.

use super::kernel::{Factors, Kernel};
use super::scene_transport::SceneTransport;
use crate::math::direction::Frame;
use crate::math::{Rgb, Rng};
use crate::scene::bsdf::{Bsdf, TransportMode, diffuse};
use crate::scene::{Vertex, offset_origin};

impl Kernel for SceneTransport<'_> {
    fn sample_direction(&self, at: &Vertex, rng: &mut Rng) -> Option<Factors<Vertex>> {
        let (u, mode) = (rng.four(), TransportMode::Radiance);
        let (direction, normal, f, cos, pdf, delta) = match self.scene.bsdf(at) {
            Bsdf::Black => return None,
            Bsdf::Diffuse(surface) => {
                let (direction, cos, pdf) = diffuse::direction(at.n, self.sampling, [u[0], u[1]]);
                (direction, at.n, surface.f(), cos, pdf, false)
            }
            bsdf => {
                let frame = Frame::new(at.n);
                let wo = frame.local(at.omega);
                let s = bsdf.sample(wo, self.sampling, mode, [u[0], u[1], u[2]])?;
                let cos = s.wi.z.abs();
                let f = if s.delta { s.weight * (s.pdf / cos) } else { bsdf.eval(wo, s.wi, mode) };
                let normal = if s.wi.z > 0.0 { at.n } else { -at.n };
                (frame.world(s.wi), normal, f, cos, s.pdf, s.delta)
            }
        };
        if f == Rgb::ZERO {
            return None;
        }
        let state = self.scene.look(offset_origin(at.p, normal), direction)?;
        let pair = if delta { [pdf, 0.0] } else { self.densities(at, &state, pdf).into() };
        Some(Factors { state, f, cos, pdf, pair })
    }

    fn sample_emitter(&self, at: &Vertex, rng: &mut Rng) -> Option<Factors<Vertex>> {
        if self.scene.lights.is_empty() || !at.on_surface() {
            return None;
        }
        let light = self.scene.sample_light(at, rng.four())?;
        let (f, cos, normal, other) = match self.scene.bsdf(at) {
            Bsdf::Black => return None,
            Bsdf::Diffuse(surface) => {
                let cos = light.to.dot(at.n);
                (cos > 0.0).then(|| (surface.f(), cos, at.n, self.sampling.pdf(cos)))?
            }
            bsdf => {
                let frame = Frame::new(at.n);
                let (wo, wi) = (frame.local(at.omega), frame.local(light.to));
                let normal = if wi.z > 0.0 { at.n } else { -at.n };
                let f = bsdf.eval(wo, wi, TransportMode::Radiance);
                (f, wi.z.abs(), normal, bsdf.pdf(wo, wi, self.sampling))
            }
        };
        if f == Rgb::ZERO || self.scene.blocked(at.p, normal, light.state.p, light.state.n) {
            return None;
        }
        let pair = [light.pdf, if light.can_be_hit { other } else { 0.0 }];
        Some(Factors { state: light.state, f, cos, pdf: light.pdf, pair })
    }
}
