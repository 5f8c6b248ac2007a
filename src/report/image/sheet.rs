//! A sheet: a title, rows of pictures with text above and below each, and the caption.

use super::{
    picture::Picture,
    typeset::{Caption, LINE, SANS, caption_elements, page_at, text_element, text_width},
};
use crate::report::ReportError;

/// Font size of the line above a picture.
pub(super) const LABEL: f64 = 14.0;
const NOTE: f64 = 12.0;
const SMALL: f64 = 10.5;
const TITLE: f64 = 18.0;
const GAP: f64 = 16.0;
const NARROWEST: f64 = 400.0;
const DIM: &str = "fill=\"#333333\"";
const BOLD: &str = "font-weight=\"bold\"";

/// Width of a slide in pixels.
pub const SLIDE: usize = 1920;

/// A picture with its text. All pictures of a sheet have the same size.
pub struct Tile {
    /// The picture.
    pub image: Picture,
    /// Text above the picture.
    pub label: String,
    /// Lines of text below the picture.
    pub notes: Vec<String>,
}

/// A sheet before it is drawn.
pub struct Layout<'a> {
    /// Title above all pictures.
    pub title: &'a str,
    /// The pictures with their text.
    pub tiles: &'a [Tile],
    /// Column (half columns are allowed) and row of every tile.
    pub places: &'a [(f64, usize)],
    /// Text to the left of each row: a large line and a small one. If empty, there is none.
    pub heads: &'a [[String; 2]],
    /// A line of text below all tiles.
    pub foot: Option<&'a str>,
    /// Pixels per CSS pixel: 1 for a screen, 2 for a projector. The pictures keep their pixels, text and gaps grow.
    pub scale: usize,
}

/// Width of a tile without the gap: the width of its picture or of its widest text.
fn room(tiles: &[Tile], scale: usize) -> f64 {
    let notes = tiles.iter().flat_map(|t| &t.notes).map(|note| text_width(note, SANS, NOTE));
    let words = notes.chain(tiles.iter().map(|t| text_width(&t.label, SANS, LABEL)));
    words.fold(tiles.first().map_or(0.0, |t| t.image.width as f64 / scale as f64), f64::max).ceil()
}

/// Number of columns that fit in `width` pixels: at least one, and at most the number of tiles.
pub fn columns_in(width: f64, tiles: &[Tile]) -> usize {
    (((width - GAP) / (room(tiles, 1) + GAP)).floor() as usize).clamp(1, tiles.len().max(1))
}

/// A sheet for a projector, [`SLIDE`] pixels wide: the pictures in `columns`, row by row.
///
/// # Errors
/// If the text cannot be drawn.
pub fn slide(
    title: &str,
    columns: usize,
    tiles: &[Tile],
    foot: Option<&str>,
    caption: &Caption,
) -> Result<Picture, ReportError> {
    let places = in_rows(tiles.len(), columns);
    Layout { title, tiles, places: &places, heads: &[], foot, scale: 2 }.draw(caption)
}

/// Places tiles row by row: column and row of each.
pub fn in_rows(tiles: usize, columns: usize) -> Vec<(f64, usize)> {
    (0..tiles).map(|i| ((i % columns) as f64, i / columns)).collect()
}

impl Layout<'_> {
    /// Least width in CSS pixels: a sheet for a projector is [`SLIDE`] pixels wide.
    fn at_least(&self) -> f64 {
        if self.scale > 1 { (SLIDE / self.scale) as f64 } else { 0.0 }
    }

    /// Draws the text first, then copies the pictures to their places.
    ///
    /// # Errors
    /// If the text cannot be drawn.
    pub fn draw(&self, caption: &Caption) -> Result<Picture, ReportError> {
        let scale = self.scale as f64;
        let image_h = self.tiles.first().map_or(0.0, |t| t.image.height as f64 / scale);
        let below = self.tiles.iter().map(|t| t.notes.len()).max().unwrap_or(0) as f64;
        let (cell_w, cell_h) = (room(self.tiles, self.scale) + GAP, LABEL * LINE + image_h + below * NOTE * LINE + GAP);
        let heads =
            self.heads.iter().map(|[large, small]| text_width(large, SANS, TITLE).max(text_width(small, SANS, NOTE)));
        let left = GAP + heads.map(|w| w + GAP).fold(0.0, f64::max).ceil();
        let top = GAP + TITLE * LINE;
        let corner = |(column, row): (f64, usize)| (left + column * cell_w, top + row as f64 * cell_h);

        let right = self.places.iter().map(|&place| corner(place).0 + cell_w).fold(0.0, f64::max);
        let words =
            text_width(self.title, SANS, TITLE).max(self.foot.map_or(0.0, |foot| text_width(foot, SANS, SMALL)));
        let width = right.max(words + 2.0 * GAP).max(NARROWEST).max(self.at_least()).ceil();
        let bottom = self.places.iter().map(|&place| corner(place).1 + cell_h).fold(top, f64::max);
        let lines = caption.lines(width - 2.0 * GAP, SMALL);
        let small = lines.len() + usize::from(self.foot.is_some());
        let height = (bottom + small as f64 * SMALL * LINE + GAP).ceil();

        let mut text = text_element(GAP, GAP + TITLE * 0.8, TITLE, SANS, "", self.title);
        for (row, [large, small]) in self.heads.iter().enumerate() {
            let y = corner((0.0, row)).1 + LABEL * LINE + 0.5 * image_h;
            text += &text_element(GAP, y, TITLE, SANS, BOLD, large);
            text += &text_element(GAP, y + LABEL * LINE, NOTE, SANS, DIM, small);
        }
        for (tile, &place) in self.tiles.iter().zip(self.places) {
            let (x, y) = corner(place);
            text += &text_element(x, y + LABEL, LABEL, SANS, BOLD, &tile.label);
            for (line, note) in tile.notes.iter().enumerate() {
                let below = y + LABEL * LINE + image_h + NOTE * (1.2 + line as f64 * LINE);
                text += &text_element(x, below, NOTE, SANS, DIM, note);
            }
        }
        let mut y = bottom + SMALL;
        if let Some(foot) = self.foot {
            text += &text_element(GAP, y, SMALL, SANS, DIM, foot);
            y += SMALL * LINE;
        }
        text += &caption_elements(&lines, GAP, y, SMALL);
        let mut picture = page_at(self.scale, width as usize, height as usize, &text)?;
        for (tile, &place) in self.tiles.iter().zip(self.places) {
            let (x, y) = corner(place);
            let at = [x, y + LABEL * LINE].map(|v| (v * scale).round() as usize);
            picture.paste(&tile.image, at[0], at[1]);
        }
        Ok(picture)
    }
}
