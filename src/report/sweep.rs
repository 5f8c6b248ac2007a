//! One setting, several values: what each value costs, and what it buys.
//!
//! ```text
//! V = n · Var(mean of n samples)        efficiency = 1 / (V · rays)   or   1 / (V · seconds)        rays, seconds: per path
//! ```
//!
//! The efficiency of independent samples does not depend on their number: twice as efficient is half the work for the same
//! error. Every term is charged with the whole path, because that is what has to be walked to get it.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample, averaged over pixels and channels | [`Row::variance`] |
//! | n | samples per pixel | [`Row::spp`] |
//! | rays | asked for on behalf of each slot | [`Row::rays`] |
//!
//! Reference: Hammersley and Handscomb, *Monte Carlo Methods* (1964), section 3.

use super::{
    ReportError,
    axis::Axis,
    canvas::{Drawn, Entry, Page, Sample, Stroke, Words},
    panel::Panel,
    plot::{Curve, Figure, GREY, Look, Point, figure},
    table::{Side, aligned, average, known, significant},
    typeset::{Caption, superscript},
};
use crate::terms::variance::Variance;
use crate::terms::{Estimate, Functional};
use crate::worlds::sampled::Sampled;

/// What one value gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The value, as it was typed.
    pub value: String,
    /// Samples per pixel.
    pub spp: u32,
    /// Paths started.
    pub paths: u64,
    /// Means and errors of the image.
    pub image: Functional,
    /// Rays by slot: k = 0..=K, tail.
    pub rays: Vec<u64>,
    /// Variance of one sample by slot.
    pub variance: Vec<Variance>,
    /// Variance of one sample of the sum of all slots.
    pub total: Variance,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl Row {
    /// The numbers of a finished run.
    pub fn new(value: &str, sampled: &Sampled) -> Self {
        let unknown = Variance { value: f64::NAN, std_error: f64::NAN, ..Variance::default() };
        // variances of the mean of n samples, times n
        let (slots, total) = match sampled.snapshots.last() {
            Some(s) => {
                let n = f64::from(s.spp);
                let one = |v: &Variance| Variance {
                    value: n * v.value,
                    channels: n * v.channels,
                    std_error: n * v.std_error,
                };
                (s.slots.iter().map(one).collect(), one(&s.total))
            }
            None => (vec![unknown; sampled.rays.len()], unknown),
        };
        Self {
            value: value.into(),
            spp: sampled.spp,
            paths: sampled.series.cost.paths,
            image: sampled.series.image().clone(),
            rays: sampled.rays.clone(),
            variance: slots,
            total,
            seconds: sampled.series.cost.seconds,
        }
    }

    /// Rays of all slots per path.
    pub fn rays_per_path(&self) -> f64 {
        self.rays.iter().sum::<u64>() as f64 / self.paths as f64
    }

    /// 1/(V · rays) and 1/(V · seconds), both per path.
    pub fn efficiency(&self, variance: f64) -> [f64; 2] {
        [self.rays_per_path(), self.seconds / self.paths as f64].map(|cost| 1.0 / (variance * cost))
    }

    /// Name, estimate, variance and rays of every term, of the tail if there is one, and of the whole.
    fn parts(&self) -> Vec<(String, Estimate, Variance, u64)> {
        let Functional { terms, tail, total, .. } = &self.image;
        let term = |(k, e): (usize, &Estimate)| (k.to_string(), *e, self.variance[k], self.rays[k]);
        let mut parts: Vec<_> = terms.iter().enumerate().map(term).collect();
        let last = terms.len();
        if !tail.is_none() {
            parts.push(("tail".into(), *tail, self.variance[last], self.rays[last]));
        }
        parts.push(("all".into(), *total, self.total, self.rays.iter().sum()));
        parts
    }
}

/// A setting and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The setting: `branching`, `spp`, ….
    pub over: String,
    /// One per value.
    pub rows: Vec<Row>,
}

/// Two tables: the whole image by value, and every term of every value.
pub fn table(sweep: &Sweep) -> String {
    let number = |x: f64| if x.is_infinite() { "∞".into() } else { known_to(x, 3) };
    let cost = |r: &Row, v: f64| r.efficiency(v).map(number);
    // a sweep over spp has its numbers of samples in the first column
    let spp = if sweep.over == "spp" { "n" } else { "spp" };
    let header = [&sweep.over, spp, "mean", "± 95 %", "rays/path", "µs/path", "variance V", "1/(V rays)", "1/(V s)"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(sweep.rows.iter().map(|r| {
        let (mean, half) = average(&r.image.total);
        let [per_ray, per_second] = cost(r, r.total.value);
        let time = 1e6 * r.seconds / r.paths as f64;
        let numbers = [significant(mean, 4), known(half), number(r.rays_per_path()), number(time)];
        let cut = if r.image.tail.is_none() { " (cut at K)" } else { "" };
        let head = [format!("{}{cut}", r.value), r.spp.to_string()];
        head.into_iter().chain(numbers).chain([number(r.total.value), per_ray, per_second]).collect()
    }));
    let whole = aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 8]].concat());

    let header = [&sweep.over, "k", "mean", "± 95 %", "rays/path", "variance V", "1/(V rays)", "1/(V s)"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for r in &sweep.rows {
        let parts = r.parts();
        rows.extend(parts[..parts.len() - 1].iter().map(|(k, e, v, rays)| {
            let (mean, half) = average(e);
            let [per_ray, per_second] = cost(r, v.value);
            let numbers = [significant(mean, 4), known(half), number(*rays as f64 / r.paths as f64), number(v.value)];
            [r.value.clone(), k.clone()].into_iter().chain(numbers).chain([per_ray, per_second]).collect()
        }));
    }
    let terms = aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat());
    format!("the whole image\n{whole}\nterm by term, each charged with the whole path\n{terms}")
}

