//! Table, plot and pictures of chapter 12.
//!
//! | file | shows |
//! |---|---|
//! | `fresnel` | the part of the samples that is reflected against the angle, on the curves of the formula |
//! | `techniques.png` | the scene `caustic` by three estimators, with a small lamp and with a point light |
//! | `classes.md` | means of the terms on the floor and in the glass |

use super::caustic::{Found, LAST};
use super::{DIAMOND, GLASS, Measured, fresnel};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::picture::{Picture, auto_gain, develop, gain_label, mean};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{self, Axis, Curve, Entry, Figure, Look, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::{markdown, number::significant};

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    folder.text("classes.md", &classes(m))?;
    let shown = |x: Number| x.to_string();
    let zero =
        |inside: bool| m.angles.iter().find(|a| a.inside == inside).map_or_else(String::new, |a| shown(a.reflected));
    let percent = |x: Number| format!("{} %", x.times(100.0));
    let f = fresnel(1.0, DIAMOND, 0.0);
    folder.numbers(&[
        ("normal", zero(false)),
        ("normal_inside", zero(true)),
        ("plate", shown(m.plate)),
        ("plate_once", significant((1.0 - f).powi(2), 4)),
        ("variance", shown(m.choice[1].variance.over(m.choice[0].variance))),
        ("corridor", percent(m.corridor)),
        ("seen_twice", shown(m.found[1][0].floor[3])),
    ])?;
    folder.figure("fresnel", &curves(folder, m)?)?;
    folder.picture("techniques.png", &techniques(folder, m)?)?;
    Ok(())
}

/// A mean, or how it was found.
fn cell(x: Number) -> String {
    match x.value {
        0.0 => "0".into(),
        // fewer than about 25 hits of equal size: the scatter of the replicates says little about the error
        v if x.std_error > 0.2 * v => format!("{} (few hits)", significant(v, 1)),
        _ => x.to_string(),
    }
}

fn classes(m: &Measured) -> String {
    let rows = [
        ("floor", 1, "LDE"),
        ("floor", 2, "LSDE"),
        ("floor", 3, "LSSDE, LDSDE"),
        ("glass", 2, "LDSE, LSSE"),
        ("glass", 3, "LDSSE, LSDSE"),
    ];
    let lights = ["small lamp", "point light"].into_iter().zip(&m.found);
    let row = |light: &str, found: &[Found; 3], (place, k, paths): (&str, usize, &str)| {
        let value = |f: &Found| cell(if place == "floor" { f.floor[k] } else { f.ball[k] });
        let words = [format!("{light}, {place}"), k.to_string(), paths.to_string()];
        words.into_iter().chain(found.each_ref().map(value)).collect::<Vec<_>>()
    };
    let rows: Vec<_> = lights.flat_map(|(light, found)| rows.map(|r| row(light, found, r))).collect();
    markdown::table(&["light, pixels", "k", "paths", "from the eye", "from the light", "from both ends"], &rows)
}

fn curves(folder: &Folder<'_>, m: &Measured) -> book::Result<Figure> {
    let sides = [(false, "ray in air", [1.0, GLASS], 0), (true, "ray in glass", [GLASS, 1.0], 1)];
    let critical = Stroke { color: plot::GREY, width: 1.8, dash: Some((7.0, 5.0)) };
    let counted = |inside: bool, label: &str, i: usize| {
        let point = |a: &super::Angle| Point {
            x: a.degrees,
            value: a.reflected.value,
            std_error: a.reflected.std_error,
            replicates: u64::from(a.samples),
        };
        let points = m.angles.iter().filter(|a| a.inside == inside).map(point).collect();
        Curve { label: format!("{label}, counted"), points, look: Look::nth(i) }
    };
    Ok(plot::figure("fresnel", 960, 480, &folder.caption("glass-furnace"), |page| {
        let title = "How much light glass of index 1.5 reflects";
        page.text(title, (24.0, 26.0), Words { size: 20.0, ..Words::default() })?;
        let axes = [
            Axis::linear("angle with the normal, degrees", 0.0, 90.0, 9),
            Axis::linear("part reflected", 0.0, 1.05, 6),
        ];
        let [x, y] = axes;
        let panel = Panel::draw(page, "", [84.0, 56.0, 580.0, 370.0], x, y)?;
        panel.line((m.critical, 0.0), (m.critical, 1.05), critical)?;
        let mut entries = vec![];
        for (inside, label, [n, beyond], i) in sides {
            let line = Stroke::solid(Look::nth(i).color, 2.4);
            let at = |step: u32| {
                let degrees = f64::from(step) * 0.1;
                (degrees, fresnel(n, beyond, degrees.to_radians()))
            };
            (0..900).try_for_each(|step| panel.line(at(step), at(step + 1), line))?;
            let curve = counted(inside, label, i);
            panel.curve(&curve, 0.0, false)?;
            entries.push(Entry::new(Sample::Line(line), format!("{label}, Fresnel's formula")));
            entries.push(Entry::new(Sample::Mark(curve.look), curve.label));
        }
        entries.push(Entry::new(Sample::Line(critical), format!("critical angle {:.2}°", m.critical)));
        page.legend((684.0, 72.0), 256.0, &entries).map(|_| ())
    })?)
}

/// Two lights, three estimators; one exposure for each row.
fn techniques(folder: &Folder<'_>, m: &Measured) -> book::Result<Picture> {
    let names = ["from the eye, with connections", "from the light", "from both ends"];
    let mut tiles = vec![];
    for found in &m.found {
        let gain = auto_gain(&found[2].image);
        for (f, name) in found.iter().zip(names) {
            let side = f.image.len().isqrt();
            let image = develop(side, side, &f.image, gain).picture.enlarged(512 / side);
            let words =
                format!("{} samples, gain {}, mean {}", f.spp, gain_label(gain), significant(mean(&f.image), 3));
            tiles.push(Tile { image, label: name.into(), notes: vec![words] });
        }
    }
    let heads = [["lamp", "radius 5 cm"], ["point", "no area"]].map(|words| words.map(String::from));
    let title = format!("A glass ball over a floor, k ≤ {LAST}: which light does each estimator find?");
    let layout = Layout { title: &title, tiles: &tiles, places: &in_rows(6, 3), heads: &heads, foot: None, scale: 2.0 };
    Ok(layout.draw(&folder.caption("caustic"))?)
}
