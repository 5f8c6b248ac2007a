//! Pictures of several settings side by side at one exposure, with numbers below each.
//!
//! ```text
//! code = round(255 · s(gain · L)),   the same gain for every picture
//! panel width = m · w  or  ⌈w/m⌉     with a whole number m, at least 256 pixels
//! ```
//!
//! A number says how large the noise is, and the picture shows how it looks. A common gain makes the pictures comparable, so
//! the gain is printed once, in the title. Small images are enlarged by repeating pixels, large ones are averaged down in linear
//! radiance; both by a whole number m, so that all pixels keep the same size.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | s | transfer curve of sRGB | [`super::picture`] |
//! | w | width of the image in pixels | argument of [`draw`] |
//! | m | factor of enlarging or reducing | `Size` |
//!
//! Reference: IEC 61966-2-1 (1999), for the transfer curve.

use super::{
    picture::{Picture, develop, gain_label, shrink},
    sheet::{GAP, Layout, READABLE, Tile, in_rows, words},
    typeset::{Caption, SANS, text_width, wrap},
};
use crate::report::ReportError;

/// Narrowest panel in pixels.
pub const NARROWEST: usize = 256;
/// Widest sheet in pixels.
pub const WIDEST: usize = 1920;
/// Height above which a panel is not enlarged further.
const TALLEST: usize = 640;
/// Most panels in a row.
const MOST: usize = 5;
/// Scale of the text.
const TEXT: f64 = READABLE;
/// Font size of the text below all panels.
const SMALL: f64 = 10.5 * TEXT;
/// Longest label in letters.
const LETTERS: usize = 22;

/// One setting: its image and what is written beside it.
#[derive(Clone, Debug)]
pub struct Panel<'a> {
    /// Line above the picture: the value of the setting. A long one is cut.
    pub label: String,
    /// Linear RGB; all images of a sheet have the same size.
    pub pixels: &'a [[f32; 3]],
    /// Lines below the picture.
    pub numbers: Vec<String>,
}

/// How an image is resized.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    /// Each pixel is repeated m times in both directions.
    Enlarged(usize),
    /// Blocks of m × m pixels are averaged.
    Reduced(usize),
}

/// Draws the sheet. `title` is followed by the common gain; `foot` explains the numbers.
///
/// # Errors
/// If there is no panel, the pixels do not match the size, or the text cannot be drawn.
pub fn draw(
    title: &str,
    [width, height]: [usize; 2],
    panels: &[Panel],
    gain: f64,
    foot: &str,
    caption: &Caption,
) -> Result<Picture, ReportError> {
    if panels.is_empty() || panels.iter().any(|p| p.pixels.len() != width * height || p.pixels.is_empty()) {
        let cause = format!("{} images do not make a sheet of {width}×{height} pixels", panels.len());
        return Err(ReportError::new("(sheet)", cause, "compare at least one image, and images of one size"));
    }
    let text = panels.iter().map(|p| words(&short(&p.label), &p.numbers, TEXT)).fold(0.0, f64::max);
    let (columns, size) = arranged(panels.len(), [width, height], text);
    let tile = |p: &Panel| {
        let image = match size {
            Size::Enlarged(m) => develop(width, height, p.pixels, gain).picture.enlarged(m),
            Size::Reduced(m) => {
                let (w, h, small) = shrink(width, height, p.pixels, m);
                develop(w, h, &small, gain).picture
            }
        };
        Tile { image, label: short(&p.label), notes: p.numbers.clone() }
    };
    let tiles: Vec<Tile> = panels.iter().map(tile).collect();
    let places = in_rows(tiles.len(), columns);
    let title = format!("{title}; exposure {} for all", gain_label(gain));
    let shown = tiles[0].image.width as f64;
    let across = (columns as f64 * (shown.max(text) + GAP * TEXT)).max(1200.0).min(WIDEST as f64 - 2.0 * GAP * TEXT);
    let reduced = match size {
        Size::Enlarged(_) => String::new(),
        Size::Reduced(m) => {
            format!(" Each pixel of a panel is the mean of {m} × {m} pixels of the image, so it shows less noise.")
        }
    };
    let foot = wrap(&format!("{foot}{reduced}"), |line| text_width(line, SANS, SMALL) <= across).join("\n");
    Layout { title: &title, tiles: &tiles, places: &places, heads: &[], foot: Some(&foot), scale: TEXT }.draw(caption)
}

