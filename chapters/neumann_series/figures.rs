//! Tables and plots of chapter 6.
//!
//! | file | shows |
//! |---|---|
//! | `ratios` | γ_k of the Cornell box, from paths and from the matrix, and of the furnace, below the largest albedo and r(T) |
//! | `remainder` | Σ_{k>K} m_k against K, below its two bounds |
//! | `scaled` | Σ s^k m_k against s: partial sums, and all terms by the matrix, up to the pole at s = 1/r(T) |
//! | `enough.md`, `lit.md` | how many bounces are enough; which bounce lights which surface |

use super::claims::{or_dash, value};
use super::scaled::{DARKER, TOWARDS_THE_POLE};
use super::{LAST, Measured, PARTS, Value};
use fredholm::engine::Settings;
use fredholm::report::book::{self, Folder};
use fredholm::report::figures::lit as lit_table;
use fredholm::report::plot::{self, Axis, Curve, Line, Look, Mark, Point, Stroke};
use fredholm::report::text::{markdown, number::significant};
use fredholm::scene::{Scene, load};
use fredholm::study::lit::lit;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let row = |i: usize| [m.enough[i], m.enough[i + 3]].concat().into_iter().map(or_dash);
    let part = |i: usize| format!("{} %", significant(100.0 * PARTS[i], 1));
    let rows: Vec<Vec<String>> = (0..3).map(|i| [part(i)].into_iter().chain(row(i)).collect()).collect();
    let head = ["missing", "all light: measured", "guaranteed", "indirect light: measured", "guaranteed"];
    folder.text("enough.md", &markdown::table(&head, &rows))?;
    let room = load::scene("cornell", &load::Options::default())?.description;
    let settings = Settings { seed: folder.seed, ..Settings::default() };
    let surfaces = lit(&room, &Scene::new(&room), folder.pick(1 << 17, 1 << 12), &settings, folder.progress);
    let table = lit_table::grid(&surfaces);
    folder.text("lit.md", &markdown::table(&table.head, &table.rows))?;
    // m_1 + m_1 γ_0 + m_1 γ_0² + … over the reflected light
    let extrapolated = m.terms.mean[1] / (1.0 - m.ratios[0].0) / m.remainder[0].0;
    folder.numbers(&[
        ("radius", value(m.radius)),
        ("early", value(m.rates[0])),
        ("late", value(m.rates[1])),
        ("r0", value(m.ratios[0])),
        ("r1", value(m.ratios[1])),
        ("r2", value(m.ratios[2])),
        ("extrapolated", format!("{} %", significant(100.0 * extrapolated, 2))),
        ("pole", significant(pole(m), 3)),
    ])?;
    ratios(folder, m)?;
    remainder(folder, m)?;
    scaled(folder, m)
}

/// 1/r(T_h), on the mesh of the matrix.
fn pole(m: &Measured) -> f64 {
    m.towards_pole[0].0 / TOWARDS_THE_POLE[0]
}

fn solid(color: plot::Colour) -> Stroke {
    Stroke::solid(color, 2.4)
}

fn dashed(color: plot::Colour) -> Stroke {
    Stroke { dash: Some((9.0, 5.0)), ..solid(color) }
}

/// A horizontal line.
fn flat(y: f64) -> Vec<(f64, f64)> {
    vec![(-0.5, y), (LAST as f64 + 0.5, y)]
}

/// Marks at 0, 1, 2, ….
fn curve(label: &str, values: &[Value], look: Look) -> Curve {
    let point = |(k, v): (usize, &Value)| Point { x: k as f64, value: v.0, std_error: v.1, replicates: 64 };
    Curve { label: label.into(), points: values.iter().enumerate().map(point).collect(), look }
}

