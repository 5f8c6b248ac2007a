//! Random walks on the radiosity matrix: tables that compare them with the powers of the matrix, and the variance of guided
//! walks against the error of the guide.
//!
//! ```text
//! relative variance E[(X − B)²]/B²      against      ‖v − B‖/‖B − E‖
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | B | the solution of the radiosity equation B = E + T B | |
//! | X | the result of one walk, an estimate of B at the patch where it starts | |
//! | v | the guide, an approximation of B that chooses the steps of a walk | [`variances`], [`guides`], [`draw`] |
//! | z | (mean of the walks − power of the matrix)/standard error, for each patch | [`full_table`] |

use std::fmt::Display;

use crate::math::CHANNELS;
use crate::report::{
    ReportError,
    image::typeset::{Caption, superscript},
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        number::{average, error, mark, outcome, significant},
        table::{Side, aligned},
    },
};
use crate::stats::Comparison;
use crate::study::walk::Walked;
use crate::study::zero_variance::{Guide, Led, Spread, ZeroVariance};
use crate::terms::Estimate;

/// The small table, a row per term: the walks with their error, the power of the matrix, the difference in percent, and the
/// verdict. Of the terms it shows the first `most`, then the tail and the whole.
pub fn table(walked: &Walked, comparison: &Comparison, most: usize) -> String {
    let (found, exact) = (walked.sampled.series.image(), walked.exact.image());
    let mut rows = vec![["k", "walks", "± 95 %", "exact", "difference", "verdict"].map(String::from).to_vec()];
    let mut push = |name: String, quantity: &str, a: &Estimate, b: &Estimate| {
        let [m, truth] = [a, b].map(|e| average(e).0);
        let off = 100.0 * (m / truth - 1.0);
        let verdict = comparison.rows.iter().find(|r| r.name == quantity);
        rows.push(vec![
            name,
            significant(m, 5),
            error(a),
            significant(truth, 5),
            if off.is_finite() { format!("{off:+.2} %") } else { "–".into() },
            verdict.map_or_else(|| "–".into(), |r| format!("{} {}", mark(r.outcome), outcome(r.outcome))),
        ]);
    };
    for (k, (a, b)) in found.terms.iter().zip(&exact.terms).enumerate().take(most) {
        push(k.to_string(), &format!("T{k}"), a, b);
    }
    if !found.tail.is_none() && !found.terms.is_empty() {
        push(format!("k > {}", found.terms.len() - 1), "tail", &found.tail, &exact.tail);
    }
    push("all".into(), "total", &found.total, &exact.total);
    aligned(&rows, &[[Side::Right; 5].as_slice(), &[Side::Left]].concat())
}

/// The full table, a row per term: the walks, the power of the matrix, their difference, and z of the patches.
pub fn full_table(walked: &Walked) -> String {
    let (found, exact) = (walked.sampled.series.image(), walked.exact.image());
    let header = ["k", "walk", "± 95 %", "power of the matrix", "difference", "|z| > 2", "largest |z|"];
    let mut rows = vec![header.map(String::from).to_vec()];
    let mut push = |name: String, a: &Estimate, b: &Estimate, z: &[f64]| {
        let [m, truth] = [a, b].map(|e| average(e).0);
        let beyond = z.iter().filter(|z| z.abs() > 2.0).count() as f64 / z.len() as f64;
        let largest = z.iter().fold(0.0, |a: f64, z| a.max(z.abs()));
        let shares = if z.is_empty() {
            ["–".into(), "–".into()]
        } else {
            [format!("{:.1} %", 100.0 * beyond), format!("{largest:.1}")]
        };
        let numbers = [significant(m, 5), error(a), significant(truth, 5), significant(m - truth, 2)];
        rows.push([name].into_iter().chain(numbers).chain(shares).collect());
    };
    for (k, (a, b)) in found.terms.iter().zip(&exact.terms).enumerate() {
        push(k.to_string(), a, b, &walked.z[k]);
    }
    if !found.tail.is_none() && !found.terms.is_empty() {
        push(format!("k > {}", found.terms.len() - 1), &found.tail, &exact.tail, &walked.z[found.terms.len()]);
    }
    push("all".into(), &found.total, &exact.total, walked.z.last().map_or(&[], Vec::as_slice));
    format!("{}\n{}", walked.sampled.series.label, aligned(&rows, &[Side::Right; 7]))
}

fn spread_cells(s: &Spread) -> [String; 4] {
    let bias = format!("{} ± {}", significant(s.bias[0], 2), significant(1.96 * s.bias[1], 2));
    [significant(s.variance, 3), significant(s.largest, 3), bias, significant(s.steps, 3)]
}

/// The small table, a row per guide: the relative error of the guide in the first channel, and the relative variance of one
/// walk in every channel.
pub fn variances(all: &[ZeroVariance]) -> String {
    let mut header = ["guide v".to_string(), "error of v".into()].to_vec();
    header.extend(all.iter().map(|z| CHANNELS[z.channel].to_string()));
    let mut rows = vec![header];
    let Some(first) = all.first() else { return String::new() };
    for (i, led) in first.guides.iter().enumerate() {
        let error = if led.error.is_nan() { "–".into() } else { significant(led.error, 2) };
        let mut row = vec![led.guide.to_string(), error];
        row.extend(all.iter().map(|z| z.guides.get(i).map_or("–".into(), |l| significant(l.spread.variance, 2))));
        rows.push(row);
    }
    aligned(&rows, &[[Side::Left].as_slice(), &vec![Side::Right; all.len() + 1]].concat())
}

