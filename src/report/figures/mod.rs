//! Figures, tables and CSV files: one module per study.

pub mod bounces;
pub mod decay;
pub mod diagnosis;
pub mod drift;
pub mod equilibrium;
#[cfg(test)]
mod example;
pub mod extrapolation;
pub mod growth;
pub mod homework;
pub mod lit;
pub mod modes;
pub mod patches;
mod pictures;
pub mod pyramid;
mod rate;
pub mod refine;
pub mod roulette;
pub mod signature;
pub mod solvers;
pub mod split;
pub mod stages;
pub mod sweep;
pub mod variance;
pub mod walk;
pub mod watch;
