//! A comparison as one sentence, for the terminal and for the page.

use super::number::{mark, p_value, significant};
use crate::stats::{Comparison, Outcome, Verdict};

/// The outcome of a comparison of the two results named in `sides`, with its mark: ✓ agrees, ✗ differs, ? inconclusive.
///
/// ```
/// use fredholm::report::text::sentence::sentence;
/// use fredholm::stats::{Comparison, Outcome};
/// let found = Comparison { rows: vec![], family: 0, outcome: Outcome::Inconclusive, undecided: None };
/// assert_eq!(sentence(["A", "B"], &found), "? A and B: they have nothing in common to compare");
/// ```
pub fn sentence(sides: [&str; 2], found: &Comparison) -> String {
    let [a, b] = sides;
    let mark = mark(found.outcome);
    match found.outcome {
        Outcome::Agrees => format!("{mark} {a} = {b}{}", accuracy(found)),
        Outcome::Differs => format!("{mark} {a} ≠ {b}: {}", differences(found)),
        Outcome::Inconclusive => format!("{mark} {a} and {b}: {}", open(found)),
    }
}

/// The largest difference of the whole image that the interval allows, as a fraction of the image: ± 0.13 % is 0.0013. None
/// if the whole image was not compared.
pub fn bound(found: &Comparison) -> Option<f64> {
    found.rows.iter().find(|row| row.name == "total").and_then(reach)
}

/// The largest difference that the interval of a row allows, as a fraction of the quantity.
fn reach(row: &Verdict) -> Option<f64> {
    let reach = row.interval.0.abs().max(row.interval.1.abs()) / row.size;
    reach.is_finite().then_some(reach)
}

fn accuracy(found: &Comparison) -> String {
    let parts = match found.rows.len() {
        1 => String::new(),
        n => format!("; all {n} parts agree"),
    };
    bound(found).map_or(parts.clone(), |x| format!(" to ± {} %{parts}", significant(100.0 * x, 2)))
}

/// The clearest difference, and how many there are.
fn differences(found: &Comparison) -> String {
    let differ = || found.rows.iter().filter(|row| row.outcome == Outcome::Differs);
    let Some(worst) = differ().min_by(|a, b| a.p.total_cmp(&b.p)) else { return "a difference is proved".into() };
    let by = match 100.0 * worst.effect / worst.size {
        x if x.is_finite() => format!("{} %", significant(x, 2).replace('-', "−")),
        _ => significant(worst.effect, 2),
    };
    let others = match differ().count() - 1 {
        0 => String::new(),
        1 => "; 1 other part differs, too".into(),
        n => format!("; {n} other parts differ, too"),
    };
    format!("{} differs by {by} ({}, p = {}){others}", worst.name, worst.functional, p_value(worst.p))
}

/// Undecided parts that are listed by name at most.
const NAMED: usize = 4;

/// What is not decided, and what would decide it.
fn open(found: &Comparison) -> String {
    if let Some(why) = &found.undecided {
        return format!("no verdict, because {why}");
    }
    let open: Vec<&Verdict> = found.rows.iter().filter(|row| row.outcome == Outcome::Inconclusive).collect();
    if open.is_empty() {
        return "they have nothing in common to compare".into();
    }
    let names = match open.len() {
        n if n > NAMED => format!("{n} of {} parts", found.rows.len()),
        _ => open.iter().map(|row| row.name.as_str()).collect::<Vec<_>>().join(", "),
    };
    let remedy = match obstacle(&open) {
        Obstacle::Reason(_, reason) => reason.to_owned(),
        Obstacle::Samples(factor) => format!("{} times the samples will decide", significant(factor, 2)),
        Obstacle::Noise => "more samples will decide".into(),
    };
    format!("no difference found; undecided: {names} ({remedy})")
}

/// Why parts of a comparison are undecided.
pub enum Obstacle<'a> {
    /// A part, and the reason why no number of samples alone decides it.
    Reason(&'a str, &'a str),
    /// The noise; this many times the samples decide all parts.
    Samples(f64),
    /// The noise; the number of samples that would decide is not known.
    Noise,
}

/// The obstacle that some undecided parts have: the first reason other than noise, or else the noise.
pub fn obstacle<'a>(open: &[&'a Verdict]) -> Obstacle<'a> {
    if let Some((name, reason)) = open.iter().find_map(|row| Some((row.name.as_str(), row.reason.as_deref()?))) {
        return Obstacle::Reason(name, reason);
    }
    match open.iter().filter_map(|row| row.needed_factor).fold(0.0, f64::max) {
        0.0 => Obstacle::Noise,
        factor => Obstacle::Samples(factor),
    }
}
