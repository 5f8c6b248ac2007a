//! Pictures with labels: single terms with a strip of text below, and grids of labelled cells.
//!
//! Text never covers a pixel; it is written next to the images. Images narrower than 256 pixels are enlarged by repeating
//! pixels. In grids, images wider than 600 pixels are averaged down in linear radiance; single pictures are not. Gain and
//! mean always come from the full image.

use super::{
    picture::{
        Developed, Picture, auto_gain, auto_gain_beside_lamps, develop, gain_label, magnification, mean, shrink,
    },
    sheet::{LABEL, Layout, READABLE, SLIDE, Tile, columns_in, in_rows},
    typeset::{Caption, SANS, page, superscript, text_element, text_width},
};
use crate::report::{ReportError, text::number::significant};

const NARROWEST: usize = 256;
const WIDEST: usize = 600;
const SHEET: f64 = SLIDE as f64;

/// One image of a sheet.
#[derive(Clone, Debug)]
pub struct Cell<'a> {
    /// Line above the image, such as `T3 E`.
    pub label: String,
    /// Linear RGB; every cell of a sheet has the same size.
    pub pixels: &'a [[f32; 3]],
    /// Gain with which it is shown; if none, [`auto_gain`] chooses it.
    pub gain: Option<f64>,
}

/// A finished sheet, with the number of clipped pixels.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The picture.
    pub picture: Picture,
    /// Number of clipped pixels per cell, counted in the image before it is resized.
    pub clipped: Vec<usize>,
}

/// One image with a strip below that states its label and gain: `T3  ×16`. Also returns the gain used.
///
/// # Errors
/// If the pixels do not match the size or the text cannot be drawn.
pub fn single(
    label: &str,
    width: usize,
    height: usize,
    pixels: &[[f32; 3]],
    gain: Option<f64>,
) -> Result<(Developed, f64), ReportError> {
    check_size(label, width, height, pixels)?;
    let gain = gain.unwrap_or_else(|| auto_gain(pixels));
    let mut developed = develop(width, height, pixels, gain);
    let text = format!("{label}  {}", gain_label(gain));
    // On a narrow image, shrink the letters instead of cutting the text, but keep them readable.
    let natural = text_width(&text, SANS, LABEL) + 8.0;
    let factor = magnification(width, height, 48);
    let image = developed.picture.enlarged(factor);
    let size = (LABEL * (image.width as f64 / natural).min(1.0)).max(9.0);
    let strip = (size * 1.7).ceil() as usize;
    let words = text_element(4.0, size * 1.2, size, SANS, "", &text);
    let mut strip = page(image.width, strip, &words)?;
    strip.pixels.splice(0..0, image.pixels);
    strip.height += image.height;
    developed.picture = strip;
    Ok((developed, gain))
}

/// A grid of labelled images with a title above and the caption below.
///
/// The gain and the mean over pixels and channels are printed under each image. To compare images at a common exposure, give
/// every cell the same gain.
///
/// # Errors
/// If there is no cell, the pixels do not match the size, or the text cannot be drawn.
pub fn grid(title: &str, width: usize, height: usize, cells: &[Cell], caption: &Caption) -> Result<Sheet, ReportError> {
    laid_out(None, title, width, height, cells, &gains(cells), caption)
}

/// A [`grid`] with a given number of columns.
///
/// # Errors
/// As for [`grid`].
pub fn grid_of(
    columns: usize,
    title: &str,
    width: usize,
    height: usize,
    cells: &[Cell],
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    laid_out(Some(columns), title, width, height, cells, &gains(cells), caption)
}

/// A [`grid`] with other lines of text under each image. `notes` has one entry per cell.
///
/// # Errors
/// As for [`grid`].
pub fn annotated(
    title: &str,
    width: usize,
    height: usize,
    cells: &[Cell],
    notes: &[Vec<String>],
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    laid_out(None, title, width, height, cells, notes, caption)
}

/// Gain and mean of every cell, as text.
fn gains(cells: &[Cell]) -> Vec<Vec<String>> {
    let note = |cell: &Cell| {
        let gain = cell.gain.unwrap_or_else(|| auto_gain(cell.pixels));
        vec![format!("{} · mean {}", gain_label(gain), significant(mean(cell.pixels), 3))]
    };
    cells.iter().map(note).collect()
}

