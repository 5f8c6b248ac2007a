//! Images in linear colour, used for textures and skies.
//!
//! `L(u, v) = Σ b(uw − ½ − i) b((1 − v)h − ½ − j) t[i mod w, j mod h]`, b(x) = max(0, 1 − |x|)
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | t\[i, j\] | column i, row j; row 0 on top | [`Raster::texel`] |
//! | w, h | width and height | [`Raster::size`] |
//! | u, v | position from the bottom left corner; texel centres are at half-integers of uw and vh | [`Raster::bilinear`] |

use crate::math::{Rgb, fnv1a};
use glam::DVec3;
use std::fmt;

/// An image of linear Rec. 709 texels, row 0 on top.
#[derive(Clone, PartialEq)]
pub struct Raster {
    /// Width and height, both at least 1.
    pub size: [u32; 2],
    /// The texels, row by row.
    pub texels: Vec<Rgb>,
}

/// Prints the size and a hash of the texels, so that equal images have equal text.
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

    /// Bilinear interpolation between texel centres; the image repeats in both directions.
    pub fn bilinear(&self, uv: [f32; 2]) -> Rgb {
        let ([left, right], across) = neighbours(uv[0] - uv[0].floor(), self.size[0]);
        let ([top, bottom], down) = neighbours(1.0 - (uv[1] - uv[1].floor()), self.size[1]);
        let mix = |a: Rgb, b: Rgb, t: f32| a + (b - a) * t;
        let row = |j| mix(self.texel(left, j), self.texel(right, j), across);
        mix(row(top), row(bottom), down)
    }

    /// Mean of the texels, which equals the integral of [`Self::bilinear`] over the unit square.
    pub fn mean(&self) -> DVec3 {
        self.texels.iter().map(|t| t.as_dvec3()).sum::<DVec3>() / self.texels.len() as f64
    }
}

/// The two texels whose centres lie on both sides of x in [0, 1], and the position of x between the first and the second, in
/// [0, 1).
fn neighbours(x: f32, n: u32) -> ([u32; 2], f32) {
    let at = x * n as f32 - 0.5;
    let first = at.floor();
    let wrapped = |i: i64| i.rem_euclid(i64::from(n)) as u32;
    ([wrapped(first as i64), wrapped(first as i64 + 1)], at - first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A test image of 2 × 2 texels: 1 and 2 in the upper row, 3 and 4 in the lower.
    fn four() -> Raster {
        Raster::new([2, 2], [1.0, 2.0, 3.0, 4.0].map(Vec3::splat).to_vec())
    }

    #[test]
    fn centres_are_texels_and_edges_wrap() {
        let r = four();
        let at = |u: f32, v: f32| r.bilinear([u, v]).x;
        assert_eq!([at(0.25, 0.75), at(0.75, 0.75), at(0.25, 0.25), at(0.75, 0.25)], [1.0, 2.0, 3.0, 4.0]);
        assert_eq!([at(0.5, 0.75), at(0.25, 0.5), at(0.5, 0.5)], [1.5, 2.0, 2.5]);
        // the corner is the middle of all four texels, in every copy of the image
        assert_eq!([at(0.0, 0.0), at(1.0, 1.0), at(-3.0, 5.0)], [2.5; 3]);
        // three quarters of the last column and one quarter of the first
        assert_eq!([at(0.875, 0.75), at(-0.125, 0.75), at(0.25, 1.125)], [1.75, 1.75, 2.5]);
        assert_eq!([at(1.25, -0.25), at(-0.75, 1.75)], [1.0; 2]);
    }

    #[test]
    fn interpolation_keeps_constants_bounds_and_the_mean() {
        let one = Raster::new([1, 1], vec![Vec3::new(0.1, 0.7, 3.3)]);
        let r = four();
        let n = 64;
        let mut sum = DVec3::ZERO;
        for i in 0..n * n {
            let uv = [((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32];
            assert_eq!(one.bilinear(uv), one.texels[0]);
            let x = r.bilinear(uv);
            assert!((1.0..=4.0).contains(&x.x));
            sum += x.as_dvec3();
        }
        assert_eq!(sum / f64::from(n * n), r.mean());
        assert_eq!(r.mean(), DVec3::splat(2.5));
        // a number whose fractional part rounds to 1
        assert!(r.bilinear([-1e-9, -1e-9]).is_finite());
    }
}
