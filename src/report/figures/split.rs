//! Three ways to spend the same rays on samples, predicted and measured, and the heat map of covariances that explains them.
//!
//! ```text
//! equal: Σσ² · Σc      optimal: (Σ σ√c)²      prefix: 1ᵀC1 · c       each the product of variance and cost of the sum
//! ```
//!
//! Reference and symbols: [`study::split`](crate::study::split).

use crate::report::{
    ReportError, half_width_95,
    image::typeset::{Caption, superscript},
    plot::{BLACK, BLUE, Canvas, Drawn, Figure, GREY, VERMILION, Words, figure},
    text::{
        csv::Csv,
        number::significant,
        prose::wrapped,
        ranking::{Candidate, Ranking},
        table::{Side, aligned},
    },
};
use crate::study::split::{REPLICATES, Study, Term, Unit, Work, best, work};
use crate::terms::covariance::Covariance;
use plotters::{prelude::RGBColor, style::text_anchor::HPos};

/// Variance × cost of one way to spend the samples.
pub struct Way {
    /// `equal`, `optimal` or `prefix`.
    pub name: &'static str,
    /// Variance × cost predicted by the pilot run, by rays and by seconds.
    pub predicted: [Work; 2],
    /// Variance × cost measured by the render, by rays and by seconds.
    pub measured: [Work; 2],
    /// Rays spent per pixel.
    pub rays: f64,
    /// Seconds spent per pixel.
    pub seconds: f64,
}

/// The three ways.
pub fn ways(study: &Study) -> Vec<Way> {
    let units = [Unit::Rays, Unit::Seconds];
    let split = |name, terms: &[Term]| {
        let counts: Vec<u32> = terms.iter().map(|t| t.spp).collect();
        let spent = |unit| terms.iter().map(|t| f64::from(t.spp) * t.cost(unit)).sum();
        Way {
            name,
            predicted: units.map(|u| work(&study.pilot, &counts, u)),
            measured: units.map(|u| work(terms, &counts, u)),
            rays: spent(Unit::Rays),
            seconds: spent(Unit::Seconds),
        }
    };
    let n = f64::from(study.reuse.spp);
    let prefix = Way {
        name: "prefix",
        predicted: units.map(|u| study.pilot_reuse.work(u)),
        measured: units.map(|u| study.reuse.work(u)),
        rays: n * study.reuse.rays,
        seconds: n * study.reuse.seconds,
    };
    vec![split("equal", &study.equal), split("optimal", &study.optimal), prefix]
}

fn number(x: f64) -> String {
    if x.is_nan() { "–".into() } else { significant(x, 4) }
}

fn half(error: f64) -> String {
    number_to(half_width_95(error, REPLICATES as u64), 2)
}

fn number_to(x: f64, digits: usize) -> String {
    if x.is_nan() { "–".into() } else { significant(x, digits) }
}

