//! Tables and plots of chapter 9.
//!
//! | file | shows |
//! |---|---|
//! | `broken` | r_k of the three broken rules of emission |
//! | `correlation` | correlation of the terms of one path, as a heat map |
//! | `noise.md`, `ways.md` | variance and rays of every term; three ways to compute the sum |

use super::broken::{BROKEN, TERMS};
use super::reuse::{Noise, mean, value};
use super::{LAST, Measured};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::typeset::superscript;
use fredholm::report::plot::{
    self, Align, Axis, Canvas, Curve, Drawn, Entry, GREY, Look, Panel, Point, Sample, Words, figure,
};
use fredholm::report::text::{markdown, number::significant};
use plotters::style::RGBColor;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    folder.text("noise.md", &noise(m))?;
    folder.text("ways.md", &ways(m))?;
    let of = |f: fn(&Noise) -> f64| value(&m.noise, f);
    folder.numbers(&[
        ("equal", of(|x| x.equal() / x.one_path()).to_string()),
        ("best", of(|x| x.best() / x.one_path()).to_string()),
        ("extra", of(|x| x.shared() / x.covariance.iter().enumerate().map(|(k, row)| row[k]).sum::<f64>()).to_string()),
        ("first", of(|x| x.alone(1)).to_string()),
        ("last", of(|x| x.alone(LAST)).to_string()),
        ("next", of(|x| x.correlation(2, 3)).to_string()),
        ("apart", of(|x| x.correlation(2, 4)).to_string()),
        ("r1", m.ratios[2][1].to_string()),
        ("r2", m.ratios[2][2].to_string()),
        ("r3", m.ratios[2][3].to_string()),
    ])?;
    broken(folder, m)?;
    correlation(folder, m)
}

/// Variance, rays and best number of samples, term by term.
fn noise(m: &Measured) -> String {
    let all = mean(m.noise.iter());
    let counts = all.counts(100.0 * all.rays.iter().sum::<f64>());
    let row = |k: usize| {
        let of = |f: &dyn Fn(&Noise) -> f64| value(&m.noise, f);
        let scaled = |x: Number| x.times(1000.0).to_string();
        vec![
            k.to_string(),
            scaled(of(&|x| x.variance[k - 1])),
            scaled(of(&|x| x.covariance[k - 1][k - 1])),
            significant(of(&|x| x.rays[k - 1]).value, 3),
            counts.get(k - 1).map(u32::to_string).unwrap_or_default(),
            of(&|x| x.alone(k)).to_string(),
        ]
    };
    let head = ["k", "σ², own paths", "σ², one path", "rays c", "n, best split", "this term alone: own / one"];
    markdown::table(&head, &(1..=LAST).map(row).collect::<Vec<_>>())
}

/// The three ways to compute the sum.
fn ways(m: &Measured) -> String {
    let row = |name: &str, f: fn(&Noise) -> f64| {
        let (work, ratio) = (value(&m.noise, f), value(&m.noise, move |x| f(x) / x.one_path()));
        vec![name.into(), work.times(1000.0).to_string(), ratio.to_string()]
    };
    let rows = [
        row("own paths, one sample of every term", Noise::equal),
        row("own paths, best split", Noise::best),
        row("one path for all terms", Noise::one_path),
    ];
    markdown::table(&["way", "variance × rays, 10⁻³", "over one path"], &rows)
}

fn broken(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let label = [
        "counted twice, in a room without mirrors",
        "left out at the eye, in the same room",
        "left out after mirrors and glass",
    ];
    let curve = |i: usize| {
        let point = |(k, r): (usize, &Number)| Point {
            x: k as f64 + 0.07 * (i as f64 - 1.0),
            value: r.value,
            std_error: r.std_error,
            replicates: 16,
        };
        let points = m.ratios[i].iter().enumerate().map(point).collect();
        Curve { label: format!("{} ({})", label[i], BROKEN[i].scene), points, look: Look::nth(i) }
    };
    let curves = [0, 1, 2].map(curve);
    let drawing = figure("broken", 960, 470, &folder.caption("sphere, cornell-spheres"), |page| {
        page.text("Three broken rules of emission: wrong term over right term", (24.0, 26.0), words(18.0))?;
        let axes = [Axis::counts("k", TERMS, TERMS), Axis::linear("wrong term / right term", 0.0, 2.4, 6)];
        let [x, y] = axes;
        let panel = Panel::draw(page, "", [82.0, 56.0, 850.0, 270.0], x, y)?;
        panel.line((-0.5, 1.0), (TERMS as f64 + 0.5, 1.0), plot::Stroke::solid(GREY, 1.8))?;
        for curve in &curves {
            panel.curve(curve, 0.0, true)?;
        }
        let entries = curves.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect::<Vec<_>>();
        page.legend((82.0, 386.0), 850.0, &entries).map(|_| ())
    })?;
    Ok(folder.figure("broken", &drawing)?)
}

fn words(size: f64) -> Words {
    Words { size, ..Words::default() }
}

/// Width of a cell of the heat map.
const CELL: f64 = 58.0;

fn correlation(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let (left, top) = (150.0, 112.0);
    let drawing = figure("correlation", 660, 600, &folder.caption("cornell"), |page| {
        page.text("Correlation of the terms of one path", (24.0, 28.0), words(20.0))?;
        page.text(
            "Blue: positive. Orange: negative. Full colour from 0.25 on.",
            (24.0, 56.0),
            Words { color: GREY, ..words(14.0) },
        )?;
        let centred = Words { align: Align::Center, ..words(16.0) };
        for j in 1..=LAST {
            let at = CELL * (j as f64 - 0.5);
            let name = format!("T{}E", if j == 1 { String::new() } else { superscript(j) });
            page.text(&name, (left + at, top - 16.0), centred)?;
            page.text(&name, (left - 32.0, top + at), centred)?;
            for k in 1..=LAST {
                let r = value(&m.noise, |x| x.correlation(j, k));
                cell(page, (left + CELL * (k as f64 - 1.0), top + CELL * (j as f64 - 1.0)), r.value)?;
            }
        }
        Ok(())
    })?;
    Ok(folder.figure("correlation", &drawing)?)
}

/// A coloured square with the value. The colour is full at ± 0.25, so that small values are seen beside the diagonal.
fn cell(page: &Canvas<'_>, (x, y): (f64, f64), r: f64) -> Drawn {
    let (x1, y1) = (x + CELL - 2.0, y + CELL - 2.0);
    let depth = (r.abs() / 0.25).min(1.0).sqrt();
    let full = if r < 0.0 { plot::ORANGE } else { plot::BLUE };
    let mix = |c: u8| (247.0 + (f64::from(c) - 247.0) * depth).round() as u8;
    page.polygon(&[(x, y), (x1, y), (x1, y1), (x, y1)], RGBColor(mix(full.0), mix(full.1), mix(full.2)))?;
    let color = if depth > 0.75 && r > 0.0 { RGBColor(255, 255, 255) } else { plot::BLACK };
    let text = format!("{r:.2}").replace("-0.00", "0.00").replace('-', "−");
    page.text(&text, (x + 0.5 * CELL - 1.0, y + 0.5 * CELL - 1.0), Words { align: Align::Center, color, ..words(16.0) })
}
