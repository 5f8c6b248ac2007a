//! A sensor that covers all surfaces of a scene: the mean of its image of T^k E is ‖T^k E‖₁.

use super::scene_transport::SceneTransport;
use super::transport::Sensor;
use crate::math::Rng;
use crate::scene::{SurfaceSensor, Vertex};

/// The surface sensor as a row of equal pixels. Every pixel samples the whole surface; with more pixels, more threads can
/// work.
pub struct SurfaceStrip {
    /// The sensor that samples points on all surfaces.
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
