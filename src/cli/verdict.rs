//! A comparison in one sentence: `compare` and `walk` begin with it.

use super::notes;
use fredholm::report::text::prose::listed;
use fredholm::report::text::sentence::{Obstacle, obstacle};
use fredholm::stats::{Comparison, Criterion, Outcome, Verdict};

/// Names that a sentence lists; more are counted.
const NAMED: usize = 5;

/// The outcome of a comparison of `who` in one sentence, and in a second one what would decide what is not decided.
///
/// `who` is a plural, such as "the two results".
pub fn sentence(who: &str, c: &Comparison, criterion: &Criterion) -> String {
    if let Some(why) = &c.undecided {
        return notes::undecided(why);
    }
    let delta = delta(criterion);
    let with = |outcome: Outcome| -> Vec<&Verdict> { c.rows.iter().filter(|r| r.outcome == outcome).collect() };
    match c.outcome {
        _ if c.rows.is_empty() => format!("{who} have nothing in common to compare."),
        Outcome::Agrees => format!("{who} agree: every difference is proved smaller than {delta}."),
        Outcome::Differs => format!(
            "{who} differ in {}: if they were equal, this would happen with a probability of at most {}.",
            named(&with(Outcome::Differs)),
            criterion.alpha
        ),
        Outcome::Inconclusive => {
            let open = with(Outcome::Inconclusive);
            format!(
                "{who} do not contradict each other, but {} cannot be decided.\n{}",
                named(&open),
                remedy(&open, &delta)
            )
        }
    }
}

/// δ in words: `2 % of the term (plus 0.01 % of the whole image)`.
pub fn delta(criterion: &Criterion) -> String {
    let percent = |x: f64| format!("{} %", (1e6 * x).round() / 1e4);
    let plus = match criterion.of_total {
        x if x > 0.0 => format!(" (plus {} of the whole image)", percent(x)),
        _ => String::new(),
    };
    format!("{} of the term{plus}", percent(criterion.of_term))
}

/// The names of the quantities. If there are too many, the first few and the number of the others.
fn named(rows: &[&Verdict]) -> String {
    let names: Vec<&str> = rows.iter().map(|r| r.name.as_str()).collect();
    if names.len() > NAMED {
        format!("{} and {} more", names[..NAMED - 1].join(", "), names.len() - NAMED + 1)
    } else {
        listed(&names)
    }
}

/// The number of samples that would decide, or the other reason why nothing is decided.
fn remedy(open: &[&Verdict], delta: &str) -> String {
    let noise = format!("The noise hides differences as small as {delta}");
    match obstacle(open) {
        Obstacle::Reason(name, reason) => format!("The reason for {name}: {reason}."),
        Obstacle::Samples(factor) => format!("{noise}; with {factor:.1} times the samples there will be a verdict."),
        Obstacle::Noise => format!("{noise}."),
    }
}
