//! Which bounce lights which surface, as a table.

use crate::report::text::grid::Grid;
use crate::study::lit::{LAST, Lit};

/// One row for each surface: the shares of k = 1, 2, … in its reflected light, in percent.
pub fn grid(surfaces: &[Lit]) -> Grid {
    let head = ["surface".to_owned()].into_iter().chain((1..=LAST).map(|k| format!("k = {k}")));
    let sentence = "Which bounce lights what? Shares of the light that each surface reflects, in %.";
    let mut grid = Grid::new(sentence, head.chain([format!("k > {LAST}")]));
    for surface in surfaces {
        let share = |share: f64| match 100.0 * share {
            x if x.is_nan() => "–".into(),
            0.0 => "0".into(),
            x => format!("{x:.1}"),
        };
        grid.push(std::iter::once(surface.name.clone()).chain(surface.shares().into_iter().map(share)));
    }
    grid
}
