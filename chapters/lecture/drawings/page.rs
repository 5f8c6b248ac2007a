//! Parts that all drawings share: text with subscripts, paragraphs, arcs, and views of points in space.
//!
//! ```text
//! place(p) = o + s · (r·p, −u·p)          orthographic view: depth is dropped, the page's y axis points down
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r, u | unit vectors that point to the right and upwards on the page | [`View::right`], [`View::up`] |
//! | s | CSS pixels per metre | [`View::scale`] |
//! | o | place of the point 0 on the page | [`View::origin`] |
//!
//! Reference: Foley, van Dam, Feiner, Hughes, *Computer Graphics: Principles and Practice* (2nd ed. 1990), ch. 6.

use fredholm::report::image::typeset::{SANS, text_width, wrap};
use fredholm::report::plot::{Align, BLACK, Canvas, Colour, Drawn, Place, Stroke, Words};
use glam::DVec3;

/// Width of a slide in CSS pixels.
pub const WIDTH: u32 = 960;
/// Left margin of a slide.
pub const LEFT: f64 = 20.0;
/// Font size of text.
pub const SIZE: f64 = 14.0;

/// Text of a size and colour, with its left end at its place.
pub fn words(size: f64, color: Colour) -> Words {
    Words { size, color, ..Words::default() }
}

/// Text of a size and colour, with its middle at its place.
pub fn centred(size: f64, color: Colour) -> Words {
    Words { align: Align::Center, ..words(size, color) }
}

/// The title of a slide.
pub fn title(page: &Canvas<'_>, text: &str) -> Drawn {
    page.text(text, (LEFT, 26.0), Words { bold: true, ..words(22.0, BLACK) })
}

/// A heading of a part of a slide.
pub fn heading(page: &Canvas<'_>, text: &str, at: Place) -> Drawn {
    page.text(text, at, Words { bold: true, ..words(15.0, BLACK) })
}

/// Text broken into lines of at most `width`. Returns the y below the last line.
pub fn paragraph(
    page: &Canvas<'_>,
    text: &str,
    (x, mut y): Place,
    width: f64,
    style: Words,
) -> Result<f64, Box<dyn std::error::Error>> {
    for line in wrap(text, |line| text_width(line, SANS, style.size) <= width) {
        maths(page, &line, (x, y), style)?;
        y += style.size * 1.4;
    }
    Ok(y)
}

/// Text in which `_` makes the next character a subscript, as in `cos θ_y`. Use letters that are not bold: the width of bold
/// ones is not known.
pub fn maths(page: &Canvas<'_>, text: &str, at: Place, style: Words) -> Drawn {
    let mut pieces = text.split('_');
    let mut parts = vec![(pieces.next().unwrap_or_default(), false)];
    for piece in pieces {
        let cut = piece.chars().next().map_or(0, char::len_utf8);
        parts.extend([(&piece[..cut], true), (&piece[cut..], false)]);
    }
    let size = |lowered: bool| if lowered { 0.72 * style.size } else { style.size };
    // SVG drops blanks at both ends of a text, so their width is added here
    let blank = text_width("a a", SANS, style.size) - text_width("aa", SANS, style.size);
    let blanks = |text: &str| blank * text.len() as f64;
    let ends = |text: &str| [text.trim_start(), text.trim_end()].map(|part| blank * (text.len() - part.len()) as f64);
    let wide = |&(text, lowered): &(&str, bool)| match text.trim() {
        "" => blanks(text),
        inner => ends(text).iter().sum::<f64>() + text_width(inner, SANS, size(lowered)),
    };
    let whole: f64 = parts.iter().map(wide).sum();
    let mut x = at.0
        - match style.align {
            Align::Left => 0.0,
            Align::Center => 0.5 * whole,
            Align::Right => whole,
        };
    for part in &parts {
        let y = at.1 + if part.1 { 0.3 * style.size } else { 0.0 };
        if !part.0.trim().is_empty() {
            let place = (x + ends(part.0)[0], y);
            page.text(part.0.trim(), place, Words { size: size(part.1), align: Align::Left, ..style })?;
        }
        x += wide(part);
    }
    Ok(())
}

/// Part of a circle between two angles in radians, counter-clockwise from the right.
pub fn arc(page: &Canvas<'_>, centre: Place, radius: f64, [from, to]: [f64; 2], stroke: Stroke) -> Drawn {
    // pieces of about ten pixels
    let parts = ((radius * (to - from)).abs() / 10.0).ceil().max(1.0) as usize;
    let at = |i: usize| {
        let (sin, cos) = (from + (to - from) * i as f64 / parts as f64).sin_cos();
        (centre.0 + radius * cos, centre.1 - radius * sin)
    };
    page.path(&(0..=parts).map(at).collect::<Vec<_>>(), stroke)
}

/// An orthographic view of points in space.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Unit vector that points to the right on the page.
    pub right: DVec3,
    /// Unit vector that points upwards on the page.
    pub up: DVec3,
    /// CSS pixels per metre.
    pub scale: f64,
    /// Place of the point 0.
    pub origin: Place,
}

impl View {
    /// Place of a point on the page.
    pub fn at(&self, p: DVec3) -> Place {
        (self.origin.0 + self.scale * self.right.dot(p), self.origin.1 - self.scale * self.up.dot(p))
    }

    /// Places of several points.
    pub fn all(&self, points: &[DVec3]) -> Vec<Place> {
        points.iter().map(|&p| self.at(p)).collect()
    }
}
