//! Engines: each solves a scene with one realisation of T, from paths or patches to a [`Series`](crate::terms::Series) with
//! images.
//!
//! | engine | result | place |
//! |---|---|---|
//! | by rays | every `T^k E` separately; Σ T^k E by the path tracer | [`by_rays::terms`], [`by_rays::path`] |
//! | pass by pass | callbacks between the passes; states that are kept, and taken up again | [`passes::Watch`], [`passes::Keep`] |
//! | guided | both, with a matrix as a guide for the directions of rays | [`guided`] |
//! | by matrix | `T_h^k E` and the solution of the linear system, through the same camera | [`by_matrix::radiosity`] |
//! | rows of stored rays, in parts | files that are put together | [`rows`] |
//! | batches | by rays in batches, for comparisons that are updated with every batch | [`batches::Side`] |
//! | timing | seconds per sample, from a short pilot | [`timing::seconds_per_sample`] |
//!
//! All engines read [`Settings`]. The module [`known`] examines a scene before any of them runs.

pub mod batches;
pub mod by_matrix;
pub mod by_rays;
pub mod discretisation;
mod estimator;
pub mod guided;
pub mod known;
mod matrix_error;
mod options;
pub mod passes;
pub mod radius;
pub mod rows;
mod sampled;
mod settings;
pub mod timing;
mod unlit;

pub use settings::{MOST_BOUNCES, Settings};
