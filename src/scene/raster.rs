//! An image as numbers: textures and skies.

use crate::math::{Rgb, fnv1a};
use std::fmt;

/// Linear Rec. 709 texels, row 0 on top.
#[derive(Clone, PartialEq)]
pub struct Raster {
    /// Width and height, both at least 1.
    pub size: [u32; 2],
    /// Row by row.
    pub texels: Vec<Rgb>,
}

/// Size and a hash of the texels: equal images have equal text.
impl fmt::Debug for Raster {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.texels.iter().flat_map(|t| t.to_array()).flat_map(|x| x.to_bits().to_le_bytes());
        write!(f, "Raster({}×{}, {:016x})", self.size[0], self.size[1], fnv1a(bytes))
    }
}

impl Raster {
    /// An image; `texels` has one entry per pixel.
    ///
    /// # Panics
    /// If the number of texels is not width × height, or is 0.
    pub fn new(size: [u32; 2], texels: Vec<Rgb>) -> Self {
        assert!(texels.len() == size[0] as usize * size[1] as usize && !texels.is_empty(), "{size:?}");
        Self { size, texels }
    }

    /// The texel in this column and row.
    pub fn texel(&self, column: u32, row: u32) -> Rgb {
        self.texels[(row * self.size[0] + column) as usize]
    }

    pub fn bilinear(&self, _uv: [f32; 2]) -> Rgb { self.texels[0] }
}
