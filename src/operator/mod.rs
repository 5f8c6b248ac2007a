//! The transport operator T in three realisations.
//!
//! | realisation | T is | place |
//! |---|---|---|
//! | continuous | light transport along rays in a scene; it can be sampled | [`scene_transport`] |
//! | discrete | a matrix over patches, diag(ρ) F; it can be applied to a vector | [`patches`]; [`form_factor`] and [`matrix`], or stored [`rays`] |
//! | walk | a random walk on that matrix; it can be sampled, and its exact result is known | [`matrix_walk`] |
//!
//! The trait [`Transport`] samples T; [`Kernel`] returns the factors of each sample separately. The trait
//! [`matrix::LinearOperator`] applies T to a vector; [`algebra`] combines such operators.

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
mod scene_view;
mod scene_waves;
pub mod surface_strip;
pub mod transport;

pub use adjoint::{Adjoint, Role, Steps};
pub use kernel::{Factors, Kernel};
pub use matrix_walk::MatrixWalk;
pub use scene_transport::SceneTransport;
pub use surface_strip::SurfaceStrip;
pub use transport::{Samples, Seen, Sensor, Step, Transport, Wave};
