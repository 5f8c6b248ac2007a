//! Plots and tables of chapter 13.
//!
//! | file | shows |
//! |---|---|
//! | `convergence` | RMSE against N: independent paths, Sobol points, numbers that repeat, clamped paths |
//! | `shown` | mean of images of N paths, and mean of what a screen shows; part of the pixels that it cannot show |
//! | `intervals` | 95 % intervals of 60 pixels, for a large and a tiny lamp of the same light |
//! | `shown.md`, `covered.md` | the numbers of the second and the third plot |

use super::claims::{any, expected};
use super::intervals::{Covered, TRUTH};
use super::{Curve, Measured, convergence, display};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::plot::{self, Axis, Drawn, Entry, Look, Mark, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::{markdown, number::significant};

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    tables(folder, m)?;
    numbers(folder, m)?;
    convergence(folder, m)?;
    shown(folder, m)?;
    intervals(folder, m)
}

fn percent(x: Number) -> String {
    format!("{} %", x.times(100.0))
}

fn tables(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let row = |i: &display::Images| {
        [i.paths.to_string(), i.mean.to_string(), i.shown.to_string(), percent(i.clipped), i.rmse.to_string()]
    };
    let rows: Vec<_> = m.display.images.iter().map(row).collect();
    let head = ["paths N", "mean", "mean shown", "pixels clipped", "RMSE"];
    folder.text("shown.md", &markdown::table(&head, &rows))?;
    let row = |(name, c): (&str, &Covered)| {
        let numbers = [c.covered.to_string(), c.black.to_string(), c.mean.to_string(), significant(c.median, 3)];
        [vec![format!("{name}, p = {}", significant(c.lamp, 2))], numbers.to_vec()].concat()
    };
    let rows: Vec<_> = ["large", "tiny"].into_iter().zip(&m.covered).map(row).collect();
    let head = ["lamp", "intervals that cover 0.6", "black pixels", "mean of all pixels", "median"];
    Ok(folder.text("covered.md", &markdown::table(&head, &rows))?)
}

fn numbers(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let (d, [free, sobol, repeated, clamped]) = (&m.display, &m.curves);
    let slope = |c: &Curve| c.slope.map_or("none".into(), |s| s.to_string());
    let ends = |c: &Curve| [c.rmse[0].1, c.rmse[c.rmse.len() - 1].1].map(|x| x.to_string());
    let ([_, free_1], [repeated_0, _], [_, clamped_1]) = (ends(free), ends(repeated), ends(clamped));
    let tiny = &m.covered[1];
    let one = Number { value: 1.0, std_error: 0.0 };
    Ok(folder.numbers(&[
        ("rmse4", d.images[0].rmse.to_string()),
        ("rmse128", d.images[5].rmse.to_string()),
        ("predicted128", d.images[0].rmse.times(expected()).to_string()),
        ("darker", percent(one.minus(d.darker))),
        ("reference", d.reference.to_string()),
        ("most", free.rmse[free.rmse.len() - 1].0.to_string()),
        ("slope", slope(free)),
        ("slope_sobol", slope(sobol)),
        ("slope_clamped", slope(clamped)),
        ("rmse_last", free_1),
        ("rmse_repeated", repeated_0),
        ("rmse_clamped", clamped_1),
        ("bias", percent(clamped.bias)),
        ("pixel_same", m.same[0].to_string()),
        ("image_same", m.same[1].to_string()),
        ("merged", m.merged.variance.to_string()),
        ("tiny", percent(tiny.covered)),
        ("any", format!("{} %", significant(100.0 * any(tiny.lamp), 3))),
    ])?)
}

/// Words of a title.
fn title() -> Words {
    Words { size: 18.0, ..Words::default() }
}

