//! Figures with axes: an axis places values, a panel is a frame with two of them on a canvas, and `figure` makes the SVG,
//! with the command, the seed and the scene below.

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
