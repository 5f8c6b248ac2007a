//! Text in pictures and plots. The DejaVu fonts are built into the program, so that every machine draws the same letters.
//!
//! The layout is written as SVG and rasterised by `resvg`. System fonts are never used. Lengths are CSS pixels.

use std::{
    fmt::Write,
    sync::{Arc, OnceLock},
};

use plotters::style::{FontStyle, IntoFont, register_font};
use resvg::{tiny_skia, usvg};

use crate::report::{ReportError, image::picture::Picture};

/// Font family of labels and titles.
pub const SANS: &str = "DejaVu Sans";
/// Font family of command lines.
pub const MONO: &str = "DejaVu Sans Mono";

/// Origin of a picture; printed in small letters below every sheet and figure.
///
/// ```
/// use fredholm::report::image::typeset::Caption;
/// let c = Caption { command: "fredholm series cornell --spp 64".into(), seed: 0, scene: "cornell".into() };
/// assert_eq!(c.lines(1000.0, 12.0), ["fredholm series cornell --spp 64", "scene cornell · seed 0"]);
/// assert!(c.lines(120.0, 12.0).len() > 2);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Caption {
    /// The command that reproduces the picture.
    pub command: String,
    /// Seed of its random numbers.
    pub seed: u64,
    /// Name of the scene.
    pub scene: String,
}

impl Caption {
    /// The caption broken into lines that fit `width` in the monospaced font.
    pub fn lines(&self, width: f64, font_size: f64) -> Vec<String> {
        let columns = (width / text_width("0", MONO, font_size)).floor().max(8.0) as usize;
        let fits = |line: &str| line.chars().count() <= columns;
        let origin = format!("scene {} · seed {}", self.scene, self.seed);
        [&self.command, &origin].into_iter().flat_map(|text| wrap(text, fits)).collect()
    }
}

/// A number in superscript, as in TᵏE.
///
/// ```
/// assert_eq!(fredholm::report::image::typeset::superscript(12), "¹²");
/// ```
pub fn superscript(k: usize) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    k.to_string().bytes().map(|b| DIGITS[usize::from(b - b'0')]).collect()
}

/// Breaks text at spaces (not at no-break spaces), so that every line `fits`. A word that is too long for a line is cut.
pub fn wrap(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split([' ', '\t', '\n']).filter(|word| !word.is_empty()) {
        let line = &lines[lines.len() - 1];
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if fits(&longer) {
            lines.pop();
            lines.push(longer);
            continue;
        }
        // Start a new line, unless the current one is empty. If the word alone is too long, break it between letters.
        let mut piece = String::new();
        if line.is_empty() {
            lines.pop();
        }
        for letter in word.chars() {
            piece.push(letter);
            if piece.chars().count() > 1 && !fits(&piece) {
                piece.pop();
                lines.push(std::mem::replace(&mut piece, letter.to_string()));
            }
        }
        lines.push(piece);
    }
    lines
}

/// Width of a line of text in pixels.
pub fn text_width(text: &str, family: &str, font_size: f64) -> f64 {
    register_fonts();
    const MEASURED_AT: f64 = 1000.0;
    // The font is registered above, so that measuring cannot fail. If it did, one em per letter would be a safe width.
    let em = (family, MEASURED_AT)
        .into_font()
        .box_size(text)
        .map_or(text.chars().count() as f64, |(w, _)| f64::from(w) / MEASURED_AT);
    // The plot crate measures fonts by their height (ascent to descent); DejaVu's is 1.164 em.
    em * DEJAVU_HEIGHT * font_size
}

const DEJAVU_HEIGHT: f64 = 1.164;

/// Registers the fonts with the plot crate. This happens only here.
pub(crate) fn register_fonts() {
    static ONCE: OnceLock<()> = OnceLock::new();
    ONCE.get_or_init(|| {
        for (family, style, bytes) in [
            (SANS, FontStyle::Normal, dejavu::sans::regular()),
            (SANS, FontStyle::Bold, dejavu::sans::bold()),
            (MONO, FontStyle::Normal, dejavu::sans_mono::regular()),
        ] {
            // The bytes are compiled in and are valid fonts: a test draws with all three.
            let _ = register_font(family, style, bytes);
        }
    });
}

/// Escapes characters that have a special meaning in SVG and HTML.
///
/// ```
/// assert_eq!(fredholm::report::image::typeset::escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
/// ```
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Control characters are not allowed in XML, escaped or not.
            c if c.is_control() && !c.is_whitespace() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A line of text as an SVG element; `(x, y)` is the left end of its baseline.
