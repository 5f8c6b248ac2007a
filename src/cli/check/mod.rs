//! `fredholm check …`: tests of the rendering equation and of the estimators, each with a known false-alarm rate.

mod bias;
mod bias_args;
mod common;
mod equilibrium;
mod sides;

use super::base::{Ending, Failure};
use clap::{Args, Subcommand};

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct Check {
    /// What is checked
    #[command(subcommand)]
    pub what: What,
}

/// What can be checked.
#[derive(Debug, Subcommand)]
pub enum What {
    /// Are two estimators equal? Watched until it is decided, and stopped at any moment
    #[command(after_help = bias_args::EXAMPLES)]
    Bias(bias_args::Bias),
    /// Does L = E + T L hold, point by point?
    #[command(after_help = equilibrium::EXAMPLES)]
    Equilibrium(equilibrium::Equilibrium),
}

/// Runs a check.
pub fn run(args: &Check) -> Result<Ending, Failure> {
    match &args.what {
        What::Bias(args) => bias::run(args),
        What::Equilibrium(args) => equilibrium::run(args),
    }
}
