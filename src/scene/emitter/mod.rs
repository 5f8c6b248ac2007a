//! Lights: choice of a light, choice of a point on it, and the densities.
//!
//! A light is an emitting shape, a point light, a directional light, or the sky. An emitting mesh is one light, with points
//! uniform over the area of its triangles.
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | P_i | probability of choosing light i: 1/n, or Φ_i/ΣΦ | [`Selection`] |
//! | p_A = P_i/A_i | density of a point on a surface, m⁻² | `Lights::density` |
//! | p_ω | density in solid angle at the receiver: p_A r²/cos θ_y; for a sphere P_i over its solid angle ([`cone`]) | `LightSample::pdf` |
//! | Φ | power, W: π A L for a surface, 4π I for a point, π R² H for a direction, 4π² R² L̄ for the sky (R the radius of the scene) | `power` |
//!
//! For the choice of a light, powers are compared by luminance. References: Shirley, Wang, Zimmerman, *Monte Carlo
//! Techniques for Direct Lighting Calculations* (1996); Pharr, Jakob, Humphreys, *Physically Based Rendering* (4th ed.
//! 2023), ch. 12.

pub mod cone;
pub mod environment;
mod mirror_ball;

use super::description::{Description, LightDescription};
use super::primitive::Primitive;
use crate::math::{Rgb, luminance};
use environment::Environment;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Rule by which next-event estimation chooses a light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// Every light with the same probability.
    #[default]
    Uniform,
    /// Each light with a probability in proportion to its power.
    Power,
}

impl std::fmt::Display for Selection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Uniform { "uniform" } else { "power" })
    }
}

/// One light, prepared for sampling.
#[derive(Clone, Debug)]
pub(crate) enum Light {
    /// An emitting surface: its primitives, and the cumulative fractions of its area, ending in 1.
    Surface { prims: Vec<u32>, cdf: Vec<f32> },
    /// A whole sphere that emits outwards. Its points are sampled uniformly in the solid angle that they fill from the shaded point.
    Ball { prim: u32, center: DVec3, radius: f64 },
    /// A point light; intensity in W/sr.
    Point { position: Vec3, intensity: Rgb },
    /// Parallel light along a unit direction; irradiance in W/m².
    Directional { direction: Vec3, irradiance: Rgb },
    /// The sky.
    Environment,
}

/// A light as a row of numbers, from which waves fill SIMD lanes. What a kind does not need is zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    /// One bit, see [`kind`].
    pub(crate) kind: u32,
    /// P_i.
    pub(crate) probability: f32,
    /// Position of a point light, or unit direction towards parallel light.
    pub(crate) at: Vec3,
    /// What [`Scene::light`](super::Scene::light) returns for its points; zero for an image of the sky.
    pub(crate) radiance: Rgb,
    /// Density of a constant sky, sr⁻¹.
    pub(crate) density: f32,
    /// Primitive, centre and radius of a sphere.
    pub(crate) prim: u32,
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

/// Kinds of lights as bits of a set.
pub(crate) mod kind {
    /// A point light.
    pub(crate) const POINT: u32 = 1;
    /// Parallel light.
    pub(crate) const PARALLEL: u32 = 2;
    /// A constant sky.
    pub(crate) const SKY: u32 = 4;
    /// A sky with an image.
    pub(crate) const IMAGE: u32 = 8;
    /// A whole sphere.
    pub(crate) const BALL: u32 = 16;
    /// Any other surface.
    pub(crate) const SURFACE: u32 = 32;
    /// Lights that a ray can hit.
    pub(crate) const HITTABLE: u32 = SKY | IMAGE | BALL | SURFACE;
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    pub(crate) lights: Vec<Light>,
    power: Vec<f64>,
    selection: Selection,
    /// P_i of every light, and their cumulative sums `cdf`.
    probability: Vec<f64>,
    cdf: Vec<f32>,
    /// For every primitive the number of its light.
    of_prim: Vec<u32>,
    /// Area of every light, m²; 0 for a light without a surface.
    area: Vec<f64>,
    /// For every primitive p_A, m⁻²; 0 if it does not emit.
    pub(crate) density: Vec<f32>,
    /// The sky, and its number among the lights.
    pub(crate) environment: Option<(Environment, u32)>,
    /// Radiance of each light with a surface.
    emission: Vec<Rgb>,
    /// Every light as numbers.
    rows: Vec<Row>,
}

