//! How a command ends and what it prints: results to stdout, everything else to stderr.

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
    /// Something is wrong with the scene or a file. Adds `error: ` to the text unless it is there.
    pub fn input(text: &str) -> Self {
        Self::Input(if text.starts_with("error: ") { text.into() } else { format!("error: {text}") })
    }
}

/// The error for arguments that do not make sense together: what is wrong, and what to do.
pub fn usage(what: &str, help: &str) -> Failure {
    Failure::Usage(format!("error: {what}\nhelp: {help}"))
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

/// Prints to stdout, with a final newline. A closed pipe (`| head`) is no error.
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

/// Prints a note to stderr. A closed stderr is no error.
pub fn note(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Joins blocks of text with one blank line between them; empty blocks are left out.
pub fn paragraphs<S: AsRef<str>>(blocks: &[S]) -> String {
    let blocks = blocks.iter().map(|b| b.as_ref().trim_end()).filter(|b| !b.is_empty());
    blocks.collect::<Vec<_>>().join("\n\n")
}

/// Columns of a paragraph on the terminal.
pub const WIDTH: usize = 80;

/// Sentences in lines of at most [`WIDTH`] columns. A line break in the text stays a line break.
pub fn wrapped(text: &str) -> String {
    text.lines().map(|line| wrapped_after(line, "")).collect::<Vec<_>>().join("\n")
}

/// One line of text in lines of at most [`WIDTH`] columns; every line after the first begins with `indent`. A number stays
/// with its `%` and its `±`, and a command in backticks stays in one line.
pub fn wrapped_after(text: &str, indent: &str) -> String {
    const GLUE: char = '\u{a0}';
    let mut in_command = false;
    let mut glued = String::new();
    for c in text.replace(" %", "\u{a0}%").replace(" ± ", "\u{a0}±\u{a0}").replace(" = ", "\u{a0}=\u{a0}").chars() {
        in_command ^= c == '`';
        glued.push(if in_command && c == ' ' { GLUE } else { c });
    }
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

/// `a`, `a and b`, `a, b and c`.
pub fn and<S: AsRef<str>>(all: &[S]) -> String {
    match all {
        [] => String::new(),
        [one] => one.as_ref().to_owned(),
        [first @ .., last] => {
            format!("{} and {}", first.iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", "), last.as_ref())
        }
    }
}

/// `1 shape`, `2 shapes`.
pub fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// The names as owned strings, for the list of files.
pub fn names<const N: usize>(all: [&str; N]) -> Vec<String> {
    all.map(String::from).into()
}
