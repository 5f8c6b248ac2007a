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

use super::adjoint::{Adjoint, AdjointStep, Role, Steps, Toward};
use super::scene_transport::SceneTransport;
use crate::math::direction::{about, cos_sin_turn, cosine_hemisphere, uniform_sphere};
use crate::math::{Columns, Rgb, Rng, Streams};
use crate::scene::bsdf::dielectric::Dielectric;
use crate::scene::bsdf::{Bsdf, Departure, TransportMode};
use crate::scene::{DELTA, ESCAPED, Vertex, VertexWave, Vertices, emitter::Light, numbers, offset_origin, segment};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

impl Role {
    fn mode(self) -> TransportMode {
        if self == Self::Radiance { TransportMode::Radiance } else { TransportMode::Flux }
    }
}

impl SceneTransport<'_> {
    /// Returns true if light from this state arrives in parallel: a direction light or the sky.
    #[inline(always)]
    pub(super) fn parallel(&self, at: &Vertex) -> bool {
        !at.on_surface() && !matches!(self.scene.light_of(at), Some(Light::Point { .. }))
    }

    /// Unit direction from `at` to `to`.
    #[inline(always)]
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
    #[inline(always)]
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

    #[inline(always)]
    fn emit_density(&self, at: &Vertex) -> f32 {
        self.scene.emit_density(at)
    }

    #[inline(always)]
    fn connect_density(&self, from: &Vertex, at: &Vertex) -> f32 {
        match self.scene.cone_pdf(from.p, at) {
            Some(pdf) => pdf * self.angle(from, at, self.direction(from, at)),
            None => self.scene.emit_density(at),
        }
    }

    fn walk(&self, at: &Vertex, role: Role, rng: &mut Rng) -> Option<AdjointStep<Vertex>> {
        let u = rng.four();
        let d = self.leave(at, role, u)?;
        let seen = if role == Role::Radiance { self.scene.look(d.o, d.d) } else { self.scene.trace(d.o, d.d) };
        let state = seen?;
        let density = self.arrived(at, &state, role, d.pdf, d.delta);
        Some(AdjointStep { state, weight: d.weight, density, delta: d.delta.then_some(d.pdf) })
    }

    #[inline(always)]
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

    #[inline(always)]
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

    #[inline(always)]
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

    /// Both ways share the distance and the cosines.
    #[inline(always)]
    fn both_ways(&self, eye: &Vertex, light: &Vertex) -> (Toward, Toward) {
        if !eye.on_surface() || !light.on_surface() {
            return (self.toward(eye, light, Role::Radiance), self.toward(light, eye, Role::Flux));
        }
        let between = light.p - eye.p;
        let (direction, r2) = (between.normalize(), between.length_squared());
        let one = |at: &Vertex, to: &Vertex, direction: Vec3, mode| match self.towards(at, direction, mode) {
            Some(t) => Toward { value: t.value, density: t.pdf * (to.n.dot(direction).abs() / r2) },
            None => Toward::default(),
        };
        (one(eye, light, direction, TransportMode::Radiance), one(light, eye, -direction, TransportMode::Flux))
    }

    #[inline(always)]
    fn forgets(&self, at: &Vertex) -> bool {
        matches!(self.scene.bsdf(at), Bsdf::Diffuse(_))
    }

    fn link(&self, eye: &Vertex, light: &Vertex) -> f32 {
        let (p, n, q, m, r2) = self.between(eye, light);
        if self.scene.blocked(p, n, q, m) { 0.0 } else { 1.0 / r2 }
    }

    /// All rays of the wave are traced together.
    fn walk_wave(&self, wave: &mut VertexWave, role: Role, streams: Streams, out: &mut Steps, alive: &mut Vec<u32>) {
        numbers(streams, &mut wave.rays.u);
        if role == Role::Emission {
            return self.shine_wave(wave, streams.len(), out, alive);
        }
        let VertexWave { p, n, omega, side, rays } = wave;
        let on = self.depart_and_look(Vertices { p, n, omega, side }, streams.len(), rays, role.mode());
        for index in 0..on {
            let place = rays.list[index] as usize;
            let (i, state) = (rays.order[place] as usize, rays.seen(place));
            // light never walks into the sky
            if role == Role::Flux && state.side == ESCAPED {
                continue;
            }
            let (pdf, delta) = (rays.cosine[place], rays.flag[place] == DELTA);
            let at = Vertices { p, n, omega, side }.get(i);
            out.weight.set(i, rays.value.get(place));
            if out.wanted {
                out.density[i] = self.arrived(&at, &state, role, pdf, delta);
            }
            out.choice[i] = if delta { pdf } else { 0.0 };
            p.set(i, state.p);
            n.set(i, state.n);
            omega.set(i, state.omega);
            side[i] = state.side;
            alive.push(i as u32);
        }
    }

    /// All shadow segments of the wave are tested together.
    fn choose_wave(
        &self,
        wave: &mut VertexWave,
        streams: Streams,
        found: &mut VertexWave,
        weight: &mut Columns,
        alive: &mut Vec<u32>,
    ) {
        numbers(streams, &mut wave.rays.u);
        for i in 0..streams.len() {
            let at = wave.get(i);
            if let Some((step, normal)) = self.propose(&at, wave.rays.u.each_ref().map(|u| u[i])) {
                let (o, d) = segment(at.p, normal, step.state.p, step.state.n);
                wave.rays.o.set(i, o);
                wave.rays.d.set(i, d);
                wave.rays.list[alive.len()] = i as u32;
                found.set(i, step.state);
                weight.set(i, step.weight);
                alive.push(i as u32);
            }
        }
        self.scene.block_wave(&mut wave.rays, alive.len());
        alive.retain(|&i| wave.rays.prim[i as usize] == 0);
    }

    /// All segments are tested together.
    fn link_wave(
        &self,
        eye: &VertexWave,
        light: &VertexWave,
        scratch: &mut VertexWave,
        list: &mut Vec<u32>,
        factor: &mut [f32],
    ) {
        let rays = &mut scratch.rays;
        for (j, &i) in list.iter().enumerate() {
            let i = i as usize;
            let (p, n, q, m, r2) = self.between(&eye.get(i), &light.get(i));
            let (o, d) = segment(p, n, q, m);
            rays.o.set(i, o);
            rays.d.set(i, d);
            rays.list[j] = i as u32;
            factor[i] = 1.0 / r2;
        }
        self.scene.block_wave(rays, list.len());
        list.retain(|&i| rays.prim[i as usize] == 0);
    }
}

