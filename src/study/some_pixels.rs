//! Some pixels of a picture instead of all of them, for means over the picture that need several samples of each pixel.
//!
//! ```text
//! pixel i of n sees pixel ⌊(i + uᵢ) P/n⌋ of P        uᵢ uniform in [0, 1): every pixel is chosen with the same probability
//! ```

use crate::math::{Key, Purpose, Rng};
use crate::operator::{SceneTransport, Sensor};
use crate::scene::{Camera, Vertex};

/// A camera of which only some pixels are seen: one in each of as many parts of the picture, at random.
pub(super) struct SomePixels<'a> {
    pub(super) camera: &'a Camera,
    /// Their number.
    pub(super) pixels: u32,
    /// The random numbers that choose them.
    pub(super) key: Key,
}

impl Sensor<SceneTransport<'_>> for SomePixels<'_> {
    fn size(&self) -> [u32; 2] {
        [self.pixels, 1]
    }
    fn start(&self, t: &SceneTransport, pixel: u32, rng: &mut Rng) -> Option<Vertex> {
        let all = self.camera.size[0] * self.camera.size[1];
        let within = f64::from(Rng::at(self.key, pixel, 0, 0, Purpose::Start).one());
        let place = (f64::from(pixel) + within) * f64::from(all) / f64::from(self.pixels);
        self.camera.start(t, (place as u32).min(all - 1), rng)
    }
}
