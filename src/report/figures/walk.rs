//! The walk on the matrix: tables beside the powers, and the variance of led walks against the error of the guide.
//!
//! ```text
//! relative variance E[(X − B)²]/B²      against      ‖v − B‖/‖B − E‖
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | z | (mean − power)/error, patch by patch | [`table`] |
//! | v | guide | [`guides`], [`draw`] |

use std::fmt::Display;

use crate::math::CHANNELS;
use crate::report::{
    ReportError,
    image::typeset::{Caption, superscript},
    plot::{Axis, Canvas, Curve, Drawn, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        number::{average, error, significant},
        table::{Side, aligned},
    },
};
use crate::study::walk::Walked;
use crate::study::zero_variance::{Guide, Led, Spread, ZeroVariance};

/// A row per term: the walk, the power, how many standard errors apart, and the same patch by patch.
pub fn table(walked: &Walked) -> String {
    let (found, exact) = (walked.sampled.series.image(), walked.exact.image());
    let header = ["k", "walk", "± 95 %", "power of the matrix", "difference", "|z| > 2", "largest |z|"];
    let mut rows = vec![header.map(String::from).to_vec()];
    let mut push = |name: String, a: &crate::terms::Estimate, b: &crate::terms::Estimate, z: &[f64]| {
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

/// A row per guide and channel.
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

/// A row per term and channel: walks of k steps led by the lower terms.
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

/// Everything, a line per channel and guide or term.
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

/// Relative variance against the error of the guide, on logarithmic axes: one curve per channel and kind of guide. Walks led by B itself
/// have no error to stand at; they are named in the legend.
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
