//! What a ray met, in three bytes: rows are most of the memory of a mesh of a million patches.

/// The number of a patch, or [`Hit::NOTHING`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit([u8; 3]);

impl Hit {
    /// The ray left the scene, or met a side that takes no part. Sorts last.
    pub const NOTHING: Self = Self([u8::MAX; 3]);
    /// Patches have numbers below this.
    pub const MOST: usize = (1 << 24) - 1;

    /// The lower three bytes of `patch`.
    #[inline(always)]
    pub(super) fn new(patch: u32) -> Self {
        let [a, b, c, _] = patch.to_le_bytes();
        Self([a, b, c])
    }

    /// The number of the patch; [`Hit::MOST`] of nothing.
    #[inline(always)]
    pub fn patch(self) -> usize {
        let [a, b, c] = self.0;
        u32::from_le_bytes([a, b, c, 0]) as usize
    }
}
