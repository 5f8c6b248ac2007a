//! Markdown tables for the book: each chapter writes its results into files that its text includes.

use super::{
    number::{average, count, dash, mark, outcome, plus_minus, significant},
    rows::{Cell, Column, Name, Rows},
};
use crate::stats::Comparison;
use crate::terms::Functional;

/// A statement of the book, the result of a run, and whether the result confirms it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// The statement.
    pub says: &'static str,
    /// The result, in a few words.
    pub found: String,
    /// True if the result confirms the statement.
    pub holds: bool,
}

/// A table; the first column is aligned to the left, all others to the right.
///
/// ```
/// let rows = [["0".to_string(), "1.5".into()], ["1".to_string(), "0.7".into()]];
/// let page = fredholm::report::text::markdown::table(&["k", "mean"], &rows);
/// assert_eq!(page, "| k | mean |\n|:---|---:|\n| 0 | 1.5 |\n| 1 | 0.7 |\n");
/// ```
pub fn table<S: AsRef<str>, R: AsRef<[String]>>(header: &[S], rows: &[R]) -> String {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let sides: String = (0..header.len()).map(|c| if c == 0 { ":---|" } else { "---:|" }).collect();
    let rows = rows.iter().map(|r| line(r.as_ref().iter().map(String::as_str).collect()));
    format!("{}|{sides}\n{}", line(header.iter().map(AsRef::as_ref).collect()), rows.collect::<String>())
}

/// A table of claims with their results.
pub fn claims(claims: &[Claim]) -> String {
    let row = |c: &Claim| [c.says.to_string(), c.found.clone(), if c.holds { "✓" } else { "✗" }.to_string()];
    table(&["claim", "found", ""], &claims.iter().map(row).collect::<Vec<_>>())
}

/// Several series in one table: a row per term, then the tail and the whole. The second column is the share of each term in
/// the whole of the first series. A path tracer has only the row of the whole.
pub fn terms(columns: &[(&str, &Functional)]) -> String {
    let (names, worlds): (Vec<_>, Vec<_>) = columns.iter().copied().unzip();
    let whole = worlds.iter().map(|f| average(&f.total).0).fold(0.0, f64::max);
    let thousands = if whole > 0.0 { (whole.log10() / 3.0).floor() as i32 } else { 0 };
    let unit = 10f64.powi(-3 * thousands);
    let shown: Vec<_> = [Column::Share].into_iter().chain((0..worlds.len()).map(Column::World)).collect();
    let header: Vec<&str> = ["k", "share"].into_iter().chain(names).collect();
    let rows = lines(&Rows::series(&worlds, &[]).without_sums(), &shown, unit);
    let scale = if thousands == 0 { String::new() } else { format!("10<sup>{}</sup> ", 3 * thousands) };
    let note = format!("Radiance in {scale}W sr⁻¹ m⁻², mean of the channels; ± half a 95 % interval.");
    format!("{}\n{note}\n", table(&header, &rows))
}

/// The verdicts of a comparison: the difference, its interval, the margin, the verdict, and what is needed to decide an
/// inconclusive row.
pub fn verdicts(name: &str, comparison: &Comparison) -> String {
    let columns = [Column::Difference, Column::Interval, Column::Margin, Column::Outcome, Column::Cure];
    let rows = lines(&Rows::comparison(comparison), &columns, 1.0);
    table(&[name, "difference", "interval", "δ", "verdict", "needed to decide"], &rows)
}

/// The rows as text, with radiance in multiples of 1/`unit`.
fn lines(rows: &Rows, columns: &[Column], unit: f64) -> Vec<Vec<String>> {
    let name = |name: &Name| match name {
        Name::Tail(last) => format!("&gt; {last}"),
        Name::Cut => Name::Whole.to_string(),
        other => other.to_string(),
    };
    let row = |(n, cells): (&Name, Vec<&Cell>)| {
        [name(n)].into_iter().chain(cells.into_iter().map(|cell| words(cell, unit))).collect()
    };
    rows.pick(columns).map(row).collect()
}

/// Formats a cell. An estimate is rounded to the first digit of the half width of its 95 % interval.
fn words(cell: &Cell, unit: f64) -> String {
    match cell {
        Cell::Blank => String::new(),
        Cell::Words(words) => words.clone(),
        Cell::Estimate(e) => {
            let (mean, half) = average(e);
            plus_minus(mean * unit, half * unit, 1)
        }
        Cell::Share(share) => format!("{} %", significant(100.0 * share, 2)),
        Cell::Interval(low, high) => {
            let [low, high] = [low, high].map(|v| significant(*v, 2));
            format!("{low} to {high}").replace('-', "−").replace("e−", "e-")
        }
        Cell::Ratio(v) | Cell::Difference(v) | Cell::P(v) | Cell::Size(v) => significant(*v, 2),
        Cell::Rays(rays) => rays.map_or_else(dash, count),
        Cell::Outcome(found) => format!("{} {}", mark(*found), outcome(*found)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::Estimate;
    use glam::DVec3;

    #[test]
    fn series_stand_side_by_side_in_one_unit_and_a_path_tracer_has_no_terms() {
        let of = |m: f64, s: f64| Estimate {
            mean: DVec3::splat(m),
            std_error: DVec3::splat(s),
            replicates: 16,
            events: None,
        };
        let exact = |m: f64| Estimate::exact(DVec3::splat(m));
        let name = String::new;
        let a = Functional {
            name: name(),
            terms: vec![of(0.03, 0.0002), of(0.01, 0.00001)],
            tail: of(0.01, 0.002),
            sum: of(0.04, 0.0),
            total: of(0.05, 0.002),
        };
        let b = Functional { name: name(), terms: vec![], tail: exact(0.0), sum: exact(0.0), total: exact(0.05) };
        let expected = "| k | share | a | b |\n|:---|---:|---:|---:|\n\
            | 0 | 60 % | 30.0 ± 0.4 |  |\n| 1 | 20 % | 10.00 ± 0.02 |  |\n| &gt; 1 | 20 % | 10 ± 4 |  |\n\
            | all | 100 % | 50 ± 4 | 50.00 |\n";
        let page = terms(&[("a", &a), ("b", &b)]);
        assert!(page.starts_with(expected), "{page}");
        assert!(page.contains("10<sup>-3</sup>"));
    }
}
