//! The noise of several renders against samples per pixel: table, CSV and figure.
//!
//! ```text
//! V(n) = c n^b      efficiency = 1 / (n V(n) · rays)   or   1 / (n V(n) · seconds)        rays, seconds: per path
//! ```
//!
//! Bands and intervals are 95 %, on the logarithmic scale: V · exp(± t s/V), which never reaches zero. Slopes carry one
//! standard error.

use crate::report::{
    ReportError, half_width_95,
    image::typeset::{Caption, superscript},
    plot::{Axis, BLACK, Canvas, Drawn, Entry, Figure, GREY, Look, Panel, Place, Sample, Stroke, Words, figure},
    text::{
        csv::Csv,
        number::{plus_minus, significant},
        table::{Side, aligned},
    },
};
use crate::stats::Slope;
use crate::study::convergence::{NoiseCurve, Stand};
use crate::terms::{Variance, scatter::Scatter};

/// The noise of one render at growing numbers of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Fall {
    /// The estimator, and the settings in which the renders differ.
    pub label: String,
    /// Pixels.
    pub pixels: usize,
    /// Cost and scatter at every number of samples n.
    pub stands: Vec<Stand>,
    /// The noise of each term, of the tail and of the sum.
    pub parts: Vec<NoiseCurve>,
}

impl Fall {
    /// Collects the noise of one render. `variance` says if the variance of the tail and of the sum is finite.
    pub fn new(label: String, pixels: usize, stands: Vec<Stand>, tail_is_known: bool, variance: Variance) -> Self {
        Self { label, pixels, parts: NoiseCurve::all(&stands, tail_is_known, variance), stands }
    }

    /// Rays and seconds per path, measured up to one number of samples.
    pub(super) fn cost(&self, s: &Stand) -> [f64; 2] {
        [s.rays as f64, s.seconds].map(|c| c / (self.pixels as f64 * f64::from(s.spp)))
    }

    /// Efficiency of a part with variance `v` at one number of samples: 1/(n V · rays) and 1/(n V · seconds), per path.
    fn efficiency(&self, s: &Stand, v: f64) -> [f64; 2] {
        self.cost(s).map(|c| 1.0 / (f64::from(s.spp) * v * c))
    }
}

/// `−1.003 ± 0.021`.
pub(super) fn slope_text(slope: Option<Slope>) -> String {
    slope.map_or("–".into(), |s| plus_minus(s.slope, s.std_error, 2))
}

pub(super) fn number(x: f64) -> String {
    if x.is_nan() { "–".into() } else { significant(x, 3) }
}

fn name(part: &str) -> String {
    match part.parse::<usize>() {
        Ok(k) => format!("T{}E", superscript(k)),
        Err(_) if part == "all" => "Σ".into(),
        Err(_) => part.into(),
    }
}

