//! Commands: each folder or file parses its own arguments, calls the library and reports.
//!
//! ```text
//! base ← choices, options, suggest, open, output, progress, preflight, notes, answer, write ← session ← commands ← here
//! here → help (layout of the help), mistyped (errors of the command line), pages, markdown (completions, man pages, the page of the book)
//! ```
//!
//! Results go to stdout, progress and errors to stderr. Exit codes: 0 ok, 1 a comparison failed, 2 usage, 3 scene or file,
//! 130, 143 or 129 ended by a signal (Ctrl-C, SIGTERM, SIGHUP) with what exists saved.
#![allow(clippy::print_stdout, clippy::print_stderr)]
#![allow(unreachable_pub)] // in a binary `pub` reaches no further than `pub(crate)` and reads better

mod answer;
mod base;
mod book;
mod chapter;
mod check;
mod choices;
mod claim;
mod compare;
mod diagnose;
mod exercise;
mod export;
mod figure;
mod help;
mod info;
mod keep;
mod markdown;
mod merge;
mod mistyped;
mod notes;
mod open;
mod options;
mod output;
mod pages;
mod preflight;
mod programs;
mod progress;
mod radiosity;
mod roulette;
mod session;
mod signals;
mod slurm;
mod solve;
mod suggest;
mod sweep;
mod verdict;
mod walk;
mod write;
mod zoo;

use base::{Ending, Failure, note};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// The operator view of global illumination: L = E + T L = Σ T^k E, measured
#[derive(Debug, Parser)]
#[command(name = "fredholm", version, max_term_width = 100)]
#[command(long_about = help::ABOUT, after_help = help::SHORT, after_long_help = help::EXAMPLES)]
#[command(override_usage = "fredholm [SCENE]\n       fredholm <COMMAND>")]
struct Cli {
    /// The command.
    #[command(subcommand)]
    command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
enum Command {
    /// Solves one scene in three ways and compares them (the default)
    #[command(after_long_help = solve::help::TOUR)]
    Tour(solve::Tour),
    /// Estimates each T^k E and the sum; compares path tracer and matrix
    #[command(after_long_help = solve::help::SERIES)]
    Series(solve::Series),
    /// Renders with the path tracer alone
    #[command(after_long_help = solve::help::RENDER)]
    Render(solve::Render),
    /// Solves with the matrix alone: form factors, solvers, modes
    #[command(after_long_help = solve::help::RADIOSITY)]
    Radiosity(radiosity::Radiosity),
    /// Puts the parts of a run together: the bits of one run
    #[command(after_long_help = merge::HELP)]
    Merge(merge::Merge),
    /// Prints a script that renders on a Slurm cluster
    #[command(after_long_help = slurm::HELP)]
    Slurm(slurm::Slurm),
    /// Compares two results: a verdict per term, a map of z
    #[command(after_long_help = compare::HELP)]
    Compare(compare::Compare),
    /// Checks another renderer's pictures, and names the mistake
    #[command(after_long_help = diagnose::HELP)]
    Diagnose(diagnose::Diagnose),
    /// Varies one setting: cost and variance of the terms
    #[command(after_long_help = sweep::HELP)]
    Sweep(sweep::Sweep),
    /// Runs the estimators on the radiosity matrix, where T^k E is known
    #[command(after_long_help = walk::HELP)]
    Walk(walk::Walk),
    /// Tests if an estimator is biased, or if L = E + T L holds
    #[command(after_long_help = check::HELP)]
    Check(check::Check),
    /// Makes a figure: data, pictures, and the command that makes them
    #[command(after_long_help = figure::HELP)]
    Figure(figure::Figure),
    /// Predicts, verifies and optimises Russian roulette
    #[command(after_long_help = roulette::HELP)]
    Roulette(roulette::Args),
    /// Shows estimators that are wrong on purpose
    #[command(after_long_help = zoo::HELP)]
    Zoo(zoo::Zoo),
    /// Lists scenes, or describes one: materials, lights, bounds on ‖T‖
    #[command(after_long_help = info::HELP)]
    Info(info::Info),
    /// Writes a scene for Mitsuba 3 or pbrt-v4
    #[command(after_long_help = export::HELP)]
    Export(export::Export),
    /// Runs a chapter of the book
    #[command(after_long_help = chapter::HELP)]
    Chapter(chapter::Options),
    /// Asks an exercise with your own numbers, and judges the answer
    #[command(after_long_help = exercise::HELP)]
    Exercise(exercise::Options),
    /// Opens the book in the browser
    #[command(after_long_help = book::HELP)]
    Book(book::Options),
    /// Prints a script that completes commands in a shell
    #[command(after_long_help = pages::COMPLETIONS)]
    Completions(pages::Completions),
    /// Prints the man page, or writes one for every command
    #[command(after_long_help = pages::MAN)]
    Man(pages::Man),
}

/// The program: parses the command line, runs the command, and returns its exit code.
pub fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    let command = help::arranged(Cli::command(), words.iter().any(|w| w == "-h"));
    let result = mistyped::with_command(words, &command).and_then(|words| {
        let parsed = command.clone().try_get_matches_from(&words).and_then(|m| Cli::from_arg_matches(&m));
        match parsed {
            Ok(cli) => run(&cli.command, &command),
            // help and version are asked for; clap prints them to stdout, and a closed pipe (`| head`) is no error
            Err(e) if !e.use_stderr() => match e.print() {
                Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(e.into()),
                _ => Ok(Ending::Ok),
            },
            Err(e) => Err(Failure::Usage(mistyped::explain(&e, &command, &words))),
        }
    });
    match result {
        Ok(Ending::Ok) => ExitCode::SUCCESS,
        Ok(Ending::Failed) => ExitCode::from(1),
        Ok(Ending::Interrupted) => ExitCode::from(signals::exit_code()),
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

fn run(command: &Command, all: &clap::Command) -> Result<Ending, Failure> {
    match command {
        Command::Tour(args) => solve::tour(args),
        Command::Series(args) => solve::series(args),
        Command::Render(args) => solve::render(args),
        Command::Radiosity(args) => radiosity::run(args),
        Command::Merge(args) => merge::run(args, all),
        Command::Slurm(args) => slurm::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Diagnose(args) => diagnose::run(args),
        Command::Sweep(args) => sweep::run(args),
        Command::Walk(args) => walk::run(args),
        Command::Check(args) => check::run(args),
        Command::Figure(args) => figure::run(args),
        Command::Roulette(args) => roulette::run(args),
        Command::Zoo(args) => zoo::run(args),
        Command::Info(args) => info::run(args),
        Command::Export(args) => export::run(args),
        Command::Chapter(args) => chapter::run(args),
        Command::Exercise(args) => exercise::run(args),
        Command::Book(args) => book::run(args),
        Command::Completions(args) => pages::completions(args, all),
        Command::Man(args) => pages::man(args, all),
    }
}
