//! Small shared mathematics: random numbers by address, directions, columns of vectors, convex polygons, and enum values by
//! name.
//!
//! Everything that runs per ray is plain scalar code marked `#[inline(always)]`. The same function serves a single path and,
//! inside a loop over SIMD lanes, a wave of paths, and both give the same bits.

#[cfg(test)]
pub(crate) mod chance;
pub mod columns;
pub mod direction;
pub mod distribution;
pub mod names;
mod pcg;
pub mod pick;
pub mod polygon;
pub mod random;
pub mod sobol;

pub use columns::Columns;
pub use random::{Key, Points, Purpose, Rng, Streams, fnv1a};

/// A radiance, reflectance or throughput in linear Rec. 709 colour, one `f32` per channel. Sums of such values are kept in
/// [`glam::DVec3`].
pub type Rgb = glam::Vec3;

/// The names of the colour channels.
pub const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Relative luminance of a linear colour (ITU-R BT.709).
pub fn luminance(c: glam::DVec3) -> f64 {
    c.dot(glam::DVec3::new(0.2126, 0.7152, 0.0722))
}
