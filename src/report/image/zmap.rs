//! The z map of two images: shows where they differ by more than their noise.
//!
//! For each pixel `z = (a − b) / √(se_a² + se_b²)`. It is drawn from blue (−4) over white (0) to red (+4), and in black
//! where z is not defined. If the images do not differ and there are many replicates, 4.6 % of the pixels lie beyond ±2 and
//! 0.27 % beyond ±3 (normal distribution). With few replicates the tails are heavier.
//!
//! Reference: Welch (1947), for samples with unequal variances.

use crate::report::{
    ReportError,
    image::{
        picture::{Picture, magnification},
        typeset::{Caption, LINE, SANS, caption_elements, page, text_element, text_width},
    },
};

const RANGE: f64 = 4.0;
const BLUE: [f64; 3] = [33.0, 82.0, 171.0];
const RED: [f64; 3] = [186.0, 26.0, 42.0];

/// A z map with its statistics.
#[derive(Clone, Debug)]
pub struct ZMap {
    /// The picture with legend and caption.
    pub picture: Picture,
    /// Number of pixels where z is defined.
    pub defined: usize,
    /// Fraction of the defined pixels with |z| > 2.
    pub beyond_2: f64,
    /// Fraction of the defined pixels with |z| > 3.
    pub beyond_3: f64,
}

/// Colour of a z value.
///
/// ```
/// use fredholm::report::image::zmap::color;
/// assert_eq!(color(0.0), [255, 255, 255]);
/// assert_eq!(color(9.0), color(4.0));
/// assert_eq!(color(f64::NAN), [0, 0, 0]);
/// ```
pub fn color(z: f64) -> [u8; 3] {
    if z.is_nan() {
        return [0; 3];
    }
    let end = if z < 0.0 { BLUE } else { RED };
    let t = (z.abs() / RANGE).min(1.0);
    end.map(|c| (255.0 + t * (c - 255.0)).round() as u8)
}

/// Draws `z` (NaN: not defined) with a legend bar, the fractions beyond 2 and 3, and the caption.
///
/// # Errors
/// If the values do not match the size or the text cannot be drawn.
pub fn draw(title: &str, width: usize, height: usize, z: &[f64], caption: &Caption) -> Result<ZMap, ReportError> {
    if z.len() != width * height || z.is_empty() {
        let cause = format!("{} values do not make {width}×{height} pixels", z.len());
        return Err(ReportError::new("(z map)", cause, "compare images of one size"));
    }
    let defined = z.iter().filter(|z| !z.is_nan()).count();
    let beyond = |limit: f64| z.iter().filter(|z| z.abs() > limit).count() as f64 / defined as f64;
    let (beyond_2, beyond_3) = (beyond(2.0), beyond(3.0));
    let image = Picture { width, height, pixels: z.iter().map(|&z| color(z)).collect() };
    let image = image.enlarged(magnification(width, height, 256));

    const GAP: f64 = 16.0;
    const TITLE: f64 = 16.0;
    const TEXT: f64 = 12.0;
    const SMALL: f64 = 10.5;
    const BAR: f64 = 14.0;
    let sheet_w = (image.width as f64 + 2.0 * GAP).max(460.0).max(text_width(title, SANS, TITLE) + 2.0 * GAP).ceil();
    let inner = sheet_w - 2.0 * GAP;
    let percent = |f: f64| if f.is_nan() { "–".into() } else { format!("{:.2} %", 100.0 * f) };
    let undefined = z.len() - defined;
    let mut facts = vec![
        format!("|z| > 2: {} of the pixels (4.55 % if equal)", percent(beyond_2)),
        format!("|z| > 3: {} of the pixels (0.27 % if equal)", percent(beyond_3)),
    ];
    if undefined > 0 {
        facts.push(format!("black: {undefined} pixels without a z value (their noise is zero or not known)"));
    }
    let lines = caption.lines(inner, SMALL);

    // From top to bottom: title, map, legend bar with its numbers, statistics, caption.
    let map_y = GAP + TITLE * LINE;
    let bar_y = map_y + image.height as f64 + GAP;
    let facts_y = bar_y + BAR + 2.0 * TEXT * LINE;
    let caption_y = facts_y + facts.len() as f64 * TEXT * LINE;
    let sheet_h = caption_y + lines.len() as f64 * SMALL * LINE + GAP * 0.5;
    let mut words = text_element(GAP, GAP + TITLE * 0.8, TITLE, SANS, "", title);
    let bar_w = inner.min(400.0).floor();
    for tick in [-4i32, -3, -2, -1, 0, 1, 2, 3, 4] {
        let x = GAP + bar_w * (f64::from(tick) + RANGE) / (2.0 * RANGE);
        let anchor = match tick {
            -4 => "start",
            4 => "end",
            _ => "middle",
        };
        let label = format!("{}{}", if tick < 0 { "−" } else { "" }, tick.abs());
        words += &text_element(x, bar_y + BAR + TEXT, TEXT, SANS, &format!("text-anchor=\"{anchor}\""), &label);
    }
    let zero = GAP + bar_w + 8.0;
    words += &text_element(zero, bar_y + TEXT, TEXT, SANS, "", "z");
    for (i, fact) in facts.iter().enumerate() {
        words += &text_element(GAP, facts_y + i as f64 * TEXT * LINE, TEXT, SANS, "", fact);
    }
    words += &caption_elements(&lines, GAP, caption_y + SMALL * 0.4, SMALL);
    words += &format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888888\"/>",
        GAP - 0.5,
        bar_y.round() - 0.5,
        bar_w + 1.0,
        BAR + 1.0
    );

    let mut picture = page(sheet_w as usize, sheet_h.ceil() as usize, &words)?;
    picture.paste(&image, GAP as usize, map_y.round() as usize);
    let columns = bar_w as usize;
    let shade = |x: usize| color(RANGE * (2.0 * (x as f64 + 0.5) / bar_w - 1.0));
    let bar = (0..columns * BAR as usize).map(|i| shade(i % columns)).collect();
    let bar = Picture { width: columns, height: BAR as usize, pixels: bar };
    picture.paste(&bar, GAP as usize, bar_y.round() as usize);
    Ok(ZMap { picture, defined, beyond_2, beyond_3 })
}
