//! Figures, tables and numbers of chapter 8: the variance near the lamp, one image by three estimators, one room at three
//! scales.
//!
//! ```text
//! σ²/F² = E[X²]/F² − 1      near the lamp, for points on it:  A/(6π h²)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | σ²/F² | relative variance of one sample, with its standard error | [`relative_variance`] |
//! | A, h | area of the lamp, 1 m²; distance from it | [`Place`] |

use super::claims::{mean, variance_ratio};
use super::wall::Place;
use super::{Measured, SCALES};
use fredholm::engine::by_rays::Sampled;
use fredholm::report::book::{self, Folder};
use fredholm::report::image::{picture, sheet, sheet::Tile};
use fredholm::report::plot::{Axis, BLACK, Curve, Entry, Look, Panel, Point, Sample, Stroke, figure};
use fredholm::report::text::markdown;
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::stats::Moments;
use std::f64::consts::PI;

/// Names of the two estimators on the wall.
const NAMES: [&str; 2] = ["points on the lamp", "directions"];

/// Writes all of them.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    near_the_lamp(folder, &m.wall)?;
    let [_, right, blind] = &m.room;
    let percent = |x: f64| format!("{} %", significant(100.0 * x, 2));
    folder.numbers(&[
        ("noise", significant(variance_ratio(&m.room[0], right)[0], 2)),
        ("power", significant(variance_ratio(&m.lamps[0], &m.lamps[1])[0], 2)),
        ("without_shadows", percent(mean(blind)[0] / mean(right)[0] - 1.0)),
        ("wrong_at_one", significant(mean(&m.scales[1][1])[0] / mean(&m.scales[1][0])[0], 2)),
    ])?;

    let labels = ["directions", "points on the lamp", "points, without V"];
    let note = |s: &Sampled| vec![format!("mean {}", value(mean(s))), noise(s, right)];
    let tiles: Vec<_> = m.room.iter().zip(labels).map(|(s, label)| tile(s, right, label, note(s))).collect();
    let title = format!("Direct light of the Cornell box, {} samples per pixel", right.spp);
    pictures(folder, "techniques", &title, &tiles, 3, &[])?;

    let unit = &m.scales[1][0];
    let row = |i: usize| m.scales.iter().zip(SCALES).map(move |(pair, s)| (&pair[i], s));
    let tiles = row(0).chain(row(1)).map(|(s, scale)| {
        let note = format!("mean: {} × that of the right image at scale 1", significant(mean(s)[0] / mean(unit)[0], 3));
        tile(s, unit, &format!("lengths × {scale}"), vec![note])
    });
    let heads = [["right", "p_ω = p_A d²/cos θ"], ["wrong", "p_A used as p_ω"]].map(|row| row.map(String::from));
    pictures(folder, "scales", "The same room, three sizes, one exposure", &tiles.collect::<Vec<_>>(), 3, &heads)
}

fn value([value, error]: [f64; 2]) -> String {
    plus_minus(value, error, 1)
}

fn noise(s: &Sampled, right: &Sampled) -> String {
    format!("variance: {} × the middle one", significant(variance_ratio(s, right)[0], 2))
}

/// A picture of T E, about 500 pixels wide, at the exposure of another.
fn tile(s: &Sampled, exposure: &Sampled, label: &str, notes: Vec<String>) -> Tile {
    let pixels = &s.terms[1].mean;
    let side = (pixels.len() as f64).sqrt() as usize;
    let gain = picture::auto_gain(&exposure.terms[1].mean);
    let image = picture::develop(side, side, pixels, gain).picture.enlarged((512 / side).max(1));
    Tile { image, label: label.into(), notes }
}

fn pictures(
    folder: &Folder<'_>,
    name: &str,
    title: &str,
    tiles: &[Tile],
    columns: usize,
    heads: &[[String; 2]],
) -> book::Result<()> {
    let places = sheet::in_rows(tiles.len(), columns);
    let foot = Some("T E only: the emission E of the lamp itself is not shown.");
    let layout = sheet::Layout { title, tiles, places: &places, heads, foot, scale: 2.0 };
    Ok(folder.picture(&format!("{name}.png"), &layout.draw(&folder.caption("cornell"))?)?)
}

/// σ²/F² and its standard error, from the means of X and X².
fn relative_variance(x: &Moments, f: f64) -> [f64; 2] {
    let (m, c) = (x.mean(), x.covariance_of_mean());
    let error = (c[(1, 1)] - 4.0 * m[0] * c[(0, 1)] + 4.0 * m[0] * m[0] * c[(0, 0)]).sqrt();
    [m[1] - m[0] * m[0], error].map(|v| v / (f * f))
}

/// The variance of both estimators against the distance from the lamp, as a figure and as a table.
fn near_the_lamp(folder: &Folder<'_>, wall: &[Place]) -> book::Result<()> {
    let curve = |i: usize| {
        let point = |p: &Place| {
            let [value, std_error] = relative_variance(&p.by[i], p.exact);
            Point { x: p.h, value, std_error, replicates: p.by[i].count() }
        };
        Curve { label: NAMES[i].into(), points: wall.iter().map(point).collect(), look: Look::nth(i) }
    };
    let curves = [curve(0), curve(1)];
    let law = |h: f64| 1.0 / (6.0 * PI * h * h);
    let dashed = Stroke { dash: Some((8.0, 5.0)), ..Stroke::solid(BLACK, 1.6) };
    let drawn = figure("near-the-lamp", 960, 470, &folder.caption("cube"), |page| {
        let x = Axis::log("distance h from the lamp, m", wall.iter().map(|p| p.h));
        let values = curves.iter().flat_map(|c| &c.points).map(|p| p.value);
        let y = Axis::log("relative variance σ²/F² of one sample", values);
        let panel = Panel::draw(page, "Direct light on a wall under a lamp", [90.0, 44.0, 600.0, 360.0], x, y)?;
        panel.line((0.02, law(0.02)), (0.3, law(0.3)), dashed)?;
        curves.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
        let marks = curves.iter().map(|c| Entry::new(Sample::Mark(c.look), c.label.clone()));
        let law = Entry::new(Sample::Line(dashed), "A/(6π h²): limit for points on the lamp as h → 0");
        page.legend((720.0, 70.0), 226.0, &marks.chain([law]).collect::<Vec<_>>())?;
        Ok(())
    })?;
    folder.figure("near-the-lamp", &drawn)?;

    let row = |p: &Place| {
        let mut cells = vec![p.h.to_string(), format!("{:.5}", p.exact)];
        cells.extend(p.by.iter().map(|x| value([x.mean()[0], x.std_error(0)])));
        cells.extend(p.by.iter().map(|x| value(relative_variance(x, p.exact))));
        cells
    };
    let head = ["h, m", "F", NAMES[0], NAMES[1], "σ²/F², points", "σ²/F², directions"];
    let rows: Vec<_> = wall.iter().map(row).collect();
    Ok(folder.text("wall.md", &markdown::table(&head, &rows))?)
}