/// The number of columns, and the size of the panels: as few rows as possible, then panels as large as possible. Averaging
/// hides noise, so an image is reduced only if two of them do not fit side by side.
fn arranged(count: usize, image: [usize; 2], text: f64) -> (usize, Size) {
    let balanced = |most: usize| count.div_ceil(count.div_ceil(most));
    let columns = || (1..=count.min(MOST)).rev().map(balanced);
    let fits = |columns: usize| size(image, room(columns), text).map(|size| (columns, size));
    let whole = |columns: usize| fits(columns).filter(|(_, size)| matches!(size, Size::Enlarged(_)));
    let of_whole = columns().filter(|&columns| columns > 1 || count == 1).find_map(whole);
    of_whole.or_else(|| columns().find_map(fits)).unwrap_or((1, Size::Enlarged(1)))
}

/// Width of one of several columns of the widest sheet.
fn room(columns: usize) -> f64 {
    let gap = GAP * TEXT;
    (WIDEST as f64 - gap) / columns as f64 - gap
}

/// The largest size that fits into `room` and is not narrower than [`NARROWEST`]; none if there is no such size, or if the text
/// does not fit.
fn size([w, h]: [usize; 2], room: f64, text: f64) -> Option<Size> {
    let room = room.floor() as usize;
    if text > room as f64 {
        return None;
    }
    if w > room {
        let m = w.div_ceil(room);
        return (w.div_ceil(m) >= NARROWEST).then_some(Size::Reduced(m));
    }
    let (least, fits) = (NARROWEST.div_ceil(w), room / w);
    let m = fits.min(least.max(TALLEST / h));
    (m >= least).then_some(Size::Enlarged(m))
}

/// A label, cut if it is long.
fn short(label: &str) -> String {
    if label.chars().count() <= LETTERS {
        label.into()
    } else {
        label.chars().take(LETTERS - 1).chain(['…']).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn shown(w: usize, size: Size) -> usize {
        match size {
            Size::Enlarged(m) => w * m,
            Size::Reduced(m) => w.div_ceil(m),
        }
    }

    /// Panels have at least 256 pixels, and a row of them fits, for images of any width.
    #[test]
    fn panels_are_wide_enough_and_fit() {
        for (count, w) in (1..=11).flat_map(|n| (1..=2500).map(move |w| (n, w))) {
            let (columns, size) = arranged(count, [w, w], 340.0);
            let panel = shown(w, size);
            assert!(panel >= NARROWEST, "{count} images of {w}: {panel}");
            assert!(panel as f64 <= room(columns), "{count} images of {w}: {panel} in {columns} columns");
            assert!(columns <= count.min(MOST));
        }
    }

    /// Images as they are used: four in a row, three enlarged further; long text takes columns away.
    #[test]
    fn few_rows_then_large_panels() {
        assert_eq!(arranged(4, [64, 64], 300.0), (4, Size::Enlarged(6)));
        assert_eq!(arranged(3, [128, 128], 300.0), (3, Size::Enlarged(4)));
        assert_eq!(arranged(5, [256, 256], 300.0), (5, Size::Enlarged(1)));
        assert_eq!(arranged(9, [48, 48], 300.0), (5, Size::Enlarged(7)));
        assert_eq!(arranged(4, [512, 512], 300.0), (2, Size::Enlarged(1)));
        assert_eq!(arranged(4, [64, 64], 500.0), (2, Size::Enlarged(10)));
    }

    #[test]
    fn a_sheet_is_no_wider_than_a_slide() {
        let pixels = vec![[0.3; 3]; 64 * 64];
        let panel = |i: usize| Panel {
            label: format!("table:0,0,0.5,0.25,0.125,{i}"),
            pixels: &pixels,
            numbers: vec!["efficiency ×1.31 ± 0.09".into()],
        };
        let caption = Caption { command: "fredholm sweep".into(), seed: 0, scene: "cornell".into() };
        let panels: Vec<Panel> = (0..5).map(panel).collect();
        let sheet = draw("cornell by roulette", [64, 64], &panels, 2.0, &"word ".repeat(90), &caption).unwrap();
        assert!(sheet.width <= WIDEST && sheet.width > 3 * NARROWEST, "{}", sheet.width);
        assert!(draw("none", [64, 64], &[], 2.0, "", &caption).is_err());
        assert!(draw("small", [63, 64], &panels, 2.0, "", &caption).is_err());
    }
}
