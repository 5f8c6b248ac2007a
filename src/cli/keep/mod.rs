//! Runs that outlive their process: a state that is kept and taken up again, and parts of a run on several machines.
//!
//! ```text
//! series … ──every minute──▶ DIR/state.fsh ──▶ series … --resume
//! series … --shard I/N ──▶ I.fsh ──▶ merge 1.fsh … N.fsh
//! ```

mod header;
mod keeper;
mod merged;
mod shard;

use crate::cli::options::{HOW, OUTPUT, duration};
use clap::Args;
pub use header::{header, meshes, streams};
pub use keeper::{Keeper, NAME, kept_in};
pub use merged::{Merged, same_command};
pub use shard::Shard;
use std::time::Duration;

/// Going on with an earlier run.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = OUTPUT)]
pub struct Keeping {
    /// Go on from where this run was stopped, or with more samples
    ///
    /// The result has the same bits as a run that was never stopped. Its --spp may be larger; everything else that a sample depends on
    /// must be as before. Where nothing was kept, the run starts at its first sample.
    #[arg(long)]
    pub resume: bool,
    /// How often the state is kept for --resume: 60s, 5m, off
    ///
    /// A run that takes longer than this keeps its state in state.fsh, in its output folder. Unless this is `off`, Ctrl-C and a batch system's SIGTERM keep it too. If writing it
    /// takes long, it is written less often, so that it costs less than two percent of the time. [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = interval, hide_short_help = true)]
    pub checkpoint: Option<Interval>,
}

/// One part of a run.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = HOW)]
pub struct Sharding {
    /// Render part I of N, for `fredholm merge`
    ///
    /// For example 3/8. Writes one file [default: fredholm-out/SCENE-COMMAND-3-of-8.fsh], which -o names. A part has every N-th block of 64 pixels, every N-th replicate if paths start at the lights, and every N-th patch of --factors rays; everything else is made by merge, such as the picture of radiosity.
    /// A part that was stopped goes on when its command is repeated, and a finished part is skipped. Stored rays are kept only when all of a mesh are traced; if they are stopped before, the mesh begins again. The merged result has the bits of
    /// one run.
    #[arg(long, value_name = "I/N", conflicts_with = "time", hide_short_help = true)]
    pub shard: Option<Shard>,
}

/// Time between two states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interval {
    /// At least this time.
    Every(Duration),
    /// No state is kept.
    Off,
}

impl Interval {
    /// The usual interval.
    pub const USUAL: Self = Self::Every(Duration::from_secs(60));
}

/// Shortest time between two states.
const SHORTEST: Duration = Duration::from_millis(10);

/// Parses the time between two states.
pub fn interval(text: &str) -> Result<Interval, String> {
    match text {
        "off" => Ok(Interval::Off),
        _ => duration(text).map(|t| Interval::Every(t.max(SHORTEST))).map_err(|e| format!("{e}, or `off`")),
    }
}
