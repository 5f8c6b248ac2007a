//! `fredholm check …`: tests of the rendering equation and of the estimators, each with a known false-alarm rate.

mod bias;
mod bias_args;
mod common;
mod equilibrium;
mod sides;

use super::base::{Ending, Failure};
use clap::{Args, Subcommand};

/// Below `check --help`.
pub const HELP: &str = "Examples:
  fredholm check bias --estimator prefix --against path
  fredholm check equilibrium cornell

Exit code 1: a bias was found, or the equation was rejected.";

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// The check to run
    #[command(subcommand)]
    pub what: What,
}

/// What can be checked.
#[derive(Debug, Subcommand)]
pub enum What {
    /// Tests if two estimators are equal, until that is decided
    #[command(after_long_help = bias_args::HELP)]
    Bias(bias_args::Bias),
    /// Tests if L = E + T L holds, point by point
    #[command(after_long_help = equilibrium::HELP)]
    Equilibrium(equilibrium::Equilibrium),
}

/// Runs a check.
pub fn run(args: &Check) -> Result<Ending, Failure> {
    match &args.what {
        What::Bias(args) => bias::run(args),
        What::Equilibrium(args) => equilibrium::run(args),
    }
}
