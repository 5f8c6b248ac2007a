//! The patch that a ray hit, in three bytes, because the rows take most of the memory of a mesh of a million patches.

/// The number of a patch, or [`Hit::NOTHING`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hit([u8; 3]);

impl Hit {
    /// The ray left the scene or hit a side that takes no part in transport. This value sorts last.
    pub const NOTHING: Self = Self([u8::MAX; 3]);
    /// All patch numbers are below this number.
    pub const MOST: usize = (1 << 24) - 1;

    /// The hit of patch number `patch`; only the lower three bytes are stored.
    #[inline(always)]
    pub(super) fn new(patch: u32) -> Self {
        let [a, b, c, _] = patch.to_le_bytes();
        Self([a, b, c])
    }

    /// The three bytes in which it is stored, the lowest first.
    pub fn bytes(self) -> [u8; 3] {
        self.0
    }

    /// A hit from its bytes; `None` if that is no hit on a mesh of `n` patches.
    pub fn from_bytes(bytes: [u8; 3], n: usize) -> Option<Self> {
        let hit = Self(bytes);
        (hit == Self::NOTHING || hit.patch() < n).then_some(hit)
    }

    /// The number of the patch; [`Hit::MOST`] for [`Hit::NOTHING`].
    #[inline(always)]
    pub fn patch(self) -> usize {
        let [a, b, c] = self.0;
        u32::from_le_bytes([a, b, c, 0]) as usize
    }
}
