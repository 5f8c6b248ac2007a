//! The adjoint for a scene: walks from its lights, and the densities of paths that are built from both ends.
//!
//! | step from | distribution of directions or positions | density per area of the next point y |
//! |---|---|---|
//! | emitting surface | Lambertian, cos θ/π | `cos θ/π · cos θ_y/r²` |
//! | point light | uniform, 1/4π | `1/4π · cos θ_y/r²` |
//! | direction light, sky | uniform on a disk of the scene's radius R | `cos θ_y/πR²` |
//! | surface | density p_ω of the BSDF sampling | `p_ω · cos θ_y/r²` |
//!
//! Reference: Veach (1997), ch. 8; Pharr, Jakob, Humphreys, *Physically Based Rendering* (3rd ed. 2016), ch. 16.

use super::adjoint::{Adjoint, AdjointStep, Role, Toward};
use super::scene_transport::SceneTransport;
use super::transport::Seen;
use crate::math::direction::{about, cos_sin_turn, cosine_hemisphere, uniform_sphere};
use crate::math::{Rgb, Rng};
use crate::scene::bsdf::dielectric::Dielectric;
use crate::scene::bsdf::{Bsdf, TransportMode};
use crate::scene::{Camera, ESCAPED, Vertex, emitter::Light, offset_origin};
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

impl Role {
    fn mode(self) -> TransportMode {
        if self == Self::Radiance { TransportMode::Radiance } else { TransportMode::Flux }
    }
}

impl SceneTransport<'_> {
    /// Returns true if light from this state arrives in parallel: a direction light or the sky.
    fn parallel(&self, at: &Vertex) -> bool {
        !at.on_surface() && !matches!(self.scene.light_of(at), Some(Light::Point { .. }))
    }

    /// Unit direction from `at` to `to`.
    fn direction(&self, at: &Vertex, to: &Vertex) -> Vec3 {
        if self.parallel(to) {
            -to.omega
        } else if self.parallel(at) {
            at.omega
        } else {
            (to.p - at.p).normalize()
        }
    }

    /// Solid angle at `at` per unit of the measure of `to`; 0 for a light that no ray can hit.
    fn angle(&self, at: &Vertex, to: &Vertex, direction: Vec3) -> f32 {
        match to.side {
            ESCAPED => 1.0,
            _ if to.on_surface() => to.n.dot(direction).abs() / (to.p - at.p).length_squared(),
            _ => 0.0,
        }
    }
}

impl Adjoint for SceneTransport<'_> {
    fn emit(&self, rng: &mut Rng) -> Option<(Vertex, f32)> {
        self.scene.emit(rng.four())
    }

    fn emit_density(&self, at: &Vertex) -> f32 {
        self.scene.emit_density(at)
    }

    fn connect_density(&self, from: &Vertex, at: &Vertex) -> f32 {
        match self.scene.cone_pdf(from.p, at) {
            Some(pdf) => pdf * self.angle(from, at, self.direction(from, at)),
            None => self.scene.emit_density(at),
        }
    }

    fn walk(&self, at: &Vertex, role: Role, rng: &mut Rng) -> Option<AdjointStep<Vertex>> {
        let u = rng.four();
        if role == Role::Emission {
            return self.shine(at, u);
        }
        let d = self.depart(at, role.mode(), u)?;
        let o = offset_origin(at.p, d.normal);
        let seen =
            if role == Role::Radiance { self.scene.look(o, d.direction) } else { self.scene.trace(o, d.direction) };
        let state = seen?;
        let delta = d.delta.then_some(d.pdf);
        let density = match delta {
            Some(choice) => self.delta_density(at, &state, choice),
            // take the density for the pair of points, as every other strategy does; if rounding makes it zero, take the
            // density of the sampled direction
            None => Some(self.toward(at, &state, role).density)
                .filter(|density| *density > 0.0)
                .unwrap_or_else(|| d.pdf * self.angle(at, &state, d.direction)),
        };
        Some(AdjointStep { state, weight: d.weight, density, delta })
    }

    fn toward(&self, at: &Vertex, to: &Vertex, role: Role) -> Toward {
        let direction = self.direction(at, to);
        if role == Role::Emission {
            let light = self.scene.light(at);
            return match self.scene.light_of(at) {
                None if at.on_surface() => {
                    let cos = at.n.dot(direction).max(0.0);
                    Toward { value: light * cos, density: cos * FRAC_1_PI * self.angle(at, to, direction) }
                }
                Some(Light::Point { .. }) => {
                    Toward { value: light, density: 0.25 * FRAC_1_PI * self.angle(at, to, direction) }
                }
                _ => {
                    let cos = if to.on_surface() { to.n.dot(direction).abs() } else { 0.0 };
                    Toward { value: light, density: cos / self.disk() }
                }
            };
        }
        match self.towards(at, direction, role.mode()) {
            Some(t) => Toward { value: t.value, density: t.pdf * self.angle(at, to, direction) },
            None => Toward::default(),
        }
    }

    fn delta_density(&self, at: &Vertex, to: &Vertex, choice: f32) -> f32 {
        let direction = self.direction(at, to);
        let cos = at.n.dot(direction);
        // the delta function in n² times projected solid angle is the same from both ends (n: refractive index); `relative`
        // is n² divided by the indices of both sides
        let relative = match self.scene.bsdf(at) {
            Bsdf::Dielectric(Dielectric::Smooth(glass)) if cos < 0.0 => glass.interface.eta,
            _ => 1.0,
        };
        choice * relative * cos.abs() * self.angle(at, to, direction)
    }

    fn facing(&self, at: &Vertex, other: &Vertex) -> Vertex {
        if !at.on_surface() {
            return *at;
        }
        let omega = self.direction(at, other);
        if at.n.dot(omega) < 0.0 {
            Vertex { n: -at.n, side: at.side ^ 1, omega, ..*at }
        } else {
            Vertex { omega, ..*at }
        }
    }

    fn link(&self, eye: &Vertex, light: &Vertex) -> f32 {
        let to = self.direction(eye, light);
        let side = |v: &Vertex, d: Vec3| if v.n.dot(d) < 0.0 { -v.n } else { v.n };
        let (q, r2) = if self.parallel(light) {
            (self.scene.beyond(eye.p, to), 1.0)
        } else {
            (light.p, (light.p - eye.p).length_squared())
        };
        if self.scene.blocked(eye.p, side(eye, to), q, side(light, -to)) { 0.0 } else { 1.0 / r2 }
    }
}

