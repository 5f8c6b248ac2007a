//! Tables, plots and pictures of chapter 15.
//!
//! | file | shows |
//! |---|---|
//! | `solvers` | errors of three solvers by step; steps against 1/(1 − λ₁) |
//! | `maps` | variance of a walk against the error of its map |
//! | `room.png` | T²E of a room without a map, with its map, and with the map of another room |
//! | `modes.md`, `steps.md`, `maps.md`, `room.md` | the same numbers |

use super::claims::{percent, predicted};
use super::room::{self, MAPS, Seen};
use super::solvers::{NAMES, rate, steps};
use super::walks::{Map, ORDERS, Walked};
use super::{Measured, spectrum};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::picture::{auto_gain, develop};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{self, Axis, Curve, Entry, Look, Mark, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::{markdown, number::significant};

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    tables(folder, m)?;
    let [a, b] = m.errors.interval;
    let cg: Vec<String> = m.brighter.iter().map(|room| room.steps[2].to_string()).collect();
    let variance = |map| m.walks.of(map).map_or("–".into(), |w| significant(w.predicted, 3));
    folder.numbers(&[
        ("first", significant(m.spectrum.values[0], 4)),
        ("second", significant(m.spectrum.values[1], 4)),
        ("smallest", significant(a, 4).replace('-', "−")),
        ("q", significant(rate([a, b]), 3)),
        ("cg", format!("{} and {}", cg[0], cg[cg.len() - 1])),
        ("reversed", variance(Map::Reversed)),
        ("infinite", m.walks.infinite.to_string()),
        ("orders", ORDERS.to_string()),
        ("flat", variance(Map::Flat)),
        ("gain", m.seen[0].variance.over(m.seen[1].variance).to_string()),
        ("loss", m.seen[2].variance.over(m.seen[0].variance).to_string()),
        ("whole", m.seen[0].whole.over(m.seen[1].whole).to_string()),
    ])?;
    solvers(folder, m)?;
    maps(folder, m)?;
    pictures(folder, &m.seen)
}

fn tables(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let term = |k: usize| {
        let [one, few] = m.spectrum.error[k].map(percent);
        let ratio = m.spectrum.ratios[k].map(|r| significant(r, 4));
        vec![k.to_string(), significant(m.spectrum.size[k], 3), ratio[0].clone(), ratio[1].clone(), one, few]
    };
    let few = format!("error of {} modes", spectrum::FEW);
    let head = ["k", "size of TᵏE", "ratio k + 1 to k", "the same beside mode 1", "error of mode 1", &few];
    let rows: Vec<Vec<String>> = [0, 1, 2, 4, 7, 10, 15, 20, 30].map(term).into();
    folder.text("modes.md", &markdown::table(&head, &rows))?;

    let room = |gap: f64, interval: [f64; 2], found: [Option<usize>; 3]| {
        let found = found.map(|n| n.map_or("–".into(), |n| n.to_string()));
        let [neumann, chebyshev] = [interval[1], rate(interval)].map(|factor| format!("{:.1}", predicted(factor)));
        let [n, c, g] = found;
        vec![significant(1.0 - gap, 4), n, neumann, c, chebyshev, g]
    };
    let [a, b] = m.errors.interval;
    let mut rows = vec![room(1.0 - b, [a, b], m.errors.by_step.each_ref().map(|e| steps(e)))];
    rows.extend(m.brighter.iter().map(|r| room(r.gap, r.interval, r.steps.map(Some))));
    let head = ["λ₁", "Neumann", "predicted", "Chebyshev", "predicted", "conjugate gradients"];
    folder.text("steps.md", &markdown::table(&head, &rows))?;

    let map = |w: &Walked| {
        let error = if w.error.is_nan() { "–".into() } else { percent(w.error) };
        let [found, predicted] = match w.map {
            Map::Exact => [format!("{:.0e}", w.variance.value), "0".into()],
            _ => [w.variance.to_string(), significant(w.predicted, 3)],
        };
        let bias = Number { value: 100.0 * w.bias.value, std_error: 100.0 * w.bias.std_error };
        let bias = if w.map == Map::Exact { "0 %".into() } else { format!("{bias} %") };
        vec![name(w.map), error, found, predicted, bias]
    };
    let rows: Vec<Vec<String>> = m.walks.all.iter().map(map).collect();
    let head = ["map v", "error of the map", "variance of a walk, measured", "predicted", "mean of X/B − 1"];
    folder.text("maps.md", &markdown::table(&head, &rows))?;

    let seen = |(name, s): (&&str, &Seen)| {
        let [none, ..] = &m.seen;
        let ratios = [s.variance.over(none.variance), s.whole.over(none.whole)].map(|x| x.to_string());
        let [term, whole] = if s.variance == none.variance { ["1".into(), "1".into()] } else { ratios };
        vec![(*name).to_string(), s.mean.to_string(), term, whole]
    };
    let rows: Vec<Vec<String>> = MAPS.iter().zip(&m.seen).map(seen).collect();
    let head = ["rays follow", "mean of T²E, red", "variance of T²E", "variance of the picture, k ≤ 3"];
    Ok(folder.text("room.md", &markdown::table(&head, &rows))?)
}

