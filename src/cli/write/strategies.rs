//! `--strategies`: the pyramid of the bidirectional estimator, as pictures and layers.

use crate::cli::base::Failure;
use fredholm::report::figures::pyramid::{Stone, draw};
use fredholm::report::image::exr;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::table;
use fredholm::study::strategies::Strategy;
use std::path::Path;

/// Names of the files that are written.
pub const FILES: [&str; 3] = ["strategies.png", "strategies-alone.png", "strategies.exr"];

/// Writes [`FILES`]. In the EXR file the layers `KkSs` are weighted by multiple importance sampling, `KkSs_alone` are not.
pub fn write(
    folder: &Path,
    all: &[Strategy],
    [w, h]: [usize; 2],
    caption: &Caption,
    attributes: &[(&str, String)],
) -> Result<(), Failure> {
    let total = |k: usize| all.iter().filter(|s| s.k == k).map(|s| table::average(&s.means[0]).0).sum::<f64>();
    let share = |s: &Strategy| {
        let (mine, all) = (table::average(&s.means[0]).0, total(s.k));
        if all > 0.0 { format!("{:.1} % of the term", 100.0 * mine / all) } else { "nothing".into() }
    };
    let alone = |s: &Strategy| format!("variance {}", table::significant(s.variances[1], 2));
    let stones: Vec<Stone> =
        all.iter().map(|s| Stone { k: s.k, s: s.s, pixels: &s.weighted.mean, note: share(s) }).collect();
    let title = "What each strategy adds to TᵏE, weighted: every row sums to its term";
    draw(title, w, h, &stones, true, caption)?.write(&folder.join(FILES[0]))?;
    let stones: Vec<Stone> =
        all.iter().map(|s| Stone { k: s.k, s: s.s, pixels: &s.alone.mean, note: alone(s) }).collect();
    let title = "What each strategy finds of TᵏE alone, unweighted";
    draw(title, w, h, &stones, false, caption)?.write(&folder.join(FILES[1]))?;
    let names: Vec<[String; 2]> =
        all.iter().map(|s| ["", "_alone"].map(|end| format!("K{:02}S{:02}{end}", s.k, s.s))).collect();
    let layers: Vec<exr::Layer> = all
        .iter()
        .zip(&names)
        .flat_map(|(s, [a, b])| {
            [exr::Layer { name: a, pixels: &s.weighted.mean }, exr::Layer { name: b, pixels: &s.alone.mean }]
        })
        .collect();
    exr::write(&folder.join(FILES[2]), w, h, &layers, attributes)?;
    Ok(())
}
