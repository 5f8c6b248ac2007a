//! The text and the figure of `check bias`: the interval of the bias as samples accumulate, and every term at the end.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x̄ ± r_n | confidence sequence of the bias, relative to the value; it holds at all n simultaneously | [`Glimpse`] |
//! | ±δ | margin: a bias inside it is too small to matter | `delta` |
//! | E_n | e-value: evidence against "no bias"; large values are evidence of a bias | [`e_value`] |

use crate::math::CHANNELS;
use crate::report::{
    ReportError,
    image::typeset::{Caption, superscript},
    plot::{
        Axis, BLACK, BLUE, Canvas, Drawn, Entry, Figure, GREEN, GREY, Panel, Sample, Stroke, VERMILION, Words, figure,
    },
    text::{
        number::{known, mark, outcome, p_value, significant},
        table::{Side, aligned},
    },
};
use crate::stats::{Finding, Outcome};

/// The state of the test after some batches.
#[derive(Clone, Debug, PartialEq)]
pub struct Glimpse {
    /// Number of batches so far.
    pub batches: u64,
    /// Findings for the mean of the whole image, one per channel.
    pub image: Vec<Finding>,
}

/// An e-value as text, from its natural logarithm. Values too large for a float are written as powers of ten.
///
/// ```
/// use fredholm::report::figures::watch::e_value;
/// assert_eq!(e_value(0.0), "1.0");
/// assert_eq!(e_value(2000.0), "1e868");
/// assert_eq!(e_value(f64::NAN), "–");
/// ```
pub fn e_value(log_e: f64) -> String {
    if log_e.is_nan() {
        "–".into()
    } else if log_e.abs() > 600.0 {
        format!("1e{:.0}", (log_e / std::f64::consts::LN_10).floor())
    } else {
        significant(log_e.exp(), 2)
    }
}

/// `x` as a percentage of `of`; a dash if `of` is 0.
fn percent(x: f64, of: f64) -> String {
    let p = 100.0 * x / of.abs();
    if p.is_finite() { format!("{}{} %", if p > 0.0 { "+" } else { "" }, significant(p, 2)) } else { "–".into() }
}

