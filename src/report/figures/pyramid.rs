//! The pyramid of strategies: a row for every term, a column for every number s of vertices walked from the light.
//!
//! Weighted, the images of a row add up to the term and stand at one exposure, so that light can be added up by eye; alone, each
//! has its own, because they show the same light with different noise. The layout is that of Veach (1997), fig. 10.3.

use crate::report::{
    ReportError,
    image::{
        picture::{Picture, auto_gain, develop, gain_label, shrink},
        typeset::{Caption, LINE, SANS, caption_elements, page, superscript, text_element, text_width},
    },
    text::{
        number::{average, error, known, significant},
        table::{Side, aligned},
    },
};

use crate::study::strategies::Strategy;

const LABEL: f64 = 13.0;
const NOTE: f64 = 10.5;
const TITLE: f64 = 18.0;
const GAP: f64 = 10.0;
const MARGIN: f64 = 64.0;
const WIDEST: usize = 144;
const NARROWEST: usize = 96;

/// One image of the pyramid.
#[derive(Clone, Debug)]
pub struct Stone<'a> {
    /// The term.
    pub k: usize,
    /// Vertices walked from the light.
    pub s: usize,
    /// Linear RGB.
    pub pixels: &'a [[f32; 3]],
    /// Words below it.
    pub note: String,
}

/// What strategy s of term k is called.
pub fn name(k: usize, s: usize) -> String {
    match s {
        0 => "s = 0: hit".into(),
        s if s == k + 1 => format!("s = {s}: to the eye"),
        1 => "s = 1: connect".into(),
        s => format!("s = {s}"),
    }
}

/// The pyramid; `common` gives every row one exposure.
///
/// # Errors
/// If there is no image, the pixels do not match the size, or the text cannot be drawn.
pub fn draw(
    title: &str,
    width: usize,
    height: usize,
    stones: &[Stone],
    common: bool,
    caption: &Caption,
) -> Result<Picture, ReportError> {
    if stones.is_empty() || stones.iter().any(|s| s.pixels.len() != width * height) {
        let cause = format!("{} images do not make a pyramid of {width}×{height} pixels", stones.len());
        return Err(ReportError::new("(pyramid)", cause, "render at least one term"));
    }
    let rows = stones.iter().map(|s| s.k).max().unwrap_or(0) + 1;
    let columns = stones.iter().map(|s| s.s).max().unwrap_or(0) + 1;
    let row_gain = |k: usize| {
        let mut sum = vec![[0.0; 3]; width * height];
        for stone in stones.iter().filter(|s| s.k == k) {
            sum.iter_mut().zip(stone.pixels).for_each(|(a, b)| (0..3).for_each(|c| a[c] += b[c]));
        }
        auto_gain(&sum)
    };
    let gains: Vec<f64> = (0..rows).map(row_gain).collect();
    let develop = |s: &Stone| {
        let gain = if common { gains[s.k] } else { auto_gain(s.pixels) };
        let (w, h, shown) = shrink(width, height, s.pixels, width.div_ceil(WIDEST));
        (develop(w, h, &shown, gain).picture.enlarged(NARROWEST.div_ceil(w)), gain)
    };
    let images: Vec<(Picture, f64)> = stones.iter().map(develop).collect();
    let words = |s: &Stone| text_width(&name(s.k, s.s), SANS, LABEL).max(text_width(&s.note, SANS, NOTE));
    let (image_w, image_h) = (images[0].0.width as f64, images[0].0.height as f64);
    let cell_w = stones.iter().map(words).fold(image_w, f64::max).ceil() + GAP;
    let cell_h = LABEL * LINE + image_h + NOTE * LINE + GAP;

    let sheet_w = (MARGIN + columns as f64 * cell_w + GAP).max(text_width(title, SANS, TITLE) + 2.0 * GAP);
    let lines = caption.lines(sheet_w - 2.0 * GAP, NOTE);
    let top = GAP + TITLE * LINE;
    let sheet_h = top + rows as f64 * cell_h + lines.len() as f64 * NOTE * LINE + GAP;
    // the rows of a pyramid are centred
    let corner = |s: &Stone| {
        let indent = 0.5 * (columns - (s.k + 2)) as f64 * cell_w;
        (MARGIN + indent + s.s as f64 * cell_w, top + s.k as f64 * cell_h)
    };

    let mut text = text_element(GAP, GAP + TITLE * 0.8, TITLE, SANS, "", title);
    for (k, &gain) in gains.iter().enumerate() {
        let y = top + k as f64 * cell_h + LABEL * LINE + 0.5 * image_h;
        text += &text_element(GAP, y, TITLE, SANS, "font-weight=\"bold\"", &format!("T{}E", superscript(k)));
        if common {
            text += &text_element(GAP, y + LABEL * LINE, LABEL, SANS, "fill=\"#333333\"", &gain_label(gain));
        }
    }
    for (stone, (_, gain)) in stones.iter().zip(&images) {
        let (x, y) = corner(stone);
        text += &text_element(x, y + LABEL, LABEL, SANS, "", &name(stone.k, stone.s));
        let note = if common { stone.note.clone() } else { format!("{} · {}", gain_label(*gain), stone.note) };
        text += &text_element(x, y + LABEL * LINE + image_h + NOTE * 1.2, NOTE, SANS, "fill=\"#333333\"", &note);
    }
    text += &caption_elements(&lines, GAP, top + rows as f64 * cell_h + NOTE, NOTE);
    let mut picture = page(sheet_w.ceil() as usize, sheet_h.ceil() as usize, &text)?;
    for (stone, (image, _)) in stones.iter().zip(&images) {
        let (x, y) = corner(stone);
        picture.paste(image, x.round() as usize, (y + LABEL * LINE).round() as usize);
    }
    Ok(picture)
}

/// A row for every strategy: what it adds, what it would give alone, and the noise of both.
pub fn table(all: &[Strategy]) -> String {
    let head = ["k", "strategy", "weighted", "± 95 %", "alone", "± 95 %", "variance weighted", "alone"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(all.iter().map(|s| {
        let [mean, alone] = s.means.each_ref().map(|e| average(e).0);
        let [weighted_error, alone_error] = s.means.each_ref().map(error);
        let [noise, noise_alone] = s.variances.map(known);
        let number = |x: f64| significant(x, 4);
        let numbers = [number(mean), weighted_error, number(alone), alone_error, noise, noise_alone];
        [s.k.to_string(), name(s.k, s.s)].into_iter().chain(numbers).collect()
    }));
    let mut sides = vec![Side::Right; head.len()];
    sides[1] = Side::Left;
    format!("strategies: s vertices walked from the light, k + 1 − s from the eye\n{}", aligned(&rows, &sides))
}
