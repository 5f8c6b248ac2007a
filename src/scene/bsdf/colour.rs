//! The colour of a surface: one colour everywhere, or an image.

use crate::math::Rgb;
use crate::scene::raster::Raster;
use glam::DVec3;
use std::sync::Arc;

/// A colour that is the same everywhere or comes from an image.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// The same colour everywhere.
    Uniform(DVec3),
    /// An image, interpolated bilinearly and repeated; the uv origin is at the bottom left.
    Texture(Arc<Raster>),
}

impl Colour {
    /// Returns true if the colour comes from an image.
    pub fn is_texture(&self) -> bool {
        matches!(self, Self::Texture(_))
    }

    /// The colour, or the mean colour of the image.
    pub fn mean(&self) -> DVec3 {
        match self {
            Self::Uniform(c) => *c,
            Self::Texture(image) => image.mean(),
        }
    }

    /// The colour; white for an image, whose colour at a point is set later.
    pub(super) fn uniform(&self) -> Rgb {
        match self {
            Self::Uniform(c) => c.as_vec3(),
            Self::Texture(_) => Rgb::ONE,
        }
    }

    /// The colour as text for the user.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Uniform(c) => rgb(*c),
            Self::Texture(image) => format!("image {}×{}", image.size[0], image.size[1]),
        }
    }
}

/// Three numbers as text, with three decimals.
pub(super) fn rgb(c: DVec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", c.x, c.y, c.z)
}
