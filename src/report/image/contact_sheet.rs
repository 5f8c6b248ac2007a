//! Pictures with words: one term above its strip, and grids of labelled cells.
//!
//! No word covers a pixel: text stands on strips beside the images. Images narrower than 128 pixels are enlarged by
//! repeating pixels, images wider than 512 are averaged down (in linear radiance) in the grids, never in single
//! pictures. The 99th percentile and the mean are those of the full image.

use crate::report::{
    ReportError,
    image::{
        picture::{Developed, Picture, auto_gain, auto_gain_beside_lamps, develop, gain_label, mean, shrink},
        typeset::{Caption, LINE, SANS, caption_elements, page, superscript, text_element, text_width},
    },
    text::number::significant,
};

const LABEL: f64 = 14.0;
const NOTE: f64 = 12.0;
const CAPTION: f64 = 10.5;
const TITLE: f64 = 18.0;
const GAP: f64 = 16.0;
const NARROWEST: usize = 128;
const WIDEST: usize = 512;
const SHEET: f64 = 1600.0;

/// One image of a sheet.
#[derive(Clone, Debug)]
pub struct Cell<'a> {
    /// Line above the image, such as `T3 E`.
    pub label: String,
    /// Linear RGB; every cell of a sheet has the same size.
    pub pixels: &'a [[f32; 3]],
    /// Gain to show it with; absent: [`auto_gain`].
    pub gain: Option<f64>,
}

/// A sheet ready to be written, and what is clipped on it.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The picture.
    pub picture: Picture,
    /// Clipped pixels per cell, of the image as given.
    pub clipped: Vec<usize>,
}

/// One image with a strip below that says what it is and with which gain: `T3  ×16`. Returns the gain used, too.
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
    // Shrink the letters rather than cut them on a narrow image, but keep them readable.
    let natural = text_width(&text, SANS, LABEL) + 8.0;
    let factor = (48usize).div_ceil(width);
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
/// Under each image stand its gain and its mean over pixels and channels. For images side by side at a common exposure
/// give every cell the same gain.
///
/// # Errors
/// If there is no cell, the pixels do not match the size, or the text cannot be drawn.
pub fn grid(title: &str, width: usize, height: usize, cells: &[Cell], caption: &Caption) -> Result<Sheet, ReportError> {
    laid_out(None, title, width, height, cells, &gains(cells), caption)
}

/// The same with so many cells in a row.
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

/// A [`grid`] with lines of one's own under each image; `notes` has an entry per cell.
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

/// Gain and mean of every cell.
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
    // Develop every image at the size it is shown with.
    let mut images = Vec::new();
    let mut clipped = Vec::new();
    for cell in cells {
        check_size(&cell.label, width, height, cell.pixels)?;
        let gain = cell.gain.unwrap_or_else(|| auto_gain(cell.pixels));
        clipped.push(develop(width, height, cell.pixels, gain).clipped);
        let (w, h, shown) = shrink(width, height, cell.pixels, width.div_ceil(WIDEST));
        let image = develop(w, h, &shown, gain).picture.enlarged(NARROWEST.div_ceil(w));
        images.push(image);
    }

    // Columns: as many as fit, then as few as the same number of rows allows.
    let noted = notes.iter().flatten().map(|note| text_width(note, SANS, NOTE));
    let widest_text = noted.chain(cells.iter().map(|cell| text_width(&cell.label, SANS, LABEL)));
    let (image_w, image_h) = (images[0].width as f64, images[0].height as f64);
    let lines_below = notes.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let cell_w = widest_text.fold(image_w, f64::max).ceil();
    let fit = (((SHEET - GAP) / (cell_w + GAP)).floor() as usize).clamp(1, cells.len());
    let fit = if cells.len() > 4 { fit.min((cells.len() as f64 * 1.8).sqrt().ceil() as usize) } else { fit };
    let columns = columns.unwrap_or_else(|| cells.len().div_ceil(cells.len().div_ceil(fit)));
    let rows = cells.len().div_ceil(columns);

    let natural = columns as f64 * (cell_w + GAP) + GAP;
    let sheet_w = natural.max(text_width(title, SANS, TITLE) + 2.0 * GAP).max(400.0).ceil();
    let lines = caption.lines(sheet_w - 2.0 * GAP, CAPTION);
    let cell_h = LABEL * LINE + image_h + lines_below * NOTE * LINE + GAP;
    let top = GAP + TITLE * LINE;
    let sheet_h = top + rows as f64 * cell_h + lines.len() as f64 * CAPTION * LINE + GAP;

    // Words first, then the pixels between them.
    let corner = |i: usize| (GAP + (i % columns) as f64 * (cell_w + GAP), top + (i / columns) as f64 * cell_h);
    let mut words = text_element(GAP, GAP + TITLE * 0.8, TITLE, SANS, "", title);
    for (i, (notes, cell)) in notes.iter().zip(cells).enumerate() {
        let (x, y) = corner(i);
        words += &text_element(x, y + LABEL, LABEL, SANS, "font-weight=\"bold\"", &cell.label);
        for (line, note) in notes.iter().enumerate() {
            let below = y + LABEL * LINE + image_h + NOTE * (1.2 + line as f64 * LINE);
            words += &text_element(x, below, NOTE, SANS, "fill=\"#333333\"", note);
        }
    }
    words += &caption_elements(&lines, GAP, top + rows as f64 * cell_h + CAPTION, CAPTION);
    let mut picture = page(sheet_w as usize, sheet_h.ceil() as usize, &words)?;
    for (i, image) in images.iter().enumerate() {
        let (x, y) = corner(i);
        picture.paste(image, x.round() as usize, (y + LABEL * LINE).round() as usize);
    }
    Ok(Sheet { picture, clipped })
}

/// The terms k = 0, 1, … each at its own exposure, and the whole if it is known.
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
    let name = |k: usize| match k {
        0 => "T⁰E: emission".to_string(),
        1 => "T¹E: direct light".to_string(),
        k => format!("T{}E", superscript(k)),
    };
    let mut cells: Vec<Cell> =
        terms.iter().enumerate().map(|(k, pixels)| Cell { label: name(k), pixels, gain: None }).collect();
    cells.extend(whole.map(|pixels| Cell { label: "Σ, all k".into(), pixels, gain: None }));
    grid(&format!("The terms of L = Σ TᵏE, {note}"), width, height, &cells, caption)
}

/// Direct light (k ≤ 1) beside direct plus indirect light, at one common exposure: that of the right image where no
/// lamp is seen. `emitted` is the term k = 0.
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