fn known_to(x: f64, digits: usize) -> String {
    if x.is_nan() { "–".into() } else { significant(x, digits) }
}

/// Everything, a line per value and k (`0`, `1`, …, `tail`, `all`); a number that is not known is left empty.
pub fn csv(sweep: &Sweep) -> String {
    let mut out = String::from(
        "over,value,k,spp,paths,mean,std_error,mean_r,mean_g,mean_b,std_error_r,std_error_g,std_error_b,replicates,rays,\
         rays_per_path,variance,variance_std_error,seconds,efficiency_per_ray,efficiency_per_second\n",
    );
    let number = |x: f64| if x.is_nan() { String::new() } else { x.to_string() };
    for r in &sweep.rows {
        for (k, e, v, rays) in r.parts() {
            let [per_ray, per_second] = r.efficiency(v.value);
            let grey = [e.mean.element_sum() / 3.0, e.std_error.element_sum() / 3.0];
            let colour = e.mean.to_array().into_iter().chain(e.std_error.to_array());
            let mut cells = vec![sweep.over.clone(), quoted(&r.value), k, r.spp.to_string(), r.paths.to_string()];
            cells.extend(grey.into_iter().chain(colour).map(number));
            cells.extend([e.replicates.to_string(), rays.to_string(), number(rays as f64 / r.paths as f64)]);
            cells.extend([v.value, v.std_error, r.seconds, per_ray, per_second].map(number));
            out += &cells.join(",");
            out.push('\n');
        }
    }
    out
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}

/// Draws cost and gain side by side: for `branching` the rays and the variance of every term, for `spp` the variance of
/// the mean as it falls, else the variance of one sample and the same times its rays.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(sweep: &Sweep, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    figure("sweep", 1120, 490, caption, |page| panels(page, sweep, title))
}

const UNIT: &str = "variance   (W² sr⁻² m⁻⁴)";
const LEFT: [f64; 4] = [84.0, 72.0, 372.0, 350.0];
const RIGHT: [f64; 4] = [552.0, 72.0, 372.0, 350.0];

fn panels(page: &Page, sweep: &Sweep, title: &str) -> Drawn {
    page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
    let by_value = |i: usize, points: Vec<Point>| {
        let r = &sweep.rows[i];
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
        "spp" => return fall(page, sweep),
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

/// What the legend says below the curves.
fn notes(silent: bool) -> Vec<Entry> {
    let mut notes = vec![Entry::new(Sample::Heading, "bars: 95 %")];
    if silent {
        notes.push(Entry::new(Sample::Heading, "no mark: no noise"));
    }
    notes
}

fn against_k<'a, 'b>(
    page: &'a Page<'b>,
    frame: [f64; 4],
    (title, unit): (&str, &str),
    curves: &[Curve],
) -> Result<Panel<'a, 'b>, Box<dyn std::error::Error>> {
    let points = || curves.iter().flat_map(|c| &c.points);
    let last = points().map(|p| p.x).fold(1.0, f64::max) as usize;
    let panel = Panel::draw(page, title, frame, Axis::counts("bounce k", last, 10), log(unit, curves))?;
    curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    Ok(panel)
}

fn log(unit: &str, curves: &[Curve]) -> Axis {
    Axis::log(unit, curves.iter().flat_map(|c| &c.points).flat_map(|p| [p.value, p.value + p.half_width()]))
}

/// A curve per term against n: the variance of the mean, and n times the same, which independent samples leave level.
fn fall(page: &Page, sweep: &Sweep) -> Drawn {
    let terms = sweep.rows.first().map_or(0, |r| r.image.terms.len());
    let curves = |factor: &dyn Fn(f64) -> f64| -> Vec<Curve> {
        let point = |r: &Row, k: usize| {
            let (n, v) = (f64::from(r.spp), &r.variance[k]);
            let replicates = r.image.total.replicates;
            Point { x: n, value: factor(n) * v.value, std_error: factor(n) * v.std_error, replicates }
        };
        let curve = |k: usize| Curve {
            label: format!("T{}E", superscript(k)),
            points: sweep.rows.iter().map(|r| point(r, k)).filter(|p| p.value > 0.0).collect(),
            look: Look::nth(k),
        };
        (0..terms).map(curve).filter(|c| !c.points.is_empty()).collect()
    };
    let (mean, one) = (curves(&|n| 1.0 / n), curves(&|_| 1.0));
    let samples = || sweep.rows.iter().map(|r| f64::from(r.spp));
    let axis = || Axis::powers_of_two("samples per pixel n", samples(), 9);
    let panel = Panel::draw(page, "Variance of the mean of n samples", LEFT, axis(), log(UNIT, &mean))?;
    if let Some(top) = one.iter().flat_map(|c| &c.points).map(|p| p.value).reduce(f64::max) {
        let far = 2.0 * samples().fold(1.0, f64::max);
        panel.line((0.5, 1.6 * top / 0.5), (far, 1.6 * top / far), GUIDE)?;
    }
    mean.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    let panel = Panel::draw(page, "n times the same: level if independent", RIGHT, axis(), log(UNIT, &one))?;
    one.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
    let mut entries: Vec<Entry> = mean.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
    entries.push(Entry::new(Sample::Line(GUIDE), "slope −1"));
    entries.extend(notes(mean.len() < terms));
    page.legend(LEGEND, 160.0, &entries)?;
    Ok(())
}
