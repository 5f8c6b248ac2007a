//! Lights as seen by a receiver, and the start of paths at lights.
//!
//! ```text
//! (T E)(x) = E[ f cos θ · L / p_ω ]      for a light chosen by Scene::sample_light with density p_ω
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p_ω | density in solid angle at the receiver of a light chosen by next-event estimation | `light_pdf`, the same density for a light that a ray has hit |
//! | p(y_0) | density of the start of a path at a light, in the measure of the state | `emit_density` |
//!
//! The densities for each light are those of [`emitter`](super::emitter).

use super::emitter::{Light, cone};
use super::{ESCAPED, LIGHT, Scene, Vertex, connection, solid_angle};
use glam::Vec3;

/// A point on a light, chosen by next-event estimation.
pub struct LightSample {
    /// The point on the light, with its direction towards the receiver.
    pub state: Vertex,
    /// Unit direction from the receiver to the light.
    pub to: Vec3,
    /// Density in solid angle. It is r² P for a point light and P for a directional light, so that f cos θ/pdf is the weight
    /// in every case.
    pub pdf: f32,
    /// True if the light has an area, so that a ray can hit it.
    pub can_be_hit: bool,
}

impl Scene {
    /// Next-event estimation: the point on a light that four uniform numbers choose for a receiver. Occlusion is not tested.
    /// `None` if the front of the light faces away, or if the receiver lies on this convex light.
    #[inline(always)]
    pub(crate) fn sample_light(&self, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        // a density of 0 or less: the front of the light faces away; an infinite one: the light is seen exactly edge-on
        self.propose_light(at, u).filter(|sample| sample.pdf > 0.0 && sample.pdf < f32::INFINITY)
    }

    /// The same as [`Self::sample_light`], but returned for every density; the density is negative if the front of the light
    /// faces away.
    #[inline(always)]
    pub(crate) fn propose_light(&self, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        let x = at.p;
        let light = self.lights.choose(u[0]);
        let probability = self.lights.probability(light);
        Some(match self.lights.lights[light as usize] {
            // rounding must not let a convex light illuminate itself
            Light::Ball { prim, .. } if prim == at.side / 2 => return None,
            Light::Point { position, .. } => {
                let (to, r2, ..) = connection(x, Vec3::ZERO, position, Vec3::ZERO);
                let state = Vertex { p: position, n: Vec3::ZERO, omega: -to, side: LIGHT + light };
                LightSample { state, to, pdf: r2 * probability, can_be_hit: false }
            }
            Light::Directional { direction, .. } => {
                let state = Vertex { side: LIGHT + light, ..Vertex::escaped(self.beyond(x, -direction), -direction) };
                LightSample {
                    state: Vertex { n: Vec3::ZERO, ..state },
                    to: -direction,
                    pdf: probability,
                    can_be_hit: false,
                }
            }
            Light::Environment => {
                let (to, density) = self.sky_sample([u[2], u[3]]);
                let state = Vertex { n: Vec3::ZERO, ..Vertex::escaped(self.beyond(x, to), to) };
                LightSample { state, to, pdf: density * probability, can_be_hit: true }
            }
            Light::Ball { prim, center, radius } => match cone::sample(x, center, radius, [u[2], u[3]]) {
                Some((p, pdf)) => {
                    let n = self.accel.shapes[prim as usize].normal(p);
                    let (to, r2, ..) = connection(x, Vec3::ZERO, p, n);
                    let state = Vertex { p, n, omega: -to, side: 2 * prim };
                    // for a receiver on the sphere itself, rounding may choose x as the point: no direction leads to it
                    let pdf = if r2 > 0.0 { pdf * probability } else { 0.0 };
                    LightSample { state, to, pdf, can_be_hit: true }
                }
                None => self.by_area(x, prim, [u[2], u[3]]),
            },
            Light::Surface { .. } => self.by_area(x, self.lights.primitive(light, u[1])?, [u[2], u[3]]),
        })
    }

    /// A point of a primitive, chosen uniformly by area. The density is 0 or negative if the front faces away.
    #[inline(always)]
    pub(super) fn by_area(&self, x: Vec3, prim: u32, u: [f32; 2]) -> LightSample {
        let shape = &self.accel.shapes[prim as usize];
        let p = shape.point(u);
        let n = shape.normal(p);
        let (to, r2, _, cos) = connection(x, Vec3::ZERO, p, n);
        let pdf = solid_angle(self.lights.density[prim as usize], r2, cos);
        LightSample { state: Vertex { p, n, omega: -to, side: 2 * prim }, to, pdf, can_be_hit: true }
    }

