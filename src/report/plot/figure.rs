//! Figures: drawn once as SVG; the PNG is rasterised from the same SVG.
//!
//! The plot crate rounds coordinates to whole pixels. Everything is therefore drawn ten times too large, and the size in the
//! SVG header is corrected afterwards. A panel computes positions itself and draws nothing outside its frame: lines are
//! clipped, points are left out, and error bars end in an arrow head at the frame.

use std::path::{Path, PathBuf};

use plotters::prelude::{IntoDrawingArea, RGBColor, SVGBackend};

use super::{
    canvas::{Canvas, Drawn, SCALE, Words},
    look::GREY,
};
use crate::report::{
    ReportError,
    image::typeset::{self, Caption, LINE, MONO, SANS},
    write_atomically,
};

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

/// Makes a figure: `draw` fills an area of `width × height`, and the caption is added below.
pub(crate) fn figure(
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
