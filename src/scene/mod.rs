//! What exists.

pub mod description;
mod error;
pub mod primitive;

pub use description::Description;
pub use error::SceneError;
pub use primitive::Primitive;