/// Every number in tables: variance × cost of the whole image, predicted and measured, and the samples of every term.
pub fn table(study: &Study) -> String {
    let ways = ways(study);
    let reuse = ways[2].measured[0].value;
    let mut blocks = vec![];
    for (u, unit) in ["rays", "seconds"].into_iter().enumerate() {
        let header = ["Var × Cost", "predicted", "± 95 %", "measured", "± 95 %", "ratio", "± 95 %", "of prefix"];
        let mut rows = vec![header.map(String::from).to_vec()];
        for w in &ways {
            let (p, m) = (w.predicted[u], w.measured[u]);
            let ratio = m.value / p.value;
            let error = ratio * (m.std_error / m.value).hypot(p.std_error / p.value);
            let base = if u == 0 { reuse } else { ways[2].measured[1].value };
            let numbers = [number(p.value), half(p.std_error), number(m.value), half(m.std_error)];
            let rest = [number_to(ratio, 3), half(error), number_to(m.value / base, 3)];
            rows.push([w.name.to_string()].into_iter().chain(numbers).chain(rest).collect());
        }
        let least = best(&study.pilot, if u == 0 { Unit::Rays } else { Unit::Seconds });
        let spent: Vec<String> = ways
            .iter()
            .map(|w| format!("{} {}", w.name, number_to(if u == 0 { w.rays } else { w.seconds }, 4)))
            .collect();
        let note = if u == 0 { "" } else { " (no ± knows the noise of the clock)" };
        blocks.push(format!(
            "by {unit} (per pixel: {})\n{}least of any split, (Σ σ√c)²: {} ± {}{note}\n",
            spent.join(", "),
            aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 7]].concat()),
            number(least.value),
            half(least.std_error)
        ));
    }
    let header = ["k", "σ²", "± 95 %", "rays c", "µs", "n equal", "n optimal", "measured σ²", "± 95 %", "prefix σ²"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for (k, t) in study.pilot.iter().enumerate() {
        let (equal, optimal) = (&study.equal[k], &study.optimal[k]);
        let name = if k + 2 == study.reuse.covariance.slots + 1 { "tail".into() } else { k.to_string() };
        rows.push(vec![
            name,
            number(t.variance),
            half(t.std_error),
            number_to(t.rays, 3),
            number_to(1e6 * t.seconds, 2),
            equal.spp.to_string(),
            optimal.spp.to_string(),
            number(optimal.variance),
            half(optimal.std_error),
            number(study.reuse.covariance.entry(k, k)),
        ]);
    }
    let terms = aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 9]].concat());
    let ((sum, _), (trace, _)) = (study.reuse.covariance.sum(), study.reuse.covariance.trace());
    blocks.push(format!(
        "term by term: σ² of one sample from the pilot of {} spp; n in multiples of {REPLICATES} replicates\n{terms}\
         one path for all terms: 1ᵀC1 = {}, trace C = {}: sharing makes the variance ×{}\n",
        study.pilot.first().map_or(0, |t| t.spp),
        number(sum),
        number(trace),
        number_to(sum / trace, 3)
    ));
    blocks.join("\n")
}

/// The answer: which way needs the fewest rays for the same error, and why.
pub fn answer(study: &Study) -> String {
    let noise = format!("{} samples per pixel and term", study.equal.first().map_or(0, |t| t.spp));
    let mut text = ranking(study).sentence("ways to spend rays", "the whole image", &noise);
    let total: u32 = study.optimal.iter().map(|t| t.spp).sum();
    let most = study.optimal.iter().enumerate().max_by_key(|(_, t)| t.spp);
    let variance: f64 = study.pilot.iter().map(|t| t.variance).sum();
    if let Some((k, t)) = most
        && let Some(pilot) = study.pilot.get(k)
    {
        text += &format!(
            " The optimal split gives term k the samples n ∝ σ/√c. So {} gets {:.0} % of the samples: it has {:.0} % of the \
             variance, and one sample takes {}.",
            term(study, k),
            100.0 * f64::from(t.spp) / f64::from(total),
            100.0 * pilot.variance / variance,
            if pilot.rays == 1.0 { "one ray".into() } else { significant(pilot.rays, 2) + " rays" }
        );
    }
    wrapped(&text)
}

/// The ways by Var × rays as measured.
fn ranking(study: &Study) -> Ranking {
    let candidate = |w: Way| Candidate {
        name: w.name.into(),
        work: w.measured[0].value,
        relative_error: w.measured[0].std_error / w.measured[0].value,
        replicates: REPLICATES as u64,
        without: vec![], // the three ways use different random numbers
    };
    Ranking::new(ways(study).into_iter().map(candidate).collect())
}

/// `T3`, or `tail`.
fn term(study: &Study, k: usize) -> String {
    if k + 1 == study.reuse.covariance.slots { "tail".into() } else { format!("T{k}") }
}

