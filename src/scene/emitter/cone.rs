//! stub
use glam::Vec3;
pub fn sample(_from: Vec3, _center: Vec3, _radius: f32, _u: [f32; 2]) -> Option<(Vec3, f32)> { None }
pub fn pdf(_from: Vec3, _center: Vec3, _radius: f32) -> f32 { 0.0 }
