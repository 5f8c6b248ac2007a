//! One file per subcommand; arguments are plain structs.
//!
//! Results go to stdout, progress and errors to stderr. Exit codes: 0 ok, 1 a comparison failed, 2 usage, 3 scene or file,
//! 130 interrupted with what exists saved.
#![allow(clippy::print_stdout, clippy::print_stderr)]
#![allow(unreachable_pub)] // in a binary `pub` reaches no further than `pub(crate)` and reads better

pub mod args;
mod chapter;
mod check;
mod compare;
mod diagnose;
mod figure;
mod info;
mod notes;
mod open;
mod output;
mod preflight;
mod progress;
mod quiz;
mod radiosity;
mod roulette;
mod solve;
mod sweep;
mod sweep_patches;
mod sweep_split;
mod sweep_spp;
mod walk;
mod write;
mod zoo;

use args::{Cli, Command};
use std::process::ExitCode;

/// How a command ends when it does not end well.
pub enum Failure {
    /// Something is wrong with the scene or a file: exit code 3.
    Input(String),
    /// The arguments do not make sense together: exit code 2.
    Usage(String),
}

impl<E: std::error::Error> From<E> for Failure {
    fn from(e: E) -> Self {
        let text = e.to_string();
        Self::Input(if text.starts_with("error: ") { text } else { format!("error: {text}") })
    }
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

/// Runs a command to its exit code.
pub fn run(cli: Cli) -> ExitCode {
    let result = match &cli.command {
        None => solve::tour(&cli.tour),
        Some(Command::Tour(run)) => solve::tour(run),
        Some(Command::Series(run)) => solve::series(run),
        Some(Command::Render(run)) => solve::render(run),
        Some(Command::Radiosity(args)) => radiosity::run(args),
        Some(Command::Compare(args)) => compare::run(args),
        Some(Command::Diagnose(args)) => diagnose::run(args),
        Some(Command::Sweep(args)) => sweep::run(args),
        Some(Command::Walk(args)) => walk::run(args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Figure(args)) => figure::run(args),
        Some(Command::Roulette(args)) => roulette::run(args),
        Some(Command::Zoo(args)) => zoo::run(args),
        Some(Command::Info(args)) => info::run(args),
        Some(Command::Chapter(args)) => chapter::run(args),
    };
    match result {
        Ok(Ending::Ok) => ExitCode::SUCCESS,
        Ok(Ending::Failed) => ExitCode::from(1),
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(Failure::Usage(text)) => {
            note(&text);
            ExitCode::from(2)
        }
        Err(Failure::Input(text)) => {
            note(&text);
            ExitCode::from(3)
        }
    }
}