fn ratios(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let matrix: Vec<Value> = m.matrix.windows(2).map(|m| (m[1] / m[0], 0.0)).collect();
    let curves = [
        curve("Cornell box, matrix", &matrix, Look::MATRIX),
        curve("Cornell box, paths, 95 % interval", &m.ratios, Look::PREFIX),
        curve("furnace, paths", &m.furnace, Look::SINGLE),
    ];
    let lines = [
        (format!("largest albedo {:.3}: no ratio is larger", m.albedo), flat(m.albedo), solid(plot::GREEN)),
        (format!("r(T) = {}", value(m.radius)), flat(m.radius.0), dashed(plot::SKY)),
    ];
    let axes = [Axis::counts("k", LAST, 12), Axis::linear("ratio of term k + 1 to term k", 0.4, 0.95, 8)];
    draw(folder, "ratios", ["The ratio of consecutive terms, red channel", "cornell, furnace"], axes, &curves, &lines)
}

fn remainder(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let (g, m0) = (m.albedo, m.terms.mean[0]);
    let before = (0..=LAST).map(|k| (k as f64, g.powi(k as i32 + 1) / (1.0 - g) * m0)).collect();
    let after = m.terms.mean.iter().enumerate().map(|(k, m)| (k as f64, g / (1.0 - g) * m)).collect();
    let lines = [
        ("bound from term 0: ρᴷ⁺¹/(1 − ρ) ‖E‖₁".into(), before, solid(plot::GREEN)),
        ("bound from term K: ρ/(1 − ρ) ‖TᴷE‖₁".into(), after, dashed(plot::PURPLE)),
        ("1 % of all light".into(), flat(0.01 * (m0 + m.remainder[0].0)), dashed(plot::GREY)),
    ];
    let curves = [curve("measured, 95 % interval", &m.remainder, Look::PREFIX)];
    let axes = [Axis::counts("K", LAST, 12), Axis::log("‖Σ TᵏE‖₁ over k > K, W sr⁻¹ m⁻²", [3e-6, 1.0].into_iter())];
    draw(
        folder,
        "remainder",
        ["What is missing after the term K, red channel; ρ is the largest albedo", "cornell"],
        axes,
        &curves,
        &lines,
    )
}

fn scaled(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let sum = |last: usize| {
        let light = |s: f64| (1..=last).map(|k| s.powi(k as i32) * m.terms.mean[k]).sum();
        (1..=160).map(|i| 0.01 * f64::from(i)).map(|s| (s, light(s))).collect()
    };
    let pole = pole(m);
    let lines = [
        ("sum of k = 1, 2".into(), sum(2), solid(plot::SKY)),
        ("sum of k = 1 to 8".into(), sum(8), solid(plot::BLUE)),
        (format!("sum of k = 1 to {LAST}"), sum(LAST), solid(plot::VERMILION)),
        (format!("s = 1/r(T) = {pole:.3} on this mesh"), vec![(pole, 1e-3), (pole, 1e3)], dashed(plot::GREY)),
    ];
    let solved = m.towards_pole.iter().map(|&(s, l)| Point::exact(s, l)).collect();
    let (light, std_error) = m.scaled[1];
    let again = vec![Point { x: DARKER, value: light, std_error, replicates: 64 }];
    let green = Look { color: plot::GREEN, mark: Mark::Square };
    let curves = [
        Curve { label: "all terms, matrix".into(), points: solved, look: Look::MATRIX },
        Curve { label: format!("room with s = {DARKER}, rendered"), points: again, look: green },
    ];
    let y = Axis::log("mean reflected light, W sr⁻¹ m⁻²", [4e-3, 50.0].into_iter());
    let axes = [Axis::linear("s, factor of all albedos", 0.0, 1.6, 8), y];
    draw(folder, "scaled", ["The same room with all albedos times s, red channel", "cornell"], axes, &curves, &lines)
}

/// One panel with its legend on the right.
fn draw(
    folder: &Folder<'_>,
    stem: &str,
    [title, scene]: [&str; 2],
    axes: [Axis; 2],
    curves: &[Curve],
    lines: &[Line],
) -> book::Result<()> {
    let drawing = plot::chart([stem, title], axes, (curves, false), lines, &folder.caption(scene))?;
    Ok(folder.figure(stem, &drawing)?)
}
