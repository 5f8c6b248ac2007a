//! Which value of a setting is best: in a sentence, and in a small table.

use super::rows::{Row, Sweep};
use crate::report::text::{
    number::significant,
    prose::{listed, wrapped},
    ranking::{Candidate, Ranking},
    table::{Side, aligned},
};
use crate::terms::variance::Variance;

/// Terms with a column of their own, besides the whole image and the tail.
const TERMS: usize = 5;
/// Most lines of the table.
const MOST: usize = 10;
/// From this share of T0 in the variance on, the reader is told that T0 dominates.
const DOMINANT: f64 = 0.5;

/// The values of a setting, in the plural.
fn plural(over: &str) -> &'static str {
    match over {
        "branching" => "numbers of children per vertex",
        "technique" => "techniques",
        "sampling" => "ways to sample directions",
        "estimator" => "estimators",
        "points" => "point sets",
        "roulette" => "roulette schedules",
        _ => "values",
    }
}

/// A value with the work V · rays of the whole path for the variance `v` of a slot; the slot after the last is the sum.
fn candidate(r: &Row, slot: usize, v: &Variance) -> Candidate {
    let without = r.without.get(slot).map_or(vec![], |all| all.iter().map(|v| v * r.rays_per_path()).collect());
    Candidate {
        without,
        name: r.value.clone(),
        work: v.value * r.rays_per_path(),
        relative_error: v.std_error / v.value,
        replicates: r.image.total.replicates,
    }
}

/// Returns true if the variance of the whole image is finite, so that its measured value means something.
fn finite(r: &Row) -> bool {
    r.known == crate::terms::Variance::Finite
}

fn whole(sweep: &Sweep) -> Ranking {
    Ranking::new(sweep.rows.iter().filter(|r| finite(r)).map(|r| candidate(r, r.variance.len(), &r.total)).collect())
}

/// The answer in one sentence: the value that needs the fewest rays for the same error of the whole image. A second sentence
/// says if the variance of a value is infinite, a third if T0 dominates the variance.
pub fn answer(sweep: &Sweep) -> String {
    let spp = sweep.rows.iter().map(|r| r.spp).min().unwrap_or(0);
    let noise = format!("{spp} samples per pixel");
    let mut out = vec![whole(sweep).sentence(plural(&sweep.over), "the whole image", &noise)];
    let infinite: Vec<String> = sweep.rows.iter().filter(|r| !finite(r)).map(|r| format!("`{}`", r.value)).collect();
    if !infinite.is_empty() {
        out.push(format!(
            "Left out: {}, whose variance is infinite or not known to be finite, so that its measured value means nothing.",
            listed(&infinite)
        ));
    }
    let share = |r: &Row| r.variance.first().map_or(0.0, |v| v.value / r.total.value);
    let shares: Vec<f64> = sweep.rows.iter().filter(|r| finite(r)).map(share).collect();
    let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
    let most = shares.iter().copied().fold(0.0, f64::max);
    if most > DOMINANT {
        let percent = |x: f64| format!("{:.0}", 100.0 * x);
        let range = if percent(least) == percent(most) {
            percent(most)
        } else {
            format!("{} to {}", percent(least), percent(most))
        };
        out.push(format!(
            "T0, emission seen directly, makes up {range} % of this variance; for reflected light read the columns T1, T2, …."
        ));
    }
    wrapped(&out.join(" "))
}

/// The table: rays and time of a path, and the rays for the same error relative to the best value, for the whole image and
/// for the first terms.
pub fn small_table(sweep: &Sweep) -> String {
    let terms = sweep.rows.iter().map(|r| r.image.terms.len()).max().unwrap_or(0);
    let shown = terms.min(TERMS);
    let tail = sweep.rows.iter().any(|r| !r.image.tail.is_none() && finite(r));
    let slot = |k: usize| {
        let sampled = |r: &&Row| k < terms || (!r.image.tail.is_none() && finite(r));
        let of = |r: &Row| r.variance.get(k).map(|v| candidate(r, k, v));
        Ranking::new(sweep.rows.iter().filter(sampled).filter_map(of).collect())
    };
    let mut columns: Vec<(String, Ranking)> = (0..shown).map(|k| (format!("T{k}"), slot(k))).collect();
    if tail {
        columns.push(("tail".into(), slot(terms)));
    }
    let whole = whole(sweep);
    let mut header = vec![sweep.over.clone(), "rays/path".into(), "µs/path".into(), "whole image".into()];
    header.extend(columns.iter().map(|c| c.0.clone()));
    let mut lines = vec![header];
    let mut cut = false;
    for r in sweep.rows.iter().take(MOST) {
        let mark = if r.image.tail.is_none() { "*" } else { "" };
        cut |= r.image.tail.is_none();
        let mut cells = vec![
            format!("{}{mark}", r.value),
            significant(r.rays_per_path(), 3),
            significant(1e6 * r.seconds / r.paths as f64, 2),
            whole.cell_with_error(&r.value),
        ];
        cells.extend(columns.iter().map(|c| c.1.cell(&r.value)));
        lines.push(cells);
    }
    let mut out = wrapped(
        "Rays for the same error, relative to the best value of each column: 1 is the best, 2 needs twice as many rays \
         (whole image: ± 95 %).",
    );
    out += "\n";
    out += &aligned(&lines, &[[Side::Left].as_slice(), &[Side::Right; 9]].concat());
    if cut {
        out += "* paths are cut at K: the tail is missing\n";
    }
    if sweep.rows.len() > MOST {
        out += &format!("{} more values: --verbose\n", sweep.rows.len() - MOST);
    }
    out
}
