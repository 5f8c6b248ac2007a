//! Sentences for the terminal: lists of words, and lines of at most 80 columns.

use crate::math::names::joined;

/// Columns of a paragraph on the terminal.
pub const WIDTH: usize = 80;

/// A blank at which no line breaks.
const GLUE: char = '\u{a0}';

/// Words as a list: `a`, `a and b`, `a, b and c`.
///
/// ```
/// use fredholm::report::text::prose::listed;
/// assert_eq!(listed(&["a", "b", "c"]), "a, b and c");
/// ```
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    joined(words, "and")
}

/// `1 shape`, `2 shapes`.
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// Breaks sentences into lines of at most [`WIDTH`] columns. A line break in the text stays a line break.
///
/// ```
/// use fredholm::report::text::prose::wrapped;
/// assert!(wrapped(&"word ".repeat(40)).lines().all(|l| l.chars().count() <= 80));
/// ```
pub fn wrapped(text: &str) -> String {
    text.lines().map(|line| wrapped_after(line, "")).collect::<Vec<_>>().join("\n")
}

/// Breaks one line of text into lines of at most [`WIDTH`] columns. Every line after the first begins with `indent`. A number
/// stays with its `%`, `±`, `=` or `≥`, and a command in backticks stays in one line. A word that is longer than a line is not
/// cut, because it may be a path.
pub fn wrapped_after(text: &str, indent: &str) -> String {
    let kept = [" ± ", " = ", " ≥ "]
        .iter()
        .fold(text.replace(" %", "\u{a0}%"), |kept, sign| kept.replace(sign, &sign.replace(' ', "\u{a0}")));
    let mut in_command = false;
    let glued = kept.chars().map(|c| {
        in_command ^= c == '`';
        if in_command && c == ' ' { GLUE } else { c }
    });
    let glued: String = glued.collect();
    let mut lines = vec![];
    let mut line = String::new();
    for word in glued.split(' ').filter(|w| !w.is_empty()) {
        if line.is_empty() {
            line = word.into();
        } else if line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(std::mem::replace(&mut line, format!("{indent}{word}")));
        } else {
            line += " ";
            line += word;
        }
    }
    lines.push(line);
    lines.join("\n").replace(GLUE, " ")
}
