//! Arguments of `zoo`, and the settings of all its renders.

use crate::cli::options::{Manner, OUTPUT, WHAT, size};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::estimator::Roulette;
use std::path::PathBuf;

/// K of the zoo.
const BOUNCES: usize = 6;

/// Below `zoo --help`.
pub const HELP: &str = "Examples:
  fredholm zoo
  fredholm zoo --list
  fredholm zoo double-emission
  fredholm zoo mixed-measures --scene cornell
  fredholm zoo --quiz --seed 3

Without NAME, all members are rendered. With NAME, one member is compared with the right estimator: a table, a picture and a plot.

r_k = T_k wrong/T_k right shows the mistake: constant in k if the connection to the light is wrong, c^(k-1) if the bounce or the \
roulette is wrong, c^k if the BSDF is wrong.

All members write zoo-out/NAME.exr if cornell shows the mistake, otherwise zoo-out/SCENE/NAME.exr, and correct.exr as the control. \
The layers are the image, T00, T01, …, T00_se, ….";

/// Arguments of `zoo`.
#[derive(Clone, Debug, Args)]
#[allow(clippy::struct_excessive_bools)] // switches of a command line
pub struct Zoo {
    /// A member of the zoo [default: all]
    #[arg(value_name = "NAME", help_heading = WHAT)]
    pub name: Option<String>,
    /// List the members, and render nothing
    #[arg(long, help_heading = WHAT)]
    pub list: bool,
    /// Quiz: which member made these numbers?
    #[arg(long, conflicts_with_all = ["name", "list"], help_heading = WHAT)]
    pub quiz: bool,
    /// Rounds of the quiz
    #[arg(long, value_name = "N", default_value_t = 5, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub rounds: u32,
    /// With NAME: another built-in scene
    ///
    /// By default the scene that shows the mistake.
    #[arg(long, value_name = "SCENE", requires = "name", help_heading = WHAT)]
    pub scene: Option<String>,
    /// Samples per pixel [default: 16; with NAME: 256]
    #[arg(long, value_name = "N", help_heading = WHAT, value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub spp: Option<u32>,
    /// Image size in pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "64x64", help_heading = WHAT)]
    pub size: [u32; 2],
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Output folder [default: zoo-out or zoo-out/NAME]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Threads [default: all]
    #[arg(short, long, value_name = "N", help_heading = OUTPUT, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print no progress
    #[arg(short, long, help_heading = OUTPUT)]
    pub quiet: bool,
}

impl Zoo {
    /// Settings of a render, with `spp` samples per pixel by default.
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
