//! How many bounces are enough, as a table: measured, beside what the albedo guarantees.

use crate::report::text::{grid::Grid, summary};
use crate::study::bounces::{Bounces, enough, guaranteed};

/// The fractions of the light that may be missing.
pub const PARTS: [(f64, &str); 3] = [(0.1, "10 %"), (0.01, "1 %"), (0.001, "0.1 %")];
/// The first terms of all light and of indirect light.
const FROM: [usize; 2] = [0, 2];

/// All of it for `summary.json`.
pub fn records(found: &Bounces, albedo: f64, bounded: [bool; 2]) -> Vec<summary::Bounces> {
    let one = |(light, from, bounded): (&str, usize, bool), missing: f64| {
        let range = |terms| {
            let e = enough(terms, from, missing);
            [e.least, e.most]
        };
        summary::Bounces {
            light: light.into(),
            missing,
            picture: range(&found.picture),
            surfaces: range(&found.surfaces),
            guaranteed: guaranteed(albedo, from, missing).filter(|_| bounded),
        }
    };
    let kinds = [("all", FROM[0], bounded[0]), ("indirect", FROM[1], bounded[1])];
    kinds.into_iter().flat_map(|kind| PARTS.map(|(missing, _)| one(kind, missing))).collect()
}

/// One row for each fraction of [`PARTS`]. `albedo` is γ; `bounded` says for which of all light and indirect light γ gives a
/// guarantee ([`Run::bounds_from`](crate::study::run::Run::bounds_from)).
pub fn grid(found: &Bounces, albedo: f64, bounded: [bool; 2]) -> Grid {
    let head = ["missing", "all light: picture", "surfaces", "bound", "indirect: picture", "surfaces", "bound"];
    let sentence = "How many bounces are enough? The K after which at most this much is missing.";
    let mut grid = Grid::new(sentence, head);
    for (part, name) in PARTS {
        let cells = FROM.iter().zip(bounded).flat_map(|(&from, bounded)| {
            let bound = guaranteed(albedo, from, part).filter(|_| bounded).map_or("–".into(), |k| k.to_string());
            [enough(&found.picture, from, part).to_string(), enough(&found.surfaces, from, part).to_string(), bound]
        });
        grid.push(std::iter::once(name.to_owned()).chain(cells));
    }
    grid
}
