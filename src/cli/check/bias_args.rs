//! Arguments of `check bias`.

use super::common::Common;
use crate::cli::choices::{CHECKED, SAMPLINGS, TECHNIQUES};
use crate::cli::options::{HOW, WHAT, duration, name_of, one_of, probability};
use clap::Args;
use fredholm::engine::MOST_BOUNCES;
use fredholm::estimator::{Roulette, Technique};
use fredholm::scene::bsdf::Sampling;
use std::time::Duration;

/// Below `check bias --help`.
pub(super) const HELP: &str = "Examples:
  fredholm check bias --estimator prefix --against path --alpha 1e-3
  fredholm check bias --technique scatter --against-technique connect --time 20s
  fredholm check bias --against fredholm-out/cornell

The check ends with exit code 1 if a bias is found. Otherwise it ends if every image mean is proved to differ by less than δ \
(--delta of the term + 1e-4 of the whole image), at --time, at --spp, or with Ctrl-C. It may be stopped at any moment without a \
higher error rate: an e-value exceeds 1/α at any time with probability at most α.

If --against is a finished run, its errors are taken into account.

The check assumes that the mean of a batch is nearly normal. A batch has --batch samples of every pixel. If fewer than 400 events \
contribute to a mean, or fewer are expected, nothing is rejected.";

/// Arguments of `check bias`.
#[derive(Clone, Debug, Args)]
pub struct Bias {
    /// Built-in scene or scene file
    #[arg(long, value_name = "SCENE", default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub(super) scene: String,
    /// Checked: prefix, light, path, …
    ///
    /// The estimator that is checked.
    #[arg(long, value_name = "NAME", default_value = "prefix", help_heading = WHAT, value_parser = name_of(CHECKED))]
    pub(super) estimator: String,
    /// An estimator, path, or a run
    ///
    /// The reference: an estimator, the path tracer, or the output folder of a finished run.
    #[arg(long, value_name = "NAME|DIR", default_value = "path", help_heading = WHAT)]
    pub(super) against: String,
    /// K: check k = 0..=K and the tail
    #[arg(long, value_name = "K", default_value_t = 8, help_heading = WHAT, value_parser = clap::value_parser!(u16).range(0..=i64::from(MOST_BOUNCES)))]
    pub(super) max_bounces: u16,
    /// Time limit: 20s, 5m [default: 60s]
    ///
    /// With --spp there is no time limit by default.
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = WHAT)]
    pub(super) time: Option<Duration>,
    /// At most N samples per pixel of each side
    #[arg(long, value_name = "N", help_heading = WHAT, value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    pub(super) spp: Option<u32>,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which a path finds light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    pub(super) technique: Technique,
    /// Technique of the reference [default: --technique]
    #[arg(long, value_name = "NAME", hide_short_help = true, help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    pub(super) against_technique: Option<Technique>,
    /// Roulette: none, lecture, constant:Q@V, albedo, …
    ///
    /// `fredholm series --help` lists the rules.
    /// [default: none for k ≤ K, then albedo; for path albedo@2]
    #[arg(long, value_name = "RULE", help_heading = HOW)]
    pub(super) roulette: Option<Roulette>,
    /// Roulette of the reference [default: the same]
    ///
    /// By default the same as without --roulette.
    #[arg(long, value_name = "RULE", hide_short_help = true, help_heading = HOW)]
    pub(super) against_roulette: Option<Roulette>,
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub(super) sampling: Sampling,
    /// Directions of the reference [default: --sampling]
    #[arg(long, value_name = "NAME", hide_short_help = true, help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub(super) against_sampling: Option<Sampling>,
    /// Children of every vertex of a branching estimator
    #[arg(long, value_name = "N", default_value_t = 2, hide_short_help = true, help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) branching: u32,
    /// Probability of a false alarm
    ///
    /// It holds whenever the check ends.
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability, help_heading = HOW)]
    pub(super) alpha: f64,
    /// δ as a fraction of the term
    ///
    /// The check ends when every bias is proved to be smaller than δ.
    #[arg(long, value_name = "X", default_value_t = 0.01, value_parser = probability, help_heading = HOW)]
    pub(super) delta: f64,
    /// Samples per pixel of one batch
    ///
    /// [default: enough for 4096 paths]
    #[arg(long, value_name = "N", hide_short_help = true, help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub(super) batch: Option<u32>,
    #[command(flatten)]
    pub(super) common: Common,
}
