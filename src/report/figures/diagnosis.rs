//! The figure and the table of a diagnosis: the ratios r_k, the curves that suspects predict, and the ratio in the regions of the
//! image.
//!
//! | panel | shows |
//! |---|---|
//! | left | r_k = mean of the k-th term of the picture/mean of the right one, with 95 % bars; a line per suspect; 1 is right |
//! | right | the ratio in the regions of the image: of direct light if the file has terms, else of the whole |

use crate::diagnosis::evidence::Ratio;
use crate::diagnosis::regions::SIDE;
use crate::diagnosis::{Diagnosis, Slot};
use crate::report::{
    ReportError,
    image::{typeset::Caption, zmap},
    plot::{Axis, BLACK, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        number::significant,
        table::{Side, aligned},
    },
};
use plotters::{prelude::RGBColor, style::text_anchor::HPos};

/// Number of suspects that are drawn; more curves would hide each other.
const MOST: usize = 4;
const RIGHT: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
const MAP: f64 = 300.0;

/// A row for each of the first `most` terms and the whole image: means, their ratio r with its 95 % interval, and whether r is the
/// same in all regions.
pub fn table(d: &Diagnosis, most: usize) -> String {
    let header = ["", "mean", "right", "r", "± 95 %", "same r everywhere?"];
    let mut rows = vec![header.map(String::from).to_vec()];
    let all = &d.evidence.ratios;
    let terms = all.len().min(most.saturating_sub(1));
    let shown = all.iter().take(terms).chain(all.last().filter(|_| terms < all.len()));
    for r in shown {
        let flat = match r.flat {
            p if p.is_nan() => "–".into(),
            p if p < 1e-3 => {
                let known = || r.regions[1..].iter().copied().filter(|v| v.is_finite());
                let (lo, hi) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
                format!("no, {} to {}", significant(lo, 3), significant(hi, 3))
            }
            p => format!("yes (p = {})", significant(p, 2)),
        };
        let [a, b] = r.means.map(|m| significant(m, 4));
        let (value, half) = if r.value.is_finite() {
            (significant(r.value, 4), significant(r.half_width, 2))
        } else {
            ("–".into(), "–".into())
        };
        rows.push(vec![r.slot.to_string(), a, b, value, half, flat]);
    }
    aligned(&rows, &[Side::Left, Side::Right, Side::Right, Side::Right, Side::Right, Side::Left])
}

/// Draws the figure of a diagnosis.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(d: &Diagnosis, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    let terms = d.evidence.ratios.iter().any(|r| matches!(r.slot, Slot::Term(_)));
    let width = if terms { 1120 } else { 620 };
    figure("diagnosis", width, 470, caption, |page| {
        let size = if title.chars().count() > 55 && !terms { 13.0 } else { 17.0 };
        page.text(title, (24.0, 24.0), Words { size, ..Words::default() })?;
        if terms {
            ratios(page, d)?;
        }
        map(page, d, if terms { 780.0 } else { 60.0 })
    })
}

fn ratios(page: &Canvas, d: &Diagnosis) -> Drawn {
    let point = |r: &Ratio| {
        let Slot::Term(k) = r.slot else { return None };
        // scaled so that this bar, like all others in the figure, is a 95 % interval of a normal distribution
        let std_error = r.half_width / 1.96;
        Some(Point { x: k as f64, value: r.value, std_error, replicates: 1_000_000 }).filter(|p| p.value.is_finite())
    };
    let seen: Vec<Point> = d.evidence.ratios.iter().filter_map(point).collect();
    let suspects: Vec<_> = d.suspects.iter().filter(|s| !s.curve.is_empty()).take(MOST).collect();
    let values = || {
        let predicted = suspects.iter().flat_map(|s| &s.curve).map(|p| p[1]);
        seen.iter().map(|p| p.value).chain(predicted).chain([1.0])
    };
    let (lo, hi) = values().fold((f64::INFINITY, 0.0f64), |a, v| (a.0.min(v), a.1.max(v)));
    let positive = values().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let log = hi > 8.0 * positive && (hi > 4.0 || lo > 0.0);
    let y = if log {
        Axis::log("r_k, picture/correct", values().filter(|v| *v > 0.0))
    } else {
        let air = 0.1 * (hi - lo).max(0.1);
        Axis::linear("r_k, picture/correct", (lo - air).max(0.0), hi + air, 6)
    };
    let last = seen.iter().map(|p| p.x).fold(1.0, f64::max);
    let panel = Panel::draw(
        page,
        "Ratio by bounce",
        [84.0, 72.0, 400.0, 320.0],
        Axis::counts("bounce k", last as usize, 10),
        y,
    )?;
    panel.line((-0.5, 1.0), (last + 0.5, 1.0), RIGHT)?;
    let mut entries = vec![Entry::new(Sample::Line(RIGHT), "correct")];
    for (i, s) in suspects.iter().enumerate() {
        let points = s.curve.iter().map(|p| Point::exact(p[0], p[1])).collect();
        let curve = Curve { label: s.name.clone(), points, look: Look::nth(i) };
        panel.curve(&curve, 0.0, true)?;
        entries.push(Entry::new(Sample::Mark(curve.look), s.name.clone()));
    }
    let own = Curve { label: "suspect".into(), points: seen, look: Look::MATRIX };
    panel.curve(&own, 0.0, false)?;
    entries.insert(0, Entry::new(Sample::Mark(own.look), "the file, 95 % bars"));
    page.legend((500.0, 68.0), 220.0, &entries)?;
    Ok(())
}

fn map(page: &Canvas, d: &Diagnosis, left: f64) -> Drawn {
    let e = &d.evidence;
    let direct = e.ratio(Slot::Term(1)).filter(|r| r.value.is_finite());
    let Some(r) = direct.or(e.ratio(Slot::Whole)).or(e.ratios.first()) else { return Ok(()) };
    let top = 72.0;
    let title = format!("Ratio in the image, {}", r.slot);
    page.text(&title, (left, top - 14.0), Words { size: 14.0, bold: true, ..Words::default() })?;
    let cell = MAP / SIDE as f64;
    for (row, column) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let (x, y) = (left + column as f64 * cell, top + row as f64 * cell);
        let name = format!("region {row},{column}");
        let value = e.regions.iter().position(|n| *n == name).and_then(|i| r.regions.get(i)).copied();
        let value = value.unwrap_or(f64::NAN);
        // the colour scale ends at a factor of 2
        let [red, green, blue] = if value.is_nan() { [220; 3] } else { zmap::color(4.0 * value.max(1e-6).log2()) };
        let corners = [(x, y), (x + cell, y), (x + cell, y + cell), (x, y + cell)];
        page.polygon(&corners, RGBColor(red, green, blue))?;
        let dark = !value.is_nan() && value.max(1e-6).log2().abs() > 0.55;
        let color = if dark { RGBColor(255, 255, 255) } else { BLACK };
        let words = if value.is_nan() { "–".into() } else { significant(value, 3) };
        page.text(
            &words,
            (x + cell / 2.0, y + cell / 2.0),
            Words { color, align: HPos::Center, size: 14.0, ..Words::default() },
        )?;
    }
    for i in 0..=SIDE {
        let at = i as f64 * cell;
        let thin = Stroke::solid(GREY, 1.0);
        page.line((left + at, top), (left + at, top + MAP), thin)?;
        page.line((left, top + at), (left + MAP, top + at), thin)?;
    }
    let note = "blue: half or less, white: correct, red: twice or more";
    page.text(note, (left, top + MAP + 18.0), Words { size: 12.0, color: GREY, ..Words::default() })?;
    Ok(())
}
