//! Some pixels of an image: enough for a mean over pixels, at the cost of 256.

use fredholm::math::Rng;
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::scene::{Camera, Vertex};

/// 16 × 16 pixels, spread evenly over the image of a camera.
pub(super) struct SomePixels<'a>(pub(super) &'a Camera);

impl Sensor<SceneTransport<'_>> for SomePixels<'_> {
    fn size(&self) -> [u32; 2] {
        [16, 16]
    }
    fn start(&self, t: &SceneTransport<'_>, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        let [width, height] = self.0.size;
        let [x, y] = [(pixel % 16, width), (pixel / 16, height)].map(|(i, n)| (2 * i + 1) * n / 32);
        self.0.start(t, y * width + x, rng)
    }
}
