//! What T is: one symbol, three realisations.
//!
//! | world | T is | place |
//! |---|---|---|
//! | continuous | rays in a scene: can be sampled | [`scene_transport`] |
//! | discrete | a matrix over patches, diag(ρ) F: can be applied | [`patches`]; [`form_factor`] and [`matrix`], or stored [`rays`] |
//! | walk | a random walk on that matrix: can be sampled, and is known exactly | [`matrix_walk`] |
//!
//! Sampling is the trait [`Transport`], with its factors apart [`Kernel`]; applying is [`matrix::LinearOperator`], and [`algebra`] combines what can be applied.

pub mod adjoint;
pub mod algebra;
pub mod edges;
pub mod form_factor;
pub mod kernel;
pub mod matrix;
pub mod matrix_walk;
pub mod modes;
pub mod patches;
pub mod rays;
mod scene_adjoint;
mod scene_kernel;
pub mod scene_transport;
pub mod surface_strip;
pub mod transport;

pub use adjoint::{Adjoint, Role};
pub use kernel::{Factors, Kernel};
pub use matrix_walk::MatrixWalk;
pub use scene_transport::SceneTransport;
pub use surface_strip::SurfaceStrip;
pub use transport::{Samples, Seen, Sensor, Step, Transport, Wave};
