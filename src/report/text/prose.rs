//! Sentences for the terminal: lists of words, and lines of at most 80 columns.

use crate::report::image::typeset::wrap;

/// Columns of a line.
const COLUMNS: usize = 80;

/// Words as a list: `a`, `a and b`, `a, b and c`.
///
/// ```
/// use fredholm::report::text::prose::listed;
/// assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
/// ```
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [one] => one.as_ref().into(),
        [first @ .., last] => {
            let first: Vec<&str> = first.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", first.join(", "), last.as_ref())
        }
    }
}

/// Breaks sentences into lines of at most 80 columns. `± 0.5`, `64 %` and the like stay together.
///
/// ```
/// use fredholm::report::text::prose::wrapped;
/// assert!(wrapped(&"word ".repeat(40)).lines().all(|l| l.chars().count() <= 80));
/// ```
pub fn wrapped(text: &str) -> String {
    let kept = text.replace(" ± ", "\u{a0}±\u{a0}").replace(" %", "\u{a0}%").replace(" ≥ ", "\u{a0}≥\u{a0}");
    wrap(&kept, |line| line.chars().count() <= COLUMNS).join("\n").replace('\u{a0}', " ")
}