fn name(map: Map) -> String {
    match map {
        Map::None => "none".into(),
        Map::Exact => "B itself".into(),
        Map::Sum(n) => format!("sum of the terms up to {n}"),
        Map::Rough(sigma) => format!("B with errors of ± {} %", significant(100.0 * sigma, 1)),
        Map::Flat => "the same value everywhere".into(),
        Map::Reversed => "1/√B".into(),
    }
}

const LOOKS: [Look; 3] = [
    Look { color: plot::BLUE, mark: Mark::Disk },
    Look { color: plot::VERMILION, mark: Mark::Square },
    Look { color: plot::GREEN, mark: Mark::Diamond },
];

fn dashed(color: plot::Colour) -> Stroke {
    Stroke { dash: Some((7.0, 5.0)), ..Stroke::solid(color, 1.8) }
}

fn solvers(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let (left, right) = ([78.0, 84.0, 372.0, 330.0], [548.0, 84.0, 372.0, 330.0]);
    let drawing = plot::figure("solvers", 960, 560, &folder.caption("cornell"), |page| {
        page.text("The ends of the spectrum predict the work", (24.0, 26.0), Words { size: 20.0, ..Words::default() })?;
        let last = m.errors.by_step[0].len() - 1;
        let axes = (Axis::counts("steps", last, 8), Axis::log("relative error", [1e-10, 1.0].into_iter()));
        let panel = Panel::draw(page, "The Cornell box", left, axes.0, axes.1)?;
        for (errors, look) in m.errors.by_step.iter().zip(LOOKS) {
            let points = errors.iter().enumerate().map(|(n, &error)| Point::exact(n as f64, error)).collect();
            panel.curve(&Curve { label: String::new(), points, look }, 0.0, true)?;
        }
        let rooms: Vec<f64> = m.brighter.iter().map(|room| 1.0 / room.gap).collect();
        let all = || m.brighter.iter().flat_map(|room| room.steps).map(|n| n as f64);
        let y = Axis::log("steps for six more digits", all());
        let panel = Panel::draw(page, "Brighter rooms", right, Axis::log("1/(1 − λ₁)", rooms.iter().copied()), y)?;
        for (i, factor) in [|b: [f64; 2]| b[1], rate].into_iter().enumerate() {
            let points: Vec<_> = m.brighter.iter().map(|r| (1.0 / r.gap, predicted(factor(r.interval)))).collect();
            points.windows(2).try_for_each(|p| panel.line(p[0], p[1], dashed(LOOKS[i].color)))?;
        }
        for (i, look) in LOOKS.into_iter().enumerate() {
            let points = m.brighter.iter().map(|r| Point::exact(1.0 / r.gap, r.steps[i] as f64)).collect();
            panel.curve(&Curve { label: String::new(), points, look }, 0.0, i == 2)?;
        }
        for (i, (name, look)) in NAMES.iter().zip(LOOKS).enumerate() {
            page.legend((78.0 + 190.0 * i as f64, 484.0), 186.0, &[Entry::new(Sample::Mark(look), *name)])?;
        }
        page.legend((668.0, 484.0), 270.0, &[Entry::new(Sample::Line(dashed(plot::GREY)), "predicted from λ")])?;
        Ok(())
    })?;
    Ok(folder.figure("solvers", &drawing)?)
}

