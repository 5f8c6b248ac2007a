//! The pyramid of strategies: one row for every term, one column for every number s of vertices sampled from the light.
//!
//! With MIS weights, the images of a row add up to the term. They have the same exposure, so that they can be compared by
//! eye. Without weights, each image has its own exposure, because all show the same light with different noise. The layout
//! is that of Veach (1997), fig. 10.3.

use crate::report::{
    ReportError,
    image::{
        contact_sheet::shown,
        picture::{Picture, auto_gain, gain_label},
        sheet::{Layout, Tile},
        typeset::{Caption, superscript},
    },
    text::{
        number::{average, error, known, significant},
        table::{Side, aligned},
    },
};

use crate::study::strategies::Strategy;

const WIDEST: usize = 144;
const NARROWEST: usize = 96;

/// One image of the pyramid.
#[derive(Clone, Debug)]
pub struct Stone<'a> {
    /// The term k.
    pub k: usize,
    /// Number s of vertices sampled from the light.
    pub s: usize,
    /// Linear RGB.
    pub pixels: &'a [[f32; 3]],
    /// Text below the image.
    pub note: String,
}

/// Name of strategy s of term k.
pub fn name(k: usize, s: usize) -> String {
    match s {
        0 => "s = 0: hit".into(),
        s if s == k + 1 => format!("s = {s}: connected to the camera"),
        1 => "s = 1: connect".into(),
        s => format!("s = {s}"),
    }
}

/// Draws the pyramid. If `common` is true, all images of a row have the same exposure.
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
    let tile = |s: &Stone| {
        let gain = if common { gains[s.k] } else { auto_gain(s.pixels) };
        let note = if common { s.note.clone() } else { format!("{} · {}", gain_label(gain), s.note) };
        let image = shown(width, height, s.pixels, gain, NARROWEST, WIDEST);
        Tile { image, label: name(s.k, s.s), notes: vec![note] }
    };
    let tiles: Vec<Tile> = stones.iter().map(tile).collect();
    // centre each row of the pyramid
    let place = |s: &Stone| (0.5 * (columns - (s.k + 2)) as f64 + s.s as f64, s.k);
    let places: Vec<_> = stones.iter().map(place).collect();
    let exposure = |gain: f64| if common { gain_label(gain) } else { String::new() };
    let head = |(k, &gain): (usize, &f64)| [format!("T{}E", superscript(k)), exposure(gain)];
    let heads: Vec<_> = gains.iter().enumerate().map(head).collect();
    Layout { title, tiles: &tiles, places: &places, heads: &heads, foot: None, scale: 1.0 }.draw(caption)
}

/// A table with a row per strategy: its contribution, its estimate without weight, and the variance of both.
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
    format!("strategies: s vertices sampled from the light, k + 1 − s from the eye\n{}", aligned(&rows, &sides))
}
