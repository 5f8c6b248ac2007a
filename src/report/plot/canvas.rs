//! A page to draw on: lines, marks, text and legends. Lengths are CSS pixels; the plot crate gets them in units ten times
//! finer.

use plotters::{
    coord::Shift,
    prelude::{Circle, DrawingArea, IntoFont, PathElement, Polygon, RGBColor, SVGBackend, Text},
    style::{
        Color, FontStyle, FontTransform, ShapeStyle, TextStyle,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::look::{BLACK, Look, Mark};
use crate::report::image::typeset::{self, SANS};

/// Text is aligned to this side of its place.
pub type Align = HPos;

/// A colour.
pub type Colour = RGBColor;

/// Drawing units per CSS pixel.
pub(crate) const SCALE: f64 = 10.0;

/// Result of a drawing operation; the error is any error of the plot crate.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A place on the page in CSS pixels.
pub type Place = (f64, f64);

/// The page of a figure. All lengths are CSS pixels.
pub struct Canvas<'a>(pub(crate) DrawingArea<SVGBackend<'a>, Shift>);

/// Style of a text.
#[derive(Clone, Copy)]
pub struct Words {
    /// Font size in CSS pixels.
    pub size: f64,
    /// Font family.
    pub family: &'static str,
    /// Colour.
    pub color: Colour,
    /// True for bold letters.
    pub bold: bool,
    /// The end of the text, or its middle, that lies at its place.
    pub align: Align,
    /// True for text that reads upwards.
    pub upwards: bool,
}

impl Default for Words {
    fn default() -> Self {
        Self { size: 13.0, family: SANS, color: BLACK, bold: false, align: HPos::Left, upwards: false }
    }
}

/// Style of a line.
#[derive(Clone, Copy)]
pub struct Stroke {
    /// Colour.
    pub color: Colour,
    /// Width in CSS pixels.
    pub width: f64,
    /// Length of the dashes and of the gaps; none for a solid line.
    pub dash: Option<(f64, f64)>,
}

impl Stroke {
    /// A solid line.
    pub fn solid(color: RGBColor, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    fn shape(self) -> ShapeStyle {
        self.color.stroke_width((self.width * SCALE).round() as u32)
    }
}

fn unit((x, y): Place) -> (i32, i32) {
    ((x * SCALE).round() as i32, (y * SCALE).round() as i32)
}

impl Canvas<'_> {
    /// A line of text, vertically centred on `at`.
    pub fn text(&self, text: &str, at: Place, words: Words) -> Drawn {
        // The plot crate divides font sizes by 1.24 when it writes SVG.
        let font = (words.family, words.size * SCALE * 1.24).into_font();
        let font = font.style(if words.bold { FontStyle::Bold } else { FontStyle::Normal });
        let font = if words.upwards { font.transform(FontTransform::Rotate270) } else { font };
        let style = TextStyle::from(font).color(&words.color).pos(Pos::new(words.align, VPos::Center));
        self.0.draw(&Text::new(text.to_owned(), unit(at), style))?;
        Ok(())
    }

    /// A straight line, dashed if the stroke has dashes.
    pub fn line(&self, from: Place, to: Place, stroke: Stroke) -> Drawn {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        let (on, off) = stroke.dash.unwrap_or((length, 0.0));
        let at = |s: f64| (from.0 + dx * s / length, from.1 + dy * s / length);
        let mut start = 0.0;
        while start < length {
            let ends = [unit(at(start)), unit(at((start + on).min(length)))];
            self.0.draw(&PathElement::new(ends, stroke.shape()))?;
            start += on + off;
        }
        Ok(())
    }

    /// A line through several points.
    pub fn path(&self, points: &[Place], stroke: Stroke) -> Drawn {
        points.windows(2).try_for_each(|ends| self.line(ends[0], ends[1], stroke))
    }

    /// An arrow; its head ends at `to`.
    pub fn arrow(&self, from: Place, to: Place, stroke: Stroke) -> Drawn {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let head = 4.0 + 3.0 * stroke.width;
        let (ux, uy) = (dx / dx.hypot(dy), dy / dx.hypot(dy));
        let base = (to.0 - head * ux, to.1 - head * uy);
        let side = |s: f64| (base.0 - s * 0.45 * head * uy, base.1 + s * 0.45 * head * ux);
        self.line(from, base, stroke)?;
        self.polygon(&[to, side(1.0), side(-1.0)], stroke.color)
    }

    /// A filled circle.
    pub fn disk(&self, centre: Place, radius: f64, color: Colour) -> Drawn {
        self.0.draw(&Circle::new(unit(centre), (radius * SCALE).round() as i32, color.filled()))?;
        Ok(())
    }

    /// A filled polygon.
    pub fn polygon(&self, corners: &[Place], color: RGBColor) -> Drawn {
        self.0.draw(&Polygon::new(corners.iter().copied().map(unit).collect::<Vec<_>>(), color.filled()))?;
        Ok(())
    }

    /// A transparent polygon.
    pub fn tint(&self, corners: &[Place], color: RGBColor) -> Drawn {
        let corners: Vec<_> = corners.iter().copied().map(unit).collect();
        self.0.draw(&Polygon::new(corners, color.mix(0.18).filled()))?;
        Ok(())
    }

    /// The mark of a curve.
    pub fn mark(&self, (x, y): Place, look: Look) -> Drawn {
        let corners = |offsets: &[Place]| offsets.iter().map(|(dx, dy)| (x + dx, y + dy)).collect::<Vec<_>>();
        match look.mark {
            Mark::Disk => self.0.draw(&Circle::new(unit((x, y)), (4.2 * SCALE) as i32, look.color.filled()))?,
            Mark::Ring => {
                let stroke = Stroke::solid(look.color, 1.6).shape();
                self.0.draw(&Circle::new(unit((x, y)), (5.0 * SCALE) as i32, stroke))?;
            }
            Mark::Square => {
                self.polygon(&corners(&[(-3.8, -3.8), (3.8, -3.8), (3.8, 3.8), (-3.8, 3.8)]), look.color)?;
            }
            Mark::Diamond => self.polygon(&corners(&[(0.0, -5.5), (5.5, 0.0), (0.0, 5.5), (-5.5, 0.0)]), look.color)?,
            Mark::Triangle => self.polygon(&corners(&[(0.0, -5.2), (5.0, 4.0), (-5.0, 4.0)]), look.color)?,
            Mark::Cross => {
                for (dx, dy) in [(4.0, 4.0), (4.0, -4.0)] {
                    self.line((x - dx, y - dy), (x + dx, y + dy), Stroke::solid(look.color, 2.0))?;
                }
            }
        }
        Ok(())
    }

    /// Draws legend entries from `at` downwards, with text wrapped to `width`. Returns the y below the last entry.
    pub fn legend(&self, at: Place, width: f64, entries: &[Entry]) -> Result<f64, Box<dyn std::error::Error>> {
        const SAMPLE: f64 = 34.0;
        const SIZE: f64 = 12.5;
        let (x, mut y) = at;
        for entry in entries {
            let (indent, bold) = match entry.sample {
                Sample::Heading => (0.0, true),
                Sample::Plain => (0.0, false),
                _ => (SAMPLE, false),
            };
            match entry.sample {
                Sample::Heading => y += 4.0,
                Sample::Plain => {}
                Sample::Mark(look) => {
                    self.line((x + 13.0, y - 8.0), (x + 13.0, y + 8.0), Stroke::solid(look.color, 1.4))?;
                    self.mark((x + 13.0, y), look)?;
                }
                Sample::Line(stroke) => self.line((x, y), (x + 26.0, y), stroke)?,
                Sample::Limit(color) => self.limit((x + 13.0, y - 8.0), 16.0, color)?,
            }
            let fits = |line: &str| typeset::text_width(line, SANS, SIZE) <= width - indent;
            for line in typeset::wrap(&entry.label, fits) {
                self.text(&line, (x + indent, y), Words { size: SIZE, bold, ..Words::default() })?;
                y += SIZE * 1.3;
            }
            y += 5.0;
        }
        Ok(y)
    }

    /// An upper limit: a bar with an arrow pointing down.
    pub fn limit(&self, (x, y): Place, length: f64, color: RGBColor) -> Drawn {
        let stroke = Stroke::solid(color, 1.6);
        self.line((x - 5.0, y), (x + 5.0, y), stroke)?;
        self.line((x, y), (x, y + length - 4.0), stroke)?;
        self.polygon(&[(x - 3.5, y + length - 7.0), (x + 3.5, y + length - 7.0), (x, y + length)], color)
    }
}

/// One line of a legend.
pub struct Entry {
    /// What it explains.
    pub sample: Sample,
    /// The text.
    pub label: String,
}

impl Entry {
    /// An entry.
    pub fn new(sample: Sample, label: impl Into<String>) -> Self {
        Self { sample, label: label.into() }
    }
}

/// The symbol in front of the text of a legend entry.
pub enum Sample {
    /// A heading.
    Heading,
    /// Text alone.
    Plain,
    /// The mark of a curve.
    Mark(Look),
    /// A line.
    Line(Stroke),
    /// An upper limit.
    Limit(Colour),
}
