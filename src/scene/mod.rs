//! What exists.

pub mod builtin;
pub mod description;
mod error;
pub mod load;
pub mod primitive;

pub use description::Description;
pub use error::SceneError;
pub use primitive::Primitive;
