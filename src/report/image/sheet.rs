//! A sheet: a title, rows of pictures with text above and below each, and the caption. All lengths of text can be scaled.

use super::{
    picture::Picture,
    typeset::{Caption, LINE, SANS, caption_elements, page, text_element, text_width},
};
use crate::report::ReportError;

/// Font size of the line above a picture.
pub(super) const LABEL: f64 = 14.0;
const NOTE: f64 = 12.0;
const SMALL: f64 = 10.5;
const TITLE: f64 = 18.0;
/// Bold letters are wider than the measured ones by about this factor.
const BOLDER: f64 = 1.12;
/// Distance between tiles, and around all of them.
pub(super) const GAP: f64 = 16.0;
const NARROWEST: f64 = 400.0;
const DIM: &str = "fill=\"#333333\"";
const BOLD: &str = "font-weight=\"bold\"";

/// Scale of the text of a sheet that is read on a screen and on a projector.
pub const READABLE: f64 = 1.75;

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
    /// Text below all tiles; it may have several lines.
    pub foot: Option<&'a str>,
    /// Text and gaps are this many times as large as 14 pixels for a label: [`READABLE`] for sheets that are also projected, 2
    /// for slides, which are at least [`SLIDE`] pixels wide. The pictures keep their pixels.
    pub scale: f64,
}

/// Width of the widest text of a tile: its label or one of its notes.
pub(super) fn words(label: &str, notes: &[String], scale: f64) -> f64 {
    let notes = notes.iter().map(|note| text_width(note, SANS, NOTE * scale));
    notes.fold(BOLDER * text_width(label, SANS, LABEL * scale), f64::max)
}

/// Width of a tile without the gap: the width of its picture or of its widest text.
fn room(tiles: &[Tile], scale: f64) -> f64 {
    let widest = tiles.iter().map(|t| words(&t.label, &t.notes, scale));
    widest.fold(tiles.first().map_or(0.0, |t| t.image.width as f64), f64::max).ceil()
}

/// Number of columns that fit in `width` pixels: at least one, and at most the number of tiles.
pub fn columns_in(width: f64, tiles: &[Tile], scale: f64) -> usize {
    let gap = GAP * scale;
    (((width - gap) / (room(tiles, scale) + gap)).floor() as usize).clamp(1, tiles.len().max(1))
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
    Layout { title, tiles, places: &places, heads: &[], foot, scale: 2.0 }.draw(caption)
}

/// Places tiles row by row: column and row of each.
pub fn in_rows(tiles: usize, columns: usize) -> Vec<(f64, usize)> {
    (0..tiles).map(|i| ((i % columns) as f64, i / columns)).collect()
}

impl Layout<'_> {
    /// Draws the text first, then copies the pictures to their places.
    ///
    /// # Errors
    /// If the text cannot be drawn.
    pub fn draw(&self, caption: &Caption) -> Result<Picture, ReportError> {
        let scale = self.scale;
        let [title, label, note, small, gap] = [TITLE, LABEL, NOTE, SMALL, GAP].map(|length| scale * length);
        let image_h = self.tiles.first().map_or(0.0, |t| t.image.height as f64);
        let below = self.tiles.iter().map(|t| t.notes.len()).max().unwrap_or(0) as f64;
        let (cell_w, cell_h) = (room(self.tiles, scale) + gap, label * LINE + image_h + below * note * LINE + gap);
        let heads =
            self.heads.iter().map(|[large, small]| text_width(large, SANS, title).max(text_width(small, SANS, note)));
        let left = gap + heads.map(|w| w + gap).fold(0.0, f64::max).ceil();
        let top = gap + title * LINE;
        let corner = |(column, row): (f64, usize)| (left + column * cell_w, top + row as f64 * cell_h);

        let foot: Vec<&str> = self.foot.iter().flat_map(|foot| foot.lines()).collect();
        let right = self.places.iter().map(|&place| corner(place).0 + cell_w).fold(0.0, f64::max);
        let words = foot.iter().map(|line| text_width(line, SANS, small));
        let words = words.fold(text_width(self.title, SANS, title), f64::max);
        let width = right.max(words + 2.0 * gap).max(if scale >= 2.0 { SLIDE as f64 } else { NARROWEST }).ceil();
        let bottom = self.places.iter().map(|&place| corner(place).1 + cell_h).fold(top, f64::max);
        let lines = caption.lines(width - 2.0 * gap, small);
        let height = (bottom + (lines.len() + foot.len()) as f64 * small * LINE + gap).ceil();

        let mut text = text_element(gap, gap + title * 0.8, title, SANS, "", self.title);
        for (row, [large, small]) in self.heads.iter().enumerate() {
            let y = corner((0.0, row)).1 + label * LINE + 0.5 * image_h;
            text += &text_element(gap, y, title, SANS, BOLD, large);
            text += &text_element(gap, y + label * LINE, note, SANS, DIM, small);
        }
        for (tile, &place) in self.tiles.iter().zip(self.places) {
            let (x, y) = corner(place);
            text += &text_element(x, y + label, label, SANS, BOLD, &tile.label);
            for (line, words) in tile.notes.iter().enumerate() {
                let below = y + label * LINE + image_h + note * (1.2 + line as f64 * LINE);
                text += &text_element(x, below, note, SANS, DIM, words);
            }
        }
        let mut y = bottom + small;
        for line in foot {
            text += &text_element(gap, y, small, SANS, DIM, line);
            y += small * LINE;
        }
        text += &caption_elements(&lines, gap, y, small);
        let mut picture = page(width as usize, height as usize, &text)?;
        for (tile, &place) in self.tiles.iter().zip(self.places) {
            let (x, y) = corner(place);
            picture.paste(&tile.image, x.round() as usize, (y + label * LINE).round() as usize);
        }
        Ok(picture)
    }
}
