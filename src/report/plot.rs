//! Figures: drawn once as SVG, rasterised from the very same SVG.
//!
//! The plot crate rounds coordinates to whole pixels, so everything is drawn ten times too large and the size in the
//! header is rewritten; that is what [`SCALE`] is for. A [`Panel`] places values itself and draws nothing whose place
//! is outside its frame: lines are clipped, points are left out, error bars end in an arrow head at the frame.
//!
//! Colours are those of Okabe and Ito (2008), told apart also by readers with a colour-vision deficiency; marks differ
//! in shape, too.

use std::path::{Path, PathBuf};

use plotters::{
    coord::Shift,
    prelude::{Circle, DrawingArea, IntoDrawingArea, IntoFont, PathElement, Polygon, RGBColor, SVGBackend, Text},
    style::{
        Color, FontStyle, FontTransform, ShapeStyle, TextStyle,
        text_anchor::{HPos, Pos, VPos},
    },
};

use super::{
    ReportError,
    axis::Axis,
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
    /// Standard error of `value`.
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
    color: RGBColor,
    mark: Mark,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Disk,
    Square,
    Diamond,
    Triangle,
    Ring,
    Cross,
}

pub(super) const BLACK: RGBColor = RGBColor(0, 0, 0);
pub(super) const GREY: RGBColor = RGBColor(85, 85, 85);
const GRID: RGBColor = RGBColor(222, 222, 222);
const FAINT: RGBColor = RGBColor(240, 240, 240);
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

/// Drawing units per CSS pixel.
pub(super) const SCALE: f64 = 10.0;

/// Anything the plot crate can complain about.
pub(super) type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A place on the page in CSS pixels.
pub(super) type Place = (f64, f64);

/// The sheet a figure is drawn on; all lengths are CSS pixels.
pub(super) struct Page<'a>(DrawingArea<SVGBackend<'a>, Shift>);