    pub(super) fn sky_sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        self.lights.environment.as_ref().map_or((Vec3::Y, 0.0), |(sky, _)| sky.sample(u))
    }

    /// Density in solid angle with which [`Self::sample_light`] chooses the point `at` that a ray from `x` has hit; 0 if it
    /// cannot choose it.
    #[inline(always)]
    pub(crate) fn light_pdf(&self, x: Vec3, at: &Vertex) -> f32 {
        if !at.on_surface() {
            return if at.side == ESCAPED { self.sky_pdf(-at.omega) } else { 0.0 };
        }
        let density = self.light_density(at.side);
        if density == 0.0 {
            return 0.0;
        }
        if let Some(pdf) = self.cone_pdf(x, at) {
            return pdf;
        }
        let (_, r2, _, cos) = connection(x, Vec3::ZERO, at.p, at.n);
        // rounding may put a grazing hit behind the plane of the light
        solid_angle(density, r2, cos.abs())
    }

    /// Density in solid angle with which [`Self::sample_light`] chooses the direction `d` of the sky.
    #[inline(always)]
    pub(crate) fn sky_pdf(&self, d: Vec3) -> f32 {
        match &self.lights.environment {
            Some((sky, light)) => sky.pdf(d) * self.lights.probability(*light),
            None => 0.0,
        }
    }

    /// The light without a surface that a vertex represents; `None` for a vertex on a surface.
    #[inline(always)]
    pub(crate) fn light_of(&self, at: &Vertex) -> Option<&Light> {
        match at.side {
            side if side < LIGHT => None,
            ESCAPED => self.lights.environment.as_ref().map(|(_, light)| &self.lights.lights[*light as usize]),
            side => self.lights.lights.get((side - LIGHT) as usize),
        }
    }

    /// The number of the light that a ray has found: of the surface that it hit, or of the sky. `None` if it is not a light.
    #[inline(always)]
    pub(crate) fn light_number(&self, at: &Vertex) -> Option<u32> {
        match at.side {
            side if side < LIGHT => self.lights.of_primitive(side / 2),
            ESCAPED => self.lights.environment.as_ref().map(|(_, light)| *light),
            side => Some(side - LIGHT),
        }
    }

    /// The start of a path at a light, chosen by four uniform numbers, and its density in the measure of the state. The
    /// density is in m⁻² on a surface, in sr⁻¹ for the sky, and a probability for a point or directional light.
    pub(crate) fn emit(&self, u: [f32; 4]) -> Option<(Vertex, f32)> {
        if self.lights.is_empty() {
            return None;
        }
        let light = self.lights.choose(u[0]);
        let probability = self.lights.probability(light);
        Some(match self.lights.lights[light as usize] {
            Light::Point { position, .. } => {
                (Vertex { p: position, n: Vec3::ZERO, omega: Vec3::ZERO, side: LIGHT + light }, probability)
            }
            Light::Directional { direction, .. } => {
                let state = Vertex::escaped(self.beyond(self.center, -direction), -direction);
                (Vertex { n: Vec3::ZERO, side: LIGHT + light, ..state }, probability)
            }
            Light::Environment => {
                let (d, density) = self.sky_sample([u[2], u[3]]);
                (Vertex::escaped(self.beyond(self.center, d), d), density * probability)
            }
            Light::Surface { .. } | Light::Ball { .. } => {
                let prim = self.lights.primitive(light, u[1])?;
                let shape = &self.accel.shapes[prim as usize];
                let p = shape.point([u[2], u[3]]);
                let n = shape.normal(p);
                (Vertex { p, n, omega: n, side: 2 * prim }, self.lights.density[prim as usize])
            }
        })
    }

    /// The density with which [`Self::emit`] chooses a state.
    pub(crate) fn emit_density(&self, at: &Vertex) -> f32 {
        match (at.side, &self.lights.environment) {
            (side, _) if side < LIGHT => self.light_density(side),
            (ESCAPED, Some((sky, light))) => sky.pdf(-at.omega) * self.lights.probability(*light),
            (ESCAPED, None) => 0.0,
            (side, _) => self.lights.probability(side - LIGHT),
        }
    }

    /// Centre of a sphere that encloses the shapes.
    pub(crate) fn center(&self) -> Vec3 {
        self.center
    }

    /// Radius of a sphere that encloses the shapes, m.
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// The result of [`Self::light_pdf`] if the light is a sphere that is sampled by solid angle; `None` otherwise.
    #[inline(always)]
    pub(crate) fn cone_pdf(&self, x: Vec3, at: &Vertex) -> Option<f32> {
        if !at.on_surface() || at.side & 1 == 1 {
            return None;
        }
        let (center, radius, probability) = self.lights.ball(at.side / 2)?;
        let pdf = cone::pdf(x, center, radius);
        (pdf > 0.0).then_some(pdf * probability)
    }
}
