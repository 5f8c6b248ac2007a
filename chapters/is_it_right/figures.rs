//! Figures and tables of chapter 14.
//!
//! | file | shows |
//! |---|---|
//! | `maps` | t per pixel, right and darker renderer, and the distribution of their p-values |
//! | `rates` | rate of false alarms against the number of looks; rate of detection against the number of samples |
//! | `signatures`, `signatures.md` | r_k of six members of the zoo |

use super::Measured;
use super::claims::{number, percent, share};
use super::decisions::{FIRST, power, power_of_equality};
use super::experiments::{ALPHA, BATCH, BATCHES, SAMPLES, SHORT, SIDE, TESTS, smallest};
use super::signatures::{LAST, Signature};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::{picture::Picture, zmap};
use fredholm::report::plot::{self, Axis, Canvas, Curve, Drawn, Entry, Look, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::markdown;
use fredholm::stats::two_sided_p;
use fredholm::zoo::signature::Ratio;

/// Bins of the histogram of p-values.
const BINS: usize = 20;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let last = |rates: &[Number]| share(rates[BATCHES - 1]);
    let below = |t: &[f64]| percent(alarms(t).iter().filter(|&&p| p <= ALPHA).count() as f64 / t.len() as f64);
    let found = |n: usize| m.power.iter().find(|p| p.0 == n).map_or("–".into(), |p| share(p.1));
    folder.numbers(&[
        ("experiments", format!("{}", m.p.len())),
        ("samples", format!("{SAMPLES}")),
        ("darker", percent(1.0 - smallest())),
        ("families", share(m.families[0])),
        ("holm", share(m.families[1])),
        ("once", percent(1.0 - (1.0 - ALPHA).powi(TESTS as i32))),
        ("watched", last(&m.watched[0])),
        ("anytime", last(&m.watched[1])),
        ("power", found(BATCHES)),
        ("short", found(SHORT)),
        ("equal_right", share(m.equal[0])),
        ("predicted_equal", percent(power_of_equality())),
        ("equal_darker", share(m.equal[1])),
        ("map_right", below(&m.maps[0])),
        ("map_darker", below(&m.maps[1])),
    ])?;
    folder.text("signatures.md", &table(&m.zoo))?;
    maps(folder, m)?;
    rates(folder, m)?;
    signatures(folder, m)
}

fn title(page: &Canvas<'_>, words: &str) -> Drawn {
    page.text(words, (24.0, 26.0), Words { size: 18.0, ..Words::default() })
}

fn dashed(color: plot::Colour) -> Stroke {
    Stroke { dash: Some((7.0, 5.0)), ..Stroke::solid(color, 2.0) }
}

/// p-values of the t of short experiments.
fn alarms(t: &[f64]) -> Vec<f64> {
    t.iter().map(|&t| two_sided_p(t, SHORT as f64 - 1.0)).collect()
}

/// Part of the p-values in each bin.
fn histogram(p: &[f64]) -> Vec<f64> {
    let mut bins = vec![0.0; BINS];
    let part = 1.0 / p.len() as f64;
    p.iter().for_each(|p| bins[((p * BINS as f64) as usize).min(BINS - 1)] += part);
    bins
}

fn maps(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let side = SIDE as usize;
    let picture = |t: &[f64]| {
        Picture { width: side, height: side, pixels: t.iter().map(|&t| zmap::color(t)).collect() }.enlarged(8)
    };
    let drawing = plot::figure("maps", 960, 400, &folder.caption("furnace"), |page| {
        title(page, "One small test per pixel: the map of t, and the p-values")?;
        let bold = Words { size: 14.0, bold: true, ..Words::default() };
        page.text("right renderer", (24.0, 60.0), bold)?;
        page.text("darker renderer", (304.0, 60.0), bold)?;
        for (i, step) in (-4..=4).enumerate() {
            let (x, [r, g, b]) = (24.0 + 40.0 * i as f64, zmap::color(f64::from(step)));
            let box_of = [(x, 346.0), (x + 40.0, 346.0), (x + 40.0, 362.0), (x, 362.0)];
            page.polygon(&box_of, plot::Colour { 0: r, 1: g, 2: b })?;
            let words = Words { align: plot::Align::Center, ..Words::default() };
            page.text(&step.to_string().replace('-', "−"), (x + 20.0, 376.0), words)?;
        }
        page.text("t = (mean − ρ)/standard error", (396.0, 354.0), Words::default())?;
        let frame = [640.0, 76.0, 296.0, 200.0];
        let [x, y] = [Axis::linear("p", 0.0, 1.0, 5), Axis::linear("part of the pixels", 0.0, 0.2, 4)];
        let panel = Panel::draw(page, "p-values in steps of 0.05", frame, x, y)?;
        panel.line((0.0, 1.0 / BINS as f64), (1.0, 1.0 / BINS as f64), dashed(plot::GREY))?;
        let looks = [Look::SINGLE, Look::PREFIX];
        for (t, look) in m.maps.iter().zip(looks) {
            let bins = histogram(&alarms(t));
            let edge = |i: usize| i as f64 / BINS as f64;
            let stroke = Stroke::solid(look.color, 2.4);
            bins.iter().enumerate().try_for_each(|(i, &h)| panel.line((edge(i), h), (edge(i + 1), h), stroke))?;
            (1..BINS).try_for_each(|i| panel.line((edge(i), bins[i - 1]), (edge(i), bins[i]), stroke))?;
        }
        let line = |look: Look, words: &str| Entry::new(Sample::Line(Stroke::solid(look.color, 2.4)), words);
        let uniform = Entry::new(Sample::Line(dashed(plot::GREY)), "uniform");
        let entries = [line(looks[0], "right renderer"), line(looks[1], "darker renderer"), uniform];
        page.legend((640.0, 334.0), 290.0, &entries).map(|_| ())
    })?;
    let drawing = drawing.over(picture(&m.maps[0]), [24, 76], 2)?.over(picture(&m.maps[1]), [304, 76], 2)?;
    Ok(folder.figure("maps", &drawing)?)
}