fn maps(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let pick = |label: &str, look: Look, of: &dyn Fn(Map) -> bool| {
        let point =
            |w: &Walked| Point { x: w.error, value: w.variance.value, std_error: w.variance.std_error, replicates: 32 };
        Curve { label: label.into(), points: m.walks.all.iter().filter(|w| of(w.map)).map(point).collect(), look }
    };
    let curves = [
        pick("sum of the first terms", LOOKS[1], &|map| matches!(map, Map::Sum(_))),
        pick("B with random errors", LOOKS[0], &|map| matches!(map, Map::Rough(_))),
        pick("the same value everywhere", LOOKS[2], &|map| map == Map::Flat),
        pick("1/√B: bright where the room is dark", Look { color: plot::PURPLE, mark: Mark::Triangle }, &|map| {
            map == Map::Reversed
        }),
    ];
    let all = || curves.iter().flat_map(|c| &c.points);
    let none = m.walks.of(Map::None).map_or(f64::NAN, |w| w.variance.value);
    let x = Axis::log("error of the map, ‖v − B‖/‖B − E‖", all().map(|p| p.x));
    let y = Axis::log("relative variance of a walk", all().map(|p| p.value).chain([none]));
    let drawing = plot::figure("maps", 960, 500, &folder.caption("cube"), |page| {
        let words = Words { size: 20.0, ..Words::default() };
        page.text("A better map leaves less to chance", (24.0, 26.0), words)?;
        let panel = Panel::draw(page, "", [92.0, 56.0, 560.0, 370.0], x, y)?;
        panel.line((1e-4, none), (1e2, none), dashed(plot::GREY))?;
        if let Some(p) = curves[1].points.last() {
            let at = |x: f64| (x, p.value * (x / p.x).powi(2));
            panel.line(at(1e-3), at(1e2), dashed(plot::SKY))?;
        }
        curves.iter().try_for_each(|c| panel.curve(c, 0.0, c.points.len() > 1))?;
        let mut entries: Vec<Entry> = curves.iter().map(|c| Entry::new(Sample::Mark(c.look), &c.label)).collect();
        entries.push(Entry::new(Sample::Line(dashed(plot::SKY)), "slope 2: variance ~ error²"));
        entries.push(Entry::new(Sample::Line(dashed(plot::GREY)), "no map"));
        entries.push(Entry::new(Sample::Plain, "B itself has variance 0 to rounding and no place on these axes."));
        page.legend((672.0, 66.0), 276.0, &entries).map(|_| ())
    })?;
    Ok(folder.figure("maps", &drawing)?)
}

fn pictures(folder: &Folder<'_>, seen: &[Seen; 3]) -> book::Result<()> {
    let pixels = room::pixels(folder);
    let gain = auto_gain(&seen[1].picture);
    let tile = |(name, seen): (&&str, &Seen)| Tile {
        image: develop(pixels, pixels, &seen.picture, gain).picture.enlarged(folder.pick(6, 18)),
        label: (*name).into(),
        notes: vec![],
    };
    let tiles: Vec<Tile> = MAPS.iter().zip(seen).map(tile).collect();
    let places = in_rows(tiles.len(), tiles.len());
    let title = "Light after two reflections, with equal numbers of paths; the lamp faces the ceiling";
    let layout = Layout { title, tiles: &tiles, places: &places, heads: &[], foot: None, scale: 2.0 };
    Ok(folder.picture("room.png", &layout.draw(&folder.caption("cornell, lamp lowered and turned up"))?)?)
}
