//! Figures and tables of chapter 2.
//!
//! ```text
//! (T E)(x) for one sphere under four lights      E_point/E_disc − 1 = (R/h)²      L = const, E ∝ 1/d²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T E | light reflected once, as a picture | [`lights`] |
//! | R/h, d | size and distance of a lamp | [`limits`] |

use super::scenes::{ball, point, scene};
use super::{Captured, Measured};
use fredholm::engine::{Settings, by_rays};
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::book::{self, Folder, Number};
use fredholm::report::image::picture::{auto_gain, develop, gain_label};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::plot::{Axis, Curve, Entry, GREY, Look, Panel, Point, Sample, Stroke, Words, figure};
use fredholm::report::text::{markdown, number::percent};
use fredholm::terms::TermImage;
use std::f64::consts::PI;

/// Draws and writes everything.
pub(super) fn draw(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    lights(folder)?;
    limits(folder, m)?;
    captured(folder, m)?;
    let rows: Vec<[String; 2]> = m.cones.iter().map(|(name, e)| [name.clone(), e.to_string()]).collect();
    folder.text("cones.md", &markdown::table(&["lamp", "measured E/(π L sin²α)"], &rows))?;
    let rows: Vec<_> =
        m.captured.differences().iter().map(|(r, d)| [format!("{} cm", 100.0 * r), d.to_string()]).collect();
    folder.text("captured.md", &markdown::table(&["radius of the object", "photograph/room − 1"], &rows))?;
    let differences = m.captured.differences();
    folder.numbers(&[
        ("large", percent(differences[2].1.value)),
        ("clipped", percent(-m.captured.clipped().value)),
        ("largest", format!("{:.2}", m.limit[0].1.value)),
        ("smallest", format!("{:.4}", m.limit[3].1.value)),
    ])?;
    Ok(())
}

/// Pictures of one size with a label and a line below each, in one row for a projector.
fn sheet(folder: &Folder<'_>, file: &str, title: &str, of: &str, tiles: &[Tile]) -> book::Result<()> {
    let places = in_rows(tiles.len(), tiles.len());
    let layout = Layout { title, tiles, places: &places, heads: &[], foot: None, scale: 2.0 };
    Ok(folder.picture(file, &layout.draw(&folder.caption(of))?)?)
}

/// A sphere under the sky, two spherical lamps and a point light of the same power.
fn lights(folder: &Folder<'_>) -> book::Result<()> {
    let size = folder.pick(432, 64);
    let camera =
        format!("origin = [0, 1.3, 3.4], target = [0, 0.4, 0], up = [0, 1, 0], fov = 38, size = [{size}, {size}]");
    let objects = "{ type = 'disk', center = [0, 0, 0], normal = [0, 1, 0], radius = 4, material = 'grey' }, \
                   { type = 'sphere', center = [0, 0.5, 0], radius = 0.5, material = 'white' }";
    let (power, place) = (150.0, [-1.2, 2.4, 0.8]);
    let lamp = |r: f64| format!("{objects}, {}", ball(r, place, &format!("power = [{power}, {power}, {power}]")));
    let point = point(place, power / (4.0 * PI));
    let sky = "{ type = 'environment', radiance = [0.7, 0.7, 0.7] }";
    // the method with little noise for each light: random directions for the sky, random points for a lamp
    let (scatter, connect) = (Technique::Scatter, Technique::Connect);
    let settings = |technique| Settings {
        spp: 16,
        technique,
        max_bounces: 1,
        roulette: Roulette::Never,
        seed: folder.seed,
        ..Settings::default()
    };
    let mut tiles = vec![];
    for (label, note, shapes, light, technique) in [
        ("the sky", "L the same from everywhere", objects.to_string(), sky, scatter),
        ("a large lamp", "sphere, R = 60 cm", lamp(0.6), "", connect),
        ("a small lamp", "sphere, R = 15 cm, same power", lamp(0.15), "", connect),
        ("a point", "R → 0, same power", objects.to_string(), point.as_str(), connect),
    ] {
        let scene = scene([&camera, &shapes, light])?;
        let found = by_rays::terms(&scene, by_rays::Estimator::Prefix, &settings(technique), folder.progress);
        let image = &found.terms[1].mean;
        let image = develop(size as usize, size as usize, image, 1.0).picture;
        tiles.push(Tile { image, label: label.into(), notes: vec![note.into()] });
    }
    let of = "a white sphere on a grey disc, T E at 16 samples per pixel";
    sheet(folder, "lights.png", "One sphere, four lights: the light that is reflected once, T E (×1)", of, &tiles)
}