impl SceneTransport<'_> {
    /// Area of the disk from which parallel light starts.
    #[inline(always)]
    fn disk(&self) -> f32 {
        PI * self.scene.radius() * self.scene.radius()
    }

    /// The ray of one step of a walk; `None` if the step is zero.
    #[inline(always)]
    fn leave(&self, at: &Vertex, role: Role, u: [f32; 4]) -> Option<Leave> {
        if role == Role::Emission {
            return self.shine(at, u);
        }
        let Departure { direction, normal, weight, pdf, delta } = self.depart(at, role.mode(), u)?;
        Some(Leave { o: offset_origin(at.p, normal), d: direction, weight, pdf, delta })
    }

    /// The first step of every walk of a wave from the lights.
    fn shine_wave(&self, wave: &mut VertexWave, n: usize, out: &mut Steps, alive: &mut Vec<u32>) {
        let mut leaves = Vec::with_capacity(n);
        for i in 0..n {
            if let Some(ray) = self.shine(&wave.get(i), wave.rays.u.each_ref().map(|u| u[i])) {
                wave.rays.o.set(leaves.len(), ray.o);
                wave.rays.d.set(leaves.len(), ray.d);
                leaves.push((i, ray.weight));
            }
        }
        let VertexWave { p, n, omega, side, rays } = wave;
        self.scene.trace_wave(rays, leaves.len(), |j, state| {
            let (i, weight) = leaves[j];
            let at = Vertices { p, n, omega, side }.get(i);
            out.weight.set(i, weight);
            if out.wanted {
                out.density[i] = self.arrived(&at, &state, Role::Emission, 0.0, false);
            }
            out.choice[i] = 0.0;
            p.set(i, state.p);
            n.set(i, state.n);
            omega.set(i, state.omega);
            side[i] = state.side;
            alive.push(i as u32);
        });
    }

    /// The first ray of light from its source. The weight E cos θ/p is π E for a surface, 4π I for a point light of
    /// intensity I, and πR² times the emission of parallel light.
    fn shine(&self, at: &Vertex, u: [f32; 4]) -> Option<Leave> {
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
        (weight != Rgb::ZERO).then_some(Leave { o, d, weight, pdf: 0.0, delta: false })
    }

    /// The density of the step from `at` to the state where its ray arrived. The direction of the ray was sampled with density
    /// `pdf`, or chosen with that probability if it came from a delta part.
    #[inline(always)]
    fn arrived(&self, at: &Vertex, state: &Vertex, role: Role, pdf: f32, delta: bool) -> f32 {
        if delta {
            return self.delta_density(at, state, pdf);
        }
        // take the density for the pair of points, as every other strategy does; if rounding makes it zero, take the density
        // of the sampled direction
        let density = self.toward(at, state, role).density;
        if density > 0.0 || role == Role::Emission { density } else { pdf * self.angle(at, state, -state.omega) }
    }

    /// The ends of the segment between two states, each with the normal on its side, and the squared distance; 1 instead of
    /// the squared distance if the light is parallel.
    #[inline(always)]
    fn between(&self, eye: &Vertex, light: &Vertex) -> (Vec3, Vec3, Vec3, Vec3, f32) {
        let to = self.direction(eye, light);
        let side = |v: &Vertex, d: Vec3| if v.n.dot(d) < 0.0 { -v.n } else { v.n };
        let (q, r2) = if self.parallel(light) {
            (self.scene.beyond(eye.p, to), 1.0)
        } else {
            (light.p, (light.p - eye.p).length_squared())
        };
        (eye.p, side(eye, to), q, side(light, -to), r2)
    }
}

/// The ray of one step of a walk, before it is traced.
struct Leave {
    o: Vec3,
    d: Vec3,
    weight: Rgb,
    /// Density of the direction per solid angle; for a delta step, the probability of choosing it.
    pdf: f32,
    delta: bool,
}
