//! The operator view of global illumination.

pub mod estimator;
pub mod math;
pub mod operator;
pub mod report;
pub mod scene;
pub mod solver;
pub mod stats;
pub mod terms;
pub mod worlds;
