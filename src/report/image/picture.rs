//! Converts linear radiance to an 8-bit picture, with one gain and the exact sRGB curve. No tone mapping is applied.
//!
//! ```text
//! code = round(255 · s(gain · L)),   s(v) = 12.92 v                   v ≤ 0.0031308
//!                                    s(v) = 1.055 v^(1/2.4) − 0.055   otherwise
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | L | linear Rec. 709 component | `pixels` |
//! | s | transfer curve of IEC 61966-2-1 (1999) | [`srgb`] |
//! | gain | …, 1/2, 1/1.5, 1, 1.5, 2, 3, 4, 6, 8, … | [`auto_gain`] |

use std::{io::Cursor, path::Path, sync::OnceLock};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::codes::Codes;
use crate::report::{ReportError, write_atomically};

/// An 8-bit sRGB picture, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `[R, G, B]` codes.
    pub pixels: Vec<[u8; 3]>,
}

/// A picture in 8 bits, with the numbers of pixels that a screen cannot show correctly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Developed {
    /// The picture.
    pub picture: Picture,
    /// Number of pixels with a component above 1 after the gain; such components are shown as 255.
    pub clipped: usize,
    /// Number of pixels with a component below 0; such components are shown as 0.
    pub negative: usize,
    /// Number of pixels with a component that is NaN or infinite; they are shown in magenta.
    pub non_finite: usize,
}

/// The sRGB transfer curve, for `0 ≤ linear ≤ 1`.
///
/// ```
/// use fredholm::report::image::picture::srgb;
/// assert_eq!(srgb(0.0), 0.0);
/// assert!((srgb(1.0) - 1.0).abs() < 1e-12);
/// assert!((srgb(0.0031308) - 12.92 * 0.0031308).abs() < 1e-12);
/// assert!((srgb(0.214_041_14) - 0.5).abs() < 1e-8);
/// ```
pub fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Colour of pixels that are not finite, chosen so that they are noticed.
pub const NON_FINITE: [u8; 3] = [255, 0, 255];

/// Applies the gain and the sRGB curve to linear pixels.
pub fn develop(width: usize, height: usize, pixels: &[[f32; 3]], gain: f64) -> Developed {
    static CODES: OnceLock<Codes> = OnceLock::new();
    let srgb_codes = CODES.get_or_init(|| Codes::new(srgb));
    let (mut clipped, mut negative, mut non_finite) = (0, 0, 0);
    let codes = pixels
        .iter()
        .map(|pixel| {
            if pixel.iter().any(|v| !v.is_finite()) {
                non_finite += 1;
                return NON_FINITE;
            }
            let scaled = pixel.map(|v| gain * f64::from(v));
            clipped += usize::from(scaled.iter().any(|&v| v > 1.0));
            negative += usize::from(scaled.iter().any(|&v| v < 0.0));
            scaled.map(|v| srgb_codes.of(v.clamp(0.0, 1.0)))
        })
        .collect();
    Developed { picture: Picture { width, height, pixels: codes }, clipped, negative, non_finite }
}

/// The gain out of …, 1/3, 1/2, 1/1.5, 1, 1.5, 2, 3, 4, 6, 8, 12, 16, … that brings the 99th percentile of luminance
/// nearest to 0.8.
///
/// If more than 99 % of the pixels are black (for example with a small lamp), the percentile of the other pixels is used. A
/// completely black image gets the gain 1.
///
/// ```
/// use fredholm::report::image::picture::auto_gain;
/// assert_eq!(auto_gain(&[[0.05; 3]; 100]), 16.0);
/// assert_eq!(auto_gain(&[[4.0; 3]; 100]), 1.0 / 6.0);
/// assert_eq!(auto_gain(&[[0.0; 3]; 100]), 1.0);
/// ```
pub fn auto_gain(pixels: &[[f32; 3]]) -> f64 {
    gain_for(pixels.iter().map(|&p| luminance(p)))
}

