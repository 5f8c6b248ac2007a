//! A colour of a surface: one number per channel, or an image.

use crate::math::Rgb;
use crate::scene::raster::Raster;
use glam::DVec3;
use std::sync::Arc;

/// A colour, the same everywhere or from an image.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// One colour.
    Uniform(DVec3),
    /// Bilinear, repeating; the uv origin is at the bottom left.
    Texture(Arc<Raster>),
}

impl Colour {
    /// Whether an image says it.
    pub fn is_texture(&self) -> bool {
        matches!(self, Self::Texture(_))
    }

    /// The colour, or the mean of the image.
    pub fn mean(&self) -> DVec3 {
        match self {
            Self::Uniform(c) => *c,
            Self::Texture(image) => image.mean(),
        }
    }

    /// White where an image will tell.
    pub(super) fn uniform(&self) -> Rgb {
        match self {
            Self::Uniform(c) => c.as_vec3(),
            Self::Texture(_) => Rgb::ONE,
        }
    }

    /// In words.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Uniform(c) => rgb(*c),
            Self::Texture(image) => format!("image {}×{}", image.size[0], image.size[1]),
        }
    }
}

/// Three numbers in words.
pub(super) fn rgb(c: DVec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", c.x, c.y, c.z)
}
