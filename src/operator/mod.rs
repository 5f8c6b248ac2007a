//! What T is.

pub mod form_factor;
pub mod matrix;
pub mod patches;
