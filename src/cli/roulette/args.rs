//! Arguments of `roulette`.

use crate::cli::choices::{AIMS, LIGHTS, SAMPLINGS, TECHNIQUES};
use crate::cli::options::{HOW, Shared, WHAT, one_of, size};
use fredholm::estimator::Technique;
use fredholm::scene::Selection;
use fredholm::scene::bsdf::Sampling;
use fredholm::study::roulette::Aim;

/// Below `roulette --help`.
pub const HELP: &str = "Examples:
  fredholm roulette cornell
  fredholm roulette cornell --verify
  fredholm roulette cornell --optimise
  fredholm roulette cornell --optimise --for indirect
  fredholm roulette furnace --schedules none,constant:0.1@0,table:0,0.2,0.4
  fredholm roulette cornell --enumerate

--optimise maximises the efficiency 1/(variance × rays) of one sample. The variance is averaged over pixels and channels. --for says \
of which quantity: `whole` means the whole image, all terms T^k E (the schedule `optimal`); `indirect` means indirect light, the \
terms k ≥ 2 (the schedule `optimal-indirect`). The two differ where T0, emission seen directly, dominates the variance, as the edge of \
the lamp does in cornell. Ending paths cannot reduce the variance of T0. The optimum for the whole image then ends most paths at \
once, because new camera paths are worth more, and indirect light becomes noisier. `--roulette optimal` of the other commands means \
the whole image; they also accept `optimal-indirect`.

Paths are recorded without roulette up to vertex K. A schedule that does not depend on the path is predicted up to vertex K; beyond \
K, all schedules continue with q = 1 − the largest albedo of the scene. albedo and throughput depend on the path, so they are only \
measured.

The command writes roulette.csv, roulette.svg, roulette.png and summary.json (with the cross moments). --verify and --optimise \
also write pictures.png: the image of every schedule that was rendered, with its noise, at one exposure. Exit code 1: a measured \
variance contradicts its prediction, or --enumerate finds a term that roulette changes.";

/// Arguments of `roulette`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Built-in scene, .toml or .obj
    #[arg(value_name = "SCENE", default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub scene: String,
    /// Schedules to compare [default: nine usual ones]
    ///
    /// A list separated by commas: none, lecture, constant:Q[@V], table:q0,q1,…, albedo[@V], throughput[@V], optimal, optimal-indirect.
    /// `fredholm series --help` describes them.
    #[arg(long, value_name = "RULE,…", help_heading = WHAT)]
    pub schedules: Option<String>,
    /// Render every schedule, and check the predictions
    #[arg(long, help_heading = WHAT)]
    pub verify: bool,
    /// Find the best schedule, and measure its gain
    ///
    /// The gain is measured over the lecture's roulette and over albedo roulette. --optimize is the same option.
    #[arg(long, alias = "optimize", help_heading = WHAT)]
    pub optimise: bool,
    /// Prove that roulette is unbiased, path by path
    ///
    /// For 4096 paths, all the ways the roulette can fall are summed with their probabilities. The sum of each term must be the
    /// term without roulette, to rounding. This is an equality, not a statistic. Writes enumeration.csv.
    #[arg(long, conflicts_with_all = ["verify", "optimise", "aim"], help_heading = WHAT)]
    pub enumerate: bool,
    /// Optimise: whole or indirect [default: both]
    ///
    /// The quantity whose variance × rays is minimised.
    #[arg(long = "for", value_name = "WHAT", value_parser = one_of::<Aim>(AIMS), help_heading = WHAT)]
    pub aim: Option<Aim>,
    /// Samples per pixel of every render
    ///
    /// The recording has the same number of samples.
    #[arg(long, value_name = "N", default_value_t = 128, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(4..=1 << 20))]
    pub spp: u32,
    /// Image size in pixels [default: at most 64 a side]
    ///
    /// By default the size of the scene, reduced to at most 64 pixels a side.
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = WHAT)]
    pub size: Option<[u32; 2]>,
    /// K: predict up to this vertex
    #[arg(long, value_name = "K", default_value_t = 16, help_heading = WHAT, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub max_bounces: u16,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which a path finds light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    pub technique: Technique,
    /// Light choice: uniform or power
    ///
    /// How a connection selects a light.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Selection>(LIGHTS))]
    pub lights: Selection,
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub sampling: Sampling,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

impl Args {
    /// The quantities that are judged.
    pub fn aims(&self) -> Vec<Aim> {
        self.aim.map_or(Aim::ALL.to_vec(), |aim| vec![aim])
    }
}
