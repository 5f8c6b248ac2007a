//! The path tracer as the lecture writes it, beside the lines of `src/estimator/path_tracer.rs` that do the same.
//!
//! ```text
//! L(x) = E(x) + E[ α-weighted light found at x_0, x_1, … ]          one loop, five steps
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | step | a part of the loop: its name, its pseudocode, the first words of its lines in the source | [`Step`] |
//! | source | the text of the library's file, read when this program is compiled | [`SOURCE`] |
//!
//! No line of the source is typed here: only its first words are, and a line that cannot be found is an error. Long lines
//! are broken at blanks.
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::page::{LEFT, WIDTH, heading, maths, title, words};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::typeset::{MONO, text_width, wrap};
use fredholm::report::plot::{BLACK, BLUE, Canvas, Colour, GREEN, GREY, ORANGE, PURPLE, VERMILION, Words, figure};

/// This figure.
pub const SLIDE: Slide = Slide {
    id: "pseudocode",
    topic: "The path tracer: pseudocode and program",
    caption: "Left: the path tracer as pseudocode. Right: the lines of the program that do the same, taken from its source \
              file. Equal colours mark equal steps: emission at the eye, connection to a lamp, Russian roulette, the next \
              direction, emission on hits.",
    scene: "none",
    program,
};

const SOURCE: &str = include_str!("../../../src/estimator/path_tracer.rs");
/// The first and the last line of the function whose lines are shown.
const BETWEEN: [&str; 2] = ["pub fn radiance<", "(colour, rays)"];

/// One step of the loop.
struct Step {
    name: &'static str,
    color: Colour,
    pseudocode: &'static [&'static str],
    /// The first words of the lines in the source, in their order there.
    begins: &'static [&'static str],
}

const STEPS: [Step; 5] = [
    Step {
        name: "emission at the eye",
        color: BLUE,
        pseudocode: &["x ← what the eye sees,  α ← 1", "colour ← E(x)"],
        begins: &["let (mut x, mut throughput", "let mut colour"],
    },
    Step {
        name: "connection",
        color: ORANGE,
        pseudocode: &[
            "repeat",
            "  y ← point on a lamp, density p",
            "  colour += α f cos θ / p · E(y) · w_c",
            "     (0 if y is hidden)",
        ],
        begins: &["for v in", "if let Some(y)", "colour +=", "throughput * y.f"],
    },
    Step {
        name: "roulette",
        color: VERMILION,
        pseudocode: &["  stop with probability q", "  α ← α / (1 − q)"],
        begins: &["let q =", "if numbers(v, Purpose::Roulette)", "break;", "throughput *= 1.0 /"],
    },
    Step {
        name: "direction",
        color: GREEN,
        pseudocode: &["  x' ← next point, density p", "  α ← α f cos θ / p", "  x ← x'"],
        begins: &["let Some(next)", "throughput *= next.f", "x = next.state"],
    },
    Step {
        name: "emission on hits",
        color: PURPLE,
        pseudocode: &["  colour += α E(x) · w_s"],
        begins: &["colour += throughput * t.emission"],
    },
];

/// The lines of the source for all steps.
fn found() -> Result<Vec<Vec<String>>> {
    let missing = |what: &str| format!("src/estimator/path_tracer.rs has no line `{what}` at its place");
    let from = SOURCE.find(BETWEEN[0]).ok_or_else(|| missing(BETWEEN[0]))?;
    let length = SOURCE[from..].find(BETWEEN[1]).ok_or_else(|| missing(BETWEEN[1]))?;
    let mut lines = SOURCE[from..from + length].lines();
    let indent = |line: &str| line.len() - line.trim_start().len();
    STEPS
        .iter()
        .map(|step| {
            let line = |first: &&str| {
                let line = lines.find(|line| line.trim_start().starts_with(*first)).ok_or_else(|| missing(first))?;
                // the function stands eight blanks deep; half of the rest is kept
                Ok(format!("{}{}", " ".repeat(indent(line).saturating_sub(8) / 2), line.trim()))
            };
            step.begins.iter().map(line).collect()
        })
        .collect()
}

