//! Parts of a film that are rendered apart, on other machines, and then put together to the bits of one render.
//!
//! ```text
//! paths add to their own pixel only     block b of pixels belongs to part b mod n
//! paths add to any pixel                replicate r belongs to part r mod n
//! ```
//!
//! A part of the first kind holds all samples of its pixels. A part of the second kind holds all pixels, but only the samples of
//! its replicates. Either way each sum of a film is made by one part alone, so that putting parts together adds nothing and rounds
//! nothing. Blocks are dealt out one by one, so that every part gets its share of a difficult region.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | number of parts | [`Part::of`] |
//! | b | block of 64 neighbouring pixels | [`Part::has`] |
//! | r | replicate | [`Part::has`] |

/// One of several parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Number of this part, from 0.
    pub index: u32,
    /// Number of parts.
    pub of: u32,
}

impl Part {
    /// The only part.
    pub const WHOLE: Self = Self { index: 0, of: 1 };

    /// True if block or replicate `i` belongs to this part.
    ///
    /// ```
    /// use fredholm::terms::Part;
    /// let second = Part { index: 1, of: 3 };
    /// assert_eq!((0..7).filter(|&i| second.has(i)).collect::<Vec<_>>(), [1, 4]);
    /// ```
    #[inline(always)]
    pub fn has(self, i: usize) -> bool {
        i % self.of as usize == self.index as usize
    }

    /// True if there is only this part.
    pub fn is_whole(self) -> bool {
        self.of == 1
    }
}

impl Default for Part {
    fn default() -> Self {
        Self::WHOLE
    }
}