pub(crate) fn text_element(x: f64, y: f64, font_size: f64, family: &str, attributes: &str, text: &str) -> String {
    let text = escape(text);
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-family=\"{family}\" font-size=\"{font_size}\" \
             xml:space=\"preserve\" {attributes}>{text}</text>\n"
    )
}

/// The caption as SVG elements, its first baseline at `y`.
pub(crate) fn caption_elements(lines: &[String], x: f64, mut y: f64, font_size: f64) -> String {
    let mut out = String::new();
    for line in lines {
        let _ = out.write_str(&text_element(x, y, font_size, MONO, "fill=\"#555555\"", line));
        y += font_size * LINE;
    }
    out
}

/// Distance between two baselines, in font sizes.
pub(crate) const LINE: f64 = 1.4;

/// Rasterises an SVG document at `scale` on a white background.
pub(crate) fn rasterise(svg: &str, scale: f32) -> Result<Picture, ReportError> {
    rasterise_over(svg, scale, None)
}

/// Rasterises an SVG document at `scale` over a picture of that size, or over white.
pub(crate) fn rasterise_over(svg: &str, scale: f32, below: Option<&Picture>) -> Result<Picture, ReportError> {
    static FONTS: OnceLock<Arc<usvg::fontdb::Database>> = OnceLock::new();
    let fonts = FONTS.get_or_init(|| {
        let mut database = usvg::fontdb::Database::new();
        for bytes in [dejavu::sans::regular(), dejavu::sans::bold(), dejavu::sans_mono::regular()] {
            database.load_font_data(bytes.to_vec());
        }
        Arc::new(database)
    });
    let wrong = |cause: &dyn ToString| {
        ReportError::new("(drawing)", cause.to_string(), "this is a defect of the program: please report it")
    };
    let options = usvg::Options { fontdb: Arc::clone(fonts), font_family: SANS.into(), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| wrong(&e))?;
    let size = tree.size();
    let pixels = |length: f32| (length * scale).round() as u32;
    let mut canvas = tiny_skia::Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| wrong(&format!("a picture of {}×{} pixels cannot be made", size.width(), size.height())))?;
    canvas.fill(tiny_skia::Color::WHITE);
    if let Some(below) = below {
        for (pixel, &[r, g, b]) in canvas.pixels_mut().iter_mut().zip(&below.pixels) {
            *pixel = tiny_skia::ColorU8::from_rgba(r, g, b, 255).premultiply();
        }
    }
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut canvas.as_mut());
    Ok(Picture {
        width: canvas.width() as usize,
        height: canvas.height() as usize,
        pixels: canvas.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect(),
    })
}

/// A white page with the given SVG elements, rasterised at scale 1.
pub(crate) fn page(width: usize, height: usize, elements: &str) -> Result<Picture, ReportError> {
    page_at(1, width, height, elements)
}

/// A white page of `width × height` CSS pixels with the given SVG elements, rasterised with `scale` pixels per CSS pixel.
pub(crate) fn page_at(scale: usize, width: usize, height: usize, elements: &str) -> Result<Picture, ReportError> {
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n{elements}</svg>\n"
    );
    rasterise(&svg, scale as f32)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wrapped_and_nothing_is_lost() {
        let fits = |line: &str| line.chars().count() <= 7;
        assert_eq!(wrap("a bc def ghijklmnop q", fits), ["a bc", "def", "ghijklm", "nop q"]);
        assert_eq!(wrap("ghijklmnop", fits), ["ghijklm", "nop"]);
        assert_eq!(wrap("", fits), [""]);
    }

    /// The monospaced font advances 1233/2048 em per letter.
    #[test]
    fn text_is_measured_as_it_is_drawn() {
        for n in [1, 20] {
            let width = text_width(&"M".repeat(n), MONO, 100.0) / n as f64;
            assert!((width - 100.0 * 1233.0 / 2048.0).abs() < 1.5, "{n} letters: {width}");
        }
        let drawn = page(400, 40, &text_element(10.0, 30.0, 20.0, SANS, "", "×192 · mean 0.00227")).unwrap();
        let inked = |x: usize| (0..40).any(|y| drawn.pixels[y * 400 + x] != [255; 3]);
        let last = (0..400).rev().find(|&x| inked(x)).unwrap() as f64;
        let width = text_width("×192 · mean 0.00227", SANS, 20.0);
        assert!((last - 10.0 - width).abs() < 3.0, "drawn {}, measured {width}", last - 10.0);
    }
}