const NONE: u32 = u32::MAX;

impl Lights {
    /// Collects the lights of a description. `radius` is the radius of the scene, for the power of distant lights.
    pub(crate) fn new(description: &Description, prims: &[(usize, Primitive)], radius: f64) -> Self {
        let mut all = Self { of_prim: vec![NONE; prims.len()], ..Self::default() };
        for (s, shape) in description.shapes.iter().enumerate() {
            if shape.emission.max_element() <= 0.0 {
                continue;
            }
            // primitives are listed shape by shape
            let [from, to] = [s, s + 1].map(|s| prims.partition_point(|p| p.0 < s));
            let mine: Vec<u32> = (from as u32..to as u32).collect();
            mine.iter().for_each(|&i| all.of_prim[i as usize] = all.lights.len() as u32);
            let area: f64 = mine.iter().map(|&i| prims[i as usize].1.area()).sum();
            let mut up_to = 0.0;
            let cdf = mine.iter().map(|&i| {
                up_to += prims[i as usize].1.area() / area;
                up_to as f32
            });
            let light = match mine.first().map(|&i| (i, prims[i as usize].1)) {
                Some((prim, Primitive::Sphere { center, radius, z: [-1.0, 1.0], inward: false })) => {
                    Light::Ball { prim, center, radius }
                }
                _ => Light::Surface { cdf: cdf.collect(), prims: mine },
            };
            all.emission.push(shape.emission.as_vec3());
            all.push(light, PI * area * luminance(shape.emission), area);
        }
        for light in &description.lights {
            match light {
                LightDescription::Point { position, intensity } => {
                    let light = Light::Point { position: position.as_vec3(), intensity: intensity.as_vec3() };
                    all.push(light, 4.0 * PI * luminance(*intensity), 0.0);
                }
                LightDescription::Directional { direction, irradiance } => {
                    let direction = direction.normalize().as_vec3();
                    let light = Light::Directional { direction, irradiance: irradiance.as_vec3() };
                    all.push(light, PI * radius * radius * luminance(*irradiance), 0.0);
                }
                LightDescription::Environment { sky, rotate, scale } => {
                    let sky = Environment::new(sky, *rotate, *scale);
                    let power = 4.0 * PI * PI * radius * radius * luminance(sky.mean());
                    all.environment = Some((sky, all.lights.len() as u32));
                    all.push(Light::Environment, power, 0.0);
                }
            }
        }
        all.select(Selection::Uniform);
        all
    }

    fn push(&mut self, light: Light, power: f64, area: f64) {
        self.lights.push(light);
        self.power.push(power);
        self.area.push(area);
    }

    /// Sets the rule by which lights are chosen.
    pub(crate) fn select(&mut self, selection: Selection) {
        let (n, total) = (self.lights.len() as f64, self.power.iter().sum::<f64>());
        let uniform = selection == Selection::Uniform || total <= 0.0;
        self.selection = selection;
        self.probability = self.power.iter().map(|p| if uniform { 1.0 / n } else { p / total }).collect();
        let sums = self.probability.iter().scan(0.0, |sum, p| {
            *sum += p;
            Some(*sum as f32)
        });
        self.cdf = sums.collect();
        // rounding must not let the largest number choose a light without power
        if let Some(last) = self.probability.iter().rposition(|&p| p > 0.0) {
            self.cdf[last..].fill(1.0);
        }
        let density = |&light: &u32| match light {
            NONE => 0.0,
            i if uniform => (1.0 / (n * self.area[i as usize])) as f32,
            i => (self.probability[i as usize] / self.area[i as usize]) as f32,
        };
        self.density = self.of_prim.iter().map(density).collect();
        self.rows = (0..self.lights.len()).map(|i| self.as_numbers(i)).collect();
    }

