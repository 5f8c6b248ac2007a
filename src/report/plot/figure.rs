//! Figures: drawn once as SVG; the PNG is rasterised from the same SVG.
//!
//! The plot crate rounds coordinates to whole pixels. Everything is therefore drawn ten times too large, and the size in the
//! SVG header is corrected afterwards. A panel computes positions itself and draws nothing outside its frame: lines are
//! clipped, points are left out, and error bars end in an arrow head at the frame.

use std::path::{Path, PathBuf};

use base64::{Engine, engine::general_purpose::STANDARD};
use plotters::prelude::{IntoDrawingArea, RGBColor, SVGBackend};

use super::{
    canvas::{Canvas, Drawn, SCALE, Words},
    look::GREY,
};
use crate::report::{
    ReportError,
    image::{
        picture::Picture,
        typeset::{self, Caption, LINE, MONO, SANS},
    },
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
    /// Pictures below the lines and the text.
    below: Vec<Below>,
}

/// The end of the first element of a figure, its white background.
const BACKGROUND_END: &str = "fill=\"#FFFFFF\" stroke=\"none\"/>\n";

/// A picture below the drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Below {
    picture: Picture,
    x: u32,
    y: u32,
    /// Picture pixels per CSS pixel.
    fine: usize,
}

impl Figure {
    /// Places a picture below the drawing, with its upper left corner at (x, y) and `fine` picture pixels per CSS pixel. In the
    /// PNG, which has two pixels per CSS pixel, no pixel is resampled if `fine` is 1 or 2.
    ///
    /// # Errors
    /// If the picture is empty.
    pub fn over(mut self, picture: Picture, [x, y]: [u32; 2], fine: usize) -> Result<Self, ReportError> {
        let data = STANDARD.encode(picture.png(Path::new("(picture in a figure)"))?);
        let [w, h] = [picture.width, picture.height].map(|n| n as f64 / fine as f64);
        let image = format!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" transform=\"scale({SCALE})\" href=\"data:image/png;base64,{data}\"/>\n"
        );
        let end = self.svg.find(BACKGROUND_END).map_or(0, |at| at + BACKGROUND_END.len());
        self.svg.insert_str(end, &image);
        self.below.push(Below { picture, x, y, fine });
        Ok(self)
    }

    /// The PNG picture: the pictures below, then the drawing.
    fn rasterised(&self) -> Result<Picture, ReportError> {
        const SCALE_OF_PNG: usize = 2;
        let drawing = typeset::rasterise(&self.svg, SCALE_OF_PNG as f32)?;
        let Some(_) = self.below.first() else { return Ok(drawing) };
        let mut page = Picture { pixels: vec![[255; 3]; drawing.pixels.len()], ..drawing };
        for Below { picture, x, y, fine } in &self.below {
            let size = [picture.width, picture.height].map(|n| n * SCALE_OF_PNG / fine);
            let row = |v: usize| (0..size[0]).map(move |u| [u, v].map(|n| n * fine / SCALE_OF_PNG));
            let pixels = (0..size[1]).flat_map(row).map(|[u, v]| picture.pixels[v * picture.width + u]).collect();
            let scaled = Picture { width: size[0], height: size[1], pixels };
            page.paste(&scaled, *x as usize * SCALE_OF_PNG, *y as usize * SCALE_OF_PNG);
        }
        let background = self.svg.find("<rect").zip(self.svg.find(BACKGROUND_END));
        let clear =
            background.map(|(from, to)| format!("{}{}", &self.svg[..from], &self.svg[to + BACKGROUND_END.len()..]));
        typeset::rasterise_over(clear.as_ref().unwrap_or(&self.svg), SCALE_OF_PNG as f32, Some(&page))
    }

    /// Writes `STEM.svg` and, at twice the size, `STEM.png` into `folder`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path, stem: &str) -> Result<[PathBuf; 2], ReportError> {
        let [svg, png] = ["svg", "png"].map(|ending| folder.join(format!("{stem}.{ending}")));
        write_atomically(&svg, self.svg.as_bytes())?;
        self.rasterised()?.write(&png)?;
        Ok([svg, png])
    }
}

/// Makes a figure: `draw` fills an area of `width × height`, and the caption is added below.
pub fn figure(
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
    Ok(Figure { svg, width, height: total, below: vec![] })
}