/// The three ways, one line each: Var × rays as predicted and as measured.
pub fn small_table(study: &Study) -> String {
    let ranking = ranking(study);
    let header = ["way", "rays/pixel", "predicted", "± 95 %", "measured", "± 95 %", "relative"];
    let mut rows = vec![header.map(String::from).to_vec()];
    for w in ways(study) {
        let (p, m) = (w.predicted[0], w.measured[0]);
        rows.push(vec![
            w.name.into(),
            number(w.rays),
            number_to(p.value, 3),
            half(p.std_error),
            number_to(m.value, 3),
            half(m.std_error),
            ranking.cell_with_error(w.name),
        ]);
    }
    let head = "Variance × rays of the whole image, predicted by a pilot run and measured at about the same rays. \
                equal: the same n for each term. optimal: n ∝ σ/√c. prefix: all terms from one path.";
    format!("{}\n{}", wrapped(head), aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; 6]].concat()))
}

/// Variance, cost and samples of the first terms and of the tail, one column each.
pub fn samples(study: &Study) -> String {
    const MOST: usize = 9;
    let all = study.pilot.len();
    // the last column is the tail, or the last term
    let shown: Vec<usize> = if all > MOST { (0..MOST - 1).chain([all - 1]).collect() } else { (0..all).collect() };
    let row = |name: &str, of: &dyn Fn(usize) -> String| -> Vec<String> {
        [name.to_owned()].into_iter().chain(shown.iter().map(|&k| of(k))).collect()
    };
    let rows = [
        row("term", &|k| term(study, k)),
        row("σ²", &|k| number_to(study.pilot[k].variance, 2)),
        row("rays c", &|k| number_to(study.pilot[k].rays, 2)),
        row("n", &|k| study.optimal[k].spp.to_string()),
    ];
    let head = "The optimal split: variance σ² and rays c of one sample, and samples n per pixel.";
    format!("{head}\n{}", aligned(&rows, &[[Side::Left].as_slice(), &[Side::Right; MOST]].concat()))
}

/// Every number as CSV: one line per way and term, `all` for the sum. Numbers that are not known are left empty.
pub fn csv(study: &Study) -> String {
    let mut csv = Csv::new(
        "way,k,n,variance,variance_std_error,rays,seconds,predicted_work_rays,predicted_work_rays_std_error,\
         measured_work_rays,measured_work_rays_std_error,predicted_work_seconds,predicted_work_seconds_std_error,\
         measured_work_seconds,measured_work_seconds_std_error",
    );
    for (name, terms) in [("pilot", &study.pilot), ("equal", &study.equal), ("optimal", &study.optimal)] {
        for (k, t) in terms.iter().enumerate() {
            csv.put(name).put(k).put(t.spp).numbers([t.variance, t.std_error, t.rays, t.seconds]).blank(8).end();
        }
    }
    for k in 0..study.reuse.covariance.slots {
        csv.put("prefix").put(k).put(study.reuse.spp).put(study.reuse.covariance.entry(k, k)).blank(11).end();
    }
    for w in ways(study) {
        csv.put(w.name).put("all").blank(3).put(w.rays).put(w.seconds);
        let works = [w.predicted[0], w.measured[0], w.predicted[1], w.measured[1]];
        csv.numbers(works.iter().flat_map(|w| [w.value, w.std_error])).end();
    }
    csv.text()
}

/// Every entry of C, a line each.
pub fn covariance_csv(c: &Covariance) -> String {
    let mut csv = Csv::new("a,b,covariance,correlation");
    for (a, b) in (0..c.slots).flat_map(|a| (0..c.slots).map(move |b| (a, b))) {
        csv.put(a).put(b).numbers([c.entry(a, b), c.correlation(a, b)]).end();
    }
    csv.text()
}

const CELL: f64 = 46.0;

