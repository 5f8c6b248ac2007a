//! `fredholm check …`: tests of the equation and of the estimators, each with its false-alarm rate.

mod bias;
mod equilibrium;
mod sides;

use super::{Ending, Failure};
use crate::cli::open::{self, Opened};
use clap::{Args, Subcommand};
use fredholm::scene::Scene;
use std::path::PathBuf;

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
    /// Override a key of the scene
    ///
    /// For example materials.white.reflectance=[0.6,0.6,0.6]
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Let a material emit: lamp=17,12,4
    #[arg(long, value_name = "MATERIAL=R,G,B")]
    emit: Vec<String>,
    /// Output folder [default: fredholm-out/<check>-<scene>]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    force: bool,
    /// Threads [default: all]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
    /// No progress
    #[arg(short, long)]
    quiet: bool,
}

impl Common {
    /// The scene, in a small picture unless a size was asked for.
    fn load(&self, name: &str, most: u32) -> Result<Opened, Failure> {
        open::threads(self.threads)?;
        let mut opened = open::scene(name, &self.set, &self.emit, None)?;
        let size = self.size.unwrap_or_else(|| small(opened.description.camera.size, most));
        opened.description.camera.size = size;
        Ok(Opened { scene: Scene::new(&opened.description), ..opened })
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
