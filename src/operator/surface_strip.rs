//! All surfaces of a scene as a sensor: ‖T^k E‖₁ is its mean.

use super::scene_transport::SceneTransport;
use super::transport::Sensor;
use crate::math::Rng;
use crate::scene::{SurfaceSensor, Vertex};

/// The surface sensor drawn as a strip of equal pixels, each of them the whole surface: more pixels, more threads.
pub struct SurfaceStrip {
    /// What is seen.
    pub sensor: SurfaceSensor,
    /// Number of pixels.
    pub pixels: u32,
}

impl Sensor<SceneTransport<'_>> for SurfaceStrip {
    fn size(&self) -> [u32; 2] {
        [self.pixels, 1]
    }
    fn start(&self, t: &SceneTransport, _pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        Some(self.sensor.vertex(t.scene, rng))
    }
}
