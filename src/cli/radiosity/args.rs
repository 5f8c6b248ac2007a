//! What `radiosity` takes.

use crate::cli::options::one_of;
use crate::cli::solve::RunArgs;
use crate::cli::write::Export;
use clap::Args;
use fredholm::solver::comparison::Solvers;
use fredholm::terms::Channel;

/// Arguments of `radiosity`.
#[derive(Clone, Debug, Args)]
pub struct Radiosity {
    /// Solve (I − T) L = E step by step instead: all, neumann, cg, …
    ///
    /// neumann: partial sums of Σ TᵏE; jacobi: the same unless patches see themselves;
    /// gauss-seidel, sor: patch by patch; southwell: progressive shooting, brightest first;
    /// chebyshev: needs the ends of the spectrum; cg: conjugate gradients in the weight 1/ρ;
    /// gmres; lu: the direct solve that all others are held against.
    /// With --factors rays there is no lu, and no cg, because T is self-adjoint only within its
    /// noise: all others are held against GMRES to rounding.
    #[arg(long, value_parser = one_of::<Solvers>(Solvers::choices()), value_name = "NAME", hide_possible_values = true, verbatim_doc_comment)]
    pub solver: Option<Solvers>,
    /// red, green or blue, for --solver and --modes [default: the slowest]
    ///
    /// The slowest is that of the largest spectral radius.
    #[arg(long, value_parser = one_of::<Channel>(Channel::ALL), value_name = "NAME", hide_possible_values = true)]
    pub channel: Option<Channel>,
    /// Also write every step of every solver, into the output folder
    #[arg(long, value_name = "NAME.csv", requires = "solver", value_parser = csv_name)]
    pub history: Option<String>,
    /// Show the spectrum of T and its N leading modes instead of L
    #[arg(long, value_name = "N", conflicts_with = "solver", value_parser = clap::value_parser!(u16).range(1..=64))]
    pub modes: Option<u16>,
    /// Also write patches and terms for other programs; with `matrix` also F
    ///
    /// mesh: mesh.csv, mesh-terms.csv, norms.csv; matrix: F.npy, too.
    #[arg(long, value_enum, value_name = "WHAT", conflicts_with_all = ["solver", "modes"], hide_possible_values = true)]
    pub export: Option<Export>,
    /// What is solved.
    #[command(flatten)]
    pub run: RunArgs,
}

fn csv_name(s: &str) -> Result<String, String> {
    let plain = std::path::Path::new(s).file_name().is_some_and(|n| n == s) && s.ends_with(".csv");
    if plain { Ok(s.into()) } else { Err(format!("`{s}` is not the name of a file such as history.csv")) }
}
