//! What `sweep` takes.

use super::Run;
use clap::{Args, ValueEnum};

/// A setting that can be swept over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Over {
    /// Children of every vertex
    Branching,
    /// Samples per pixel
    Spp,
    /// How light is found
    Technique,
    /// How directions are drawn
    Sampling,
    /// How the terms are estimated
    Estimator,
    /// How the samples of a pixel lie
    Points,
    /// How paths end
    Roulette,
    /// How fine the mesh of the matrix is
    Patches,
    /// Where the samples of separate terms go
    Split,
}

impl std::fmt::Display for Over {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.to_possible_value().as_ref().map_or("", |v| v.get_name()))
    }
}

/// Arguments of `sweep`.
#[derive(Clone, Debug, Args)]
pub struct Sweep {
    /// branching, spp, split, technique, … (all: --help)
    ///
    /// branching, spp, split, technique, sampling, estimator, points, roulette or patches
    #[arg(long, value_enum, value_name = "SETTING", hide_possible_values = true)]
    pub over: Over,
    /// Its values, with commas
    ///
    /// With --over spp the numbers of samples to look at: multiples of 16.
    /// [default: 1,2,3,4; 16,32,64,…; scatter,connect,mis,mis-power; uniform,cosine,bsdf;
    /// prefix,single,branching,light,bidirectional; independent,sobol;
    /// none,lecture,albedo; 38,150,600,2400]
    #[arg(long, visible_alias = "schedules", value_name = "V,…", verbatim_doc_comment)]
    pub values: Option<String>,
    /// Give every value the rays of the dearest, instead of the same spp
    #[arg(long)]
    pub equal_rays: bool,
    /// With --over spp: squared error against a run's folder, or a render of so many samples
    ///
    /// Its own variance is subtracted, so that the squared error is unbiased.
    /// A render of its own has another stream.
    #[arg(long, value_name = "DIR|SPP", verbatim_doc_comment)]
    pub reference: Option<String>,
    /// With --over patches: the N largest and the N most negative eigenvalues on every mesh
    ///
    /// Of the channel with the largest spectral radius. Also written: eigenvalues.csv, .svg, .png.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=16), verbatim_doc_comment)]
    pub eigenvalues: Option<u16>,
    /// Samples of the pilot of --over split [default: a quarter of --spp]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1 << 24))]
    pub pilot: Option<u32>,
    /// What may be a list.
    #[command(flatten)]
    pub several: crate::cli::sweep_spp::Several,
    /// What is rendered.
    #[command(flatten)]
    pub run: Run,
}
