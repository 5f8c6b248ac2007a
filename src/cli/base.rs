//! How a command ends, and how it speaks: results to stdout, everything else to stderr.

/// How a command ends when it does not end well.
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
    /// Something is wrong with the scene or a file, in words that may say so already.
    pub fn input(text: &str) -> Self {
        Self::Input(if text.starts_with("error: ") { text.into() } else { format!("error: {text}") })
    }
}

/// The arguments do not make sense together: what is wrong, and what would help.
pub fn usage(what: &str, help: &str) -> Failure {
    Failure::Usage(format!("error: {what}\nhelp: {help}"))
}

/// How a command ends well, or nearly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All is well.
    Ok,
    /// A comparison failed.
    Failed,
    /// Interrupted; what exists is saved.
    Interrupted,
}

/// Prints to stdout, with a final newline. A reader that has seen enough (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Failure> {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Input(format!("error: cannot print the result: {e}\nhelp: check where stdout goes")))
        }
        _ => Ok(()),
    }
}

/// Prints a note to stderr; if nobody listens there, so be it.
pub fn note(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Blocks of text with one blank line between them; empty ones leave nothing.
pub fn paragraphs<S: AsRef<str>>(blocks: &[S]) -> String {
    let blocks = blocks.iter().map(|b| b.as_ref().trim_end()).filter(|b| !b.is_empty());
    blocks.collect::<Vec<_>>().join("\n\n")
}

/// Names as a list of files.
pub fn names<const N: usize>(all: [&str; N]) -> Vec<String> {
    all.map(String::from).into()
}