/// The gain that suits everything but the lamps: [`auto_gain`] of the pixels where `emitted` (the term k = 0) is black. A
/// visible lamp may be hundreds of times brighter than the walls. With an exposure for the lamp, the walls would be black.
///
/// ```
/// use fredholm::report::image::picture::{auto_gain, auto_gain_beside_lamps};
/// let (lamp, wall) = ([17.0; 3], [0.1; 3]);
/// let image = [[lamp; 5], [wall; 5]].concat();
/// let emitted = [[lamp; 5], [[0.0; 3]; 5]].concat();
/// assert_eq!(auto_gain_beside_lamps(&image, &emitted), 8.0);
/// assert!(auto_gain(&image) < 0.1);
/// ```
pub fn auto_gain_beside_lamps(pixels: &[[f32; 3]], emitted: &[[f32; 3]]) -> f64 {
    if emitted.iter().all(|&e| luminance(e) != 0.0) {
        return auto_gain(pixels);
    }
    gain_for(pixels.iter().zip(emitted).filter(|&(_, &e)| luminance(e) == 0.0).map(|(&p, _)| luminance(p)))
}

fn gain_for(luminance: impl Iterator<Item = f64>) -> f64 {
    let mut luminance: Vec<f64> = luminance.filter(|y| y.is_finite()).collect();
    let percentile = |all: &mut [f64]| {
        let place = (all.len() * 99).div_ceil(100).max(1) - 1;
        if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(place, f64::total_cmp).1 }
    };
    let mut bright = percentile(&mut luminance);
    if bright <= 0.0 {
        luminance.retain(|&y| y > 0.0);
        bright = percentile(&mut luminance);
    }
    if bright > 0.0 { nearest_gain(0.8 / bright) } else { 1.0 }
}

/// The gain of the form 2ⁿ or 1.5 · 2ⁿ that is nearest to `gain` on a logarithmic scale.
fn nearest_gain(gain: f64) -> f64 {
    let up = gain.max(1.0 / gain);
    let power = up.log2().floor().exp2();
    let nice = [power, 1.5 * power, 2.0 * power];
    let distance = |candidate: f64| (candidate / up).ln().abs();
    let best = nice.into_iter().min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(power);
    if gain >= 1.0 { best } else { 1.0 / best }
}

/// A gain as text: `×16`, `÷1.5`.
///
/// ```
/// use fredholm::report::image::picture::gain_label;
/// assert_eq!((gain_label(16.0), gain_label(1.5), gain_label(1.0 / 3.0)), ("×16".into(), "×1.5".into(), "÷3".into()));
/// ```
pub fn gain_label(gain: f64) -> String {
    let rounded = |v: f64| (v * 1e3).round() / 1e3;
    if gain >= 1.0 { format!("×{}", rounded(gain)) } else { format!("÷{}", rounded(1.0 / gain)) }
}

/// Luminance of linear Rec. 709 components.
pub fn luminance(rgb: [f32; 3]) -> f64 {
    crate::math::luminance(glam::Vec3::from(rgb).as_dvec3())
}

/// Mean over all pixels and the three channels.
pub fn mean(pixels: &[[f32; 3]]) -> f64 {
    pixels.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / (3 * pixels.len()) as f64
}

/// Mean over all pixels and the three channels of the image that a screen shows, in the unit of radiance. Values below 0,
/// and values above 1 after the gain, are cut off. NaN if a pixel is NaN.
///
/// ```
/// use fredholm::report::image::picture::{mean, shown_mean};
/// // one firefly among four pixels: the mean is 1, the screen shows a quarter of it
/// let pixels = [[4.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]];
/// assert_eq!((mean(&pixels), shown_mean(&pixels, 1.0)), (1.0, 0.25));
/// assert_eq!(shown_mean(&pixels, 0.25), 1.0);
/// ```
pub fn shown_mean(pixels: &[[f32; 3]], gain: f64) -> f64 {
    pixels.iter().flatten().map(|&v| (gain * f64::from(v)).clamp(0.0, 1.0)).sum::<f64>()
        / (3 * pixels.len()) as f64
        / gain
}

