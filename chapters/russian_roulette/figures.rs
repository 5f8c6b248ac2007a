//! Tables and plots of chapter 10.
//!
//! | file | shows |
//! |---|---|
//! | `variance` | left: V_N against N under three schedules; right: E\[α_k²\] against k for three values of q |
//! | `median` | median of the means of n paths, relative to the mean, against n |
//! | `schedules.md` | rays per path and price of each schedule |
//! | `wrong.md` | r_k of four mistakes |

use super::claims::exact;
use super::exercises::{COMMAND_Q, radius_of};
use super::one_pixel::PATHS;
use super::weights::{LAST, QS, with_roulette};
use super::{Measured, Paths, Row};
use fredholm::estimator::Roulette;
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::plot::{self, Axis, Curve, Entry, Figure, GREY, Look, Mark, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::{markdown, number::plus_minus, number::significant};

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    tables(folder, m)?;
    let [albedo, lecture, student] = &m.seen;
    let (largest, example) = (m.radius[1].second, radius_of(0.85)?);
    let ratio = |i: usize| significant(student.medians[i].value / albedo.mean.value, 2);
    folder.numbers(&[
        ("critical", significant(1.0 - largest, 2)),
        ("radius", significant(largest, 3)),
        ("radius_half", significant(2.0 * largest, 3)),
        ("radius_student", significant(largest / 0.35, 3)),
        ("example_command", significant(example / (1.0 - COMMAND_Q), 4)),
        ("example_radius", significant(example, 4)),
        ("example_limit", significant(1.0 - example, 4)),
        ("growth", m.weights.growth.to_string()),
        ("exponent_albedo", m.seen[0].exponent.to_string()),
        ("exponent_lecture", lecture.exponent.to_string()),
        ("exponent_student", student.exponent.to_string()),
        ("matrix_lecture", significant(m.radius[1].exponents[0], 3)),
        ("matrix_student", significant(m.radius[1].exponents[1], 3)),
        ("jump_lecture", significant(jump(lecture), 2)),
        ("jump_student", significant(jump(student), 2)),
        ("jump_albedo", significant(jump(albedo), 2)),
        ("median_1", ratio(0)),
        ("median_16", ratio(2)),
        ("median_256", ratio(4)),
        ("crossed_whole", m.prices.crossed[0].to_string()),
        ("crossed_indirect", m.prices.crossed[1].to_string()),
        ("emission", format!("{} %", significant(100.0 * m.prices.emission.value, 2))),
        ("best_indirect", m.prices.schedules[4].indirect.to_string()),
        ("enumerated", m.enumerated.paths.to_string()),
    ])?;
    folder.figure("variance", &variance(folder, m)?)?;
    folder.figure("median", &median(folder, m)?)?;
    Ok(())
}

/// Largest V_N over smallest V_N, from N = 4096 on.
fn jump(paths: &Paths) -> f64 {
    let late = || paths.running.iter().filter(|(n, _)| *n >= 4096.0).map(|p| p.1);
    late().fold(0.0, f64::max) / late().fold(f64::INFINITY, f64::min)
}

fn tables(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let head = ["schedule", "q at v = 0, 1, 2, 3, 4", "rays per path", "whole image", "indirect light"];
    let rows: Vec<Vec<String>> = m
        .prices
        .schedules
        .iter()
        .map(|r: &Row| {
            let q = r.q.as_ref().map_or("depends on the path".into(), |q| {
                q.iter().map(|q| significant(*q, 2)).collect::<Vec<_>>().join(", ")
            });
            let pm = |x: Number| if x.value == 1.0 { "1".into() } else { plus_minus(x.value, x.std_error, 1) };
            vec![r.name.clone(), q, significant(r.rays.value, 3), pm(r.whole), pm(r.indirect)]
        })
        .collect();
    folder.text("schedules.md", &markdown::table(&head, &rows))?;
    let row = |w: &super::Wrong| {
        let cell = |k: usize| {
            format!("{} ({})", plus_minus(w.ratios[k].value, w.ratios[k].std_error, 1), significant(w.expected[k], 3))
        };
        [format!("`{}`", w.name)].into_iter().chain((1..w.expected.len()).map(cell)).collect()
    };
    let rows: Vec<Vec<String>> = m.wrong.iter().map(row).collect();
    Ok(folder.text("wrong.md", &markdown::table(&["mistake", "r₁", "r₂", "r₃", "r₄"], &rows))?)
}

