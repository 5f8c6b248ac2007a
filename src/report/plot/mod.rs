//! Figures with axes. An axis maps values to positions, a panel is a frame with two axes on a canvas, and `figure` makes the
//! SVG with command, seed and scene below. The parts are public: chapters and the figures of the lecture draw with them.
//!
//! The crate `plotters` (0.3.7) writes the SVG elements. Its charts are not used, for these reasons:
//!
//! - Its coordinates are `i32`, also in charts. Bars and marks would be off by up to half a pixel, so that everything would
//!   have to be drawn ten times too large anyway.
//! - Its logarithmic axes have ticks at powers of ten only. Within a decade there are none, or none with a round label.
//! - End points outside the axes are moved onto the frame one by one. A line that leaves the frame is then drawn with a
//!   wrong slope.
//! - Its error bars have no arrow where the frame cuts them, and no upper limits where they reach zero on a logarithmic
//!   axis.
//! - Its legends are inside the frame, where they cover data, with one line per curve.
//!
//! A chart would only draw the frame and its grid, which are thirty lines of the panel.

mod axis;
mod canvas;
mod chart;
mod figure;
mod look;
mod panel;

pub use axis::Axis;
pub use canvas::{Align, Canvas, Colour, Drawn, Entry, Place, Sample, Stroke, Words};
pub use chart::{Line, chart};
pub use figure::{Figure, figure};
pub use look::{BLACK, BLUE, Curve, FAINT, GREEN, GREY, GRID, Look, Mark, ORANGE, PURPLE, Point, SKY, VERMILION};
pub use panel::Panel;
