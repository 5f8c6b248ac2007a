//! Tables, plots and pictures of chapter 4.
//!
//! | picture | shows | function |
//! |---|---|---|
//! | `furnace` | T^k E against k for three albedos, and r_k of two wrong renderers | [`plot`] |
//! | `mistakes` | right and wrong images: in the furnace and in the Cornell box | [`mistakes`] |
//! | `glass` | terms of a glass ball in a sky of radiance 1, and their sum | [`glass`] |
//! | `equilibrium` | L and E + T L at points | [`equilibrium`] |

use super::{Compared, Measured, Pixels, Ratio, Value};
use fredholm::report::book::{self, Folder};
use fredholm::report::figures::equilibrium::{self as points, Dot};
use fredholm::report::half_width_95;
use fredholm::report::image::picture::{Picture, auto_gain, develop, mean};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{Axis, Curve, Entry, Figure, GREY, Look, Panel, Point, Sample, Stroke, figure};
use fredholm::report::text::markdown;
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::stats::estimate;
use fredholm::study::equilibrium::Judgement;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let row = |k: usize| [k.to_string()].into_iter().chain(m.furnaces.iter().map(|f| pm(f.terms[k]))).collect();
    let all = [String::from("all")].into_iter().chain(m.furnaces.iter().map(|f| pm(f.whole))).collect();
    let rows: Vec<Vec<String>> = (0..=4).map(row).chain([all]).collect();
    folder.text("terms.md", &markdown::table(&["k", "ρ = 0.5", "ρ = 0.8", "ρ = 0.9"], &rows))?;
    let head = ["k", "furnace, uniform-as-cosine", "furnace, cosine-twice", "Cornell box, uniform-as-cosine"];
    let columns = || tested(&m.compared).into_iter().map(|(_, r)| r);
    let row =
        |k: usize| [k.to_string()].into_iter().chain(columns().map(|r| pm([r[k].value, r[k].std_error]))).collect();
    let rows: Vec<Vec<String>> = (1..=4).map(row).collect();
    folder.text("mistakes.md", &markdown::table(&head, &rows))?;
    let bounce = |k: usize| pm([m.compared[1].wrong[1].0[k].value, m.compared[1].wrong[1].0[k].std_error]);
    folder.numbers(&[
        ("balance", gap(&m.balance[0].1)),
        ("broken", gap(&m.balance[1].1)),
        ("cornell_cosine_2", bounce(2)),
        ("cornell_cosine_3", bounce(3)),
    ])?;
    folder.figure("furnace", &plot(m, folder)?)?;
    folder.figure("equilibrium", &equilibrium(m, folder)?)?;
    folder.picture("mistakes.png", &mistakes(m, folder)?)?;
    folder.picture("glass.png", &glass(&m.glass, folder)?)?;
    Ok(())
}