fn point(x: f64, n: Number) -> Point {
    Point { x, value: n.value, std_error: n.std_error, replicates: 1000 }
}

fn rates(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let drawing = plot::figure("rates", 960, 470, &folder.caption("furnace"), |page| {
        title(page, "How often a test raises an alarm")?;
        let x = Axis::linear("batches so far", 0.0, BATCHES as f64, 8);
        let y = Axis::linear("experiments with an alarm so far", 0.0, 0.5, 5);
        let left = Panel::draw(page, "right renderer, a look after every batch", [84.0, 76.0, 370.0, 270.0], x, y)?;
        left.line((0.0, ALPHA), (BATCHES as f64, ALPHA), dashed(plot::GREY))?;
        let looks = [Look::PREFIX, Look::SINGLE];
        for (rates, look) in m.watched.iter().zip(looks) {
            let rates = &rates[FIRST as usize - 1..];
            let at = |i: usize| ((i + FIRST as usize) as f64, rates[i].value);
            let stroke = Stroke::solid(look.color, 2.4);
            (1..rates.len()).try_for_each(|i| left.line(at(i - 1), at(i), stroke))?;
        }
        let line = |look: Look, words: &str| Entry::new(Sample::Line(Stroke::solid(look.color, 2.4)), words);
        let entries = [
            line(looks[0], "test for one look, p ≤ 0.05"),
            line(looks[1], "test for any time, E ≥ 1/0.05"),
            Entry::new(Sample::Line(dashed(plot::GREY)), "α = 0.05"),
        ];
        page.legend((84.0, 410.0), 370.0, &entries)?;

        let x = Axis::linear("samples of one test", 0.0, 450.0, 6);
        let y = Axis::linear("rate of alarms", 0.0, 1.0, 5);
        let head = format!("renderer that is {} too dark, one look", percent(1.0 - smallest()));
        let right = Panel::draw(page, &head, [560.0, 76.0, 370.0, 270.0], x, y)?;
        let predicted = |n: usize| (n as f64, power(n as f64));
        let stroke = Stroke::solid(plot::BLACK, 1.6);
        (1..45).try_for_each(|i| right.line(predicted(10 * i), predicted(10 * i + 10), stroke))?;
        let points = m.power.iter().map(|&(n, rate)| point((n * BATCH) as f64, rate)).collect();
        right.curve(&Curve { label: String::new(), points, look: Look::PREFIX }, 0.0, false)?;
        let entries = [
            Entry::new(Sample::Mark(Look::PREFIX), "measured, 95 % intervals"),
            Entry::new(Sample::Line(stroke), "predicted from σ and n"),
        ];
        page.legend((560.0, 410.0), 370.0, &entries).map(|_| ())
    })?;
    Ok(folder.figure("rates", &drawing)?)
}

/// The six members with different curves.
fn shown(zoo: &[Signature]) -> &[Signature] {
    &zoo[..6.min(zoo.len())]
}

fn signatures(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let drawing = plot::figure("signatures", 960, 500, &folder.caption("cornell"), |page| {
        title(page, "Signatures of six mistakes: the mean of each wrong term over the right one")?;
        let y = Axis::log("rₖ = wrong term/right term", [0.03, 30.0].into_iter());
        let panel = Panel::draw(page, "", [84.0, 56.0, 520.0, 380.0], Axis::counts("k", LAST, LAST + 1), y)?;
        panel.line((-0.5, 1.0), (LAST as f64 + 0.5, 1.0), dashed(plot::GREY))?;
        let mut entries = vec![];
        for (i, s) in shown(&m.zoo).iter().enumerate() {
            let look = Look::nth(i);
            let points = (0..=LAST).map(|k| point(k as f64, number(s.ratios[k]))).collect();
            let curve = Curve { label: s.bug.name.into(), points, look };
            panel.curve(&curve, 1.5 * (i as f64 - 2.5), true)?;
            entries.push(Entry::new(Sample::Mark(look), format!("{}: {}", s.bug.name, law(s))));
        }
        entries.push(Entry::new(Sample::Line(dashed(plot::GREY)), "1: right"));
        entries.push(Entry::new(Sample::Plain, "bars: 95 % intervals; π⁴ and more are above the frame"));
        page.legend((628.0, 76.0), 310.0, &entries).map(|_| ())
    })?;
    Ok(folder.figure("signatures", &drawing)?)
}

/// The law of a member in words.
fn law(s: &Signature) -> &'static str {
    match s.bug.name {
        "double-emission" => "2",
        "roulette-before-light" => "0.7",
        "missing-pi" => "πᵏ",
        "roulette-weighted-twice" => "0.9⁻⁽ᵏ⁻¹⁾",
        "half-bounce" => "(1/2)ᵏ⁻¹",
        "area-density" => "depends on the scale of the scene",
        "off-by-one" => "the terms are shifted by one",
        _ => "–",
    }
}

fn table(zoo: &[Signature]) -> String {
    let head = ["member", "r₀", "r₁", "r₂", "r₃", "law for k ≥ 1", "whole image"];
    let cell = |r: &Ratio| if r.value == 0.0 { "0".into() } else { number(*r).to_string() };
    let row = |s: &Signature| {
        let mut cells = vec![format!("`{}`", s.bug.name)];
        cells.extend(s.ratios[..4].iter().map(cell));
        cells.extend([law(s).to_owned(), cell(&s.whole)]);
        cells
    };
    markdown::table(&head, &zoo.iter().map(row).collect::<Vec<_>>())
}
