//! The rows of a table before they become text: the terms of a series with their shares, or the verdicts of a comparison.
//!
//! Three writers use them: [`table`](super::table) for the terminal, [`markdown`](super::markdown) for the book and
//! [`html`](crate::report::page::html) for the page. Each writer chooses its columns, their headings and the number of digits.

use std::fmt;

use super::{
    number::{average, significant},
    summary::VerdictRecord,
};
use crate::stats::{Comparison, Outcome, Verdict};
use crate::terms::{Estimate, Functional};

/// Columns, and rows with a cell for each.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    columns: Vec<Column>,
    rows: Vec<(Name, Vec<Cell>)>,
}

/// The kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// The estimates of the i-th series.
    World(usize),
    /// Each term divided by the term before, in the first series.
    Ratio,
    /// Each term divided by the whole, in the first series.
    Share,
    Rays,
    Difference,
    Interval,
    P,
    Detectable,
    Margin,
    Outcome,
    /// What would decide an inconclusive verdict.
    Cure,
}

/// The name of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Name {
    Words(String),
    Term(usize),
    /// All terms beyond the last.
    Tail(usize),
    /// All terms up to the last.
    Sum(usize),
    Whole,
    /// The sum of a series that is cut at K and has no tail.
    Cut,
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(words) => f.write_str(words),
            Self::Term(k) => write!(f, "{k}"),
            Self::Tail(last) => write!(f, "k > {last}"),
            Self::Sum(last) => write!(f, "Σ k ≤ {last}"),
            Self::Whole => f.write_str("all"),
            Self::Cut => f.write_str("cut at K"),
        }
    }
}

/// The content of a cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    Blank,
    Words(String),
    /// A value with its standard error.
    Estimate(Estimate),
    /// NaN: not known.
    Ratio(f64),
    Share(f64),
    Rays(Option<u64>),
    Difference(f64),
    Interval(f64, f64),
    P(f64),
    /// A margin, or the smallest difference that would have been found.
    Size(f64),
    Outcome(Outcome),
}

impl Rows {
    /// A row for every term of some series, then tail, sum and whole. A path tracer has only the whole. `rays` are the rays of
    /// the first series.
    pub(crate) fn series(worlds: &[&Functional], rays: &[u64]) -> Self {
        let columns = [Column::Ratio, Column::Share, Column::Rays].into_iter();
        let mut out = Self { columns: columns.chain((0..worlds.len()).map(Column::World)).collect(), rows: Vec::new() };
        let mut push = |name, ratio, rays, of: &dyn Fn(&Functional) -> Option<Estimate>| {
            let share = worlds.first().and_then(|f| Some(average(&of(f)?).0 / average(&f.total).0));
            let estimates = worlds.iter().map(|f| of(f).map_or(Cell::Blank, Cell::Estimate));
            let cells = [ratio, share.map_or(Cell::Blank, Cell::Share), rays].into_iter().chain(estimates);
            out.rows.push((name, cells.collect()));
        };
        let first = worlds.first().map_or(&[][..], |f| &f.terms);
        let mean = |k: usize| first.get(k).map_or(f64::NAN, |e| average(e).0);
        let count = worlds.iter().map(|f| f.terms.len()).max().unwrap_or(0);
        for k in 0..count {
            let before = k.checked_sub(1).map_or(f64::NAN, mean);
            let ratio = if before == 0.0 { f64::NAN } else { mean(k) / before };
            push(Name::Term(k), Cell::Ratio(ratio), Cell::Rays(rays.get(k).copied()), &|f| f.terms.get(k).copied());
        }
        if let Some(last) = count.checked_sub(1) {
            push(Name::Tail(last), Cell::Blank, Cell::Blank, &|f| (!f.terms.is_empty()).then_some(f.tail));
            push(Name::Sum(last), Cell::Blank, Cell::Blank, &|f| (!f.terms.is_empty()).then_some(f.sum));
        }
        let cut = worlds.first().is_some_and(|f| f.tail.is_none());
        push(if cut { Name::Cut } else { Name::Whole }, Cell::Blank, Cell::Blank, &|f| Some(f.total));
        out
    }

    /// Removes the row of the whole if the series has no tail, because then it equals the sum.
    pub(crate) fn without_repetition(mut self) -> Self {
        if self.rows.len() > 1 {
            self.rows.retain(|(name, _)| *name != Name::Cut);
        }
        self
    }

    /// Removes the sums; the terms and the tail add up to the whole.
    pub(crate) fn without_sums(mut self) -> Self {
        self.rows.retain(|(name, _)| !matches!(name, Name::Sum(_)));
        self
    }

    /// A row for each verdict.
    pub(crate) fn verdicts(verdicts: &[VerdictRecord]) -> Self {
        let row = |v: &VerdictRecord| {
            let interval = Cell::Interval(v.interval.0, v.interval.1);
            let cells = [Cell::Difference(v.effect), interval, Cell::P(v.p), Cell::Size(v.min_detectable)];
            (Name::Words(v.name.clone()), cells.into_iter().chain([Cell::Outcome(v.outcome)]).collect())
        };
        let columns = vec![Column::Difference, Column::Interval, Column::P, Column::Detectable, Column::Outcome];
        Self { columns, rows: verdicts.iter().map(row).collect() }
    }

    /// A row for each verdict with its margin, and with what would decide it if it is open.
    pub(crate) fn comparison(comparison: &Comparison) -> Self {
        let records: Vec<_> = comparison.rows.iter().map(|v| VerdictRecord::of(v.name.clone(), v)).collect();
        let mut out = Self::verdicts(&records);
        out.columns.extend([Column::Margin, Column::Cure]);
        for ((_, cells), verdict) in out.rows.iter_mut().zip(&comparison.rows) {
            cells.extend([Cell::Size(verdict.delta), cure(verdict)]);
        }
        out
    }

    /// The cells of the given columns, row by row.
    pub(crate) fn pick(&self, columns: &[Column]) -> impl Iterator<Item = (&Name, Vec<&Cell>)> {
        let places: Vec<_> = columns.iter().filter_map(|c| self.columns.iter().position(|own| own == c)).collect();
        self.rows.iter().map(move |(name, cells)| (name, places.iter().map(|&i| &cells[i]).collect()))
    }
}

fn cure(verdict: &Verdict) -> Cell {
    let samples = verdict.needed_factor.map(|f| format!("{} times the samples", significant(f, 2)));
    let reason = || verdict.reason.as_deref().and_then(|r| r.rsplit(": ").next()).map(String::from);
    samples.or_else(reason).map_or(Cell::Blank, Cell::Words)
}