/// Draws a figure and writes it.
fn draw(
    folder: &Folder<'_>,
    stem: &str,
    height: u32,
    scene: &str,
    page: impl FnOnce(&plot::Canvas<'_>) -> Drawn,
) -> book::Result<()> {
    let drawing = plot::figure(stem, 960, height, &folder.caption(scene), page)?;
    Ok(folder.figure(stem, &drawing)?)
}

fn solid(color: plot::Colour) -> Stroke {
    Stroke::solid(color, 2.2)
}

fn dashed(color: plot::Colour) -> Stroke {
    Stroke { dash: Some((8.0, 5.0)), ..Stroke::solid(color, 1.6) }
}

fn point(x: u32, y: Number, replicates: u64) -> Point {
    Point { x: f64::from(x), value: y.value, std_error: y.std_error, replicates }
}

fn convergence(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let clamp = format!("clamped at {}: the bias stays", convergence::CLAMP);
    let labels = ["independent paths", "Sobol points", "numbers repeat after 16 paths", &clamp];
    let looks = [Look::SINGLE, Look::PREFIX, Look { color: plot::GREEN, mark: Mark::Diamond }, Look::MATRIX];
    let all = || m.curves.iter().flat_map(|c| &c.rmse);
    draw(folder, "convergence", 470, "cornell, lower part, k ≤ 2", |page| {
        page.text("RMSE of the image against the number of paths per pixel", (24.0, 28.0), title())?;
        let x = Axis::powers_of_two("paths per pixel, N", all().map(|p| f64::from(p.0)), 8);
        let y = Axis::log("RMSE, W sr⁻¹ m⁻²", all().map(|p| p.1.value));
        let panel = Panel::draw(page, "", [92.0, 60.0, 540.0, 330.0], x, y)?;
        let first = m.curves[0].rmse[0];
        let last = m.curves[0].rmse[m.curves[0].rmse.len() - 1].0;
        let fallen = first.1.value * (f64::from(first.0) / f64::from(last)).sqrt();
        panel.line((f64::from(first.0), first.1.value), (f64::from(last), fallen), dashed(plot::GREY))?;
        let mut entries = vec![Entry::new(Sample::Line(dashed(plot::GREY)), "1/√N from the first point")];
        for ((curve, label), look) in m.curves.iter().zip(labels).zip(looks) {
            let points = curve.rmse.iter().map(|&(n, y)| point(n, y, 16)).collect();
            panel.curve(&plot::Curve { label: label.into(), points, look }, 0.0, true)?;
            entries.push(Entry::new(Sample::Mark(look), label));
        }
        page.legend((660.0, 76.0), 280.0, &entries).map(|_| ())
    })
}

fn shown(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let images = &m.display.images;
    let curve = |look, of: &dyn Fn(&display::Images) -> Number| plot::Curve {
        label: String::new(),
        points: images.iter().map(|i| point(i.paths, of(i), 8)).collect(),
        look,
    };
    let axis = || Axis::powers_of_two("paths per pixel, N", images.iter().map(|i| f64::from(i.paths)), 6);
    let ends = [3.0, 160.0];
    draw(folder, "shown", 470, "cornell-spheres, k ≥ 1", |page| {
        let words = format!("Images of N paths, and what a screen shows of them at gain {}", display::GAIN);
        page.text(&words, (24.0, 28.0), title())?;
        let y = Axis::linear("radiance, W sr⁻¹ m⁻²", 0.07, 0.095, 5);
        let left = Panel::draw(page, "Mean over the image", [92.0, 76.0, 360.0, 250.0], axis(), y)?;
        let right = m.display.reference.value;
        left.line((ends[0], right), (ends[1], right), dashed(plot::GREY))?;
        left.curve(&curve(Look::SINGLE, &|i| i.mean), 0.0, true)?;
        left.curve(&curve(Look::PREFIX, &|i| i.shown), 0.0, true)?;
        let y = Axis::linear("part of the pixels, %", 0.0, 10.0, 5);
        let panel = Panel::draw(page, "Pixels that are clipped", [570.0, 76.0, 360.0, 250.0], axis(), y)?;
        panel.curve(&curve(Look::PREFIX, &|i| i.clipped.times(100.0)), 0.0, true)?;
        let entries = [
            Entry::new(Sample::Mark(Look::SINGLE), "mean of the images"),
            Entry::new(Sample::Mark(Look::PREFIX), "mean of what is shown"),
            Entry::new(Sample::Line(dashed(plot::GREY)), "mean of an independent render"),
        ];
        page.legend((92.0, 386.0), 860.0, &entries).map(|_| ())
    })
}

/// Pixels whose intervals are drawn.
const DRAWN: usize = 60;

fn intervals(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let [hit, miss] = [plot::BLUE, plot::VERMILION];
    let panel = |page: &plot::Canvas<'_>, c: &Covered, name: &str, left: f64, [lo, hi]: [f64; 2]| -> Drawn {
        let x = Axis::linear("pixel", 0.0, DRAWN as f64 + 1.0, 6);
        let y = Axis::linear("radiance, W sr⁻¹ m⁻²", lo, hi, 6);
        let title = format!("{name}: {} % of all intervals cover 0.6", significant(100.0 * c.covered.value, 3));
        let panel = Panel::draw(page, &title, [left, 76.0, 360.0, 270.0], x, y)?;
        for (i, (value, half)) in c.intervals.iter().take(DRAWN).enumerate() {
            let (x, color) = (i as f64 + 1.0, if (value - TRUTH).abs() <= *half { hit } else { miss });
            panel.line((x, value - half), (x, value + half), solid(color))?;
            panel.mark(x, *value, Look { color, mark: if color == hit { Mark::Disk } else { Mark::Square } })?;
        }
        panel.line((0.0, TRUTH), (DRAWN as f64 + 1.0, TRUTH), dashed(plot::BLACK))
    };
    draw(folder, "intervals", 480, "sphere, two sizes of the lamp, k = 1", |page| {
        page.text("95 % intervals of 60 pixels with the same true value, 64 paths each", (24.0, 28.0), title())?;
        panel(page, &m.covered[0], "Large lamp", 92.0, [0.0, 1.4])?;
        panel(page, &m.covered[1], "Tiny lamp", 570.0, [-2.0, 8.0])?;
        let entries = [
            Entry::new(Sample::Mark(Look { color: hit, mark: Mark::Disk }), "covers the truth"),
            Entry::new(Sample::Mark(Look { color: miss, mark: Mark::Square }), "does not cover it"),
            Entry::new(Sample::Line(dashed(plot::BLACK)), "truth, 0.6"),
        ];
        page.legend((92.0, 406.0), 860.0, &entries).map(|_| ())
    })
}
