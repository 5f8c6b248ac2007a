//! Arguments of `radiosity`.

use crate::cli::choices::{CHANNELS, SOLVERS};
use crate::cli::keep::Sharding;
use crate::cli::options::{Frame, MATRIX, Shared, WHAT, one_of};
use crate::cli::solve::{Mesh, Pictures, Pixels, Request};
use crate::cli::write::Export;
use clap::Args;
use fredholm::solver::comparison::Solvers;
use fredholm::terms::Channel;

/// Arguments of `radiosity`.
#[derive(Clone, Debug, Args)]
pub struct Radiosity {
    /// Scene, samples, size, K, seed.
    #[command(flatten)]
    pub frame: Frame,
    /// Compare solvers of (I − T) L = E: all, cg, gmres, …
    ///
    /// Solves step by step and renders nothing. With --factors rays there is no lu and no cg, because T is self-adjoint only within
    /// its noise; all others are then compared with GMRES solved to rounding.
    #[arg(long, value_parser = one_of::<Solvers>(SOLVERS), value_name = "NAME", help_heading = WHAT)]
    pub solver: Option<Solvers>,
    /// The spectrum of T and its N leading modes
    ///
    /// Solves the eigenproblem and shows the modes in place of L.
    #[arg(long, value_name = "N", conflicts_with = "solver", help_heading = WHAT, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub modes: Option<u16>,
    /// Also write patches and terms: mesh or matrix
    ///
    /// mesh writes mesh.csv, mesh-terms.csv and norms.csv; matrix also writes F.npy.
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with_all = ["solver", "modes"], help_heading = WHAT)]
    pub export: Option<Export>,
    /// How the samples of the picture are drawn.
    #[command(flatten)]
    pub pixels: Pixels,
    /// red, green or blue, for --solver and --modes
    ///
    /// [default: the channel with the largest spectral radius, where solvers converge most slowly]
    #[arg(long, value_parser = one_of::<Channel>(CHANNELS), value_name = "NAME", help_heading = MATRIX)]
    pub channel: Option<Channel>,
    /// With --solver: write every step of every solver
    ///
    /// The file goes into the output folder.
    #[arg(long, value_name = "NAME.csv", requires = "solver", help_heading = MATRIX, value_parser = csv_name)]
    pub history: Option<String>,
    /// The mesh and its form factors.
    #[command(flatten)]
    pub mesh: Mesh,
    /// The pictures of the terms.
    #[command(flatten)]
    pub pictures: Pictures,
    /// One part of the rows of stored rays.
    #[command(flatten)]
    pub sharding: Sharding,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

impl From<&Radiosity> for Request {
    fn from(r: &Radiosity) -> Self {
        let Radiosity { frame, mesh, pixels, pictures, sharding, shared, .. } = r.clone();
        let (terms, light) = (Default::default(), Default::default());
        let keeping = Default::default();
        Self { frame, worlds: vec![], terms, light, pixels, mesh, pictures, sharding, keeping, shared }
    }
}

fn csv_name(s: &str) -> Result<String, String> {
    let plain = std::path::Path::new(s).file_name().is_some_and(|n| n == s) && s.ends_with(".csv");
    if plain { Ok(s.into()) } else { Err(format!("`{s}` is not the name of a file such as history.csv")) }
}
