//! `fredholm merge FILES`: the parts of a run, made by `--shard`, as one result.
//!
//! The parts hold the films, and the rows of stored rays. Everything else, such as the matrix, norms and comparisons, is computed here, once, by the command that
//! the parts name.

use super::base::{Ending, Failure};
use super::keep::Merged;
use super::options::{OUTPUT, WHAT};
use super::output::without;
use super::radiosity::Radiosity;
use super::solve::{self, Request};
use clap::{ArgMatches, Args, Command, FromArgMatches, ValueHint};
use std::path::PathBuf;

/// Below `merge --help`.
pub const HELP: &str = "Examples:
  fredholm series cornell --spp 4096 --shard 1/2 -o 1.fsh
  fredholm series cornell --spp 4096 --shard 2/2 -o 2.fsh
  fredholm merge 1.fsh 2.fsh -o cornell-4096

The pictures and numbers have the bits of `fredholm series cornell --spp 4096`. Parts of another run, of another scene or version, parts \
that are missing, unfinished, damaged or given twice are refused by name. One exception: with the estimators light and \
bidirectional, variance.svg has only its last point, and the page has no pictures of the first samples.";

/// Arguments of `merge`.
#[derive(Clone, Debug, Args)]
pub struct Merge {
    /// All parts of a run, in any order
    #[arg(value_name = "FILE", required = true, help_heading = WHAT, value_hint = ValueHint::FilePath)]
    pub files: Vec<PathBuf>,
    /// Output folder [default: that of the undivided run]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Threads [default: all]
    #[arg(short, long, value_name = "N", help_heading = OUTPUT, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print JSON instead of tables
    #[arg(long, help_heading = OUTPUT)]
    pub json: bool,
    /// Print no progress
    #[arg(short, long, help_heading = OUTPUT)]
    pub quiet: bool,
    /// Print every number behind the answer
    #[arg(short, long, help_heading = OUTPUT)]
    pub verbose: bool,
}

/// Merges the parts; `all` describes the command line, by which the command of the parts is read.
pub fn run(args: &Merge, all: &Command) -> Result<Ending, Failure> {
    let merged = Merged::open(&args.files)?;
    let words = ["fredholm".to_string()].into_iter().chain(without(&merged.header.words, &["--shard"], &[]));
    let matches = all.clone().try_get_matches_from(words).map_err(|_| strange())?;
    let (mut request, default) = match matches.subcommand() {
        Some(("series", m)) => (Request::from(&parsed::<solve::Series>(m)?), solve::SERIES),
        Some(("render", m)) => (Request::from(&parsed::<solve::Render>(m)?), solve::RENDER),
        Some(("radiosity", m)) => {
            let radiosity = parsed::<Radiosity>(m)?;
            (Request::from(&radiosity), solve::of_radiosity(radiosity.export))
        }
        _ => return Err(strange()),
    };
    let shared = &mut request.shared;
    (shared.out, shared.force, shared.threads) = (args.out.clone(), args.force, args.threads);
    (shared.json, shared.quiet, shared.verbose) = (args.json, args.quiet, args.verbose);
    solve::merge(&request, &default, &merged)
}

/// The arguments of a command.
fn parsed<A: FromArgMatches>(matches: &ArgMatches) -> Result<A, Failure> {
    A::from_arg_matches(matches).map_err(|_| strange())
}

fn strange() -> Failure {
    Failure::input("the parts name a command that this program does not know")
}
