//! The ways to solve a scene: each takes it through one realisation of T, from paths or patches to a
//! [`Series`](crate::terms::Series) with images.
//!
//! | engine | what is computed | place |
//! |---|---|---|
//! | by rays | every `T^k E` by its own estimator; Σ T^k E by the path tracer | [`by_rays::terms`], [`by_rays::path`] |
//! | guided | both, with a matrix as a guide | [`guided`] |
//! | by matrix | `T_h^k E` and the solve, through the same camera | [`by_matrix::radiosity`] |
//! | batches | by rays, a little at a time, for what is watched while it grows | [`batches::Side`] |
//!
//! All are told how by [`Settings`]. What can be said of a scene before any of them runs is [`known`].

pub mod batches;
pub mod by_matrix;
pub mod by_rays;
pub mod discretisation;
mod estimator;
pub mod guided;
pub mod known;
mod matrix_error;
mod options;
pub mod radius;
mod settings;
mod unlit;

pub use settings::Settings;
