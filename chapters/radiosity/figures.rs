//! Tables, plots and pictures of chapter 7.
//!
//! | file | shows |
//! |---|---|
//! | `patches` | the Cornell box on two meshes, gathered once more, and by a path tracer |
//! | `solvers` | error of three solvers against products with T |
//! | `mesh` | error of the cube against the width of the patches |
//! | `modes` | the four leading modes, on the walls |
//! | `terms.md` | the terms from paths and from two matrices |

use super::claims::percent;
use super::{LAST, Measured, RED};
use fredholm::engine::{Settings, by_matrix, by_rays};
use fredholm::operator::modes::{Mode, Modes};
use fredholm::report::book::{self, Folder};
use fredholm::report::figures::solvers;
use fredholm::report::image::picture::{Picture, auto_gain_beside_lamps, develop};
use fredholm::report::image::sheet::{Layout, Tile, in_rows};
use fredholm::report::image::zmap;
use fredholm::report::plot::{self, Axis, Curve, Entry, Look, Panel, Point, Sample, Stroke, Words};
use fredholm::report::text::{markdown, number::plus_minus, number::significant};
use fredholm::scene::{Description, Scene, SceneError, load};
use fredholm::terms::TermImage;

/// Writes everything that the text includes.
pub(super) fn write(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let row = |k: usize| {
        let (x, s) = m.paths[k];
        let [coarse, fine] = [0, 1].map(|mesh| m.matrix[mesh][k]);
        [k.to_string(), plus_minus(x, s, 1), significant(fine, 4), percent((fine - x) / x), percent(s / x), {
            percent((fine - coarse) / fine)
        }]
    };
    let head = ["k", "paths", "matrix", "difference", "standard error", "change from the coarse mesh"];
    folder.text("terms.md", &markdown::table(&head, &(0..=LAST).map(row).collect::<Vec<_>>()))?;
    let products =
        |i: usize, error: f64| m.histories[i].reaches(error).map_or("–".into(), |p| p.applications.to_string());
    folder.numbers(&[
        ("radius", significant(m.radius, 4)),
        ("open", significant(m.open, 2)),
        ("jacobi", products(0, 1e-6)),
        ("jacobi4", products(0, 1e-4)),
        ("order", significant(m.order, 3)),
        ("factor", significant(2f64.powf(m.order), 2)),
        ("ratio1", significant(m.ratios[1][1], 4)),
        ("ratio2", significant(m.ratios[1][2], 4)),
    ])?;
    let title = "Three ways to solve B = E + ρ F B";
    folder.figure("solvers", &solvers::draw(&m.histories, m.radius, title, &folder.caption("cornell"))?)?;
    mesh(folder, m)?;
    patches(folder)?;
    modes(folder)
}

/// The error of the cube against h, in thousandths, with lines of order 1 and 2.
fn mesh(folder: &Folder<'_>, m: &Measured) -> book::Result<()> {
    let points: Vec<(f64, f64)> = m.mesh.iter().map(|&(h, error)| (h, 1e3 * error)).collect();
    let (h, error) = points[0];
    let guide = |order: f64| (0.2 * h, error * 0.2f64.powf(order));
    let marks = points.iter().map(|&(h, error)| Point::exact(h, error)).collect();
    let curve = Curve { label: "mean radiance of the walls".into(), points: marks, look: Look::PREFIX };
    let stroke = |color| Stroke { dash: Some((9.0, 5.0)), ..Stroke::solid(color, 2.4) };
    let orders = [(1.0, "order 1: error ~ h", plot::SKY), (2.0, "order 2: error ~ h²", plot::GREEN)];
    let mut x = Axis::log("width h of a patch, in widths of the wall", [0.2 * h, h].into_iter());
    x.ticks = points.iter().map(|&(h, _)| (h, format!("1/{:.0}", 1.0 / h))).collect();
    let y = Axis::log("error, 10⁻³ W sr⁻¹ m⁻²", [guide(2.0).1, error].into_iter());
    let figure = plot::figure("mesh", 960, 480, &folder.caption("cube"), |page| {
        page.text("The error of the mesh, in a closed cube", (24.0, 26.0), Words { size: 18.0, ..Words::default() })?;
        let panel = Panel::draw(page, "", [92.0, 56.0, 560.0, 370.0], x, y)?;
        orders.iter().try_for_each(|o| panel.line((h, error), guide(o.0), stroke(o.2)))?;
        panel.curve(&curve, 0.0, true)?;
        let lines = orders.iter().map(|o| Entry::new(Sample::Line(stroke(o.2)), o.1));
        let entries: Vec<Entry> = lines.chain([Entry::new(Sample::Mark(curve.look), &curve.label)]).collect();
        page.legend((672.0, 66.0), 276.0, &entries).map(|_| ())
    })?;
    Ok(folder.figure("mesh", &figure)?)
}

