//! What is found out about a scene with the [engines](crate::engine): data in, numbers with errors out, for a command, a chapter
//! and a test alike.
//!
//! | study | question | place |
//! |---|---|---|
//! | run | what do all the ways say of one scene, and of each other? | [`run::Run`] |
//! | convergence | how do variance and squared error fall in one render? | [`convergence::Recorder`] |
//! | split | how many samples for which term? | [`split::study`] |
//! | roulette | noise and cost of schedules, the best of them | [`roulette::pilot`], [`roulette::optimal`] |
//! | strategies | which way from both ends finds which term? | [`strategies::strategies`] |
//! | bounces | how many bounces are enough? | [`bounces::bounces`] |
//! | lit | which bounce lights which surface? | [`lit::lit`] |
//! | surface | ‖T^k E‖₁ over the whole scene, camera-free | [`surface::norms`] |
//! | refinement | how does the matrix come closer on finer meshes? | [`refinement::refine`] |
//! | equilibrium | are both sides of L = E + T L equal? | [`equilibrium`] |
//! | stages | how does an image grow? | [`stages::render_stages`] |
//! | walk | do the estimators find the powers of a matrix? | [`walk::walk`] |
//! | zero variance | how much does a guide help? | [`zero_variance::study`] |

pub mod bounces;
pub mod convergence;
pub mod equilibrium;
pub mod lit;
pub mod refinement;
pub mod roulette;
pub mod run;
pub mod split;
pub mod stages;
pub mod strategies;
pub mod surface;
pub mod walk;
pub mod zero_variance;
