//! One pass of a render.

use crate::math::Key;
use crate::terms::Part;

/// One pass: it brings every pixel of a part of the film to a number of samples.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub(super) key: Key,
    /// The number of samples that every pixel of the part shall have.
    pub(super) until: u32,
    pub(super) part: Part,
    /// True if the pass shall pause.
    pub(super) due: &'a (dyn Fn() -> bool + Sync),
}