/// Every number: for each render the variance of each term at the last n, its slope and its cost.
pub fn table(falls: &[Fall]) -> String {
    let mut blocks = vec![];
    for f in falls {
        let Some(last) = f.stands.last() else { continue };
        let referred = f.parts.iter().any(|p| p.points.iter().any(|q| q.1.squared_error().is_some()));
        let mut header = vec!["k", "V(n)", "± 95 %", "slope of V ± se"];
        if referred {
            header.extend(["MSE(n)", "± 95 %", "RMSE", "slope of MSE"]);
        } else {
            header.extend(["1/(nV rays)", "1/(nV s)"]);
        }
        let mut rows = vec![header.iter().map(|h| (*h).to_string()).collect::<Vec<_>>()];
        for p in &f.parts {
            let Some((_, s)) = p.points.last() else { continue };
            let (v, replicates) = (s.variance(), s.replicates() as u64);
            let half = |e: f64| number(half_width_95(e, replicates));
            let mut row = vec![p.name.clone(), number(v), half(s.variance_error()), slope_text(p.slope())];
            if referred {
                let mse = s.squared_error().unwrap_or(f64::NAN);
                let rmse = if mse < 0.0 { "≤ noise".into() } else { number(mse.sqrt()) };
                row.extend([number(mse), half(s.squared_error_error()), rmse, slope_text(p.error_slope())]);
            } else {
                row.extend(f.efficiency(last, v).map(|x| if x.is_infinite() { "∞".into() } else { number(x) }));
            }
            rows.push(row);
        }
        let sides = [[Side::Left].as_slice(), &[Side::Right; 7]].concat();
        let mut numbers: Vec<String> = f.stands.iter().map(|s| s.spp.to_string()).collect();
        if numbers.len() > 6 {
            numbers.splice(3..numbers.len() - 1, ["…".to_string()]);
        }
        let [rays, seconds] = f.cost(last);
        let cost = format!("{} rays and {} µs a path", number(rays), number(1e6 * seconds));
        let head = format!("{}: n = {}; {cost}", f.label, numbers.join(", "));
        blocks.push(format!("{head}\n{}", aligned(&rows, &sides[..rows[0].len()])));
    }
    if falls.len() > 1 {
        let header = ["the sum, at the last n", "n", "nV", "slope of V ± se", "1/(nV rays)", "1/(nV s)"];
        let mut rows = vec![header.map(String::from).to_vec()];
        for f in falls {
            let (Some(last), Some(all)) = (f.stands.last(), f.parts.last()) else { continue };
            let v = last.parts.last().map_or(f64::NAN, Scatter::variance);
            let [per_ray, per_second] = f.efficiency(last, v).map(number);
            let one = number(f64::from(last.spp) * v);
            rows.push(vec![f.label.clone(), last.spp.to_string(), one, slope_text(all.slope()), per_ray, per_second]);
        }
        blocks.push(aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 5]].concat()));
    }
    blocks.join("\n")
}

/// Every number as CSV: one line per render, part and n. Slopes repeat on the lines of their part. Numbers that are not
/// known are left empty.
pub fn csv(falls: &[Fall]) -> String {
    let mut csv = Csv::new(
        "value,k,n,replicates,variance,variance_std_error,mse,mse_std_error,slope,slope_std_error,mse_slope,\
         mse_slope_std_error,rays,seconds,rays_per_path,efficiency_per_ray,efficiency_per_second",
    );
    let fit = |s: Option<Slope>| s.map_or([f64::NAN; 2], |s| [s.slope, s.std_error]);
    for f in falls {
        for p in &f.parts {
            let slopes = [fit(p.slope()), fit(p.error_slope())];
            for (stand, (n, s)) in f.stands.iter().zip(&p.points) {
                let v = s.variance();
                let mse = s.squared_error().unwrap_or(f64::NAN);
                csv.put(&f.label).put(&p.name).put(n).put(s.replicates());
                csv.numbers([v, s.variance_error(), mse, s.squared_error_error()]).numbers(slopes.concat());
                csv.put(stand.rays).numbers([stand.seconds, f.cost(stand)[0]]).numbers(f.efficiency(stand, v)).end();
            }
        }
    }
    csv.text()
}

/// A curve with its band.
struct Line {
    label: String,
    /// n, value, and the ends of its interval.
    points: Vec<[f64; 4]>,
    /// Squared errors, drawn as crosses.
    errors: Vec<(f64, f64)>,
    look: Look,
    slope: Option<Slope>,
}

fn line(label: String, part: &NoiseCurve, look: Look) -> Option<Line> {
    let point = |(n, s): &(u32, Scatter)| {
        let (v, half) = (s.variance(), half_width_95(s.variance_error(), s.replicates() as u64));
        let factor = if half.is_finite() { (half / v).exp() } else { 1.0 };
        (v > 0.0 && v.is_finite()).then_some([f64::from(*n), v, v / factor, v * factor])
    };
    let points: Vec<[f64; 4]> = part.points.iter().filter_map(point).collect();
    let error = |(n, s): &(u32, Scatter)| s.squared_error().filter(|e| *e > 0.0).map(|e| (f64::from(*n), e));
    let errors = part.points.iter().filter_map(error).collect();
    (!points.is_empty()).then(|| Line { label, points, errors, look, slope: part.slope() })
}

