//! Deterministic L.
//!
//! ```text
//! (I − T) L = E        L = Σ_{k≥0} T^k E
//! ```

pub mod direct;
pub mod neumann;
mod radiosity;

pub use neumann::Neumann;
pub use radiosity::{Radiosity, Solution};