/// The three signatures of the text, with their names.
fn tested([furnace, cornell]: &[Compared; 2]) -> [(&'static str, &[Ratio]); 3] {
    [
        ("uniform-as-cosine in the furnace", &furnace.wrong[0].0),
        ("cosine-twice in the furnace", &furnace.wrong[1].0),
        ("uniform-as-cosine in the Cornell box", &cornell.wrong[0].0),
    ]
}

/// Left: the terms of three furnaces, with the lines ρ^k. Right: r_k of wrong renderers.
fn plot(m: &Measured, folder: &Folder<'_>) -> book::Result<Figure> {
    let point = |(k, [value, std_error]): (usize, Value)| Point { x: k as f64, value, std_error, replicates: 16 };
    let curve = |(i, label, values): (usize, String, Vec<Value>)| Curve {
        label,
        points: values.into_iter().enumerate().map(point).collect(),
        look: Look::nth(i),
    };
    let terms = m.furnaces.iter().enumerate().map(|(i, f)| (i, format!("ρ = {}", f.rho), f.terms.clone()));
    let terms: Vec<Curve> = terms.map(curve).collect();
    let ratio = |r: &[Ratio]| r[..=4].iter().map(|r| [r.value, r.std_error]).collect::<Vec<_>>();
    let ratios = tested(&m.compared).into_iter().enumerate().map(|(i, (name, r))| (i + 3, name.to_string(), ratio(r)));
    let ratios: Vec<Curve> = ratios.map(curve).collect();
    let dashed = Stroke { color: GREY, width: 1.4, dash: Some((6.0, 4.0)) };
    Ok(figure("furnace", 960, 430, &folder.caption("furnace, cornell"), |page| {
        let values = terms.iter().flat_map(|c| c.points.iter().map(|p| p.value)).collect::<Vec<_>>();
        let y = Axis::log("mean of TᵏE  (W sr⁻¹ m⁻²)", values.into_iter());
        let panel = Panel::draw(page, "Furnaces: TᵏE = ρᵏ", [80.0, 40.0, 270.0, 330.0], Axis::counts("k", 8, 8), y)?;
        for (f, c) in m.furnaces.iter().zip(&terms) {
            panel.line((0.0, 1.0), (8.0, f.rho.powi(8)), dashed)?;
            panel.curve(c, 0.0, false)?;
        }
        let y = Axis::linear("TᵏE of the wrong renderer / right TᵏE", 0.0, 1.2, 6);
        let panel = Panel::draw(page, "Wrong renderers", [436.0, 40.0, 270.0, 330.0], Axis::counts("k", 4, 4), y)?;
        panel.line((-0.5, 1.0), (4.5, 1.0), dashed)?;
        ratios.iter().try_for_each(|c| panel.curve(c, 0.0, true))?;
        let entry = |c: &Curve| Entry::new(Sample::Mark(c.look), &c.label);
        let head = |words: &str| Entry::new(Sample::Heading, words);
        let mut entries = vec![head("left")];
        entries.extend(terms.iter().map(entry).chain([Entry::new(Sample::Line(dashed), "ρᵏ"), head("right")]));
        entries.extend(ratios.iter().map(entry).chain([Entry::new(Sample::Line(dashed), "1: correct")]));
        page.legend((724.0, 50.0), 220.0, &entries)?;
        Ok(())
    })?)
}

/// Right and wrong images in two scenes.
fn mistakes(m: &Measured, folder: &Folder<'_>) -> book::Result<Picture> {
    let mut tiles = vec![];
    for c in &m.compared {
        let side = (c.right.len() as f64).sqrt() as usize;
        let gain = if c.right.iter().all(|p| (p[0] - 2.0).abs() < 0.1) { 0.25 } else { auto_gain(&c.right) };
        let [(_, uniform), (_, twice)] = &c.wrong;
        for (label, image) in [("right", &c.right), ("uniform-as-cosine", uniform), ("cosine-twice", twice)] {
            let picture = develop(side, side, image, gain).picture.enlarged(480 / side);
            let note = format!("mean {}", significant(mean(image), 3));
            tiles.push(Tile { image: picture, label: label.into(), notes: vec![note] });
        }
    }
    let heads = [["furnace", "ρ = 0.5"], ["cornell", "Cornell box"]].map(|words| words.map(String::from));
    let title = "Two wrong renderers: the furnace shows only one of them";
    let layout = Layout { title, tiles: &tiles, places: &in_rows(6, 3), heads: &heads, foot: None, scale: 2.0 };
    Ok(layout.draw(&folder.caption("furnace, cornell"))?)
}

/// Three terms of the glass ball and the whole image, at one exposure.
fn glass(images: &[Pixels], folder: &Folder<'_>) -> book::Result<Picture> {
    let side = (images[0].len() as f64).sqrt() as usize;
    let tile = |(image, label): (&Pixels, &str)| Tile {
        image: develop(side, side, image, 0.5).picture.enlarged(384 / side),
        label: label.into(),
        notes: vec![format!("mean {}", significant(mean(image), 3))],
    };
    let tiles: Vec<Tile> = images.iter().zip(["k = 1", "k = 2", "k = 3", "all k together"]).map(tile).collect();
    let title = "A glass ball in a sky of radiance 1; all pictures at gain ×0.5";
    let layout = Layout { title, tiles: &tiles, places: &in_rows(4, 4), heads: &[], foot: None, scale: 2.0 };
    Ok(layout.draw(&folder.caption("glass-furnace"))?)
}

/// L against E + T L at every point.
fn equilibrium(m: &Measured, folder: &Folder<'_>) -> book::Result<Figure> {
    let (balances, judgement) = &m.balance[0];
    let dot = |(i, b): (usize, &super::Balance)| {
        let mean = |v: glam::DVec3| v.element_sum() / 3.0;
        let gaps: Vec<_> = b.differences.iter().map(|&d| glam::DVec3::splat(mean(d))).collect();
        let gap = estimate(&gaps);
        Dot {
            left: mean(b.left.mean),
            right: mean(b.right.mean),
            std_error: gap.std_error.x,
            replicates: gap.replicates,
            p: if b.judged() { b.p } else { f64::NAN },
            rejected: judgement.rejected.contains(&i),
        }
    };
    let dots = balances.iter().enumerate().map(dot).collect();
    Ok(points::draw(&[("points on the walls".into(), dots)], &folder.caption("cube"))?)
}

/// Mean of L − (E + T L) over points, in percent of T L, ± half a 99.9 % interval; in the least certain channel.
pub(super) fn gap(judgement: &Judgement) -> String {
    let group = &judgement.groups[0];
    let c = group.worst_channel();
    let [gap, half] = [group.difference.mean[c], group.half[c]].map(|v| 100.0 * v / group.value[c]);
    format!("{} %", plus_minus(gap, half, 2)).replace('-', "−")
}

/// Value ± half a 95 % interval; without it where it is below 10⁻⁶.
pub(super) fn pm([value, std_error]: Value) -> String {
    let half = half_width_95(std_error, 16);
    plus_minus(value, if half < 1e-6 { 0.0 } else { half }, 1)
}

/// In percent, with two digits.
pub(super) fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}
