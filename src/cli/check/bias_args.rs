//! What `check bias` takes.

use super::common::Common;
use crate::cli::options::{among, probability};
use clap::Args;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::{Roulette, Technique};
use fredholm::scene::bsdf::Sampling;
use std::time::Duration;

pub(super) const EXAMPLES: &str = "Examples:
  fredholm check bias --estimator prefix --against path --scene cornell --alpha 1e-3
  fredholm check bias --technique scatter --against prefix --against-technique connect --time 20s
  fredholm check bias --against fredholm-out/cornell        a finished run; its errors are allowed for

The watch ends when a bias is found (exit code 1), when every image mean is bounded within ±δ of 0
(δ = --delta of the term + 1e-4 of the whole image), at --time or --spp, or with Ctrl-C. None of this
inflates the error rate: the e-value of a mean exceeds 1/α at any time ever with probability α only.

Assumed: the mean of a batch is nearly normal. A batch has --batch samples of every pixel; where fewer
than 400 events carry a mean, or are to be expected, nothing is rejected.";

/// Arguments of `check bias`.
#[derive(Clone, Debug, Args)]
pub struct Bias {
    /// Built-in scene, .toml, or .obj
    #[arg(long, value_name = "SCENE", default_value = "cornell")]
    pub(super) scene: String,
    /// The estimator that is checked.
    #[arg(long, value_name = "NAME", default_value = "prefix", help = checked())]
    pub(super) estimator: String,
    /// What it is checked against: an estimator, path, or the folder of a finished run
    #[arg(long, value_name = "NAME|DIR", default_value = "path")]
    pub(super) against: String,
    /// How light is found.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help = among("How light is found", Technique::ALL))]
    pub(super) technique: Technique,
    /// The same of the other side [default: as --technique]
    #[arg(long, value_name = "NAME")]
    pub(super) against_technique: Option<Technique>,
    /// Russian roulette [default: none for k ≤ K, then albedo; path: albedo@2]
    #[arg(long, value_name = "SCHEDULE")]
    pub(super) roulette: Option<Roulette>,
    /// The same of the other side [default: as without --roulette]
    #[arg(long, value_name = "SCHEDULE")]
    pub(super) against_roulette: Option<Roulette>,
    /// How directions are drawn.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help = among("How directions are drawn", Sampling::ALL))]
    pub(super) sampling: Sampling,
    /// The same of the other side [default: as --sampling]
    #[arg(long, value_name = "NAME")]
    pub(super) against_sampling: Option<Sampling>,
    /// Children of every vertex of a branching estimator
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) branching: u32,
    /// K: terms k = 0..=K are watched, everything longer as the tail
    #[arg(long, value_name = "K", default_value_t = 8, value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub(super) max_bounces: u16,
    /// Chance of a false alarm, whenever the watch ends
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = probability)]
    pub(super) alpha: f64,
    /// δ as a fraction of the term: the watch ends when every bias is proved smaller
    #[arg(long, value_name = "FRACTION", default_value_t = 0.01, value_parser = probability)]
    pub(super) delta: f64,
    /// Samples per pixel of one batch [default: enough for 4096 paths]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub(super) batch: Option<u32>,
    /// At most this long: 20s, 5m [default: 60s, or no limit with --spp]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub(super) time: Option<Duration>,
    /// At most this many samples per pixel of each side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    pub(super) spp: Option<u32>,
    #[command(flatten)]
    pub(super) common: Common,
}

/// Seconds by themselves or with an s; minutes with an m.
fn duration(s: &str) -> Result<Duration, String> {
    let (number, unit) = match s.strip_suffix('m') {
        Some(number) => (number, 60.0),
        None => (s.strip_suffix('s').unwrap_or(s), 1.0),
    };
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x < 1e9);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 20s or 5m"))
}

/// Help for the estimator: all names, and the path tracer's.
fn checked() -> String {
    let names = Estimator::ALL.map(Estimator::name);
    among("The estimator that is checked", names.into_iter().chain(["path"]))
}