/// Draws the correlations of the terms, and next to them the share of every entry in the variance of the sum. `slots` is the
/// number of terms shown: all of them, or all but a tail that is not known.
///
/// # Errors
/// If the plot crate fails, which is a defect.
pub fn draw(c: &Covariance, slots: usize, title: &str, caption: &Caption) -> Result<Figure, ReportError> {
    let side = slots as f64 * CELL;
    let (width, height) = ((2.0 * side + 230.0).max(700.0), side + 170.0);
    let (sum, trace) = (c.sum().0, c.trace().0);
    let largest = (0..slots).flat_map(|a| (0..slots).map(move |b| (a, b))).map(|(a, b)| (c.entry(a, b) / sum).abs());
    let largest = largest.fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    figure("covariance", width as u32, height as u32, caption, |page| {
        page.text(title, (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        let correlation = |a: usize, b: usize| (c.correlation(a, b), 1.0);
        let share = |a: usize, b: usize| (c.entry(a, b) / sum, largest);
        let text = |v: f64| if v.is_nan() { String::new() } else { signed(format!("{v:.2}")) };
        let percent = |v: f64| if v.is_nan() { String::new() } else { signed(format!("{:.1}", 100.0 * v)) };
        let tail = slots == c.slots;
        matrix(page, 70.0, slots, tail, "Correlation of the terms of one path", &correlation, &text)?;
        matrix(page, 160.0 + side, slots, tail, "Share of the variance of the sum, per cent", &share, &percent)?;
        let note = format!(
            "Variance of the sum {}, sum of the variances {}: one path for all terms has {} times the variance of separate paths",
            number(sum),
            number(trace),
            number_to(sum / trace, 3)
        );
        page.text(&note, (24.0, side + 130.0), Words { size: 12.5, ..Words::default() })?;
        let key = "blue: positive · orange: negative; the stronger the colour, the larger the value (square-root scale) · empty: a term without noise";
        page.text(key, (24.0, side + 150.0), Words { size: 12.5, color: GREY, ..Words::default() })
    })
}

fn signed(text: String) -> String {
    text.replace('-', "−")
}

fn matrix(
    page: &Canvas,
    left: f64,
    slots: usize,
    tail: bool,
    title: &str,
    value: &dyn Fn(usize, usize) -> (f64, f64),
    text: &dyn Fn(f64) -> String,
) -> Drawn {
    const TOP: f64 = 96.0;
    page.text(title, (left, 62.0), Words { size: 14.0, bold: true, ..Words::default() })?;
    let name = |k: usize| if tail && k + 1 == slots { "tail".into() } else { format!("T{}", superscript(k)) };
    let middle = Words { size: 12.0, align: HPos::Center, ..Words::default() };
    for a in 0..slots {
        let at = (a as f64 + 0.5) * CELL;
        page.text(&name(a), (left + at, TOP - 12.0), middle)?;
        page.text(&name(a), (left - 8.0, TOP + at), Words { align: HPos::Right, ..middle })?;
        for b in 0..slots {
            let (v, full) = value(a, b);
            let (x, y) = (left + b as f64 * CELL, TOP + a as f64 * CELL);
            let corners = [(x, y), (x + CELL - 1.0, y), (x + CELL - 1.0, y + CELL - 1.0), (x, y + CELL - 1.0)];
            // the root, so that the sign of small ones is seen beside a diagonal of ones
            let depth = if v.is_nan() { 0.0 } else { (v.abs() / full).min(1.0).sqrt() };
            page.polygon(&corners, shade(v < 0.0, depth))?;
            let color = if depth > 0.7 { RGBColor(255, 255, 255) } else { BLACK };
            page.text(&text(v), (x + CELL / 2.0, y + CELL / 2.0), Words { size: 11.0, color, ..middle })?;
        }
    }
    Ok(())
}

/// From a pale grey at 0 to the full colour at 1.
fn shade(negative: bool, depth: f64) -> RGBColor {
    let full = if negative { VERMILION } else { BLUE };
    let mix = |c: u8| (245.0 + (f64::from(c) - 245.0) * depth).round() as u8;
    RGBColor(mix(full.0), mix(full.1), mix(full.2))
}