    fn as_numbers(&self, i: usize) -> Row {
        let row = Row { probability: self.probability(i as u32), ..Row::default() };
        let sky = self.environment.as_ref().and_then(|(sky, _)| sky.constant());
        match (&self.lights[i], sky) {
            (Light::Surface { .. }, _) => Row { kind: kind::SURFACE, radiance: self.emission[i], ..row },
            (&Light::Ball { prim, center, radius }, _) => {
                Row { kind: kind::BALL, radiance: self.emission[i], prim, center, radius, ..row }
            }
            (&Light::Point { position, intensity }, _) => {
                Row { kind: kind::POINT, at: position, radiance: intensity, ..row }
            }
            (&Light::Directional { direction, irradiance }, _) => {
                Row { kind: kind::PARALLEL, at: -direction, radiance: irradiance, ..row }
            }
            (Light::Environment, Some((radiance, density))) => Row { kind: kind::SKY, radiance, density, ..row },
            (Light::Environment, None) => Row { kind: kind::IMAGE, ..row },
        }
    }

    /// A light as numbers.
    #[inline(always)]
    pub(crate) fn row(&self, light: u32) -> &Row {
        &self.rows[light as usize]
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Returns true if there is no light.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// P_i: the probability of choosing a light.
    #[inline(always)]
    pub(crate) fn probability(&self, light: u32) -> f32 {
        self.probability[light as usize] as f32
    }

    /// Power of each light, W, as luminance.
    pub fn powers(&self) -> &[f64] {
        &self.power
    }

    /// Returns true if some light has no area, so that no ray can hit it.
    pub fn any_delta(&self) -> bool {
        self.lights.iter().any(|l| matches!(l, Light::Point { .. } | Light::Directional { .. }))
    }

    /// Returns true if no light has an area.
    pub fn all_delta(&self) -> bool {
        self.lights.iter().all(|l| matches!(l, Light::Point { .. } | Light::Directional { .. }))
    }

    /// Returns true if all lights are chosen with the same probability.
    #[inline(always)]
    pub(crate) fn alike(&self) -> bool {
        self.selection == Selection::Uniform
    }

    /// The number of the light to which a primitive belongs; `None` if it does not emit.
    #[inline(always)]
    pub(crate) fn of_primitive(&self, prim: u32) -> Option<u32> {
        Some(self.of_prim[prim as usize]).filter(|&light| light != NONE)
    }

    /// The emitting primitive, if there is exactly one and nothing else emits.
    pub(crate) fn only(&self) -> Option<u32> {
        match self.lights.as_slice() {
            [Light::Surface { prims, .. }] if prims.len() == 1 => Some(prims[0]),
            _ => None,
        }
    }

    /// Centre, radius and P_i of a sphere light, if the primitive is one.
    #[inline(always)]
    pub(crate) fn ball(&self, prim: u32) -> Option<(DVec3, f64, f32)> {
        let light = self.of_prim[prim as usize];
        match self.lights.get(light as usize) {
            Some(&Light::Ball { center, radius, .. }) => Some((center, radius, self.probability(light))),
            _ => None,
        }
    }

    /// The number of the light that the uniform number u chooses.
    #[inline(always)]
    pub(crate) fn choose(&self, u: f32) -> u32 {
        let n = self.lights.len();
        let i = match self.selection {
            Selection::Uniform => (u * n as f32) as usize,
            Selection::Power => self.cdf.partition_point(|&c| c <= u),
        };
        i.min(n - 1) as u32
    }

    /// The primitive of a light that the uniform number u chooses; `None` if the light has no surface.
    #[inline(always)]
    pub(crate) fn primitive(&self, light: u32, u: f32) -> Option<u32> {
        match &self.lights[light as usize] {
            Light::Surface { prims, cdf } => {
                let i = if prims.len() == 1 { 0 } else { cdf.partition_point(|&c| c <= u) };
                Some(prims[i.min(prims.len() - 1)])
            }
            Light::Ball { prim, .. } => Some(*prim),
            _ => None,
        }
    }
}