/// Breaks a line of code that is wider than `width`; the continuation is indented.
fn broken(line: &str, width: f64, size: f64) -> Vec<String> {
    let indent = line.len() - line.trim_start().len();
    let room = width - text_width(&"0".repeat(indent + 4), MONO, size);
    let parts = wrap(line.trim_start(), |part| text_width(part, MONO, size) <= room);
    let deeper = |(i, part): (usize, String)| format!("{}{part}", " ".repeat(indent + if i > 0 { 4 } else { 0 }));
    parts.into_iter().enumerate().map(deeper).collect()
}

/// Font size of code.
const CODE: f64 = 13.0;
/// Left ends and widths of the two columns.
const COLUMNS: [[f64; 2]; 2] = [[LEFT, 336.0], [404.0, 536.0]];

fn program(folder: &Folder<'_>) -> Result<()> {
    let lines = found()?;
    let broken: Vec<Vec<String>> = lines
        .iter()
        .map(|step| step.iter().flat_map(|line| broken(line, COLUMNS[1][1] - 16.0, CODE)).collect())
        .collect();
    let rows: usize = STEPS.iter().zip(&broken).map(|(step, lines)| lines.len().max(step.pseudocode.len() + 1)).sum();
    let height = 84.0 + rows as f64 * LINE + STEPS.len() as f64 * (2.0 * PAD + GAP) + 24.0;
    let drawing = figure(SLIDE.id, WIDTH, height as u32, &folder.caption(SLIDE.scene), |page| {
        title(page, SLIDE.topic)?;
        heading(page, "Pseudocode", (COLUMNS[0][0], 62.0))?;
        heading(page, "src/estimator/path_tracer.rs (selected lines)", (COLUMNS[1][0], 62.0))?;
        let mut y = 84.0;
        for (step, lines) in STEPS.iter().zip(&broken) {
            y = draw(page, step, lines, y)?;
        }
        let text =
            "f: BSDF. w_c, w_s: weights of the two techniques (MIS). q: probability of termination. E: emission.";
        maths(page, text, (LEFT, y + 6.0), words(CODE, BLACK))
    })?;
    folder.figure(SLIDE.id, &drawing)?;
    Ok(())
}

/// Distance of two lines of code, and the space around a step.
const LINE: f64 = 18.0;
const PAD: f64 = 5.0;
const GAP: f64 = 9.0;

/// Draws one step in both columns, with a band between them. Returns the y of the next step.
fn draw(
    page: &Canvas<'_>,
    step: &Step,
    lines: &[String],
    y: f64,
) -> std::result::Result<f64, Box<dyn std::error::Error>> {
    let code = Words { family: MONO, ..words(CODE, BLACK) };
    let rows = lines.len().max(step.pseudocode.len() + 1) as f64;
    let (top, bottom) = (y, y + rows * LINE + 2.0 * PAD);
    for [x, width] in COLUMNS {
        page.tint(&[(x, top), (x + width, top), (x + width, bottom), (x, bottom)], step.color)?;
        page.polygon(&[(x, top), (x + 5.0, top), (x + 5.0, bottom), (x, bottom)], step.color)?;
    }
    let (from, to, middle) = (COLUMNS[0][0] + COLUMNS[0][1], COLUMNS[1][0], 0.5 * (top + bottom));
    page.polygon(&[(from, middle - 3.0), (to, middle - 3.0), (to, middle + 3.0), (from, middle + 3.0)], step.color)?;
    let row = |i: usize| top + PAD + (i as f64 + 0.5) * LINE;
    page.text(step.name, (COLUMNS[0][0] + 12.0, row(0)), Words { bold: true, ..words(CODE, GREY) })?;
    // SVG drops blanks at the start of a line, so the indentation is drawn as a distance
    let indented = |line: &str, x: f64, y: f64| {
        let blanks = line.len() - line.trim_start().len();
        page.text(line.trim_start(), (x + 12.0 + text_width(&"0".repeat(blanks), MONO, CODE), y), code)
    };
    for (i, line) in step.pseudocode.iter().enumerate() {
        indented(line, COLUMNS[0][0], row(i + 1))?;
    }
    lines.iter().enumerate().try_for_each(|(i, line)| indented(line, COLUMNS[1][0], row(i)))?;
    Ok(bottom + GAP)
}