/// The Cornell box with pictures of this many pixels each way.
fn room(pixels: usize) -> Result<Description, SceneError> {
    let size = load::Options { set: vec![format!("camera.size=[{pixels},{pixels}]")], ..Default::default() };
    Ok(load::scene("cornell", &size)?.description)
}

fn patches(folder: &Folder<'_>) -> book::Result<()> {
    let (pixels, enlarged) = folder.pick((220, 2), (55, 8));
    let room = room(pixels)?;
    let scene = Scene::new(&room);
    let read = Settings { seed: folder.seed, spp: folder.pick(16, 4), read_patches: true, ..Settings::default() };
    let gathered = Settings { read_patches: false, spp: folder.pick(32, 4), ..read.clone() };
    let [coarse, fine] =
        folder.pick([100, 600], [60, 150]).map(|n| by_matrix::matrix(&room, &scene, n, &read, folder.progress));
    let (coarse, fine) = (coarse?, fine?);
    let count = |m: &by_matrix::Matrix| m.radiosity.patches().len();
    let pictures = [
        (format!("{} patches", count(&coarse)), coarse.through_camera(&scene, &read, folder.progress)),
        (format!("{} patches", count(&fine)), fine.through_camera(&scene, &read, folder.progress)),
        (format!("{} patches, gathered", count(&fine)), fine.through_camera(&scene, &gathered, folder.progress)),
        ("path tracer".into(), by_rays::path(&scene, &gathered, folder.progress)),
    ];
    let gain = auto_gain_beside_lamps(&pictures[3].1.total.mean, &pictures[2].1.terms[0].mean);
    let tile = |(label, picture): &(String, by_rays::Sampled)| Tile {
        image: develop(pixels, pixels, &picture.total.mean, gain).picture.enlarged(enlarged),
        label: label.clone(),
        notes: vec![],
    };
    sheet(folder, "patches.png", "The Cornell box by radiosity", &pictures.each_ref().map(tile))
}

fn modes(folder: &Folder<'_>) -> book::Result<()> {
    let (pixels, enlarged) = folder.pick((220, 2), (55, 8));
    let room = room(pixels)?;
    let scene = Scene::new(&room);
    let settings = Settings { seed: folder.seed, spp: folder.pick(16, 4), ..Settings::default() };
    let matrix = by_matrix::dense_matrix(&room, &scene, folder.pick(600, 150), 1.0, 0, folder.progress)?;
    let leading = Modes::of(&matrix.radiosity.operator(RED), 4).leading;
    let fields: Vec<Vec<f64>> = leading.iter().map(|mode| mode.vector.clone()).collect();
    let seen = matrix.paint(&scene, &fields, &settings, folder.progress);
    let tile = |((i, mode), image): ((usize, &Mode), &TermImage)| {
        let label = format!("mode {}: λ = {:.3}", i + 1, mode.value);
        Tile { image: signed(pixels, image).enlarged(enlarged), label, notes: vec![] }
    };
    let tiles: Vec<Tile> = leading.iter().enumerate().zip(&seen).map(tile).collect();
    sheet(folder, "modes.png", "The leading modes of T, red channel: red positive, blue negative", &tiles)
}

/// Red where the picture is positive, blue where it is negative; 4 is the end of the colour map.
fn signed(pixels: usize, image: &TermImage) -> Picture {
    let values: Vec<f64> = image.mean.iter().map(|v| f64::from(v[RED])).collect();
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let scale = sizes[(sizes.len() - 1) * 99 / 100].max(f64::MIN_POSITIVE);
    Picture { width: pixels, height: pixels, pixels: values.iter().map(|v| zmap::color(4.0 * v / scale)).collect() }
}

fn sheet(folder: &Folder<'_>, name: &str, title: &str, tiles: &[Tile]) -> book::Result<()> {
    let places = in_rows(tiles.len(), tiles.len());
    let layout = Layout { title, tiles, places: &places, heads: &[], foot: None, scale: 2.0 };
    Ok(folder.picture(name, &layout.draw(&folder.caption("cornell"))?)?)
}
