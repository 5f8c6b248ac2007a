//! The sum over path lengths: every term and every partial sum of the series at one exposure.
//!
//! ```text
//! L = Σ_k T^k E      S_k = E + T E + … + T^k E      L = S_K + tail
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | T^k E | light after exactly k reflections: slot k | `shot.image(k..k + 1)` |
//! | S_k | light after at most k reflections | `shot.image(0..k + 1)` |
//! | tail | paths with more than K reflections | slot K + 1 |
//! | L | the same image by a path tracer that shares no weight with the terms | `path` |
//!
//! Reference: Kajiya, *The Rendering Equation* (1986).

use super::board::{Board, Tile};
use super::measure::{Interval, Shot, built_in};
use fredholm::estimator::{PathTracer, Plan, Prefix, Roulette, Technique};
use fredholm::report::book::{Folder, Result, Slide};
use fredholm::report::image::picture::{auto_gain_beside_lamps, gain_label};
use fredholm::report::image::typeset::superscript;
use fredholm::report::text::csv::Csv;
use fredholm::report::text::number::{percent, significant};
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;

/// This slide.
pub(crate) const SLIDE: Slide = Slide {
    id: "path-lengths",
    topic: "The sum over path lengths",
    caption: "The upper row shows the light after exactly k reflections, the lower row the light after at most k \
              reflections, all at one exposure. Look at the ceiling: it is black until k = 2. Every further term is \
              darker, and the last partial sum differs from the whole image by the tail only.",
    scene: "cornell",
    program,
};

/// K: the last term with a picture of its own.
const K: usize = 4;
/// The difference from the path tracer must be proved to be below this part of the mean.
const MARGIN: f64 = 0.02;

fn program(folder: &Folder<'_>) -> Result<()> {
    let size = folder.pick(288, 144);
    let scene = Scene::new(&built_in("cornell", [size, size])?);
    let plan = Plan { max_bounces: K, technique: Technique::Mis, roulette: Roulette::Albedo { from: 2 } };
    let terms = Prefix(Plan { roulette: plan.roulette.clone().after(K), ..plan.clone() });
    let shot = Shot::new(&scene, Sampling::Bsdf, &terms, folder.pick(128, 32), "terms", folder);
    let path = Shot::new(&scene, Sampling::Bsdf, &PathTracer(plan), folder.pick(32, 16), "path", folder);

    let (all, whole) = (0..K + 2, shot.mean(0..K + 2));
    let gain = auto_gain_beside_lamps(&shot.image(all.clone()).mean, &shot.image(0..1).mean);
    let share = |slots: std::ops::Range<usize>| format!("{} of L", percent(shot.mean(slots).value / whole.value));
    let tile = |slots: std::ops::Range<usize>, label: String| {
        let mean = significant(shot.mean(slots.clone()).value, 3);
        let tile =
            Tile::new(size, &shot.image(slots.clone()).mean, gain, label, vec![format!("mean {mean}"), share(slots)]);
        if folder.quick { tile } else { tile.fine() }
    };
    let name = |k: usize| format!("T{}E", superscript(k));
    let mut upper: Vec<Tile> = (0..=K).map(|k| tile(k..k + 1, name(k))).collect();
    upper.push(tile(K + 1..K + 2, format!("tail: k > {K}")));
    let mut lower: Vec<Tile> =
        (0..=K).map(|k| tile(0..k + 1, if k == 0 { "k = 0".into() } else { format!("k ≤ {k}") })).collect();
    lower.push(tile(all, "whole: L".into()));

    let apart = whole.minus(path.mean(0..1));
    let mut board = Board::new(
        "L = Σ TᵏE: the image is a sum over path lengths",
        &format!(
            "Above: light after exactly k reflections. Below: after at most k reflections. All pictures have the \
             same exposure, gain {}; the lamp itself (k = 0) is brighter than white.",
            gain_label(gain)
        ),
    );
    board.wide_row(upper);
    board.wide_row(lower);
    board.lines(
        &format!(
            "Terms + tail − path tracer = {} (mean over the image, ± 95 %); the path tracer's mean is {}.",
            apart.words(),
            path.mean(0..1).words()
        ),
        14.0,
    );
    if apart.at_most() > MARGIN * whole.value {
        return Err(format!("terms and path tracer: difference {} of {}", apart.words(), whole.words()).into());
    }
    let mut csv = Csv::new("k,mean,std_error,sum_mean,sum_std_error");
    for k in 0..K + 2 {
        let (term, sum) = (shot.mean(k..k + 1), shot.mean(0..k + 1));
        csv.put(if k > K { "tail".into() } else { k.to_string() });
        csv.numbers([term.value, term.std_error, sum.value, sum.std_error]).end();
    }
    folder.text("path-lengths.csv", &csv.text())?;
    board.finish(folder, &SLIDE, |_| Ok(()))
}