/// The small table, a row for each of `findings`: the value, the bias with its interval, the smallest bias that would have been
/// found, and the verdict.
pub fn table(findings: &[&Finding]) -> String {
    let header = ["what", "value", "bias", "interval", "detectable", "verdict"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(findings.iter().map(|f| {
        let [name, value, bias, interval, _, _, detectable, verdict] = cells(f);
        vec![name, value, bias, interval, detectable, verdict]
    }));
    let right = Side::Right;
    aligned(&rows, &[Side::Left, right, right, right, right, Side::Left])
}

/// The full table: the same with the e-value and the p-value.
pub fn full_table(findings: &[Finding]) -> String {
    let header = ["what", "value", "bias", "interval", "e-value", "p", "detectable", "verdict"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(findings.iter().map(|f| cells(f).to_vec()));
    let right = Side::Right;
    aligned(&rows, &[Side::Left, right, right, right, right, right, right, Side::Left])
}

fn cells(f: &Finding) -> [String; 8] {
    let place = f.functional.replace("image, ", "");
    [
        format!("{}, {place}", f.name),
        known(f.scale),
        percent(f.effect, f.scale),
        format!("[{}, {}]", percent(f.interval.0, f.scale), percent(f.interval.1, f.scale)),
        e_value(f.log_e),
        p_value(f.p),
        percent(f.min_detectable, f.scale).replace('+', ""),
        format!("{} {}", mark(f.outcome), outcome(f.outcome)),
    ]
}

/// The verdict in sentences, a line each: a bias of which terms was found, or the smallest bias that could have been missed.
pub fn judgement(verdict: Outcome, findings: &[Finding], alpha: f64, beta: f64) -> String {
    let with = |outcome: Outcome| findings.iter().filter(move |f| f.outcome == outcome);
    let missed = |f: &Finding| {
        let size = percent(f.min_detectable, f.scale).replace('+', "");
        let sure = 1.0 - beta;
        format!(
            "The smallest bias it could have missed: {size} of the {} (a larger one is found by now with probability {sure}).",
            f.name
        )
    };
    let mut lines = vec![match verdict {
        Outcome::Differs => {
            let named: Vec<&str> = with(Outcome::Differs).map(|f| f.name.as_str()).collect();
            format!(
                "Biased: {} differ; without a bias this happens with a probability of at most {alpha}.",
                named.join(", ")
            )
        }
        Outcome::Agrees => "No bias: every image mean is bounded within its margin δ.".to_owned(),
        Outcome::Inconclusive => {
            "No bias found, but a bias larger than the margin δ is not excluded either.".to_owned()
        }
    }];
    lines.extend((verdict != Outcome::Differs).then(|| findings.last().map(missed)).flatten());
    if verdict == Outcome::Inconclusive
        && let Some((f, reason)) = findings.iter().find_map(|f| Some((f, f.reason.as_deref()?)))
    {
        lines.push(format!("The reason for {}: {reason}.", f.name));
    }
    lines.join("\n")
}

/// Draws the figure. A batch has `paths` paths on each side.
///
/// # Errors
/// If the plot crate fails, which is a defect of the program.
pub fn draw(
    title: &str,
    curve: &[Glimpse],
    findings: &[Finding],
    paths: u64,
    delta: f64,
    caption: &Caption,
) -> Result<Figure, ReportError> {
    figure("bias", 1060, 500, caption, |page| {
        page.text(title, (24.0, 24.0), Words { size: 16.0, ..Words::default() })?;
        narrowing(page, curve, paths, delta)?;
        terms(page, findings, delta)
    })
}

const COLOURS: [plotters::prelude::RGBColor; 3] = [VERMILION, GREEN, BLUE];

/// Lower bound, estimate and upper bound of the bias in percent of the value. None if the value is 0.
fn relative(f: &Finding) -> Option<[f64; 3]> {
    let bounds = [f.interval.0, f.effect, f.interval.1].map(|x| 100.0 * x / f.scale.abs());
    bounds.iter().all(|b| b.is_finite()).then_some(bounds)
}

fn axis(title: &str, reach: f64) -> Axis {
    Axis::linear(title, -reach, reach, 8)
}

fn margins(panel: &Panel, from: f64, to: f64, delta: f64) -> Drawn {
    panel.line((from, 0.0), (to, 0.0), Stroke::solid(GREY, 1.2))?;
    for side in [-100.0, 100.0] {
        panel.line((from, side * delta), (to, side * delta), margin())?;
    }
    Ok(())
}

fn margin() -> Stroke {
    Stroke { color: GREY, width: 1.4, dash: Some((7.0, 5.0)) }
}

fn narrowing(page: &Canvas, curve: &[Glimpse], paths: u64, delta: f64) -> Drawn {
    let x = |g: &Glimpse| (g.batches * paths) as f64;
    let known = || curve.iter().filter(|g| g.image.iter().any(|f| relative(f).is_some()));
    let last = known().next_back().map_or(0.0, |g| {
        g.image.iter().filter_map(relative).flat_map(|b| [b[0].abs(), b[2].abs()]).fold(0.0, f64::max)
    });
    let reach = (300.0 * delta).max(1.5 * last);
    let axis_x = Axis::log("paths on each side", known().map(x));
    let panel = Panel::draw(
        page,
        "Bias of the whole image",
        [84.0, 78.0, 420.0, 340.0],
        axis_x,
        axis("% of the value", reach),
    )?;
    let ends = (1.0, 1e18);
    margins(&panel, ends.0, ends.1, delta)?;
    for (c, color) in COLOURS.iter().enumerate() {
        let points: Vec<(f64, [f64; 3])> = known().filter_map(|g| Some((x(g), relative(g.image.get(c)?)?))).collect();
        for (i, width) in [(0, 1.2), (1, 2.2), (2, 1.2)] {
            for pair in points.windows(2) {
                panel.line((pair[0].0, pair[0].1[i]), (pair[1].0, pair[1].1[i]), Stroke::solid(*color, width))?;
            }
        }
    }
    let mut entries: Vec<Entry> = CHANNELS
        .iter()
        .zip(COLOURS)
        .map(|(name, c)| Entry::new(Sample::Line(Stroke::solid(c, 2.2)), format!("{name}: estimate, bounds")))
        .collect();
    entries.push(Entry::new(Sample::Line(margin()), format!("margin, ±{} %", significant(100.0 * delta, 2))));
    page.legend((590.0, 80.0), 250.0, &entries)?;
    Ok(())
}

fn terms(page: &Canvas, findings: &[Finding], delta: f64) -> Drawn {
    let bounds: Vec<Option<[f64; 3]>> = findings.iter().map(relative).collect();
    let widest = bounds.iter().flatten().flat_map(|b| [b[0].abs(), b[2].abs()]).fold(0.0, f64::max);
    let reach = (150.0 * delta).max(1.1 * widest);
    let mut x = Axis::counts("term", findings.len().saturating_sub(1), findings.len());
    x.ticks = findings.iter().enumerate().map(|(i, f)| (i as f64, short(&f.name))).collect();
    let frame = [590.0, 218.0, (60.0 * findings.len() as f64).clamp(160.0, 440.0), 200.0];
    let panel = Panel::draw(page, "Every term at the end", frame, x, axis("% of the value", reach))?;
    margins(&panel, -0.5, findings.len() as f64, delta)?;
    for (i, (f, b)) in findings.iter().zip(&bounds).enumerate() {
        let Some(b) = b else { continue };
        let color = if f.outcome == Outcome::Differs { VERMILION } else { BLACK };
        let at = i as f64;
        panel.line((at, b[0]), (at, b[2]), Stroke::solid(color, 2.0))?;
        panel.line((at - 0.22, b[1]), (at + 0.22, b[1]), Stroke::solid(color, 2.6))?;
        for end in [b[0], b[2]] {
            panel.line((at - 0.12, end), (at + 0.12, end), Stroke::solid(color, 1.4))?;
        }
    }
    let label = if findings.iter().any(|f| f.outcome == Outcome::Differs) { "bias found" } else { "" };
    let mut entries = vec![Entry::new(Sample::Line(Stroke::solid(BLACK, 2.0)), "interval of one term, worst channel")];
    if !label.is_empty() {
        entries.push(Entry::new(Sample::Line(Stroke::solid(VERMILION, 2.0)), label));
    }
    page.legend((850.0, 80.0), 190.0, &entries)?;
    Ok(())
}

/// Formats `T3` as `T³`; other names are unchanged.
fn short(name: &str) -> String {
    name.strip_prefix('T')
        .and_then(|k| k.parse().ok())
        .map_or_else(|| name.to_owned(), |k| format!("T{}", superscript(k)))
}
