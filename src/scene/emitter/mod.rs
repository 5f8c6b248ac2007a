//! Choosing a point on the lights: a light uniformly, then a point uniformly by area.
//!
//! `p_A = 1 / (number of lights · area of the light)`; the change to solid angle is in
//! [`connect`](crate::operator::scene_transport), and nowhere else.
//!
//! A light is a shape that emits; a mesh is one light, and its triangles share its area.

pub mod cone;
pub mod environment;
mod mirror_ball;

use super::description::Description;
use super::primitive::Primitive;

#[derive(Clone, Debug)]
struct Light {
    prims: Vec<u32>,
    /// Cumulative share of the light's area, ending in 1.
    cdf: Vec<f32>,
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    lights: Vec<Light>,
    /// p_A in m⁻² by primitive; 0 for what does not emit.
    pub(crate) density: Vec<f32>,
}

impl Lights {
    pub(crate) fn new(description: &Description, prims: &[(usize, Primitive)]) -> Self {
        let emits = |shape: usize| description.shapes[shape].emission.max_element() > 0.0;
        let mut lights = vec![];
        let mut areas = vec![];
        for shape in (0..description.shapes.len()).filter(|&s| emits(s)) {
            let mine: Vec<u32> = (0..prims.len()).filter(|&i| prims[i].0 == shape).map(|i| i as u32).collect();
            let area: f64 = mine.iter().map(|&i| prims[i as usize].1.area()).sum();
            let mut up_to = 0.0;
            let cdf = mine.iter().map(|&i| {
                up_to += prims[i as usize].1.area() / area;
                up_to as f32
            });
            let cdf = cdf.collect();
            lights.push(Light { prims: mine, cdf });
            areas.push(area);
        }
        let mut density = vec![0.0; prims.len()];
        for (light, area) in lights.iter().zip(&areas) {
            for &i in &light.prims {
                density[i as usize] = (1.0 / (lights.len() as f64 * area)) as f32;
            }
        }
        Self { lights, density }
    }

    /// Number of lights.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether nothing emits.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// The emitting primitive, if there is only one.
    pub(crate) fn only(&self) -> Option<u32> {
        match self.lights.as_slice() {
            [light] if light.prims.len() == 1 => Some(light.prims[0]),
            _ => None,
        }
    }

    /// The light and the primitive on it that two uniform numbers choose.
    #[inline(always)]
    pub(crate) fn choose(&self, u: [f32; 2]) -> u32 {
        let n = self.lights.len();
        let light = &self.lights[((u[0] * n as f32) as usize).min(n - 1)];
        let i = if light.prims.len() == 1 { 0 } else { light.cdf.partition_point(|&c| c <= u[1]) };
        light.prims[i.min(light.prims.len() - 1)]
    }
}
