//! A tree of boxes with eight children per node: one ray against eight boxes or eight triangles at once.
//!
//! | what | file |
//! |---|---|
//! | operations on lanes, and the choice of the instruction set | `lanes` |
//! | a node: eight boxes | `node` |
//! | the leaves: up to eight triangles each | `leaves` |
//! | how a ray goes through the tree | `tree` |
//! | how two rays take turns | `two` |
//! | building | `build` |
//!
//! Shapes that are not triangles are leaves of their own, tested by [`Shape::meet`](super::shape::Shape::meet).

mod build;
mod lanes;
mod leaves;
mod node;
mod tree;
mod two;

pub(crate) use lanes::{InstructionSet, Lanes, Task};
pub(crate) use leaves::MOST_TRIANGLES;
pub(crate) use node::{ROUNDING, reciprocal};
pub(crate) use tree::{Closest, Occluded, Wide, behind};
