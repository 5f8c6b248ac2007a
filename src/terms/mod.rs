//! What comes out: estimates of the terms `T^k E`, whichever world they come from.
//!
//! | notation | type | place |
//! |---|---|---|
//! | Σ over samples, by replicate | [`TermFilm`] | [`film`] |
//! | image of T^k E with its error | [`TermImage`] | [`image`] |
//! | φ(T^k E) | [`Functional`] | [`functional`] |
//! | ‖T^k E‖₂ of the image | [`norms::SquaredNorm`] | [`norms`] |
//! | the largest contributions, and how heavy their tail is | [`largest::Largest`] | [`largest`] |
//! | how replicates scatter | [`scatter::Scatter`] | [`scatter`] |
//! | E\[Y_a Y_b\] over the slots of one path | [`CrossMoments`] | [`cross_moments`] |
//! | everything a world returns | [`Series`] | [`series`] |

pub mod covariance;
pub mod cross_moments;
pub mod film;
pub mod functional;
pub mod image;
pub mod largest;
pub mod norms;
pub mod scatter;
pub mod series;
pub mod variance;

pub use cross_moments::{CrossMoments, Recorded};
pub use film::{Shape, TermFilm};
pub use image::TermImage;
pub use series::{Channel, Cost, Doubt, Estimate, Events, Functional, Series, UnsampledPaths, Variance, World};
