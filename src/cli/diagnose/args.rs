//! Arguments of `diagnose`.

use crate::cli::options::{HOW, Shared, WHAT, fraction, probability};
use clap::Args;
use fredholm::diagnosis::Effort;
use std::path::PathBuf;

/// Below `diagnose --help`.
pub const HELP: &str = "Examples:
  fredholm diagnose mine.exr --against cornell
  fredholm diagnose T00.exr T01.exr T02.exr T03.exr --against box.toml
  fredholm diagnose r_4.exr r_16.exr r_64.exr --against cornell
  fredholm diagnose mine.exr --scale 10=large.exr --against cornell
  fredholm diagnose mine.png --gain 2 --against fredholm-out/cornell
  fredholm diagnose zoo-out/*.exr --against cornell
  fredholm diagnose --how

First the command finds the tone curve, the exposure and the clipped pixels of a picture. Then it compares the picture with the \
correct terms, region by region. If they differ, it fits mistakes with a constant, such as 'every bounce times c', and renders the \
known mistakes in the same scene. It answers in three lines: what is wrong, the evidence, and the next step. If too many \
explanations remain, it names none.

A file with the terms in layers T00, T01, … carries the most information. The whole image alone carries less, 8 bits the least.

Exit code 0: correct, as far as the data can tell. Exit code 1: something is wrong, or the data cannot tell.";

/// How several files belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Grouping {
    #[value(help = "by their names")]
    Auto,
    #[value(help = "each file separately")]
    Separate,
    #[value(help = "numbered terms of one render")]
    Bounces,
    #[value(help = "one render at growing samples per pixel")]
    Spp,
}

/// Arguments of `diagnose`.
#[derive(Clone, Debug, Args)]
pub struct Diagnose {
    /// Pictures of one scene: EXR, PNG, JPEG or HDR
    ///
    /// An EXR may have layers. Files named T00.exr, T01.exr, … are read as the terms of one render, files named r_16.exr, r_64.exr,
    /// … as one render at growing samples per pixel, and all others separately; --as changes that.
    #[arg(required_unless_present = "how", value_name = "RENDER", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub renders: Vec<PathBuf>,
    /// The scene, or the output folder of a run
    ///
    /// The right answer: a built-in scene, a .toml or .obj file, or the output folder of `fredholm series`.
    #[arg(long, value_name = "SCENE|DIR", required_unless_present = "how", help_heading = WHAT)]
    pub against: Option<String>,
    /// How to write the pictures in C++, Python and Mitsuba
    ///
    /// Prints how to write a file with the terms in layers, and exits.
    #[arg(long, exclusive = true, help_heading = WHAT)]
    pub how: bool,
    /// auto, separate, bounces or spp
    ///
    /// How several files belong together.
    #[arg(long = "as", value_enum, default_value = "auto", value_name = "HOW", help_heading = WHAT)]
    pub grouping: Grouping,
    /// The same scene S times as large: --scale 10=FILE
    ///
    /// A render by the same program of the scene made S times as large. It shows mistakes that depend on the unit of length.
    #[arg(long, value_name = "S=FILE", value_parser = scale, help_heading = WHAT)]
    pub scale: Option<(f64, PathBuf)>,
    /// Divide the pictures by G first
    ///
    /// 0 means that the exposure is unknown. [default: 1; 0 for PNG and JPEG]
    #[arg(long, value_name = "G", value_parser = fraction, help_heading = WHAT)]
    pub gain: Option<f64>,
    /// K of the reference, if the file has no terms
    ///
    /// [default: as the file says, or 20]
    #[arg(long, value_name = "K", help_heading = HOW, value_parser = clap::value_parser!(u16).range(0..=64))]
    pub max_bounces: Option<u16>,
    /// Samples per pixel of the reference
    ///
    /// [default: 8 million paths in all]
    #[arg(long, value_name = "N", help_heading = HOW, value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub spp: Option<u32>,
    /// Paths for simulating the known mistakes, per stage
    #[arg(long, default_value_t = Effort::default().paths, value_name = "N", help_heading = HOW)]
    pub paths: u64,
    /// Probability of a false alarm
    ///
    /// The probability that a correct renderer is called wrong.
    #[arg(long, default_value_t = 1e-3, value_name = "P", value_parser = probability, help_heading = HOW)]
    pub alpha: f64,
    /// Seed of reference and candidates
    #[arg(long, default_value_t = 0, value_name = "N", help_heading = HOW)]
    pub seed: u64,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

fn scale(s: &str) -> Result<(f64, PathBuf), String> {
    let wrong = || format!("`{s}` is not SCALE=FILE, such as 10=large.exr");
    let (factor, file) = s.split_once('=').ok_or_else(wrong)?;
    let factor = factor.parse().ok().filter(|f: &f64| *f > 0.0 && f.is_finite()).ok_or_else(wrong)?;
    Ok((factor, file.into()))
}