/// The full table, a row per guide and channel.
pub fn guides(all: &[ZeroVariance]) -> String {
    let header = ["channel", "guide v", "error of v", "variance/B²", "largest |X−B|/B", "mean/B − 1", "steps"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for z in all {
        rows.extend(z.guides.iter().map(|led| {
            let error = if led.error.is_nan() { "–".into() } else { significant(led.error, 3) };
            let head = [CHANNELS[z.channel].to_string(), led.guide.to_string(), error];
            head.into_iter().chain(spread_cells(&led.spread)).collect()
        }));
    }
    aligned(&rows, &[Side::Left, Side::Left, Side::Right, Side::Right, Side::Right, Side::Right, Side::Right])
}

/// A row per term and channel, for walks of k steps that are guided by the lower terms.
pub fn terms(all: &[ZeroVariance]) -> String {
    let header = ["channel", "k", "variance/T²", "largest |X−T|/T", "mean/T − 1", "steps"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for z in all {
        rows.extend(z.terms.iter().enumerate().map(|(i, s)| {
            let head = [CHANNELS[z.channel].to_string(), (i + 1).to_string()];
            head.into_iter().chain(spread_cells(s)).collect()
        }));
    }
    aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 5]].concat())
}

/// All numbers as CSV, a line per channel and guide or term.
pub fn csv(all: &[ZeroVariance]) -> String {
    let mut csv =
        Csv::new("channel,guide,guide_error,relative_variance,largest_deviation,bias,bias_std_error,steps,walks");
    let mut line = |channel: usize, name: &dyn Display, error: f64, s: &Spread| {
        csv.put(CHANNELS[channel]).put(name).numbers([error]);
        csv.put(s.variance).put(s.largest).put(s.bias[0]).put(s.bias[1]).put(s.steps).put(s.walks).end();
    };
    for z in all {
        z.guides.iter().for_each(|l| line(z.channel, &l.guide, l.error, &l.spread));
        z.terms.iter().enumerate().for_each(|(i, s)| line(z.channel, &format_args!("term {}", i + 1), 0.0, s));
    }
    csv.text()
}

/// Draws the relative variance of a walk against the error of its guide, on logarithmic axes: one curve per channel and kind of
/// guide. Walks guided by B itself have an error of 0 and no place on the axis; the legend gives their variance.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(all: &[ZeroVariance], caption: &Caption) -> Result<Figure, ReportError> {
    figure("walk", 960, 490, caption, |page| panel(page, all))
}

fn panel(page: &Canvas, all: &[ZeroVariance]) -> Drawn {
    page.text(
        "The better the guide, the less is left to chance",
        (24.0, 24.0),
        Words { size: 18.0, ..Words::default() },
    )?;
    let point = |l: &Led| Point::exact(l.error, l.spread.variance);
    let mut curves = vec![];
    for z in all {
        for (kind, meshes) in [("meshes", true), ("partial sums", false)] {
            let chosen = |guide: &Guide| match guide {
                Guide::Mesh(_) => meshes,
                Guide::Partial(_) => !meshes,
                Guide::Analog | Guide::Exact => false,
            };
            let of = |l: &&Led| chosen(&l.guide) && l.spread.variance > 0.0 && l.error > 0.0;
            let points: Vec<Point> = z.guides.iter().filter(of).map(point).collect();
            if !points.is_empty() {
                let label = format!("{}, {kind}", CHANNELS[z.channel]);
                curves.push(Curve { label, points, look: Look::nth(curves.len()) });
            }
        }
    }
    let points = || curves.iter().flat_map(|c| &c.points);
    let analog: Vec<(usize, f64)> = all
        .iter()
        .flat_map(|z| z.guides.iter().filter(|l| l.guide == Guide::Analog).map(|l| (z.channel, l.spread.variance)))
        .collect();
    let x = Axis::log("error of the guide  ‖v − B‖ / ‖B − E‖", points().map(|p| p.x));
    let y = Axis::log("relative variance of a walk", points().map(|p| p.value).chain(analog.iter().map(|a| a.1)));
    let panel = Panel::draw(page, "Variance of the absorption estimator", [84.0, 72.0, 540.0, 350.0], x, y)?;
    let (lo, hi) = points().fold((f64::INFINITY, 0.0f64), |a, p| (a.0.min(p.x), a.1.max(p.x)));
    let guide = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    // slope 2 through the best of the meshes
    if let Some(best) = points().min_by(|a, b| a.x.total_cmp(&b.x)) {
        let at = |x: f64| (x, 0.6 * best.value * (x / best.x).powi(2));
        panel.line(at(0.5 * lo), at(2.0 * hi), guide)?;
    }
    curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    let mut entries: Vec<Entry> = curves.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
    entries.push(Entry::new(Sample::Line(guide), format!("slope 2: variance ∝ error{}", superscript(2))));
    entries.push(Entry::new(Sample::Heading, "without a guide"));
    entries.extend(
        analog.iter().map(|(c, v)| Entry::new(Sample::Heading, format!("{}: {}", CHANNELS[*c], significant(*v, 3)))),
    );
    entries.push(Entry::new(Sample::Heading, "led by B itself"));
    entries.extend(
        all.iter().filter_map(|z| z.guides.iter().find(|l| l.guide == Guide::Exact).map(|l| (z.channel, l))).map(
            |(c, l)| Entry::new(Sample::Heading, format!("{}: {}", CHANNELS[c], significant(l.spread.variance, 2))),
        ),
    );
    page.legend((646.0, 68.0), 300.0, &entries)?;
    Ok(())
}
