//! Tables and plots of chapter 16.
//!
//! | file | shows |
//! |---|---|
//! | `dimension` | the error of T^k E against N, by independent numbers and by Sobol points |
//! | `running` | running means of four runs that look for a small lamp |
//! | `corner` | E[X²] towards the edge between a wall and its lamp |
//! | `rare.md`, `angles.md` | runs with few events; two reflections at several angles |

use super::claims::growth;
use super::dimension::{LAST, variance};
use super::{GLASS, Measured, polarisation, rare};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::plot::{self, Axis, Curve, Line, Look, Mark, Point, Stroke};
use fredholm::report::text::{markdown, number::significant};
use fredholm::study::convergence::NoiseCurve;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let share = |x: Number| format!("{} %", x.times(100.0));
    let row = |r: &rare::Row| {
        let exact = format!("{} %", significant(100.0 * r.predicted, 3));
        vec![r.expected.to_string(), exact, share(r.none), share(r.covered), share(r.printed)]
    };
    let head = ["pN", "(1 − p)ᴺ", "no event", "95 % interval contains the truth", "fredholm prints an error"];
    folder.text("rare.md", &markdown::table(&head, &m.rare.iter().map(row).collect::<Vec<_>>()))?;
    folder.text("angles.md", &angles())?;
    let gain = |k| m.dimension.gain(k).to_string();
    let [eye, light] = m.caustic.t3;
    let last = |room: &super::mirrors::Room| room.uneven.last().copied().unwrap_or(f64::NAN);
    folder.numbers(&[
        ("gain0", gain(0)),
        ("gain1", gain(1)),
        ("gain2", gain(2)),
        ("gain4", gain(4)),
        ("growth", growth(&m.corner).to_string()),
        ("tail", m.corner.tail.to_string()),
        ("eye", eye.to_string()),
        ("light", light.to_string()),
        ("caustic", format!("{} %", light.over(m.caustic.all).times(100.0))),
        ("note", m.caustic.note.clone().unwrap_or_default()),
        ("mirror", significant(last(&m.mirrors), 3)),
        ("diffuse", significant(last(&m.diffuse), 4)),
        ("own", format!("{:.0e}", m.own.own)),
        ("wrong", significant(m.own.right, 2)),
        ("deficit", format!("{} %", significant(100.0 * m.own.deficit, 3))),
    ])?;
    dimension(folder, m)?;
    running(folder)?;
    corner(folder, m)
}

/// Two reflections at glass, at several angles of incidence.
fn angles() -> String {
    let brewster = polarisation::brewster(GLASS).to_degrees();
    let row = |degrees: f64| {
        let t = polarisation::twice(GLASS, degrees.to_radians(), polarisation::reflection);
        let part = |x: f64| format!("{} %", significant(100.0 * x, 3));
        // rounding leaves 10⁻³⁰ of nothing
        let crossed = if t.crossed < 1e-12 { "0".into() } else { part(t.crossed) };
        vec![format!("{degrees:.1}°"), part(t.scalar), part(t.same), crossed, significant(t.same / t.scalar, 3)]
    };
    let head = ["θ", "F²", "one plane", "crossed planes", "one plane / F²"];
    markdown::table(&head, &[0.0, 30.0, 45.0, brewster, 70.0, 85.0].map(row))
}

