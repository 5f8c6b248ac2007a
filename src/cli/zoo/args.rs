//! What `zoo` takes, and what all of it is made with.

use crate::cli::options::{Manner, size};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::estimator::Roulette;
use std::path::PathBuf;

/// K of the zoo.
const BOUNCES: usize = 6;

/// Arguments of `zoo`.
#[derive(Clone, Debug, Args)]
#[allow(clippy::struct_excessive_bools)] // switches of a command line
pub struct Zoo {
    /// A member; none: all of them
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
    /// List the members and render nothing
    #[arg(long)]
    pub list: bool,
    /// Predict, then reveal: which member made these numbers?
    #[arg(long, conflicts_with_all = ["name", "list"])]
    pub quiz: bool,
    /// Rounds of the quiz
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub rounds: u32,
    /// With NAME: another built-in scene than the one that shows it
    #[arg(long, value_name = "SCENE", requires = "name")]
    pub scene: Option<String>,
    /// Samples per pixel [default: 16; with NAME: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub spp: Option<u32>,
    /// Image size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "64x64")]
    pub size: [u32; 2],
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Output folder [default: zoo-out; with NAME: zoo-out/NAME]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]; results do not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
}

impl Zoo {
    /// What a run of the zoo is made with.
    pub fn settings(&self, spp: u32) -> Settings {
        let roulette = Roulette::Albedo { from: 2 }.after(BOUNCES);
        let spp = self.spp.unwrap_or(spp);
        Settings { spp, seed: self.seed, max_bounces: BOUNCES, roulette, ..Settings::default() }
    }
}

impl From<&Zoo> for Manner {
    fn from(z: &Zoo) -> Self {
        Self { out: z.out.clone(), force: z.force, threads: z.threads, quiet: z.quiet, ..Self::default() }
    }
}