impl SceneTransport<'_> {
    /// Area of the disk from which parallel light starts.
    fn disk(&self) -> f32 {
        PI * self.scene.radius() * self.scene.radius()
    }

    /// The first step of light from its source. The weight E cos θ/p is π E for a surface, 4π I for a point light of
    /// intensity I, and πR² times the emission of parallel light.
    fn shine(&self, at: &Vertex, u: [f32; 4]) -> Option<AdjointStep<Vertex>> {
        let light = self.scene.light(at);
        let (o, d, weight) = match self.scene.light_of(at) {
            None if at.on_surface() => {
                let (d, _) = cosine_hemisphere(at.n, [u[0], u[1]]);
                (offset_origin(at.p, at.n), d, light * PI)
            }
            Some(Light::Point { .. }) => (at.p, uniform_sphere([u[0], u[1]]), light * (4.0 * PI)),
            _ => {
                let (c, s) = cos_sin_turn(u[1]);
                let r = self.scene.radius() * u[0].sqrt();
                let o = self.scene.center() + about(at.omega, r * c, r * s, 0.0);
                (o - at.omega * (2.0 * self.scene.radius()), at.omega, light * self.disk())
            }
        };
        let state = self.scene.trace(o, d)?;
        let density = self.toward(&Vertex { omega: at.omega, ..*at }, &state, Role::Emission).density;
        (weight != Rgb::ZERO).then_some(AdjointStep { state, weight, density, delta: None })
    }
}

impl Camera {
    /// The vector from the pinhole to a state, in `f64`; for the sky, a unit direction.
    fn toward(&self, t: &SceneTransport, at: &Vertex) -> DVec3 {
        if t.parallel(at) { -at.omega.as_dvec3() } else { at.p.as_dvec3() - self.origin }
    }

    /// The pixel that sees a state if nothing blocks the view.
    pub(crate) fn see(&self, t: &SceneTransport, at: &Vertex) -> Option<Seen<Vertex>> {
        // a camera never sees a point light or a direction light
        if !at.on_surface() && at.side != ESCAPED {
            return None;
        }
        let d = self.toward(t, at);
        let (pixel, per_angle) = self.pixel(d)?;
        let pixel = pixel?;
        let r2 = if at.on_surface() { d.length_squared() as f32 } else { 1.0 };
        Some(Seen { pixel, eye: self.eye(), importance: per_angle / r2, density: per_angle * angle(at, d) })
    }

    fn eye(&self) -> Vertex {
        Vertex { p: self.origin.as_vec3(), n: Vec3::ZERO, ..Vertex::default() }
    }

    /// Density with which a path starts at a state that some pixel sees. It is also valid if rounding puts the state just
    /// outside the picture.
    pub(crate) fn start_density(&self, t: &SceneTransport, at: &Vertex) -> f32 {
        let d = self.toward(t, at);
        self.pixel(d).map_or(0.0, |(_, per_angle)| per_angle * angle(at, d))
    }

    /// Returns true if nothing blocks the view from the eye to the state.
    pub(crate) fn unhidden(&self, t: &SceneTransport, at: &Vertex) -> bool {
        let start = self.enter(self.toward(t, at).normalize());
        let (p, n) = if at.on_surface() {
            let toward_eye = if at.n.dot(start - at.p) < 0.0 { -at.n } else { at.n };
            (at.p, toward_eye)
        } else {
            (t.scene.beyond(start, -at.omega), Vec3::ZERO)
        };
        !t.scene.blocked(p, n, start, Vec3::ZERO)
    }
}

/// Solid angle at the eye per unit of the measure of a state in direction `d` from the eye; 0 for a light that no ray can
/// hit.
fn angle(at: &Vertex, d: DVec3) -> f32 {
    match at.side {
        ESCAPED => 1.0,
        _ if at.on_surface() => {
            let r2 = d.length_squared();
            (at.n.as_dvec3().dot(d).abs() / (r2 * r2.sqrt())) as f32
        }
        _ => 0.0,
    }
}
