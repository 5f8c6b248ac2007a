//! The data of a figure: points with errors, curves, and their colours and marks.
//!
//! The colours are those of Okabe and Ito (2008), which readers with a colour-vision deficiency can distinguish. The marks
//! also differ in shape.

use plotters::prelude::RGBColor;

use crate::report::half_width_95;

/// A value with its error at one position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Bounce k, or samples per pixel.
    pub x: f64,
    /// The value; if NaN, no mark is drawn.
    pub value: f64,
    /// Standard error of `value`; NaN if not known (no bar).
    pub std_error: f64,
    /// Number of replicates: 0 for an exact value, 1 if the error is unknown (no bar).
    pub replicates: u64,
}

impl Point {
    /// A value without error.
    pub fn exact(x: f64, value: f64) -> Self {
        Self { x, value, std_error: 0.0, replicates: 0 }
    }

    /// Half width of the 95 % interval; 0 where the error is not known.
    pub(crate) fn half_width(&self) -> f64 {
        let half = half_width_95(self.std_error, self.replicates);
        if half.is_nan() { 0.0 } else { half }
    }
}

/// The points of one curve, with its label and appearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Text in the legend.
    pub label: String,
    /// Its points.
    pub points: Vec<Point>,
    /// Its colour and mark.
    pub look: Look,
}

/// Colour and mark of a curve. The same estimator has the same appearance in every figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Colour.
    pub color: RGBColor,
    /// Mark.
    pub mark: Mark,
}

/// Shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A filled circle.
    Disk,
    /// A square.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle.
    Triangle,
    /// An open circle.
    Ring,
    /// A cross.
    Cross,
}

/// Black.
pub const BLACK: RGBColor = RGBColor(0, 0, 0);
/// Grey for notes and guide lines.
pub const GREY: RGBColor = RGBColor(85, 85, 85);
/// Light grey of grid lines.
pub const GRID: RGBColor = RGBColor(222, 222, 222);
/// Lighter grey of minor grid lines.
pub const FAINT: RGBColor = RGBColor(240, 240, 240);
/// Orange.
pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
/// Sky blue.
pub const SKY: RGBColor = RGBColor(86, 180, 233);
/// Bluish green.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Blue.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Vermilion.
pub const VERMILION: RGBColor = RGBColor(213, 94, 0);
/// Reddish purple.
pub const PURPLE: RGBColor = RGBColor(204, 121, 167);

impl Look {
    /// Monte Carlo, one estimator per term.
    pub const SINGLE: Self = Self { color: BLUE, mark: Mark::Disk };
    /// Monte Carlo, all terms from the prefixes of one path.
    pub const PREFIX: Self = Self { color: VERMILION, mark: Mark::Square };
    /// The radiosity matrix.
    pub const MATRIX: Self = Self { color: BLACK, mark: Mark::Ring };

    /// The mark of a second quantity on the same axes.
    pub(crate) const CROSS: Mark = Mark::Cross;

    /// Appearance of the i-th curve, for any number of curves, as in a sweep.
    pub fn nth(i: usize) -> Self {
        let colors = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK];
        let marks = [Mark::Disk, Mark::Square, Mark::Diamond, Mark::Triangle, Mark::Ring, Mark::Cross];
        Self { color: colors[i % colors.len()], mark: marks[i % marks.len()] }
    }
}
