//! Figures, tables and numbers of chapter 11.
//!
//! | file | shows |
//! |---|---|
//! | `pictures.png` | each strategy alone, both with weights, and the weight as a map |
//! | `rays` | rays for the same error against the radius of the lamp, for each plate |
//! | `scales.png` | weights of one measure and of mixed measures, at three scales |
//! | `rays.md`, `mistakes.md`, `line.md` | the same numbers, factors of mistakes, variances in one dimension |

use super::claims::{largest, opposite, value};
use super::mistakes::{Run, SCALES, cornell, direct, from_the_lamp, member, point_light};
use super::pairs::Pair;
use super::plates::{ALPHA, RADIUS};
use super::{Measured, line, pictures};
use fredholm::engine::by_rays::Sampled;
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::{picture, sheet, sheet::Tile};
use fredholm::report::plot::{Axis, BLACK, Curve, Entry, Look, Panel, Point, Sample, Stroke, figure};
use fredholm::report::text::markdown;
use fredholm::report::text::number::significant;

/// The techniques, in the order of `Technique::ALL`.
const NAMES: [&str; 4] =
    ["BSDF sampling alone", "light sampling alone", "MIS, balance heuristic", "MIS, power heuristic"];

/// Writes all of them.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    pictures::draw(folder)?;
    rays(folder, m)?;
    scales(folder)?;
    let all: Vec<&Pair> = m.pairs.iter().flatten().collect();
    let row = |i: usize| -> Vec<String> {
        let cells = || all.iter().map(|p| p.rays[i].value);
        let (least, wins) = (cells().fold(f64::INFINITY, f64::min), cells().filter(|x| *x <= 1.0).count());
        vec![NAMES[i].into(), significant(least, 2), value(&largest(&all, i)), wins.to_string()]
    };
    let head = ["technique", "fewest rays", "most rays", "pairs with at most 1"];
    folder.text("rays.md", &markdown::table(&head, &(0..4).map(row).collect::<Vec<_>>()))?;

    let rows: Vec<Vec<String>> = m
        .mistakes
        .iter()
        .map(|f| {
            let cells = f.cornell.iter().chain([&f.many]).map(value);
            [format!("`{}`", f.name)].into_iter().chain(cells).collect()
        })
        .collect();
    let head = ["mistake", "Cornell box × 0.1", "× 1", "× 10", "`many-lights`"];
    folder.text("mistakes.md", &markdown::table(&head, &rows))?;

    let names = ["½ and ½", "balance", "power", "the larger density only"];
    let row = |k: usize| {
        let cells = (0..2).flat_map(|i| [significant(m.line.exact[i][k], 4), value(&m.line.measured[i][k])]);
        [names[k].to_owned(), line::BETA[k].to_string().replace("inf", "∞")]
            .into_iter()
            .chain(cells)
            .collect::<Vec<_>>()
    };
    let head = ["weights", "β", "Var X", "measured", "Var Y", "measured"];
    folder.text("line.md", &markdown::table(&head, &(0..4).map(row).collect::<Vec<_>>()))?;

    let [connect, scatter] = opposite(m);
    let excess = all.iter().map(|p| p.excess).fold(all[0].excess, |a, b| if b.value > a.value { b } else { a });
    let percent = |x: Number| format!("{} %", significant(100.0 * (1.0 - x.value).abs(), 1));
    let factor = |name: &str| m.mistakes.iter().find(|f| f.name == name).ok_or("this mistake was not measured");
    let (measures, heuristics) = (factor("mixed-measures")?, factor("mixed-heuristics")?);
    Ok(folder.numbers(&[
        ("smooth_large", value(&connect)),
        ("rough_small", value(&scatter)),
        ("worst_balance", value(&largest(&all, 2))),
        ("worst_power", value(&largest(&all, 3))),
        ("excess", value(&excess)),
        ("lamp_share", value(&from_the_lamp(point_light(&Run::of(folder))?, 0.5))),
        ("sum", significant(m.sums.0, 1)),
        ("points", m.sums.1.to_string()),
        ("mixed_one", percent(measures.cornell[1])),
        ("mixed_ten", percent(measures.cornell[2])),
        ("heuristics", percent(heuristics.cornell[1])),
        ("choice", value(&factor("wrong-light-choice")?.many)),
    ])?)
}

