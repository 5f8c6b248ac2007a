//! Figures with axes: an axis places values, a panel is a frame with two of them on a canvas, and `figure` makes the SVG,
//! with the command, the seed and the scene below.
//!
//! The crate `plotters` (0.3.7) writes the SVG, element by element. Its charts are not used, because
//!
//! - its coordinates are `i32`, also in charts: bars and marks would be off by up to half a pixel, so that everything is drawn
//!   ten times too large anyway;
//! - a logarithmic axis has ticks at powers of ten only: within a decade it has none, or none with a round label;
//! - ends outside the axes are moved onto the frame one by one: a bound that leaves the frame is drawn with another slope;
//! - error bars have no arrow where the frame cuts them, and no upper limits where they reach zero on a logarithmic axis;
//! - legends stand inside the frame, over the data, in one line for each curve.
//!
//! What would be left to a chart is the frame and its grid, thirty lines of the panel, with ticks that are given to it.

mod axis;
mod canvas;
mod figure;
mod look;
mod panel;

pub use figure::Figure;
pub use look::{Curve, Look, Point};

pub(super) use axis::Axis;
pub(super) use canvas::{Canvas, Drawn, Entry, Place, Sample, Stroke, Words};
pub(super) use figure::figure;
pub(super) use look::{BLACK, BLUE, GREEN, GREY, Mark, ORANGE, PURPLE, SKY, VERMILION};
pub(super) use panel::Panel;
