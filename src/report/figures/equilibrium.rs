//! The rendering equation at points: a plot of E + T L against L, a plot of the p-values against the uniform law, and a table.
//!
//! ```text
//! L(x) = E(x) + (T L)(x)      if it holds, points lie on the diagonal and p-values are uniform on [0, 1]
//! ```

use crate::report::{
    ReportError,
    image::typeset::Caption,
    plot::{
        Axis, BLUE, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, VERMILION, Words,
        figure,
    },
    text::{
        number::{mark, outcome, p_value, significant},
        table::{Side, aligned},
    },
};
use crate::stats::uniformity::band;
use crate::study::equilibrium::Group;
use crate::terms::Channel;

/// The two sides of the equation at a point, with the error of their difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// L, mean over the channels.
    pub left: f64,
    /// E + T L, mean over the channels.
    pub right: f64,
    /// Standard error of the difference.
    pub std_error: f64,
    /// Replicates from which the standard error is estimated.
    pub replicates: u64,
    /// p-value of the hypothesis that both sides are equal; NaN if the point is not judged.
    pub p: f64,
    /// True if the test over all points rejects this one.
    pub rejected: bool,
}

/// A row per group of points: the mean of T L, the mean difference of both sides in percent of it (± half the interval), p, and
/// the verdict.
pub fn table(groups: &[Group]) -> String {
    let header = ["points", "number", "mean of T L", "L − (E + T L)", "p", "verdict"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(groups.iter().map(|g| {
        let c = g.worst_channel();
        let (value, difference, half) = (g.value[c], g.difference.mean[c], g.half[c]);
        let apart = match g.evidence.no_error {
            None => format!("{:+.2} ± {:.2} %", 100.0 * difference / value, 100.0 * half / value),
            Some(why) => format!("{} ({})", significant(difference, 3), why.short()),
        };
        vec![
            if g.name == "camera" { "seen by pixels" } else { "on all surfaces" }.to_owned(),
            g.points.to_string(),
            format!("{} ({})", significant(value, 4), Channel::ALL[c]),
            apart,
            p_value(g.p),
            format!("{} {}", mark(g.outcome), outcome(g.outcome)),
        ]
    }));
    let right = Side::Right;
    aligned(&rows, &[Side::Left, right, right, right, right, Side::Left])
}

/// Draws groups of points, each with its label in the legend.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(groups: &[(String, Vec<Dot>)], caption: &Caption) -> Result<Figure, ReportError> {
    figure("equilibrium", 1120, 500, caption, |page| {
        let title = "L = E + T L at random points: two estimates from independent paths";
        page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        diagonal(page, groups)?;
        p_values(page, groups)
    })
}

fn diagonal(page: &Canvas, groups: &[(String, Vec<Dot>)]) -> Drawn {
    let dots = || groups.iter().flat_map(|g| &g.1).filter(|d| d.left > 0.0 && d.right > 0.0);
    let both = || dots().flat_map(|d| [d.left, d.right]);
    let name = "radiance   (W sr⁻¹ m⁻²)";
    let (x, y) = (Axis::log(&format!("L, {name}"), both()), Axis::log(&format!("E + T L, {name}"), both()));
    let panel = Panel::draw(page, "The two sides", [92.0, 78.0, 390.0, 340.0], x, y)?;
    let line = Stroke { color: GREY, width: 1.4, dash: Some((7.0, 5.0)) };
    let (low, high) = both().fold((f64::INFINITY, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
    panel.line((0.2 * low, 0.2 * low), (5.0 * high, 5.0 * high), line)?;
    let mut entries = vec![];
    let rejected = Look { color: VERMILION, ..Look::nth(5) };
    for (i, (label, dots)) in groups.iter().enumerate() {
        let look = Look { color: BLUE, ..Look::nth([0, 3][i % 2]) };
        let point = |d: &Dot| Point { x: d.left, value: d.right, std_error: d.std_error, replicates: d.replicates };
        let some = |rejected: bool| dots.iter().filter(|d| d.rejected == rejected).map(point).collect::<Vec<_>>();
        panel.curve(&Curve { label: label.clone(), points: some(false), look }, 0.0, false)?;
        panel.curve(&Curve { label: label.clone(), points: some(true), look: rejected }, 0.0, false)?;
        entries.push(Entry::new(Sample::Mark(look), label.clone()));
    }
    if dots().any(|d| d.rejected) {
        entries.push(Entry::new(Sample::Mark(rejected), "rejected"));
    }
    entries.push(Entry::new(Sample::Line(line), "equality"));
    entries.push(Entry::new(Sample::Heading, "bars: 95 % of the difference"));
    page.legend((506.0, 84.0), 140.0, &entries)?;
    Ok(())
}

fn p_values(page: &Canvas, groups: &[(String, Vec<Dot>)]) -> Drawn {
    let mut p: Vec<f64> = groups.iter().flat_map(|g| &g.1).map(|d| d.p).filter(|p| !p.is_nan()).collect();
    p.sort_by(f64::total_cmp);
    let n = p.len();
    let unit = |title: &str| Axis::linear(title, 0.0, 1.0, 5);
    let title = format!("p-values of {n} points");
    let frame = [730.0, 78.0, 340.0, 340.0];
    let panel = Panel::draw(page, &title, frame, unit("p"), unit("share of points below"))?;
    if n == 0 {
        return Ok(());
    }
    let dashed = Stroke { color: GREY, width: 1.4, dash: Some((7.0, 5.0)) };
    panel.line((0.0, 0.0), (1.0, 1.0), Stroke::solid(GREY, 1.2))?;
    let width = band(n, 0.05);
    for side in [-width, width] {
        panel.line((0.0, side), (1.0, 1.0 + side), dashed)?;
    }
    let step = Stroke::solid(BLUE, 2.0);
    let (mut x, mut share) = (0.0, 0.0);
    for (i, &next) in p.iter().chain([&1.0]).enumerate() {
        panel.line((x, share), (next, share), step)?;
        let up = (i + 1).min(n) as f64 / n as f64;
        panel.line((next, share), (next, up), step)?;
        (x, share) = (next, up);
    }
    page.text(
        "dashed: uniform p-values stay inside with 95 % probability",
        (730.0, 474.0),
        Words { size: 12.0, color: GREY, ..Words::default() },
    )
}
