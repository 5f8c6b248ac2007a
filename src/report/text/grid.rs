//! A small table under the sentence that says what it shows: for the terminal and for the page.

use super::table::{Side, columns};
use std::fmt;

/// A sentence, a header, and rows. All rows have as many cells as the header.
///
/// ```
/// use fredholm::report::text::grid::Grid;
/// let mut grid = Grid::new("The terms of the furnace.", ["k", "mean"]);
/// grid.push(["0".into(), "0.5000".into()]);
/// assert_eq!(grid.to_string(), "The terms of the furnace.\nk    mean\n0  0.5000\n");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Grid {
    /// Says what the table shows.
    pub sentence: String,
    /// The names of the columns.
    pub head: Vec<String>,
    /// The cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Grid {
    /// A table without rows.
    pub fn new<S: Into<String>>(sentence: impl Into<String>, head: impl IntoIterator<Item = S>) -> Self {
        Self { sentence: sentence.into(), head: head.into_iter().map(Into::into).collect(), rows: vec![] }
    }

    /// Adds a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = String>) {
        self.rows.push(row.into_iter().collect());
    }
}

impl fmt::Display for Grid {
    /// The sentence, then aligned lines: the first column to the left, all others to the right.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sides = [[Side::Left].as_slice(), &vec![Side::Right; self.head.len()]].concat();
        let (lines, _) = columns(std::iter::once(&self.head).chain(&self.rows), &sides);
        writeln!(f, "{}", self.sentence)?;
        lines.iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}