/// The photograph, and the object under it and in the room.
fn captured(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let c: &Captured = &m.captured;
    let size = c.photo.mean.len().isqrt();
    let gain = auto_gain(&c.under.mean);
    let room = |i: usize| (format!("R = {} cm, in the room", 100.0 * c.in_room[i].0), "all bounces", &c.in_room[i].1);
    let pictures = [
        ("photograph".to_string(), "a mirror ball, R = 5 cm", &c.photo),
        ("under the photograph".into(), "one reflection", &c.under),
        room(0),
        room(2),
    ];
    let tile = |(label, note, image): &(String, &str, &TermImage)| Tile {
        image: develop(size, size, &image.mean, gain).picture.enlarged(3),
        label: label.clone(),
        notes: vec![format!("{note}, {}", gain_label(gain))],
    };
    let title = "A photograph of a mirror ball, used as the sky for an object of plastic";
    sheet(folder, "captured.png", title, "cornell, a ball in place of the tall block", &pictures.each_ref().map(tile))
}

/// Left: the point light as a limit. Right: radiance and irradiance against distance.
fn limits(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let point = |x: f64, n: Number| Point { x, value: n.value, std_error: n.std_error, replicates: 16 };
    let curve = |label: &str, points: Vec<Point>, look| Curve { label: label.into(), points, look };
    let disc = curve("measured", m.limit.iter().map(|&(r, e)| point(r, e)).collect(), Look::nth(0));
    let radiance = curve("radiance", m.distance.iter().map(|&(d, l, _)| point(d, l)).collect(), Look::nth(1));
    let irradiance = curve("irradiance", m.distance.iter().map(|&(d, _, e)| point(d, e)).collect(), Look::nth(2));
    let guide = Stroke { color: GREY, width: 1.6, dash: Some((7.0, 5.0)) };
    let drawn = figure("limits", 960, 430, &folder.caption("discs over a white patch"), |page| {
        page.text("Size and distance of a lamp", (24.0, 24.0), Words { size: 18.0, ..Words::default() })?;
        let x = Axis::log("R/h, radius by height", m.limit.iter().map(|p| p.0));
        let y = Axis::log("E of the point / E of the disc − 1", m.limit.iter().map(|p| p.1.value));
        let left = Panel::draw(page, "A disc shrinks at fixed power", [90.0, 72.0, 340.0, 240.0], x, y)?;
        left.line((0.05, 0.0025), (1.0, 1.0), guide)?;
        left.curve(&disc, 0.0, false)?;
        let x = Axis::log("distance d, m", m.distance.iter().map(|p| p.0));
        let y =
            Axis::log("L in W/(m² sr), E in W/m²", radiance.points.iter().chain(&irradiance.points).map(|p| p.value));
        let right = Panel::draw(page, "A lamp is moved away", [570.0, 72.0, 340.0, 240.0], x, y)?;
        let near = irradiance.points[0].value;
        right.line((0.5, 4.0 * near), (8.0, near / 64.0), guide)?;
        right.line((0.5, 1.0), (8.0, 1.0), guide)?;
        right.curve(&radiance, 0.0, false)?;
        right.curve(&irradiance, 0.0, false)?;
        let of = |c: &Curve, says: &str| Entry::new(Sample::Mark(c.look), says);
        page.legend((90.0, 376.0), 340.0, &[of(&disc, "measured"), Entry::new(Sample::Line(guide), "(R/h)²")])?;
        let right = [of(&radiance, "L along the ray: constant"), of(&irradiance, "E of a facing patch: falls as 1/d²")];
        page.legend((570.0, 376.0), 340.0, &right)?;
        Ok(())
    })?;
    Ok(folder.figure("limits", &drawn)?)
}
