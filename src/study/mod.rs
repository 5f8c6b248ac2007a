//! Studies of a scene. Each one runs one or more [engines](crate::engine) and returns numbers with their errors. Commands,
//! chapters of the book and tests call the same functions.
//!
//! | study | question | place |
//! |---|---|---|
//! | run | what do the series, the path tracer and the matrix give for one scene, and do they agree? | [`run::Run`] |
//! | convergence | how fast do variance and squared error fall within one render? | [`convergence::Recorder`] |
//! | enumeration | is roulette unbiased, path by path? | [`enumeration::ends`] |
//! | split | how many samples should each term get? | [`split::study`] |
//! | roulette | how noisy and how expensive is each roulette schedule, and which is the best? | [`roulette::pilot`], [`roulette::optimal`] |
//! | strategies | which bidirectional strategy contributes how much to which term? | [`strategies::strategies`] |
//! | bounces | how many bounces are enough? | [`bounces::bounces`] |
//! | lit | which bounce lights which surface? | [`lit::lit`] |
//! | homework | what does every bounce, roulette and every number of samples look like? | [`homework::homework`] |
//! | surface | how large is ‖T^k E‖₁ over all surfaces, independent of the camera? | [`surface::norms`] |
//! | refinement | how fast does the matrix approach the truth on finer meshes? | [`refinement::refine`] |
//! | equilibrium | are the two sides of L = E + T L equal? | [`equilibrium`] |
//! | stages | how does one image look after more and more paths? | [`stages::render_stages`] |
//! | growth | how do time and memory grow with the size of the work? | [`growth::measure()`] |
//! | walk | do the estimators reproduce the powers of a matrix? | [`walk::walk`] |
//! | zero variance | how much variance does a guide remove? | [`zero_variance::study`] |

pub mod bounces;
pub mod convergence;
pub mod enumeration;
pub mod equilibrium;
pub mod growth;
pub mod homework;
pub mod lit;
pub mod refinement;
pub mod roulette;
pub mod run;
mod some_pixels;
pub mod split;
pub mod stages;
pub mod strategies;
mod strip;
pub mod surface;
pub mod walk;
pub mod zero_variance;
