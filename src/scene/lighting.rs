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
use super::groups::Vertices;
use super::shape::Shape;
use super::sixteen::{LANES, ZERO, ZERO3, get, put, store, store3};
use super::{ESCAPED, LIGHT, Rays, Scene, Vertex, connection, solid_angle};
use crate::math::Columns;
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
    fn by_area(&self, x: Vec3, prim: u32, u: [f32; 2]) -> LightSample {
        let shape = &self.accel.shapes[prim as usize];
        let p = shape.point(u);
        let n = shape.normal(p);
        let (to, r2, _, cos) = connection(x, Vec3::ZERO, p, n);
        let pdf = solid_angle(self.lights.density[prim as usize], r2, cos);
        LightSample { state: Vertex { p, n, omega: -to, side: 2 * prim }, to, pdf, can_be_hit: true }
    }

    /// [`Self::sample_light`] for the first `m` places of a sorted wave, from the random numbers `rays.u` of their paths. Writes
    /// by place: direction, density, position, normal and radiance to `rays.to`, `rays.t`, `rays.q`, `rays.m` and
    /// `rays.radiance`, and to `rays.prim` whether a ray can hit the light. The density is 0 where there is no light point.
    pub(crate) fn light_wave(&self, at: Vertices, rays: &mut Rays, m: usize) {
        if let Some(prim) = self.lights.only() {
            let density = self.lights.density[prim as usize];
            lamp_points(&self.accel.shapes[prim as usize], density, at.p, rays, m);
            rays.radiance.fill(m, self.emission(2 * prim));
            rays.prim[..m].fill(1);
            return;
        }
        for place in 0..m {
            let i = rays.order[place] as usize;
            let u = rays.u.each_ref().map(|u| u[i]);
            let Some(sample) = self.propose_light(&at.get(i), u) else {
                rays.t[place] = 0.0;
                continue;
            };
            rays.to.set(place, sample.to);
            rays.t[place] = sample.pdf;
            rays.q.set(place, sample.state.p);
            rays.m.set(place, sample.state.n);
            rays.radiance.set(place, self.light(&sample.state));
            rays.prim[place] = u32::from(sample.can_be_hit);
        }
    }

    fn sky_sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        self.lights.environment.as_ref().map_or((Vec3::Y, 0.0), |(sky, _)| sky.sample(u))
    }

    /// Density in solid angle with which [`Self::sample_light`] chooses the point `at` that a ray from `x` has hit; 0 if it
    /// cannot choose it.
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

/// Uniform points of a lamp of one primitive, for the first `m` places of a sorted wave with the points `x`, from the last two
/// columns of random numbers: direction, density per solid angle, position and normal, by place.
#[pulp::with_simd(lamp_points = pulp::Arch::new())]
#[inline(always)]
fn lamp_points_with_simd<'a, S: pulp::Simd>(
    _simd: S,
    shape: &'a Shape,
    density: f32,
    x: &'a Columns,
    rays: &'a mut Rays,
    m: usize,
) {
    // the kind is chosen here and not for each point, so that the loops inside have no branch
    match shape {
        Shape::Flat(s) => points(
            #[inline(always)]
            |u| (s.point(u), s.normal()),
            density,
            x,
            rays,
            m,
        ),
        other => points(
            #[inline(always)]
            |u| {
                let p = other.point(u);
                (p, other.normal(p))
            },
            density,
            x,
            rays,
            m,
        ),
    }
}

#[inline(always)]
fn points(point: impl Fn([f32; 2]) -> (Vec3, Vec3), density: f32, x: &Columns, rays: &mut Rays, m: usize) {
    for place in (0..m).step_by(LANES) {
        let (mut to, mut q, mut n, mut at) = (ZERO3, ZERO3, ZERO3, ZERO3);
        let (mut u, mut v, mut pdf) = (ZERO, ZERO, ZERO);
        for lane in 0..LANES.min(m - place) {
            let i = rays.order[place + lane] as usize;
            put(&mut at, lane, x.get(i));
            (u[lane], v[lane]) = (rays.u[2][i], rays.u[3][i]);
        }
        for lane in 0..LANES {
            let (p, normal) = point([u[lane], v[lane]]);
            let (d, r2, _, cos) = connection(get(&at, lane), Vec3::ZERO, p, normal);
            pdf[lane] = solid_angle(density, r2, cos);
            put(&mut to, lane, d);
            put(&mut q, lane, p);
            put(&mut n, lane, normal);
        }
        store3(&mut rays.to, place, &to);
        store3(&mut rays.q, place, &q);
        store3(&mut rays.m, place, &n);
        store(&mut rays.t, place, &pdf);
    }
}
