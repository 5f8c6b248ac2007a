//! Results: estimates of the terms `T^k E`, in the same types for every [`World`] (a way to compute the terms).
//!
//! | notation | type | place |
//! |---|---|---|
//! | sum of the samples, by replicate | [`TermFilm`] | [`film`] |
//! | parts that are rendered apart | [`Part`] | [`part`] |
//! | what is remembered of the passes of a render | [`history::History`] | [`history`] |
//! | image of T^k E with its standard error | [`TermImage`] | [`image`] |
//! | φ(T^k E), a linear functional of the image | [`Functional`] | [`functional`] |
//! | sums over 16 × 16 tiles, replicate by replicate | [`TileSums`] | [`tile_sums`] |
//! | ‖T^k E‖₂ of the image | [`norms::SquaredNorm`] | [`norms`] |
//! | the largest contributions, and the index of their tail | [`largest::Largest`] | [`largest`] |
//! | all of these in one pass over a film | [`statistics::Statistics`] | [`statistics`] |
//! | scatter of the replicates | [`scatter::Scatter`] | [`scatter`] |
//! | E\[Y_a Y_b\] over the slots of one path | [`CrossMoments`] | [`cross_moments`] |
//! | complete result of a world | [`Series`] | [`series`] |

pub mod covariance;
pub mod cross_moments;
mod deviations;
pub mod film;
pub mod functional;
pub mod history;
pub mod image;
pub mod largest;
pub mod norms;
pub mod part;
pub mod scatter;
pub mod series;
pub mod statistics;
pub mod tile_sums;
mod tiles;
pub mod variance;

pub use cross_moments::{CrossMoments, Recorded};
pub use film::{Shape, TermFilm};
pub use image::TermImage;
pub use part::Part;
pub use series::{Channel, Cost, Doubt, Estimate, Events, Functional, Series, UnsampledPaths, Variance, World};
pub use tile_sums::TileSums;
