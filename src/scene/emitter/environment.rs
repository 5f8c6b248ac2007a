//! stub
use crate::math::Rgb;
use crate::scene::description::Sky;
use glam::{DVec3, Vec3};
#[derive(Clone, Debug)]
pub struct Environment(Rgb);
impl Environment {
    pub fn new(sky: &Sky, _rotate: f64, scale: f64) -> Self {
        Self(match sky { Sky::Constant(c) => (*c * scale).as_vec3(), _ => Rgb::ZERO })
    }
    pub fn radiance(&self, _d: Vec3) -> Rgb { self.0 }
    pub fn sample(&self, u: [f32; 2]) -> (Vec3, f32) {
        let z = 1.0 - 2.0 * u[0];
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (c, s) = crate::math::direction::cos_sin_turn(u[1]);
        (Vec3::new(r * c, r * s, z), self.pdf(Vec3::Z))
    }
    pub fn pdf(&self, _d: Vec3) -> f32 { 0.25 * std::f32::consts::FRAC_1_PI }
    pub fn mean(&self) -> DVec3 { self.0.as_dvec3() }
}