const COLUMN: f64 = 560.0;
const ROW: f64 = 430.0;
const GUIDE: Stroke = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };

/// Draws one panel with the whole image of each render, and for each render one panel with its terms.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(falls: &[Fall], title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    let mut panels: Vec<(String, Vec<Line>)> = vec![];
    let sum = |(i, f): (usize, &Fall)| f.parts.last().and_then(|p| line(f.label.clone(), p, Look::nth(i)));
    let sums: Vec<Line> = falls.iter().enumerate().filter_map(sum).collect();
    panels.push(("The sum of all terms".into(), sums));
    for f in falls.iter().filter(|f| f.parts.len() > 1) {
        let terms = &f.parts[..f.parts.len() - 1];
        let lines = terms.iter().enumerate().filter_map(|(i, p)| line(name(&p.name), p, Look::nth(i)));
        panels.push((f.label.clone(), lines.collect()));
    }
    let rows = panels.len().div_ceil(2);
    let width = if panels.len() == 1 { COLUMN } else { 2.0 * COLUMN };
    figure("variance", width as u32, (56.0 + rows as f64 * ROW) as u32, caption, |page| {
        page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        let at = |i: usize| ((i % 2) as f64 * COLUMN, 56.0 + (i / 2) as f64 * ROW);
        panels.iter().enumerate().try_for_each(|(i, (title, lines))| panel(page, at(i), title, lines))
    })
}

fn panel(page: &Canvas, (left, top): Place, title: &str, lines: &[Line]) -> Drawn {
    let points = || lines.iter().flat_map(|l| &l.points);
    let values = points().flat_map(|p| p[1..].to_vec()).chain(lines.iter().flat_map(|l| &l.errors).map(|e| e.1));
    let x = Axis::powers_of_two("samples per pixel n", points().map(|p| p[0]), 9);
    let y = Axis::log("variance of the mean   (W² sr⁻² m⁻⁴)", values);
    let frame = [left + 84.0, top + 24.0, 250.0, 320.0];
    let panel = Panel::draw(page, title, frame, x, y)?;
    // −1, through the top of the highest curve
    if let Some(p) = points().max_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1]))) {
        let (c, far) = (1.5 * p[0] * p[1], 4.0 * points().map(|p| p[0]).fold(1.0, f64::max));
        panel.line((0.25, c / 0.25), (far, c / far), GUIDE)?;
    }
    for l in lines {
        let upper = l.points.iter().map(|p| (p[0], p[3]));
        let lower = l.points.iter().rev().map(|p| (p[0], p[2]));
        panel.band(&upper.chain(lower).collect::<Vec<_>>(), l.look)?;
    }
    for l in lines {
        for pair in l.points.windows(2) {
            panel.line((pair[0][0], pair[0][1]), (pair[1][0], pair[1][1]), Stroke::solid(l.look.color, 1.2))?;
        }
        l.points.iter().try_for_each(|p| panel.mark(p[0], p[1], l.look))?;
        l.errors.iter().try_for_each(|&(n, e)| panel.mark(n, e, Look { mark: Look::CROSS, ..l.look }))?;
    }
    let mut entries = vec![Entry::new(Sample::Heading, "slope ± standard error")];
    entries.extend(lines.iter().map(|l| {
        let slope = slope_text(l.slope).replace(' ', "\u{a0}");
        Entry::new(Sample::Mark(l.look), format!("{}: {slope}", l.label))
    }));
    entries.push(Entry::new(Sample::Line(GUIDE), "slope −1"));
    if lines.iter().any(|l| !l.errors.is_empty()) {
        entries.push(Entry::new(Sample::Mark(Look { color: BLACK, mark: Look::CROSS }), "squared error"));
    }
    entries.push(Entry::new(Sample::Plain, "bands: 95 %"));
    page.legend((left + 350.0, top + 28.0), 200.0, &entries)?;
    Ok(())
}
