//! Light from the point of view of a receiver, and from where it starts.
//!
//! ```text
//! (T E)(x) = E[ f cos θ · L / p_ω ]      for a light chosen by Scene::sample_light with density p_ω
//! ```
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | p_ω | density of a choice in solid angle at the receiver | `light_pdf`, the same number for what a ray has hit |
//! | p(y_0) | density of where light starts, in the measure of the state | `emit_density` |
//!
//! The densities per light are those of [`emitter`](super::emitter).

use super::emitter::{Light, cone};
use super::{ESCAPED, LIGHT, Scene, Vertex, connection, solid_angle};
use glam::Vec3;

/// What next-event estimation chose.
pub struct LightSample {
    /// On the light, leaving towards the receiver.
    pub state: Vertex,
    /// Unit direction from the receiver.
    pub to: Vec3,
    /// Density in solid angle; r² P for a point and P for a direction, so that f cos θ/pdf is the weight in every case.
    pub pdf: f32,
    /// Whether it has an area, so that a ray can hit it.
    pub can_be_hit: bool,
}

impl Scene {
    /// Next-event estimation: the light that four uniform numbers choose for a receiver, before anybody looks whether it is
    /// hidden; nothing where the receiver is the light and cannot see itself.
    #[inline(always)]
    pub(crate) fn sample_light(&self, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        // a density that is not positive: the light's front looks away; infinite: it is seen from exactly beside it
        self.propose_light(at, u).filter(|sample| sample.pdf > 0.0 && sample.pdf < f32::INFINITY)
    }

    /// The same before anybody looks at its density, which is negative where the light's front looks away.
    #[inline(always)]
    pub(crate) fn propose_light(&self, at: &Vertex, u: [f32; 4]) -> Option<LightSample> {
        let x = at.p;
        let light = self.lights.choose(u[0]);
        let probability = self.lights.probability(light);
        Some(match self.lights.lights[light as usize] {
            // rounding must not let a convex light shine on itself
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
                    // seen from its own surface, rounding may choose x itself: there is no direction to it
                    let pdf = if r2 > 0.0 { pdf * probability } else { 0.0 };
                    LightSample { state, to, pdf, can_be_hit: true }
                }
                None => self.by_area(x, prim, [u[2], u[3]]),
            },
            Light::Surface { .. } => self.by_area(x, self.lights.primitive(light, u[1])?, [u[2], u[3]]),
        })
    }

    /// A point of a primitive, uniformly by area. The density is not positive where the front looks away.
    #[inline(always)]
    fn by_area(&self, x: Vec3, prim: u32, u: [f32; 2]) -> LightSample {
        let shape = &self.accel.shapes[prim as usize];
        let p = shape.point(u);
        let n = shape.normal(p);
        let (to, r2, _, cos) = connection(x, Vec3::ZERO, p, n);
        let pdf = solid_angle(self.lights.density[prim as usize], r2, cos);
        LightSample { state: Vertex { p, n, omega: -to, side: 2 * prim }, to, pdf, can_be_hit: true }
    }

    fn sky_sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        self.lights.environment.as_ref().map_or((Vec3::Y, 0.0), |(sky, _)| sky.sample(u))
    }

    /// Density with which [`Self::sample_light`] chooses what a ray from `x` has arrived at, in solid angle; 0 where it cannot.
    #[inline(always)]
    pub(crate) fn light_pdf(&self, x: Vec3, at: &Vertex) -> f32 {
        if !at.on_surface() {
            return match &self.lights.environment {
                Some((sky, light)) if at.side == ESCAPED => sky.pdf(-at.omega) * self.lights.probability(*light),
                _ => 0.0,
            };
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

    /// The light without a surface that a vertex stands for.
    #[inline(always)]
    pub(crate) fn light_of(&self, at: &Vertex) -> Option<&Light> {
        match at.side {
            side if side < LIGHT => None,
            ESCAPED => self.lights.environment.as_ref().map(|(_, light)| &self.lights.lights[*light as usize]),
            side => self.lights.lights.get((side - LIGHT) as usize),
        }
    }

    /// The number of the light that a ray has arrived at: of what it has hit, or of the sky.
    #[inline(always)]
    pub(crate) fn light_number(&self, at: &Vertex) -> Option<u32> {
        match at.side {
            side if side < LIGHT => self.lights.of_primitive(side / 2),
            ESCAPED => self.lights.environment.as_ref().map(|(_, light)| *light),
            side => Some(side - LIGHT),
        }
    }

    /// Where light starts, as four uniform numbers choose, and the density in the measure of the state: m⁻² on a surface,
    /// sr⁻¹ for the sky, a probability for a point or a direction.
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

    /// The density of [`Self::emit`] at a state.
    pub(crate) fn emit_density(&self, at: &Vertex) -> f32 {
        match (at.side, &self.lights.environment) {
            (side, _) if side < LIGHT => self.light_density(side),
            (ESCAPED, Some((sky, light))) => sky.pdf(-at.omega) * self.lights.probability(*light),
            (ESCAPED, None) => 0.0,
            (side, _) => self.lights.probability(side - LIGHT),
        }
    }

    /// Centre of a sphere around the shapes.
    pub(crate) fn center(&self) -> Vec3 {
        self.center
    }

    /// Its radius, metres.
    pub(crate) fn radius(&self) -> f32 {
        self.radius
    }

    /// The same where it is a sphere that is sampled by solid angle.
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
