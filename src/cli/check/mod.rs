//! `fredholm check …`: tests of the equation and of the estimators, each with its false-alarm rate.

mod bias;
mod equilibrium;
mod sides;

use super::{Ending, Failure};
use crate::cli::open::{self, Opened};
use clap::{Args, Subcommand};
use fredholm::engine::known::resort::with_last_resort;
use fredholm::scene::Scene;

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
    #[command(after_help = bias::EXAMPLES)]
    Bias(bias::Bias),
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

/// What every check takes.
#[derive(Clone, Debug, Args)]
struct Common {
    /// Seed: same seed and same number of samples, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Image size in pixels [default: the scene's shape, small]
    #[arg(long, value_name = "WxH", value_parser = super::args::size)]
    size: Option<[u32; 2]>,
    /// Scene, output, threads.
    #[command(flatten)]
    shared: crate::cli::open::Shared,
}

impl Common {
    /// The scene, in a small picture unless a size was asked for.
    fn load(&self, name: &str, most: u32) -> Result<Opened, Failure> {
        open::threads(self.shared.threads)?;
        let mut opened = open::scene(name, &self.shared.changes, None)?;
        let size = self.size.unwrap_or_else(|| small(opened.description.camera.size, most));
        opened.description.camera.size = size;
        Ok(Opened { scene: with_last_resort(Scene::new(&opened.description)), ..opened })
    }
}

/// The same shape with at most so many pixels on each side.
fn small([w, h]: [u32; 2], most: u32) -> [u32; 2] {
    let largest = w.max(h);
    if largest <= most {
        return [w, h];
    }
    [w, h].map(|side| (f64::from(side) * f64::from(most) / f64::from(largest)).round().max(1.0) as u32)
}

/// A number above 0 and below 1.
fn fraction(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|p| *p > 0.0 && *p < 1.0).ok_or(format!("`{s}` is not between 0 and 1"))
}

fn usage(what: &str, help: &str) -> Failure {
    Failure::Usage(format!("error: {what}\nhelp: {help}"))
}
