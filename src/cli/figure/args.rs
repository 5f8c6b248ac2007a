//! The arguments of `figure`, and its help.

use crate::cli::options::{OUTPUT, WHAT, size};
use clap::Args;
use std::path::PathBuf;

/// Below `figure --help`.
pub const HELP: &str = "Examples:
  fredholm figure --list
  fredholm figure one-path
  fredholm figure noise-paths -o slides/noise --seed 3
  fredholm figure lecture -o slides
  fredholm figure cs184-part4 -o homework

`lecture` makes one figure for every topic of the lecture, and index.html with all of them. Each figure is a folder with pictures, \
the numbers as CSV, and summary.json. Every figure carries the command that makes it. Figures at equal time and \
`growth` measure how fast this machine is, so that their numbers differ from run to run; all others give the same bits for the same seed.";

/// Arguments of `figure`.
#[derive(Clone, Debug, Args)]
pub struct Figure {
    /// Name of the figure, or `lecture`; --list prints the names
    #[arg(value_name = "NAME", conflicts_with_all = ["list", "all"], help_heading = WHAT)]
    pub id: Option<String>,
    /// List the figures
    #[arg(long, help_heading = WHAT)]
    pub list: bool,
    /// Make every figure, each in its own folder
    #[arg(long, conflicts_with = "list", help_heading = WHAT)]
    pub all: bool,
    /// Take fewer samples and make smaller pictures: seconds for each figure
    #[arg(long, help_heading = WHAT)]
    pub quick: bool,
    /// Image size in pixels [default: the figure's]
    ///
    /// Figures with a layout of their own keep their size.
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = WHAT)]
    pub size: Option<[u32; 2]>,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Measure one point of `growth` in this process, and print it as JSON
    #[arg(long, hide = true, value_name = "SUBJECT:SIZE:MESH")]
    pub measure: Option<String>,
    /// Output folder [default: fredholm-out/NAME]
    ///
    /// With `lecture` and --all, the folder for all figures.
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Print no progress
    #[arg(short, long, help_heading = OUTPUT)]
    pub quiet: bool,
}