fn dimension(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    // relative to the error of the first independent samples
    let points = |curve: &NoiseCurve, k: usize| -> Vec<Point> {
        let unit = m.dimension.independent[k].points.first().map_or(f64::NAN, |(_, s)| s.variance());
        let point = |(n, s): &(u32, _)| {
            let v = variance(s);
            let value = (v.value / unit).sqrt();
            Point { x: f64::from(*n), value, std_error: 0.5 * value * v.std_error / v.value, replicates: 16 }
        };
        curve.points.iter().map(point).collect()
    };
    let colors = [plot::PURPLE, plot::VERMILION, plot::ORANGE, plot::GREEN, plot::BLUE];
    let marks = [Mark::Diamond, Mark::Disk, Mark::Square, Mark::Triangle, Mark::Cross];
    let sobol = (0..=LAST).map(|k| Curve {
        label: format!("k = {k}, Sobol points"),
        points: points(&m.dimension.even[k], k),
        look: Look { color: colors[k], mark: marks[k] },
    });
    let independent = (0..=LAST).map(|k| Curve {
        label: "k = 0 to 4, independent".into(),
        points: points(&m.dimension.independent[k], k),
        look: Look::MATRIX,
    });
    let curves: Vec<Curve> = independent.chain(sobol).collect();
    let n = || curves[0].points.iter().map(|p| p.x);
    let line = n().map(|x| (x, (16.0 / x).sqrt())).collect();
    let lines = [("N to the power −1/2".into(), line, Stroke::solid(plot::GREY, 1.6))];
    let values = curves.iter().flat_map(|c| c.points.iter().map(|p| p.value));
    let axes = [
        Axis::powers_of_two("N, samples per pixel", n(), 8),
        Axis::log("error, relative to 16 independent samples", values),
    ];
    draw(
        folder,
        "dimension",
        ["The error of each term of the cube, by two kinds of points", "cube"],
        axes,
        &curves,
        &lines,
    )
}

fn running(folder: &Folder<'_>) -> book::Result<()> {
    let colors = [plot::BLUE, plot::VERMILION, plot::GREEN, plot::PURPLE];
    let runs = rare::running(folder)?;
    let most = runs[0].last().map_or(10.0, |p| p.0);
    let line = |(i, run): (usize, Vec<(f64, f64)>)| (format!("run {}", i + 1), run, Stroke::solid(colors[i], 2.2));
    let truth = vec![(1.0, 1.0), (1e7, 1.0)];
    let mut lines: Vec<Line> =
        vec![("the truth".into(), truth, Stroke { dash: Some((9.0, 5.0)), ..Stroke::solid(plot::BLACK, 2.0) })];
    let event = 1.0 / rare::P[1];
    let one = vec![(event, 0.0), (event, 4.0)];
    lines.push((
        "N = 1/p: one event is expected".into(),
        one,
        Stroke { dash: Some((3.0, 4.0)), ..Stroke::solid(plot::GREY, 2.0) },
    ));
    lines.extend(runs.into_iter().enumerate().map(line));
    let axes = [
        Axis::log("N, samples", [10.0, most].into_iter()),
        Axis::linear("running mean / truth (peaks above 4 are cut)", 0.0, 4.0, 8),
    ];
    let title = format!("A lamp that a direction hits with probability p = {}", rare::P[1]);
    draw(folder, "running", [&title, "a floor and a disk"], axes, &[], &lines)
}

fn corner(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let names = ["points on the lamp", "MIS: a point and a direction"];
    let looks = [Look { color: plot::VERMILION, mark: Mark::Square }, Look { color: plot::BLUE, mark: Mark::Disk }];
    let point = |i: usize| {
        let of = move |p: &super::corner::Place| {
            let Number { value, std_error } = p.square[i];
            Point { x: p.d, value, std_error, replicates: 64 }
        };
        m.corner.places.iter().map(of).collect::<Vec<_>>()
    };
    let curves = [0, 1].map(|i| Curve { label: names[i].into(), points: point(i), look: looks[i] });
    let anchor = &curves[0].points[4];
    let at = |d: f64| (d, anchor.value * (anchor.x / d).powi(2));
    let lines = [("d to the power −2".into(), vec![at(0.012), at(0.6)], Stroke::solid(plot::GREY, 1.6))];
    let values = curves.iter().flat_map(|c| c.points.iter().map(|p| p.value));
    let d = curves[0].points.iter().map(|p| p.x);
    let axes = [Axis::log("d, distance from the edge, m", d), Axis::log("mean square of X, in units of (ρE)²", values)];
    draw(folder, "corner", ["Direct light on a wall that touches its lamp", "cube"], axes, &curves, &lines)
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
    let drawing = plot::chart([stem, title], axes, (curves, true), lines, &folder.caption(scene))?;
    Ok(folder.figure(stem, &drawing)?)
}
