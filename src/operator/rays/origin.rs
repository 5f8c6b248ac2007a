//! Origins of the rays of a patch, distributed uniformly on its uncovered part.
//!
//! ```text
//! x = polygon(u, v), lifted to the true surface; points under something are left out and the sequence goes on
//! ```
//!
//! For a piece of a sphere, the flat facet is sampled uniformly. Its image on the sphere is uniform up to O(h²).

use crate::operator::patches::{Patch, Patches, SurfacePoint, polygon::uniform};

/// Samples origins one after the other.
pub(super) struct Origins<'a> {
    patches: &'a Patches,
    patch: &'a Patch,
    number: usize,
    /// True if a part of the patch is covered.
    partly: bool,
    next: u32,
}

/// After this number of consecutive covered points, the next point is used in any case. Its ray hits a black back and counts
/// as a ray that hit nothing.
const PATIENCE: u32 = 4096;

impl<'a> Origins<'a> {
    pub(super) fn new(patches: &'a Patches, number: usize) -> Self {
        let patch = &patches[number];
        let whole = patch.stretch * patch.flat_area;
        Self { patches, patch, number, partly: patch.area < whole * (1.0 - 1e-9), next: 0 }
    }

    /// The next origin, computed from the last two of four numbers, and the four numbers.
    pub(super) fn next(&mut self, numbers: impl Fn(u32) -> [f32; 4]) -> (SurfacePoint, [f32; 4]) {
        let first = self.next;
        loop {
            let four = numbers(self.next);
            self.next += 1;
            let at = self.patch.lift(uniform(&self.patch.polygon, four[2].into(), four[3].into()));
            let patience = self.next - first < PATIENCE;
            if !(self.partly && patience && self.patches.is_covered(self.number, at)) {
                return (at, four);
            }
        }
    }
}
