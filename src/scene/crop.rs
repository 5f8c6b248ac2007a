//! A rectangle of a picture: only its pixels are rendered, and they have the bits that they have in the whole picture.
//!
//! ```text
//! pixel (x, y) of the rectangle = pixel (x₀ + x, y₀ + y) of the picture, with number (y₀ + y)·W + x₀ + x
//! ```
//!
//! Random numbers belong to the number of a pixel in the picture, so they do not depend on the rectangle.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | (x₀, y₀) | pixel at the top left | [`Crop::from`] |
//! | W | width of the picture | argument |

use std::ops::Range;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The pixel of the picture at its top left corner.
    pub from: [u32; 2],
    /// Its width and height in pixels.
    pub size: [u32; 2],
}

impl Crop {
    /// All of a picture.
    pub fn whole(size: [u32; 2]) -> Self {
        Self { from: [0, 0], size }
    }

    /// Translates a range of the rectangle's pixel numbers into those of a picture of width `width`. For each row: the first number in the
    /// rectangle, and the range in the picture.
    ///
    /// ```
    /// use fredholm::scene::Crop;
    /// let crop = Crop { from: [2, 1], size: [3, 2] };
    /// assert_eq!(crop.rows(1..5, 10).collect::<Vec<_>>(), [(1, 13..15), (3, 22..24)]);
    /// ```
    pub fn rows(self, own: Range<u32>, width: u32) -> impl Iterator<Item = (u32, Range<u32>)> {
        let ([x, y], [w, _]) = (self.from, self.size);
        // neighbouring rows of the picture are one row of numbers
        let w = if w == width { u32::MAX } else { w };
        let mut next = own.start;
        std::iter::from_fn(move || {
            let (row, column) = (next / w, next % w);
            let n = (w - column).min(own.end.checked_sub(next).filter(|n| *n > 0)?);
            let (start, number) = (next, (y + row) * width + x + column);
            next += n;
            Some((start, number..number + n))
        })
    }
}