/// Makes a figure: `draw` fills `width × height`, the caption follows below.
pub(super) fn figure(
    name: &str,
    width: u32,
    height: u32,
    caption: &Caption,
    draw: impl FnOnce(&Page) -> Drawn,
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
        let page = Page(area);
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

/// How a piece of text looks.
#[derive(Clone, Copy)]
pub(super) struct Words {
    pub(super) size: f64,
    pub(super) family: &'static str,
    pub(super) color: RGBColor,
    pub(super) bold: bool,
    pub(super) align: HPos,
    pub(super) upwards: bool,
}

impl Default for Words {
    fn default() -> Self {
        Self { size: 13.0, family: SANS, color: BLACK, bold: false, align: HPos::Left, upwards: false }
    }
}

/// How a line looks.
#[derive(Clone, Copy)]
pub(super) struct Stroke {
    pub(super) color: RGBColor,
    pub(super) width: f64,
    /// Length of dashes and gaps.
    pub(super) dash: Option<(f64, f64)>,
}

impl Stroke {
    pub(super) fn solid(color: RGBColor, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    fn shape(self) -> ShapeStyle {
        self.color.stroke_width((self.width * SCALE).round() as u32)
    }
}

fn unit((x, y): Place) -> (i32, i32) {
    ((x * SCALE).round() as i32, (y * SCALE).round() as i32)
}

impl Page<'_> {
    /// A line of text, vertically centred on `at`.
    pub(super) fn text(&self, text: &str, at: Place, words: Words) -> Drawn {
        // The plot crate divides font sizes by 1.24 when it writes SVG.
        let font = (words.family, words.size * SCALE * 1.24).into_font();
        let font = font.style(if words.bold { FontStyle::Bold } else { FontStyle::Normal });
        let font = if words.upwards { font.transform(FontTransform::Rotate270) } else { font };
        let style = TextStyle::from(font).color(&words.color).pos(Pos::new(words.align, VPos::Center));
        self.0.draw(&Text::new(text.to_owned(), unit(at), style))?;
        Ok(())
    }

    /// A straight line, dashed if the stroke says so.
    pub(super) fn line(&self, from: Place, to: Place, stroke: Stroke) -> Drawn {
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

    fn polygon(&self, corners: &[Place], color: RGBColor) -> Drawn {
        self.0.draw(&Polygon::new(corners.iter().copied().map(unit).collect::<Vec<_>>(), color.filled()))?;
        Ok(())
    }

    /// The mark of a curve.
    fn mark(&self, (x, y): Place, look: Look) -> Drawn {
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

    /// Legend entries from `at` downwards, words wrapped to `width`; returns the y below the last.
    pub(super) fn legend(&self, at: Place, width: f64, entries: &[Entry]) -> Result<f64, Box<dyn std::error::Error>> {
        const SAMPLE: f64 = 34.0;
        const SIZE: f64 = 12.5;
        let (x, mut y) = at;
        for entry in entries {
            let (indent, bold) = match entry.sample {
                Sample::Heading => (0.0, true),
                _ => (SAMPLE, false),
            };
            match entry.sample {
                Sample::Heading => y += 4.0,
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
    fn limit(&self, (x, y): Place, length: f64, color: RGBColor) -> Drawn {
        let stroke = Stroke::solid(color, 1.6);
        self.line((x - 5.0, y), (x + 5.0, y), stroke)?;
        self.line((x, y), (x, y + length - 4.0), stroke)?;
        self.polygon(&[(x - 3.5, y + length - 7.0), (x + 3.5, y + length - 7.0), (x, y + length)], color)
    }
}

/// One line of a legend.
pub(super) struct Entry {
    pub(super) sample: Sample,
    pub(super) label: String,
}

impl Entry {
    pub(super) fn new(sample: Sample, label: impl Into<String>) -> Self {
        Self { sample, label: label.into() }
    }
}

/// What stands before the words of a legend entry.
pub(super) enum Sample {
    Heading,
    Mark(Look),
    Line(Stroke),
    Limit(RGBColor),
}

/// A frame with two axes.
pub(super) struct Panel<'a, 'b> {
    page: &'a Page<'b>,
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: Axis,
    y: Axis,
}

impl<'a, 'b> Panel<'a, 'b> {
    /// Draws grid, frame, labels and title. `frame` is left, top, width, height; labels stand outside it.
    pub(super) fn draw(
        page: &'a Page<'b>,
        title: &str,
        [left, top, width, height]: [f64; 4],
        x: Axis,
        y: Axis,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let panel = Self { page, left, top, width, height, x, y };
        let (right, bottom) = (left + width, top + height);
        let vertical = |v: f64| left + width * panel.x.position(v);
        let level = |v: f64| bottom - height * panel.y.position(v);
        let inside = |p: f64| (1e-6..=1.0 - 1e-6).contains(&p);

        for &v in panel.y.minor.iter().filter(|&&v| inside(panel.y.position(v))) {
            page.line((left, level(v)), (right, level(v)), Stroke::solid(FAINT, 1.0))?;
        }
        for (v, _) in panel.x.ticks.iter().filter(|(v, _)| inside(panel.x.position(*v))) {
            page.line((vertical(*v), top), (vertical(*v), bottom), Stroke::solid(GRID, 1.0))?;
        }
        for (v, _) in panel.y.ticks.iter().filter(|(v, _)| inside(panel.y.position(*v))) {
            page.line((left, level(*v)), (right, level(*v)), Stroke::solid(GRID, 1.0))?;
        }
        let axis = Stroke::solid(GREY, 1.0);
        for (from, to) in [
            ((left, top), (right, top)),
            ((right, top), (right, bottom)),
            ((right, bottom), (left, bottom)),
            ((left, bottom), (left, top)),
        ] {
            page.line(from, to, axis)?;
        }

        let label = Words { size: 12.5, ..Words::default() };
        for (v, words) in &panel.x.ticks {
            page.line((vertical(*v), bottom), (vertical(*v), bottom + 4.0), axis)?;
            page.text(words, (vertical(*v), bottom + 14.0), Words { align: HPos::Center, ..label })?;
        }
        for (v, words) in &panel.y.ticks {
            page.line((left - 4.0, level(*v)), (left, level(*v)), axis)?;
            page.text(words, (left - 8.0, level(*v)), Words { align: HPos::Right, ..label })?;
        }
        let title_words = Words { size: 14.0, bold: true, ..Words::default() };
        page.text(title, (left, top - 14.0), title_words)?;
        let middle = Words { align: HPos::Center, size: 13.0, ..Words::default() };
        page.text(&panel.x.title, (left + width / 2.0, bottom + 34.0), middle)?;
        page.text(&panel.y.title, (left - 54.0, top + height / 2.0), Words { upwards: true, ..middle })?;
        Ok(panel)
    }

    /// The place of a value, if it is inside the frame.
    fn at(&self, x: f64, value: f64) -> Option<Place> {
        let (u, v) = (self.x.position(x), self.y.position(value));
        ((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)).then(|| self.place(u, v))
    }

    fn place(&self, u: f64, v: f64) -> Place {
        (self.left + u * self.width, self.top + (1.0 - v) * self.height)
    }

    /// The part of a straight line (straight on these axes) that lies in the frame.
    pub(super) fn line(&self, from: (f64, f64), to: (f64, f64), stroke: Stroke) -> Drawn {
        let unit_square = |(x, y)| (self.x.position(x), self.y.position(y));
        match clip(unit_square(from), unit_square(to)) {
            Some((a, b)) => self.page.line(self.place(a.0, a.1), self.place(b.0, b.1), stroke),
            None => Ok(()),
        }
    }

    /// Marks with 95 % bars, moved sideways by `shift` pixels so that curves do not hide each other, joined by a thin
    /// line if `joined`. On a logarithmic axis an interval that reaches zero is drawn as an upper limit.
    pub(super) fn curve(&self, curve: &Curve, shift: f64, joined: bool) -> Drawn {
        let color = curve.look.color;
        if joined {
            for pair in curve.points.windows(2).filter(|pair| pair.iter().all(|p| !self.is_limit(p))) {
                let thin = Stroke::solid(color, 1.2);
                self.line((pair[0].x, pair[0].value), (pair[1].x, pair[1].value), thin)?;
            }
        }
        for point in &curve.points {
            let half = point.half_width();
            if self.is_limit(point) {
                if let Some((x, y)) = self.at(point.x, point.value + half) {
                    let room = self.top + self.height - y;
                    self.page.limit((x + shift, y), room.min(22.0), color)?;
                }
            } else if let Some((x, y)) = self.at(point.x, point.value) {
                if half > 0.0 {
                    self.bar(x + shift, y, point.value, half, color)?;
                }
                self.page.mark((x + shift, y), curve.look)?;
            }
        }
        Ok(())
    }

    /// Whether a point can only be shown as an upper limit.
    pub(super) fn is_limit(&self, point: &Point) -> bool {
        self.y.is_log() && point.value - point.half_width() <= 0.0
    }

    /// The error bar of a mark at `(x, y)`: a cap at each end, or an arrow head where the frame cuts it.
    fn bar(&self, x: f64, y: f64, value: f64, half: f64, color: RGBColor) -> Drawn {
        let stroke = Stroke::solid(color, 1.4);
        for (end, outward) in [(value + half, -1.0), (value - half, 1.0)] {
            let v = self.y.position(end);
            let (_, tip) = self.place(0.0, v.clamp(0.0, 1.0));
            self.page.line((x, y), (x, tip), stroke)?;
            if (0.0..=1.0).contains(&v) {
                self.page.line((x - 3.5, tip), (x + 3.5, tip), stroke)?;
            } else {
                let base = tip - 7.0 * outward;
                self.page.polygon(&[(x - 4.0, base), (x + 4.0, base), (x, tip)], color)?;
            }
        }
        Ok(())
    }
}

/// The part of the segment from `a` to `b` inside the unit square (Liang and Barsky 1984).
fn clip(a: Place, b: Place) -> Option<(Place, Place)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for (speed, room) in [(-dx, a.0), (dx, 1.0 - a.0), (-dy, a.1), (dy, 1.0 - a.1)] {
        if !(speed.is_finite() && room.is_finite()) || (speed == 0.0 && room < 0.0) {
            return None;
        }
        if speed < 0.0 {
            t0 = t0.max(room / speed);
        } else if speed > 0.0 {
            t1 = t1.min(room / speed);
        }
    }
    (t0 <= t1).then(|| ((a.0 + t0 * dx, a.1 + t0 * dy), (a.0 + t1 * dx, a.1 + t1 * dy)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping() {
        assert_eq!(clip((-1.0, 0.5), (2.0, 0.5)), Some(((0.0, 0.5), (1.0, 0.5))));
        assert_eq!(clip((0.2, 0.2), (0.4, 0.8)), Some(((0.2, 0.2), (0.4, 0.8))));
        assert_eq!(clip((0.2, 1.2), (0.4, 1.8)), None);
        assert_eq!(clip((0.5, 0.5), (0.5, f64::NAN)), None);
        assert_eq!(clip((0.5, 0.5), (0.5, f64::NEG_INFINITY)), None);
    }
}