/// Rays for the same error, relative to the better strategy alone: one panel for each plate.
fn rays(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let everything: Vec<f64> = m.pairs.iter().flatten().flat_map(|p| p.rays.map(|x| x.value)).collect();
    let curve = |plate: usize, i: usize| {
        let point = |(p, &x): (&Pair, &f64)| {
            let Number { value, std_error } = p.rays[i];
            Point { x, value, std_error, replicates: 64 }
        };
        Curve {
            label: NAMES[i].into(),
            points: m.pairs[plate].iter().zip(&RADIUS).map(point).collect(),
            look: Look::nth(i),
        }
    };
    let drawn = figure("rays", 960, 760, &folder.caption("veach-mis"), |page| {
        for (plate, alpha) in ALPHA.iter().enumerate() {
            let mut x = Axis::log("radius of the lamp, m", RADIUS.into_iter());
            x.ticks = RADIUS.iter().map(|r| (*r, r.to_string())).collect();
            x.minor = Vec::new();
            let y = Axis::log("rays for the same error", everything.iter().copied());
            let place = [80.0 + 470.0 * (plate % 2) as f64, 46.0 + 350.0 * (plate / 2) as f64, 390.0, 250.0];
            let panel = Panel::draw(page, &format!("plate with alpha {alpha}"), place, x, y)?;
            panel.line(
                (RADIUS[0] * 0.8, 1.0),
                (RADIUS[3] * 1.2, 1.0),
                Stroke { dash: Some((8.0, 5.0)), ..Stroke::solid(BLACK, 1.4) },
            )?;
            (0..4).try_for_each(|i| panel.curve(&curve(plate, i), 0.0, true))?;
        }
        for (i, name) in NAMES.into_iter().enumerate() {
            let mark = Entry::new(Sample::Mark(Look::nth(i)), name);
            page.legend((80.0 + 225.0 * i as f64, 738.0), 220.0, &[mark])?;
        }
        Ok(())
    })?;
    folder.figure("rays", &drawn)?;
    Ok(())
}

/// The Cornell box at three scales: weights of one measure, and of mixed measures.
fn scales(folder: &Folder<'_>) -> book::Result<()> {
    let pixels = folder.pick(128, 64);
    let render = |name: &str, s: f64| -> book::Result<Sampled> {
        Ok(direct(&Run::of(folder), &cornell(pixels, s)?, member(name)?, folder.pick(32, 8)))
    };
    let unit = render("right", 1.0)?;
    let gain = picture::auto_gain(&unit.terms[1].mean);
    let mean = |s: &Sampled| s.replicates.mean[1].element_sum();
    let side = pixels as usize;
    let tile = |name: &str, s: f64| -> book::Result<Tile> {
        let shot = render(name, s)?;
        let image = picture::develop(side, side, &shot.terms[1].mean, gain).picture.enlarged(512 / side);
        let note = format!("mean: {} × the right one", significant(mean(&shot) / mean(&unit), 3));
        Ok(Tile { image, label: format!("lengths × {s}"), notes: vec![note] })
    };
    let names = ["right", "mixed-measures"];
    let tiles = names.iter().flat_map(|name| SCALES.map(|s| tile(name, s))).collect::<book::Result<Vec<_>>>()?;
    let heads = [["right", "both p per solid angle"], ["wrong", "w₁: p₁ per area"]].map(|row| row.map(String::from));
    let foot = Some("T E only: the emission E of the lamp itself is not shown. All pictures have one exposure.");
    let title = "Weights of mixed measures depend on the scale";
    let places = sheet::in_rows(tiles.len(), 3);
    let layout = sheet::Layout { title, tiles: &tiles, places: &places, heads: &heads, foot, scale: 2.0 };
    Ok(folder.picture("scales.png", &layout.draw(&folder.caption("cornell"))?)?)
}
