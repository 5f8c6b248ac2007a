//! `fredholm check …`: tests of the rendering equation and of the estimators, each with a known false-alarm rate.

mod bias;
mod bias_args;
mod common;
mod equilibrium;
mod scene;
mod sides;

use super::base::{Ending, Failure};
use clap::{Args, Subcommand};

/// Below `check --help`.
pub const HELP: &str = "Examples:
  fredholm check bias --estimator prefix --against path
  fredholm check equilibrium cornell
  fredholm check scene scenes/furnace.toml

Exit code 1: a bias was found, the equation was rejected, or a value of a scene was not confirmed.";

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
    /// Tests the values that a scene file promises in [expect]
    #[command(after_long_help = scene::HELP)]
    Scene(scene::OfScene),
}

/// Runs a check.
pub fn run(args: &Check) -> Result<Ending, Failure> {
    match &args.what {
        What::Bias(args) => bias::run(args),
        What::Equilibrium(args) => equilibrium::run(args),
        What::Scene(args) => scene::run(args),
    }
}
