//! Figures of the lecture that are rendered: sheets of pictures with their numbers.
//!
//! | file | figure |
//! |---|---|
//! | [`path_lengths`] | every term and every partial sum at one exposure |
//!
//! Shared: [`board`] places pictures and text on a slide, [`measure`] renders and measures.

use fredholm::report::book::Slide;

mod board;
mod measure;
mod path_lengths;

/// The figures, in the order of the lecture.
pub(crate) const SLIDES: &[Slide] = &[path_lengths::SLIDE];
