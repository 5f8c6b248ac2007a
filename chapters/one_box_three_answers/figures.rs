//! Figures, tables and numbers of chapter 1: the terms as pictures, their norms with the bounds, the comparisons.
//!
//! ```text
//! ‖T^k E‖₁ ≤ g^k ‖E‖₁      ‖Σ_{k>K} T^k E‖₁ ≤ g/(1 − g) ‖T^K E‖₁      g = max albedo
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T^k E | the picture of a term, at its own exposure | [`terms`] |
//! | ‖T^k E‖₁ | mean of a term over all surfaces, against k | [`norms`] |

use super::claims::of_bounds;
use super::{Answers, Measured, comparisons, percent};
use fredholm::report::book::{self, Folder};
use fredholm::report::figures::decay::{self, Decay, RateLine};
use fredholm::report::image::{picture, sheet, sheet::Tile, typeset::superscript};
use fredholm::report::plot::{Curve, Look};
use fredholm::report::text::{
    markdown,
    number::{average, significant},
};
use fredholm::stats::TermMeans;
use fredholm::study::run::Run;
use fredholm::terms::TermImage;

/// Writes all of them.
pub(super) fn write(folder: &Folder<'_>, m: &Measured, a: &Answers<'_>) -> book::Result<()> {
    const NORM: &str = "all surfaces, $\\norm{\\T^k E}_1$";
    let surface = a.norms.functional("surface");
    let images = [&a.series.series, &a.matrix.fine.series, &a.path.series].map(|s| s.image());
    let columns = [("series", images[0]), ("matrix", images[1]), ("path tracer", images[2]), (NORM, &surface)];
    folder.text("terms.md", &markdown::terms(&columns))?;
    let tables = comparisons(a, m.margin).map(|(name, c)| markdown::verdicts(name, &c));
    folder.text("verdicts.md", &tables.join("\n"))?;
    numbers(folder, &m.run, a)?;
    terms(folder, &m.run, a)?;
    norms(folder, &m.run, a)
}

/// In the red channel: ‖T^K E‖₁, the bound on the tail that follows from it, the tail, their ratio r, and the rate r/(1 + r)
/// of the geometric series with this tail. Then what part of the bounds is reached, and the share of T³E in the picture.
fn numbers(folder: &Folder<'_>, run: &Run, a: &Answers<'_>) -> book::Result<()> {
    let (g, k) = (run.guaranteed_rate().x, run.settings.max_bounces);
    let [last, tail] = [k, k + 1].map(|n| a.norms.mean[n].x);
    let ratio = tail / last;
    let image = a.series.series.image();
    let [term, rest] = of_bounds(&run.scene, a);
    folder.numbers(&[
        ("last", significant(last, 3)),
        ("bound", significant(last * g / (1.0 - g), 3)),
        ("tail", significant(tail, 3)),
        ("ratio", significant(ratio, 3)),
        ("rate", significant(ratio / (1.0 + ratio), 2)),
        ("term_of_bound", percent(term)),
        ("tail_of_bound", percent(rest)),
        ("third", percent(average(&image.terms[3]).0 / average(&image.total).0)),
    ])?;
    Ok(())
}

/// The terms and the whole image, each at its own exposure.
fn terms(folder: &Folder<'_>, run: &Run, a: &Answers<'_>) -> book::Result<()> {
    let [w, h] = run.scene.camera.size.map(|n| n as usize);
    let tile = |label: String, image: &TermImage| {
        let gain = picture::auto_gain(&image.mean);
        let mean = significant(picture::mean(&image.mean), 2);
        let image = picture::develop(w, h, &image.mean, gain).picture.enlarged((344 / w).max(1));
        Tile { image, label, notes: vec![format!("{} · mean {mean}", picture::gain_label(gain))] }
    };
    let name = |k: usize| match k {
        0 => "E: emission".to_string(),
        1 => "TE: direct light".into(),
        k => format!("T{}E", superscript(k)),
    };
    let mut tiles: Vec<Tile> = a.series.terms.iter().enumerate().map(|(k, image)| tile(name(k), image)).collect();
    tiles.push(tile("sum of all k".into(), &a.series.total));
    let title = format!("The terms TᵏE, {} paths per pixel and term", run.settings.spp);
    let foot = Some("× and ÷: the exposure of each picture. Mean: over pixels and channels, W sr⁻¹ m⁻².");
    let places = sheet::in_rows(tiles.len(), 5);
    let layout = sheet::Layout { title: &title, tiles: &tiles, places: &places, heads: &[], foot, scale: 2.0 };
    Ok(folder.picture("terms.png", &layout.draw(&folder.caption("cornell"))?)?)
}

/// The norms of the terms against k, with both bounds.
fn norms(folder: &Folder<'_>, run: &Run, a: &Answers<'_>) -> book::Result<()> {
    let matrix = run.norms_of_matrix().unwrap_or_default();
    let (series, k) = (TermMeans::from(a.norms), run.settings.max_bounces);
    let g = run.guaranteed_rate().max_element();
    let curve = |label: &str, terms: &TermMeans, look| Curve { label: label.into(), points: decay::norms(terms), look };
    let surface =
        vec![curve("series", &series, Look::SINGLE), curve("matrix", &TermMeans::exact(&matrix), Look::MATRIX)];
    let lines = [Some(RateLine::guaranteed(g, matrix[0])), RateLine::tail_bound(g, k, series.mean[k])];
    let lines = lines.into_iter().flatten().collect();
    let figure = Decay { title: "How the terms decay".into(), surface, lines, ..Decay::default() };
    Ok(folder.figure("decay", &decay::draw(&figure, &folder.caption("cornell"))?)?)
}
