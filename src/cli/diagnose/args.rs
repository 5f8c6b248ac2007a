//! What `diagnose` takes.

use crate::cli::options::{Shared, fraction, probability};
use clap::Args;
use fredholm::diagnosis::Effort;
use std::path::PathBuf;

/// How several files belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Grouping {
    /// By their names
    Auto,
    /// Each by itself
    Separate,
    /// Numbered terms of one render
    Bounces,
    /// One render at growing samples per pixel
    Spp,
}

/// Arguments of `diagnose`.
#[derive(Clone, Debug, Args)]
pub struct Diagnose {
    /// Pictures of one scene: EXR with layers, EXR, PNG, JPEG or HDR
    ///
    /// Files named T00.exr, T01.exr, … are taken for the terms of one render, files named r_16.exr,
    /// r_64.exr, … for one render at growing samples per pixel, all others each for itself (--as).
    #[arg(required = true, value_name = "RENDER", verbatim_doc_comment)]
    pub renders: Vec<PathBuf>,
    /// What they should show: a built-in scene, .toml, .obj, or the output folder of a run
    #[arg(long, value_name = "SCENE|DIR")]
    pub against: String,
    /// How several files belong together: auto, separate, bounces, spp
    #[arg(long = "as", value_enum, default_value = "auto", value_name = "HOW", hide_possible_values = true)]
    pub grouping: Grouping,
    /// The same render of the scene made so many times larger: --scale 10=FILE
    #[arg(long, value_name = "S=FILE", value_parser = scale)]
    pub scale: Option<(f64, PathBuf)>,
    /// Divide the pictures by this first; 0: exposure unknown [default: 1; 0 for 8-bit pictures]
    #[arg(long, value_name = "G", value_parser = fraction)]
    pub gain: Option<f64>,
    /// K of the reference where the file has no terms [default: as the file says, or 8]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=64))]
    pub max_bounces: Option<u16>,
    /// Samples per pixel of the reference [default: 8 million paths in all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub spp: Option<u32>,
    /// Paths that all candidates together may take in one stage
    #[arg(long, default_value_t = Effort::default().paths, value_name = "N")]
    pub paths: u64,
    /// Chance that a correct renderer is called wrong
    #[arg(long, default_value_t = 1e-3, value_name = "P", value_parser = probability)]
    pub alpha: f64,
    /// Seed of the reference and of the candidates
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

fn scale(s: &str) -> Result<(f64, PathBuf), String> {
    let wrong = || format!("`{s}` is not SCALE=FILE, such as 10=large.exr");
    let (factor, file) = s.split_once('=').ok_or_else(wrong)?;
    let factor = factor.parse().ok().filter(|f: &f64| *f > 0.0 && f.is_finite()).ok_or_else(wrong)?;
    Ok((factor, file.into()))
}
