//! The figure of a sweep: cost and gain side by side.
//!
//! Lines join the points of one value over k, which has an order. They never join values, which may have none.
//!
//! | setting | left | right |
//! |---|---|---|
//! | branching | rays per path against k, straight lines of slope log N | V against k |
//! | any other | V against k | V · rays of a path |

use super::rows::{Row, Sweep};
use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
};

/// Draws cost and gain side by side: for `branching` the rays and the variance of every term, else the variance of one
/// sample and the same times its rays.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(sweep: &Sweep, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("sweep", 1120, 490, caption, |page| panels(page, sweep, title))
}

const UNIT: &str = "variance   (W² sr⁻² m⁻⁴)";
const LEFT: [f64; 4] = [84.0, 72.0, 372.0, 350.0];
const RIGHT: [f64; 4] = [552.0, 72.0, 372.0, 350.0];

fn panels(page: &Canvas, sweep: &Sweep, title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    // a little to the side, so that curves that agree do not hide each other
    let middle = (sweep.rows.len() as f64 - 1.0) / 2.0;
    let by_value = |i: usize, mut points: Vec<Point>| {
        let r = &sweep.rows[i];
        points.iter_mut().for_each(|p| p.x += 0.08 * (i as f64 - middle).clamp(-4.0, 4.0));
        let label = if sweep.over == "branching" { format!("N = {}", r.value) } else { r.value.clone() };
        Curve { label, points, look: Look::nth(i) }
    };
    let curves = |point: &dyn Fn(&Row, usize) -> Point| -> Vec<Curve> {
        let points = |r: &Row| (0..r.image.terms.len()).map(|k| point(r, k)).filter(|p| p.value > 0.0).collect();
        sweep.rows.iter().enumerate().map(|(i, r)| by_value(i, points(r))).collect()
    };
    let of = |r: &Row, k: usize, factor: f64| Point {
        x: k as f64,
        value: factor * r.variance[k].value,
        std_error: factor * r.variance[k].std_error,
        replicates: r.image.total.replicates,
    };
    let variance = curves(&|r, k| of(r, k, 1.0));
    let per_sample = ("Variance of one sample of TᵏE", UNIT);
    let mut entries = vec![];
    match sweep.over.as_str() {
        "branching" => {
            let rays = curves(&|r, k| Point::exact(k as f64, r.rays[k] as f64 / r.paths as f64));
            let panel = against_k(page, LEFT, ("Cost: rays per path at depth k", "rays"), &rays)?;
            for n in sweep.rows.iter().filter_map(|r| r.value.parse::<f64>().ok()) {
                let last = sweep.rows[0].image.terms.len() as f64 - 1.0;
                panel.line((0.0, 1.0), (last, n.powf(last)), GUIDE)?;
            }
            against_k(page, RIGHT, ("Gain: variance of one sample of TᵏE", UNIT), &variance)?;
            entries.push(Entry::new(Sample::Line(GUIDE), "Nᵏ"));
            entries.push(Entry::new(Sample::Heading, "children per vertex"));
        }
        _ => {
            against_k(page, LEFT, per_sample, &variance)?;
            let work = curves(&|r, k| of(r, k, r.rays_per_path()));
            against_k(page, RIGHT, ("V · rays of a path: lower is better", "V · rays"), &work)?;
            entries.push(Entry::new(Sample::Heading, sweep.over.as_str()));
        }
    }
    entries.extend(variance.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)));
    entries.extend(notes(variance.iter().any(|c| c.points.len() < sweep.rows[0].image.terms.len())));
    page.legend(LEGEND, 160.0, &entries)?;
    Ok(())
}

const LEGEND: (f64, f64) = (944.0, 68.0);
const GUIDE: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };

/// Notes in the legend below the curves.
fn notes(silent: bool) -> Vec<Entry> {
    let mut notes = vec![Entry::new(Sample::Plain, "bars: 95 %")];
    if silent {
        notes.push(Entry::new(Sample::Plain, "no mark: no noise"));
    }
    notes
}

fn against_k<'a, 'b>(
    page: &'a Canvas<'b>,
    frame: [f64; 4],
    (title, unit): (&str, &str),
    curves: &[Curve],
) -> Result<Panel<'a, 'b>, Box<dyn std::error::Error>> {
    let points = || curves.iter().flat_map(|c| &c.points);
    let last = points().map(|p| p.x).fold(1.0, f64::max).round() as usize;
    let panel = Panel::draw(page, title, frame, Axis::counts("bounce k", last, 10), log(unit, curves))?;
    curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    Ok(panel)
}

fn log(unit: &str, curves: &[Curve]) -> Axis {
    Axis::log(unit, curves.iter().flat_map(|c| &c.points).flat_map(|p| [p.value, p.value + p.half_width()]))
}
