//! Tables for the terminal: aligned text, at most 100 columns wide.

pub use super::number::{average, count, error, mark, outcome, plus_minus, significant};

use super::{
    number::{dash, known, p_value, percent, signed},
    rows::{Cell, Column, Name, Rows},
    summary::VerdictRecord,
};
use crate::terms::Functional;

/// The table of one result: a row for each term, then the tail and the sums.
///
/// `rays` is the number of rays traced for each k. If it is empty, the table has no such column.
///
/// ```
/// use fredholm::{report::text::table::series, terms::{Estimate, Functional}};
/// use glam::DVec3;
/// let terms: Vec<_> = [1.0, 0.5, 0.25].map(|v| Estimate::exact(DVec3::splat(v))).into();
/// let of = |v: f64| Estimate::exact(DVec3::splat(v));
/// let furnace = Functional { name: "image".into(), terms, tail: of(0.25), sum: of(1.75), total: of(2.0) };
/// let table = series("furnace", &furnace, &[]);
/// assert!(table.lines().any(|l| l.split_whitespace().eq(["1", "0.5000", "0", "0.5000", "25.0", "%"])));
/// ```
pub fn series(label: &str, functional: &Functional, rays: &[u64]) -> String {
    let rows = Rows::series(&[functional], rays).without_repetition();
    let mut columns = vec![(Column::World(0), "mean"), (Column::Ratio, "ratio"), (Column::Share, "share")];
    if !rays.is_empty() {
        columns.push((Column::Rays, "rays"));
    }
    format!("{label}\n{}", aligned(&lines("k", &columns, &rows), &[Side::Right; 6]))
}

/// The table of a comparison: a row for each part that was compared.
pub fn verdicts(verdicts: &[VerdictRecord]) -> String {
    let columns = [
        (Column::Difference, "difference"),
        (Column::Interval, "interval at 1 − α"),
        (Column::P, "p"),
        (Column::Detectable, "detectable"),
        (Column::Outcome, "verdict"),
    ];
    let lines = lines("what", &columns, &Rows::verdicts(verdicts));
    aligned(&lines, &[Side::Left, Side::Right, Side::Right, Side::Right, Side::Right, Side::Left])
}

/// The header and the rows as text. An estimate takes two columns, its mean and its error.
fn lines(first: &str, columns: &[(Column, &str)], rows: &Rows) -> Vec<Vec<String>> {
    let mut head = vec![first.to_owned()];
    for (column, words) in columns {
        head.push((*words).into());
        if matches!(column, Column::World(_)) {
            head.push("± 95 %".into());
        }
    }
    let row = |(name, cells): (&Name, Vec<&Cell>)| {
        [shortened(&name.to_string(), 34)].into_iter().chain(cells.into_iter().flat_map(words)).collect()
    };
    let columns: Vec<Column> = columns.iter().map(|c| c.0).collect();
    [head].into_iter().chain(rows.pick(&columns).map(row)).collect()
}

fn words(cell: &Cell) -> Vec<String> {
    vec![match cell {
        Cell::Blank => String::new(),
        Cell::Words(words) => words.clone(),
        Cell::Estimate(e) => return vec![significant(average(e).0, 4), error(e)],
        Cell::Ratio(ratio) => significant(*ratio, 4),
        Cell::Share(share) => percent(*share),
        Cell::Rays(rays) => rays.map_or_else(dash, count),
        Cell::Difference(effect) => signed(*effect),
        Cell::Interval(low, high) => format!("[{}, {}]", signed(*low), signed(*high)),
        Cell::P(p) => p_value(*p),
        Cell::Size(size) => known(*size),
        Cell::Outcome(found) => format!("{} {}", mark(*found), outcome(*found)),
    }]
}

fn shortened(text: &str, longest: usize) -> String {
    if text.chars().count() <= longest {
        return text.into();
    }
    text.chars().take(longest - 1).chain(['…']).collect()
}

#[derive(Clone, Copy)]
pub(crate) enum Side {
    Left,
    Right,
}

/// Aligns rows of text: two blanks between columns, a line under the header.
pub(crate) fn aligned(rows: &[Vec<String>], sides: &[Side]) -> String {
    let (mut lines, width) = columns(rows.iter(), sides);
    lines.insert(1.min(lines.len()), "─".repeat(width));
    lines.into_iter().map(|line| line + "\n").collect()
}

/// The rows as lines with two blanks between columns, without blanks at their ends, and the width of all columns.
pub(super) fn columns<'a>(rows: impl Iterator<Item = &'a Vec<String>> + Clone, sides: &[Side]) -> (Vec<String>, usize) {
    let count = rows.clone().next().map_or(0, Vec::len);
    let width = |c: usize| rows.clone().map(|row| row[c].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(sides).map(|((text, &w), side)| match side {
            Side::Left => format!("{text:<w$}"),
            Side::Right => format!("{text:>w$}"),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    (rows.clone().map(line).collect(), widths.iter().sum::<usize>() + 2 * (count.max(1) - 1))
}
