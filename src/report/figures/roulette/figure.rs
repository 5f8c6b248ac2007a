//! The figure: cost and rays for the same error of every schedule, and q vertex by vertex.
//!
//! Schedules have no order. So each has its own line with its name, and no curve joins them; only q against the vertex is a curve.

use super::answer::efficiency;
use super::rows::{Row, shown};
use crate::report::{
    ReportError, half_width_95,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, Look, Panel, Point, Sample, Stroke, Words, figure},
};
use crate::stats::Noise;
use crate::study::roulette::Aim;
use crate::terms::cross_moments::Value;
use plotters::style::text_anchor::HPos;

/// Width of a panel, and the places of their left sides.
const WIDTH: f64 = 270.0;
const LEFTS: [f64; 3] = [210.0, 510.0, 810.0];
const TOP: f64 = 96.0;
/// Height of the line of one schedule.
const LINE: f64 = 26.0;

/// Draws rays per path and V · rays of the whole image and of indirect light, one line per schedule, and below q at each vertex.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(rows: &[Row], title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    let height = LINE * rows.len() as f64;
    figure("roulette", 1120, (TOP + height + 430.0) as u32, caption, |page| {
        page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        lines(page, rows, height)?;
        termination(page, rows, TOP + height + 96.0)
    })
}

/// V · rays of a quantity.
fn work(noise: &Noise, aim: Aim) -> Value {
    let e = efficiency(noise, aim);
    let value = 1.0 / e.value;
    Value { value, std_error: value * e.std_error / e.value }
}

/// A panel: heading, unit, and the value of a row that it shows.
type Shown<'a> = (&'a str, &'a str, &'a dyn Fn(&Noise) -> Value);

fn lines(page: &Canvas, rows: &[Row], height: f64) -> Drawn {
    let level = |i: usize| (rows.len() - i) as f64;
    let of: [Shown; 3] = [
        ("Cost", "rays per path", &|n| n.rays),
        ("Whole image", "V · rays (less is better)", &|n| work(n, Aim::Whole)),
        ("Indirect light, k ≥ 2", "V · rays (less is better)", &|n| work(n, Aim::Indirect)),
    ];
    for (i, r) in rows.iter().enumerate() {
        let y = TOP + height * (1.0 - (level(i) - 0.5) / rows.len() as f64);
        page.text(&shown(&r.name), (LEFTS[0] - 12.0, y), Words { align: HPos::Right, size: 12.5, ..Words::default() })?;
    }
    for ((heading, unit, of), left) in of.into_iter().zip(LEFTS) {
        let marks = |r: &Row| [r.predicted.as_ref().map(of), r.measured.as_ref().map(of)];
        let ends = |v: Value, r: &Row| {
            let half = half_width_95(v.std_error, r.replicates);
            let half = if half.is_finite() { half } else { 0.0 };
            // an interval that reaches zero has no place on a logarithmic axis
            [(v.value - half).max(0.2 * v.value), v.value, v.value + half]
        };
        let shown = |v: &Value| v.value > 0.0 && v.value.is_finite();
        let values = rows.iter().flat_map(|r| marks(r).into_iter().flatten().filter(shown).flat_map(|v| ends(v, r)));
        let mut y = Axis::linear("", 0.5, rows.len() as f64 + 0.5, 2);
        y.ticks.clear(); // the names stand to the left of the first panel
        let panel = Panel::draw(page, heading, [left, TOP, WIDTH, height], Axis::log(unit, values), y)?;
        for (i, r) in rows.iter().enumerate() {
            for (v, look) in marks(r).into_iter().zip([Look::MATRIX, Look::SINGLE]) {
                let Some(v) = v.filter(shown) else { continue };
                let [low, value, high] = ends(v, r);
                panel.line((low, level(i)), (high, level(i)), Stroke::solid(look.color, 1.4))?;
                panel.mark(value, level(i), look)?;
            }
        }
    }
    Ok(())
}

/// q at each vertex of the schedules that matter most, and the legend.
fn termination(page: &Canvas, rows: &[Row], top: f64) -> Drawn {
    let last = rows.iter().map(|r| r.q.len()).max().unwrap_or(1).max(2) - 1;
    let frame = [LEFTS[0], top, 2.0 * WIDTH + 30.0, 240.0];
    let q = Axis::linear("q", -0.03, 1.0, 6);
    let panel =
        Panel::draw(page, "Probability q that a path ends at vertex v", frame, Axis::counts("vertex v", last, 16), q)?;
    let names = [Aim::Whole.schedule_name(), Aim::Indirect.schedule_name(), "lecture"];
    let known = |name: &&str| rows.iter().find(|r| r.name == **name && !r.q.is_empty());
    let mut chosen: Vec<&Row> = names.iter().filter_map(known).collect();
    if chosen.is_empty() {
        chosen = rows.iter().filter(|r| !r.q.is_empty()).take(3).collect();
    }
    let curve = |(i, r): (usize, &&Row)| Curve {
        label: shown(&r.name),
        points: r.q.iter().enumerate().map(|(v, q)| Point::exact(v as f64, *q)).collect(),
        look: Look::nth(i + 1),
    };
    let curves: Vec<Curve> = chosen.iter().enumerate().map(curve).collect();
    curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;

    let mut entries = vec![Entry::new(Sample::Heading, "above (bars: 95 %)")];
    entries.push(Entry::new(Sample::Mark(Look::MATRIX), "predicted"));
    if rows.iter().any(|r| r.measured.is_some()) {
        entries.push(Entry::new(Sample::Mark(Look::SINGLE), "measured"));
    }
    entries.push(Entry::new(Sample::Heading, "left"));
    entries.extend(curves.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    page.legend((LEFTS[2], top + 4.0), 230.0, &entries)?;
    Ok(())
}
