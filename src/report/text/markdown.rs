//! Tables for the pages of the book: what a chapter found, as Markdown that its text includes.

use crate::report::text::table::{average, mark, outcome, plus_minus, significant};
use crate::stats::{Comparison, Verdict};
use crate::terms::{Estimate, Functional};

/// A sentence of a text, what a run found, and whether the sentence holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    /// The sentence.
    pub says: &'static str,
    /// What was found, in a few words.
    pub found: String,
    /// Whether it holds.
    pub holds: bool,
}

/// A table with its first column to the left and all others to the right.
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

/// Claims with what was found.
pub fn claims(claims: &[Claim]) -> String {
    let row = |c: &Claim| [c.says.to_string(), c.found.clone(), if c.holds { "✓" } else { "✗" }.to_string()];
    table(&["claim", "found", ""], &claims.iter().map(row).collect::<Vec<_>>())
}

/// Series side by side: a row per term, then the tail and the whole. The second column is the share of each term in the
/// whole of the first series; a path tracer has a whole only.
pub fn terms(columns: &[(&str, &Functional)]) -> String {
    let whole = columns.iter().map(|c| average(&c.1.total).0).fold(0.0, f64::max);
    let thousands = if whole > 0.0 { (whole.log10() / 3.0).floor() as i32 } else { 0 };
    let unit = 10f64.powi(-3 * thousands);
    let count = columns.iter().map(|c| c.1.terms.len()).max().unwrap_or(0);
    let row = |name: String, of: &dyn Fn(&Functional) -> Option<Estimate>| {
        let share = columns.first().and_then(|c| Some(average(&of(c.1)?).0 / average(&c.1.total).0));
        let share = share.map_or(String::new(), |s| format!("{} %", significant(100.0 * s, 2)));
        let values = columns.iter().map(|c| of(c.1).map_or(String::new(), |e| value(&e, unit)));
        [name, share].into_iter().chain(values).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = (0..count).map(|k| row(k.to_string(), &|f| f.terms.get(k).copied())).collect();
    if let Some(last) = count.checked_sub(1) {
        rows.push(row(format!("&gt; {last}"), &|f| (!f.terms.is_empty()).then_some(f.tail)));
    }
    rows.push(row("all".into(), &|f| Some(f.total)));
    let header: Vec<&str> = ["k", "share"].into_iter().chain(columns.iter().map(|c| c.0)).collect();
    let scale = if thousands == 0 { String::new() } else { format!("10<sup>{}</sup> ", 3 * thousands) };
    let note = format!("Radiance in {scale}W sr⁻¹ m⁻², mean of the channels; ± half a 95 % interval.");
    format!("{}\n{note}\n", table(&header, &rows))
}

/// The verdicts of a comparison: where each difference may lie, the margin, and what would decide what is undecided.
pub fn verdicts(name: &str, comparison: &Comparison) -> String {
    let row = |v: &Verdict| {
        let [effect, low, high, delta] = [v.effect, v.interval.0, v.interval.1, v.delta].map(|x| significant(x, 2));
        let samples = v.needed_factor.map(|f| format!("{} times the samples", significant(f, 2)));
        let cure = v.reason.as_deref().and_then(|r| r.rsplit(": ").next()).map(String::from);
        let judged = format!("{} {}", mark(v.outcome), outcome(v.outcome));
        let interval = format!("{low} to {high}").replace('-', "−").replace("e−", "e-");
        [v.name.clone(), effect, interval, delta, judged, samples.or(cure).unwrap_or_default()]
    };
    let rows: Vec<_> = comparison.rows.iter().map(row).collect();
    table(&[name, "difference", "it lies in", "δ", "verdict", "would decide"], &rows)
}

/// Mean over channels and half its 95 % interval, in multiples of 1/`unit`, to the first digit of the latter.
fn value(estimate: &Estimate, unit: f64) -> String {
    let (mean, half) = average(estimate);
    plus_minus(mean * unit, half * unit, 1)
}

#[cfg(test)]
mod tests {
    use super::*;
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
