//! A slide with pictures: a title, a line below it, rows of pictures with text, and lines with results.
//!
//! ```text
//! title   line below it   rows of pictures, each with a label above and notes below   results   command, seed, scene
//! ```
//!
//! | what | place |
//! |---|---|
//! | a picture with its label and notes | [`Tile`] |
//! | the page, filled from top to bottom; lengths are CSS pixels, the PNG has two pixels per CSS pixel | [`Board`] |
//!
//! A line of text that does not fit, or a page that is too high, is an error: a slide never shows clipped text.

use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{Picture, develop};
use fredholm::report::image::typeset::{SANS, text_width, wrap};
use fredholm::report::plot::{Canvas, Drawn, GREY, Place, Words, figure};

/// Width of a slide.
pub(crate) const WIDTH: f64 = 960.0;
/// Space at the left and right edge.
pub(crate) const MARGIN: f64 = 16.0;
/// Greatest height of a slide, with its caption.
const HIGHEST: u32 = 600;
/// Space between pictures.
pub(crate) const GAP: f64 = 12.0;
const TITLE: f64 = 20.0;
const LABEL: f64 = 14.0;
const NOTE: f64 = 13.0;
const LINE: f64 = 1.3;

/// A picture with its text.
pub(crate) struct Tile {
    /// The picture.
    pub(crate) image: Picture,
    /// Picture pixels per CSS pixel, 1 or 2.
    pub(crate) fine: usize,
    /// Text above the picture.
    pub(crate) label: String,
    /// Lines below the picture.
    pub(crate) notes: Vec<String>,
}

impl Tile {
    /// A linear image of this width, developed with this gain.
    pub(crate) fn new(
        width: u32,
        pixels: &[[f32; 3]],
        gain: f64,
        label: impl Into<String>,
        notes: Vec<String>,
    ) -> Self {
        let width = width as usize;
        let image = develop(width, pixels.len() / width, pixels, gain).picture;
        Self { image, fine: 1, label: label.into(), notes }
    }

    /// The same picture with two picture pixels per CSS pixel.
    pub(crate) fn fine(self) -> Self {
        Self { fine: 2, ..self }
    }

    /// The same picture with every pixel repeated: a small picture of a short run takes the room of a large one.
    pub(crate) fn enlarged(self, factor: usize) -> Self {
        Self { image: self.image.enlarged(factor), ..self }
    }

    fn size(&self) -> [f64; 2] {
        [self.image.width, self.image.height].map(|n| n as f64 / self.fine as f64)
    }
}

/// A slide that is filled from top to bottom.
pub(crate) struct Board {
    /// Upper end of the free space.
    pub(crate) y: f64,
    pictures: Vec<(Picture, [u32; 2], usize)>,
    texts: Vec<(String, Place, Words)>,
    too_wide: Vec<String>,
}

impl Board {
    /// A page with its title and a text below it, which may be empty.
    pub(crate) fn new(title: &str, lead: &str) -> Self {
        let mut board = Self { y: 26.0, pictures: vec![], texts: vec![], too_wide: vec![] };
        let words = Words { size: TITLE, bold: true, ..Words::default() };
        board.text(title, (MARGIN, board.y), WIDTH - 2.0 * MARGIN, words);
        board.y += 0.5 * TITLE + 12.0;
        if !lead.is_empty() {
            board.lines(lead, 14.0);
        }
        board
    }

    /// One line of text, vertically centred on `at`, at most `room` wide.
    pub(crate) fn text(&mut self, text: &str, at: Place, room: f64, words: Words) {
        // bold letters are up to 1.15 times as wide as the letters that are measured
        let width = text_width(text, words.family, words.size) * if words.bold { 1.12 } else { 1.0 };
        if width > room {
            self.too_wide.push(format!("`{text}` is {width:.0} wide, and there is room for {room:.0}"));
        }
        self.texts.push((text.into(), at, words));
    }

    /// A paragraph over the whole width.
    pub(crate) fn lines(&mut self, text: &str, size: f64) {
        self.y = self.paragraph(text, (MARGIN, self.y), WIDTH - 2.0 * MARGIN, size) + 4.0;
    }

    /// A paragraph of a given width whose first line is centred on `at`. Returns the place of the line after it.
    pub(crate) fn paragraph(&mut self, text: &str, at: Place, width: f64, size: f64) -> f64 {
        let (x, mut y) = at;
        for line in wrap(text, |line| text_width(line, SANS, size) <= width) {
            self.text(&line, (x, y), width, Words { size, ..Words::default() });
            y += size * LINE;
        }
        y
    }

    /// A row of tiles between two places, at equal distances. Moves the free space below the row and its notes.
    pub(crate) fn row(&mut self, tiles: Vec<Tile>, [left, right]: [f64; 2]) {
        let pitch = (right - left + GAP) / tiles.len() as f64;
        let top = self.y + LABEL * LINE - 2.0;
        let mut bottom = top;
        for (i, tile) in tiles.into_iter().enumerate() {
            let (x, [w, h]) = ((left + i as f64 * pitch).round(), tile.size());
            let room = pitch - GAP + 2.0;
            if w > room {
                self.too_wide.push(format!("a picture is {w} wide, and there is room for {room}"));
            }
            self.text(&tile.label, (x, top - 11.0), room, Words { size: LABEL, bold: true, ..Words::default() });
            let notes = tile.notes.len() as f64;
            for (line, note) in tile.notes.iter().enumerate() {
                let y = top + h + NOTE * (0.9 + line as f64 * LINE);
                self.text(note, (x, y), room, Words { size: NOTE, color: GREY, ..Words::default() });
            }
            bottom = f64::max(bottom, top + h + notes * NOTE * LINE + 4.0);
            self.pictures.push((tile.image, [x as u32, top.round() as u32], tile.fine));
        }
        self.y = bottom + 10.0;
    }

    /// A row of tiles over the whole width.
    pub(crate) fn wide_row(&mut self, tiles: Vec<Tile>) {
        self.row(tiles, [MARGIN, WIDTH - MARGIN]);
    }

    /// A picture without text, with `fine` picture pixels per CSS pixel.
    pub(crate) fn picture(&mut self, image: Picture, at: [u32; 2], fine: usize) {
        self.pictures.push((image, at, fine));
    }

    /// Writes `ID.svg` and `ID.png`. `draw` adds lines and curves.
    pub(crate) fn finish(
        self,
        folder: &Folder<'_>,
        slide: &Slide,
        draw: impl FnOnce(&Canvas<'_>) -> Drawn,
    ) -> Result<()> {
        if !self.too_wide.is_empty() {
            return Err(format!("slide {}: {}", slide.id, self.too_wide.join("; ")).into());
        }
        let height = self.y.ceil() as u32;
        let mut page = figure(slide.id, WIDTH as u32, height, &folder.caption(slide.scene), |canvas| {
            self.texts.iter().try_for_each(|(text, at, words)| canvas.text(text, *at, *words))?;
            draw(canvas)
        })?;
        if page.height > HIGHEST {
            return Err(format!("slide {} is {} high instead of at most {HIGHEST}", slide.id, page.height).into());
        }
        for (picture, at, fine) in self.pictures {
            page = page.over(picture, at, fine)?;
        }
        folder.figure(slide.id, &page)?;
        Ok(())
    }
}