/// Label and colour of the three schedules.
fn style(paths: &Paths) -> (&'static str, Look) {
    match paths.schedule {
        Roulette::Albedo { .. } => ("q = 1 − albedo", Look { color: plot::GREEN, mark: Mark::Square }),
        Roulette::Constant { q: 0.5, .. } => ("q = 0.5, the lecture's", Look { color: plot::BLUE, mark: Mark::Disk }),
        _ => ("q = 0.65: survival 0.35", Look { color: plot::VERMILION, mark: Mark::Triangle }),
    }
}

fn variance(folder: &Folder<'_>, m: &Measured) -> book::Result<Figure> {
    let all = || m.seen.iter().flat_map(|p| &p.running);
    let looks = [Look { color: plot::BLACK, mark: Mark::Ring }, style(&m.seen[1]).1, style(&m.seen[2]).1];
    Ok(plot::figure("variance", 960, 560, &folder.caption("cornell"), |page| {
        page.text(
            "Infinite variance: samples and moments, red channel",
            (24.0, 26.0),
            Words { size: 18.0, ..Words::default() },
        )?;
        let x = Axis::powers_of_two("N, paths through one pixel", all().map(|p| p.0), 6);
        let y = Axis::log("V_N, variance of the first N paths", all().map(|p| p.1));
        let left = Panel::draw(page, "Indirect light of one pixel", [86.0, 78.0, 370.0, 330.0], x, y)?;
        for paths in &m.seen {
            let stroke = Stroke::solid(style(paths).1.color, 2.4);
            paths.running.windows(2).try_for_each(|ends| left.line(ends[0], ends[1], stroke))?;
        }
        let y = Axis::log("E[α_k²], with α_k = 0 after the end", [1e-5, 1e3].into_iter());
        let title = "Squared weight of a path at vertex k";
        let right = Panel::draw(page, title, [566.0, 78.0, 370.0, 330.0], Axis::counts("k", LAST, 8), y)?;
        for (q, look) in QS.into_iter().zip(looks) {
            let point = |(k, n): (usize, &Number)| {
                let n = with_roulette(*n, k, q);
                Point { x: k as f64, value: n.value, std_error: n.std_error, replicates: 64 }
            };
            let points = m.weights.second.iter().enumerate().map(point).collect();
            right.curve(&Curve { label: String::new(), points, look }, 0.0, true)?;
        }
        let seen = m.seen.iter().map(|p| Entry::new(Sample::Line(Stroke::solid(style(p).1.color, 2.4)), style(p).0));
        page.legend((86.0, 470.0), 380.0, &seen.collect::<Vec<_>>())?;
        let label = |q: f64| if q == 0.0 { "no roulette".into() } else { format!("q = {q} at every vertex") };
        let marks = QS.iter().zip(looks).map(|(&q, look)| Entry::new(Sample::Mark(look), label(q)));
        page.legend((566.0, 470.0), 380.0, &marks.collect::<Vec<_>>()).map(|_| ())
    })?)
}

fn median(folder: &Folder<'_>, m: &Measured) -> book::Result<Figure> {
    let mean = exact(m.seen[0].mean.value);
    let curve = |paths: &Paths| {
        let point = |(&n, median): (&usize, &Number)| {
            let r = median.over(mean);
            Point { x: n as f64, value: r.value, std_error: r.std_error, replicates: 64 }
        };
        let (label, look) = style(paths);
        Curve { label: label.into(), points: PATHS.iter().zip(&paths.medians).map(point).collect(), look }
    };
    let curves = m.seen.each_ref().map(curve);
    let dashed = Stroke { dash: Some((9.0, 5.0)), ..Stroke::solid(GREY, 2.0) };
    Ok(plot::figure("median", 960, 480, &folder.caption("cornell"), |page| {
        let title = "A typical estimate of indirect light: too dark where survivors are rare";
        page.text(title, (24.0, 26.0), Words { size: 18.0, ..Words::default() })?;
        let x = Axis::powers_of_two("n, paths of one estimate", PATHS.iter().map(|&n| n as f64), 6);
        let y = Axis::linear("median of the estimates/mean", 0.0, 1.2, 6);
        let panel = Panel::draw(page, "", [92.0, 56.0, 560.0, 350.0], x, y)?;
        panel.line((0.1, 1.0), (1e5, 1.0), dashed)?;
        curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
        let marks = curves.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label));
        let entries: Vec<_> =
            marks.chain([Entry::new(Sample::Line(dashed), "mean: unbiased under all three")]).collect();
        page.legend((672.0, 66.0), 276.0, &entries).map(|_| ())
    })?)
}