fn laid_out(
    columns: Option<usize>,
    title: &str,
    width: usize,
    height: usize,
    cells: &[Cell],
    notes: &[Vec<String>],
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    if cells.is_empty() {
        return Err(ReportError::new("(contact sheet)", "there is no image to show", "render at least one term"));
    }
    let (mut tiles, mut clipped) = (Vec::new(), Vec::new());
    for (cell, notes) in cells.iter().zip(notes) {
        check_size(&cell.label, width, height, cell.pixels)?;
        let gain = cell.gain.unwrap_or_else(|| auto_gain(cell.pixels));
        let developed = develop(width, height, cell.pixels, gain);
        clipped.push(developed.clipped);
        let image = if width > WIDEST {
            shown(width, height, cell.pixels, gain, NARROWEST, WIDEST)
        } else {
            developed.picture.enlarged(magnification(width, height, NARROWEST))
        };
        tiles.push(Tile { image, label: cell.label.clone(), notes: notes.clone() });
    }
    let columns = columns.unwrap_or_else(|| balanced(&tiles));
    let places = in_rows(tiles.len(), columns);
    let picture =
        Layout { title, tiles: &tiles, places: &places, heads: &[], foot: None, scale: READABLE }.draw(caption)?;
    Ok(Sheet { picture, clipped })
}

/// Number of columns: as many as fit, then reduced as far as the number of rows stays the same.
fn balanced(tiles: &[Tile]) -> usize {
    let (count, mut fit) = (tiles.len(), columns_in(SHEET, tiles, READABLE));
    if count > 4 {
        fit = fit.min((count as f64 * 1.8).sqrt().ceil() as usize);
    }
    count.div_ceil(count.div_ceil(fit))
}

/// An image, resized and developed for display.
pub fn shown(width: usize, height: usize, pixels: &[[f32; 3]], gain: f64, narrowest: usize, widest: usize) -> Picture {
    let (w, h, small) = shrink(width, height, pixels, width.div_ceil(widest));
    develop(w, h, &small, gain).picture.enlarged(magnification(w, h, narrowest))
}

/// A sheet of the terms k = 0, 1, …, each at its own exposure, and of the whole image if it is known.
///
/// # Errors
/// As for [`grid`].
pub fn terms(
    width: usize,
    height: usize,
    terms: &[&[[f32; 3]]],
    whole: Option<&[[f32; 3]]>,
    note: &str,
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    terms_at(None, width, height, terms, whole, note, caption)
}

/// The sheet of [`terms`()] with the same gain for all pictures, if one is given.
///
/// # Errors
/// As for [`grid`].
pub fn terms_at(
    gain: Option<f64>,
    width: usize,
    height: usize,
    terms: &[&[[f32; 3]]],
    whole: Option<&[[f32; 3]]>,
    note: &str,
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    let name = |k: usize| match k {
        0 => "T⁰E: emission".to_string(),
        1 => "T¹E: direct light".to_string(),
        k => format!("T{}E", superscript(k)),
    };
    let mut cells: Vec<Cell> =
        terms.iter().enumerate().map(|(k, pixels)| Cell { label: name(k), pixels, gain }).collect();
    cells.extend(whole.map(|pixels| Cell { label: "Σ, all k".into(), pixels, gain }));
    grid(&format!("The terms of L = Σ TᵏE, {note}"), width, height, &cells, caption)
}

/// Direct light (k ≤ 1) next to direct plus indirect light. Both have the same exposure: the one that suits the right image
/// outside the visible lamps. `emitted` is the term k = 0.
///
/// # Errors
/// As for [`grid`].
pub fn direct_and_indirect(
    width: usize,
    height: usize,
    emitted: &[[f32; 3]],
    direct: &[[f32; 3]],
    full: &[[f32; 3]],
    caption: &Caption,
) -> Result<Sheet, ReportError> {
    check_size("emission", width, height, emitted)?;
    let gain = Some(auto_gain_beside_lamps(full, emitted));
    let cells = [
        Cell { label: "direct: k ≤ 1".into(), pixels: direct, gain },
        Cell { label: "direct + indirect: all k".into(), pixels: full, gain },
    ];
    grid("What indirect light adds", width, height, &cells, caption)
}

fn check_size(label: &str, width: usize, height: usize, pixels: &[[f32; 3]]) -> Result<(), ReportError> {
    if width * height == pixels.len() && !pixels.is_empty() {
        return Ok(());
    }
    let cause = format!("image `{label}` has {} pixels instead of {width}×{height}", pixels.len());
    Err(ReportError::new("(sheet)", cause, "compare and combine images of one size"))
}
