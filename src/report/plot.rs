//! Figures: drawn once as SVG, rasterised from the very same SVG.
//!
//! The plot crate rounds coordinates to whole pixels, so everything is drawn ten times too large and the size in the
//! header is rewritten. A panel places values itself and draws nothing whose place
//! is outside its frame: lines are clipped, points are left out, error bars end in an arrow head at the frame.
//!
//! Colours are those of Okabe and Ito (2008), told apart also by readers with a colour-vision deficiency; marks differ
//! in shape, too.

use std::path::{Path, PathBuf};

use plotters::prelude::{IntoDrawingArea, RGBColor, SVGBackend};

use super::{
    ReportError,
    canvas::{Canvas, Drawn, SCALE, Words},
    half_width_95,
    typeset::{self, Caption, LINE, MONO, SANS},
    write_atomically,
};

/// A value with its error at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Bounce k, or samples per pixel.
    pub x: f64,
    /// The value; NaN: no mark.
    pub value: f64,
    /// Standard error of `value`; NaN where it is not known (no bar).
    pub std_error: f64,
    /// Replicates behind it: 0 exact, 1 error unknown (no bar).
    pub replicates: u64,
}

impl Point {
    /// A value without error.
    pub fn exact(x: f64, value: f64) -> Self {
        Self { x, value, std_error: 0.0, replicates: 0 }
    }

    /// Half width of the 95 % interval; 0 where the error is not known.
    pub(super) fn half_width(&self) -> f64 {
        let half = half_width_95(self.std_error, self.replicates);
        if half.is_nan() { 0.0 } else { half }
    }
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its words in the legend.
    pub label: String,
    /// Its points.
    pub points: Vec<Point>,
    /// Its colour and mark.
    pub look: Look,
}

/// Colour and mark of a curve: the same thing looks the same in every figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    pub(super) color: RGBColor,
    pub(super) mark: Mark,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Disk,
    Square,
    Diamond,
    Triangle,
    Ring,
    Cross,
}

pub(super) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(super) const GREY: RGBColor = RGBColor(85, 85, 85);
pub(super) const GRID: RGBColor = RGBColor(222, 222, 222);
pub(super) const FAINT: RGBColor = RGBColor(240, 240, 240);
pub(super) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(super) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(super) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(super) const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub(super) const PURPLE: RGBColor = RGBColor(204, 121, 167);

impl Look {
    /// Monte Carlo, one estimator per term.
    pub const SINGLE: Self = Self { color: BLUE, mark: Mark::Disk };
    /// Monte Carlo, all terms from the prefixes of one path.
    pub const PREFIX: Self = Self { color: VERMILION, mark: Mark::Square };
    /// The radiosity matrix.
    pub const MATRIX: Self = Self { color: BLACK, mark: Mark::Ring };
    /// The full path tracer.
    pub const PATH: Self = Self { color: PURPLE, mark: Mark::Triangle };

    /// The mark of a second quantity on the same axes.
    pub(super) const CROSS: Mark = Mark::Cross;

    /// Looks for any number of curves, as in a sweep.
    pub fn nth(i: usize) -> Self {
        let colors = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK];
        let marks = [Mark::Disk, Mark::Square, Mark::Diamond, Mark::Triangle, Mark::Ring, Mark::Cross];
        Self { color: colors[i % colors.len()], mark: marks[i % marks.len()] }
    }
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The SVG document.
    pub svg: String,
    /// Width in CSS pixels.
    pub width: u32,
    /// Height in CSS pixels.
    pub height: u32,
}

impl Figure {
    /// Writes `STEM.svg` and, at twice the size, `STEM.png` into `folder`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path, stem: &str) -> Result<[PathBuf; 2], ReportError> {
        let [svg, png] = ["svg", "png"].map(|ending| folder.join(format!("{stem}.{ending}")));
        write_atomically(&svg, self.svg.as_bytes())?;
        typeset::rasterise(&self.svg, 2.0)?.write(&png)?;
        Ok([svg, png])
    }
}

/// Makes a figure: `draw` fills `width × height`, the caption follows below.
pub(super) fn figure(
    name: &str,
    width: u32,
    height: u32,
    caption: &Caption,
    draw: impl FnOnce(&Canvas) -> Drawn,
) -> Result<Figure, ReportError> {
    const SIZE: f64 = 11.0;
    const MARGIN: f64 = 16.0;
    typeset::register_fonts();
    let lines = caption.lines(f64::from(width) - 2.0 * MARGIN, SIZE);
    let total = height + (lines.len() as f64 * SIZE * LINE + MARGIN).ceil() as u32;
    let large = |length: u32| length * SCALE as u32;
    let mut svg = String::new();
    let render = || -> Drawn {
        let area = SVGBackend::with_string(&mut svg, (large(width), large(total))).into_drawing_area();
        area.fill(&RGBColor(255, 255, 255))?;
        let page = Canvas(area);
        draw(&page)?;
        for (i, line) in lines.iter().enumerate() {
            let y = f64::from(height) + (i as f64 + 0.5) * SIZE * LINE;
            page.text(line, (MARGIN, y), Words { size: SIZE, family: MONO, color: GREY, ..Words::default() })?;
        }
        page.0.present()?;
        Ok(())
    };
    render().map_err(|e| ReportError::new(name, e, "this is a defect of the program: please report it"))?;
    let header = format!("width=\"{}\" height=\"{}\"", large(width), large(total));
    let families = format!("font-family=\"{SANS}, Verdana, system-ui, sans-serif\"");
    let svg = svg
        .replacen(&header, &format!("width=\"{width}\" height=\"{total}\""), 1)
        .replace(&format!("font-family=\"{SANS}\""), &families)
        .replace(&format!("font-family=\"{MONO}\""), &format!("font-family=\"{MONO}, ui-monospace, monospace\""));
    Ok(Figure { svg, width, height: total })
}