/// Averages blocks of `factor × factor` linear pixels; blocks at the right and lower edge may be smaller.
pub(crate) fn shrink(width: usize, height: usize, pixels: &[[f32; 3]], factor: usize) -> (usize, usize, Vec<[f32; 3]>) {
    let (w, h) = (width.div_ceil(factor), height.div_ceil(factor));
    let block = |i: usize| {
        let (x0, y0) = (i % w * factor, i / w * factor);
        let (x1, y1) = ((x0 + factor).min(width), (y0 + factor).min(height));
        let mut sum = [0.0f64; 3];
        for p in (y0..y1).flat_map(|y| &pixels[y * width + x0..y * width + x1]) {
            (0..3).for_each(|c| sum[c] += f64::from(p[c]));
        }
        sum.map(|s| (s / ((x1 - x0) * (y1 - y0)) as f64) as f32)
    };
    (w, h, (0..w * h).map(block).collect())
}

/// Tallest picture that is enlarged.
const TALLEST: usize = 4096;

/// How often the pixels of a picture are repeated so that it is about `narrowest` pixels wide, as far as it does not become too tall.
///
/// ```
/// use fredholm::report::image::picture::magnification;
/// assert_eq!((magnification(64, 64, 256), magnification(300, 200, 256)), (4, 1));
/// assert_eq!((magnification(1, 1, 256), magnification(1, 512, 256), magnification(1, 32768, 256)), (256, 8, 1));
/// ```
pub fn magnification(width: usize, height: usize, narrowest: usize) -> usize {
    narrowest.div_ceil(width.max(1)).min((TALLEST / height.max(1)).max(1))
}

impl Picture {
    /// Repeats every pixel `factor` times in both directions.
    #[must_use]
    pub fn enlarged(&self, factor: usize) -> Self {
        if factor == 1 {
            return self.clone();
        }
        let (width, height) = (self.width * factor, self.height * factor);
        let mut pixels = Vec::with_capacity(width * height);
        for row in self.pixels.chunks(self.width.max(1)) {
            let start = pixels.len();
            row.iter().for_each(|&p| pixels.extend(std::iter::repeat_n(p, factor)));
            let end = pixels.len();
            (1..factor).for_each(|_| pixels.extend_from_within(start..end));
        }
        Self { width, height, pixels }
    }

    /// Copies `other` onto this picture with its upper left corner at `(x, y)`; it must fit.
    pub fn paste(&mut self, other: &Self, x: usize, y: usize) {
        for (row, source) in other.pixels.chunks(other.width).enumerate() {
            let start = (y + row) * self.width + x;
            self.pixels[start..start + other.width].copy_from_slice(source);
        }
    }

    /// The PNG file as bytes; equal pictures give equal bytes.
    ///
    /// # Errors
    /// If the picture is empty or its pixels do not match its size; `path` only names it in the message.
    pub fn png(&self, path: &Path) -> Result<Vec<u8>, ReportError> {
        let mut bytes = Cursor::new(Vec::new());
        let flat = self.pixels.as_flattened();
        if self.width == 0 || flat.len() != 3 * self.width * self.height {
            let cause = format!("{} pixels do not make {}×{}", self.pixels.len(), self.width, self.height);
            return Err(ReportError::new(path, cause, "this is a defect of the program: please report it"));
        }
        PngEncoder::new(&mut bytes)
            .write_image(flat, self.width as u32, self.height as u32, ExtendedColorType::Rgb8)
            .map_err(|e| ReportError::new(path, e, "this is a defect of the program: please report it"))?;
        Ok(bytes.into_inner())
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        write_atomically(path, &self.png(path)?)
    }
}
