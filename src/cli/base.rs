//! How a command ends and what it prints: results to stdout, everything else to stderr.

use fredholm::math::names::{hides, printable};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// An error that ends a command.
pub enum Failure {
    /// Something is wrong with the scene or a file: exit code 3.
    Input(String),
    /// The arguments do not make sense together: exit code 2.
    Usage(String),
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(e: E) -> Self {
        Self::input(&e.to_string())
    }
}

impl Failure {
    /// Something is wrong with a file or a folder: what, where, and what to do.
    pub fn at(path: &Path, what: &str, help: &str) -> Self {
        Self::Input(format!("error: {what}\n  --> {}\nhelp: {help}", path.display()))
    }

    /// Something is wrong with the scene or a file. Adds `error: ` to the text unless it is there.
    pub fn input(text: &str) -> Self {
        Self::Input(if text.starts_with("error: ") { text.into() } else { format!("error: {text}") })
    }
}

/// The error for arguments that do not make sense together: what is wrong, and what to do.
pub fn usage(what: &str, help: &str) -> Failure {
    Failure::Usage(format!("error: {what}\nhelp: {help}"))
}

/// Locks a value that no panic can leave half-changed.
pub fn lock<T>(m: &Mutex<T>) -> MutexGuard<'_, T> {
    m.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How a command ends if nothing prevents its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Success.
    Ok,
    /// A comparison failed.
    Failed,
    /// Interrupted; what exists is saved.
    Interrupted,
}

/// Prints to stdout, with a final newline. Control characters, which a terminal may obey, are printed as `\u{…}`. A closed pipe (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{}", printable(text.trim_end())).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Input(format!("error: cannot print the result: {e}\nhelp: check where stdout goes")))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON. What a terminal could obey is escaped as JSON does it.
pub fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json(&serde_json::to_string_pretty(value)?))
}

/// Escapes the characters that `printable` would change, all of which are inside strings.
fn json(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        if c != '\n' && hides(c) {
            out += &format!("\\u{:04x}", c as u32)
        } else {
            out.push(c)
        }
        out
    })
}

/// Prints a note to stderr, control characters as `\u{…}`. A closed stderr is no error.
pub fn note(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{}", printable(text));
}

/// Joins blocks of text with one blank line between them; empty blocks are left out.
pub fn paragraphs<S: AsRef<str>>(blocks: &[S]) -> String {
    let blocks = blocks.iter().map(|b| b.as_ref().trim_end()).filter(|b| !b.is_empty());
    blocks.collect::<Vec<_>>().join("\n\n")
}

/// The names as owned strings, for the list of files.
pub fn names<const N: usize>(all: [&str; N]) -> Vec<String> {
    all.map(String::from).into()
}

#[cfg(test)]
mod tests {
    use super::json;

    #[test]
    fn json_keeps_its_strings() {
        let name = "a\u{202e}b\u{9b}c\u{7f}\n\u{1b}é";
        let text = json(&serde_json::to_string_pretty(&[name]).unwrap_or_default());
        assert!(!text.chars().any(|c| c != '\n' && (c.is_control() || c == '\u{202e}')));
        assert_eq!(serde_json::from_str::<Vec<String>>(&text).ok(), Some(vec![name.to_string()]));
    }
}
