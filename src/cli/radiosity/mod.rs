//! `fredholm radiosity [SCENE]`: the matrix through the camera; with `--solver` all ways to solve it, with `--modes` its
//! spectrum.

mod modes;
mod solvers;

use super::args::Run;
use super::progress::Bar;
use super::write::Export;
use super::{Ending, Failure, args::WorldName, notes, output, preflight, solve};
use crate::cli::open::{self, Opened};
use clap::{Args, ValueEnum};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{self, Matrix, MatrixError};
use fredholm::engine::discretisation::{Factors, Stored};
use fredholm::progress::Progress;
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::summary;
use fredholm::solver::{self, comparison::Solver};
use glam::DVec3;
use std::path::PathBuf;

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
    #[arg(long, value_enum, value_name = "NAME", hide_possible_values = true, verbatim_doc_comment)]
    pub solver: Option<SolverName>,
    /// red, green or blue, for --solver and --modes [default: the slowest]
    ///
    /// The slowest is that of the largest spectral radius.
    #[arg(long, value_enum, value_name = "NAME", hide_possible_values = true)]
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
    pub run: Run,
}

/// Solvers as a choice on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SolverName {
    /// Every one
    All,
    /// Partial sums
    Neumann,
    /// Jacobi
    Jacobi,
    /// Gauss–Seidel
    GaussSeidel,
    /// Over-relaxation
    Sor,
    /// Progressive shooting
    Southwell,
    /// Chebyshev's semi-iteration
    Chebyshev,
    /// Conjugate gradients
    Cg,
    /// GMRES
    Gmres,
    /// LU
    Lu,
}

impl SolverName {
    /// The one it stands for; none is all.
    fn solver(self) -> Option<Solver> {
        Some(match self {
            Self::All => return None,
            Self::Neumann => Solver::Neumann,
            Self::Jacobi => Solver::Jacobi,
            Self::GaussSeidel => Solver::GaussSeidel,
            Self::Sor => Solver::Sor,
            Self::Southwell => Solver::Southwell,
            Self::Chebyshev => Solver::Chebyshev,
            Self::Cg => Solver::ConjugateGradients,
            Self::Gmres => Solver::Gmres,
            Self::Lu => Solver::Lu,
        })
    }
}

/// A colour channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Channel {
    /// Channel 0
    Red,
    /// Channel 1
    Green,
    /// Channel 2
    Blue,
}

/// Channels by number.
pub use fredholm::math::CHANNELS as NAMES;

fn csv_name(s: &str) -> Result<String, String> {
    let plain = std::path::Path::new(s).file_name().is_some_and(|n| n == s) && s.ends_with(".csv");
    if plain { Ok(s.into()) } else { Err(format!("`{s}` is not the name of a file such as history.csv")) }
}

/// Shows the matrix, solves it in every way, or takes it apart.
pub fn run(args: &Radiosity) -> Result<Ending, Failure> {
    match (args.solver, args.modes) {
        (Some(name), _) => solvers::run(args, name),
        (None, Some(count)) => modes::run(args, count.into()),
        (None, None) if args.channel.is_some() => Err(Failure::Usage(
            "error: --channel is for --solver and --modes, and none of them is asked for\nhelp: add one of them".into(),
        )),
        (None, None) => solve::radiosity(&args.run, args.export),
    }
}

/// A scene, its matrix and where the results go.
struct Laboratory<R = solver::Radiosity> {
    opened: Opened,
    matrix: Matrix<R>,
    /// Patches of the mesh, in whatever form T is held.
    patches: usize,
    folder: PathBuf,
}

impl Laboratory {
    /// Loads, meshes and computes form factors as a matrix; `None` if interrupted.
    fn new(run: &Run, what: &str) -> Result<Option<Self>, Failure> {
        Laboratory::prepare(run, what, Factors::Dense, |opened, s, progress| {
            let Opened { description, scene, .. } = opened;
            let matrix = by_matrix::dense_matrix(description, scene, s.patches, s.grading, 0, progress)?;
            Ok((matrix.radiosity.patches.len(), matrix))
        })
    }
}

impl Laboratory<Stored> {
    /// The same as stored rays.
    fn sampled(run: &Run, what: &str, per_row: u32) -> Result<Option<Self>, Failure> {
        Laboratory::prepare(run, what, Factors::Rays(per_row), |opened, s, progress| {
            let Opened { description, scene, .. } = opened;
            let matrix = by_matrix::sampled_matrix(description, scene, s.patches, per_row, s, progress)?;
            Ok((matrix.radiosity.patches.len(), matrix))
        })
    }
}

impl<R> Laboratory<R> {
    fn prepare(
        run: &Run,
        what: &str,
        factors: Factors,
        make: impl FnOnce(&Opened, &Settings, Progress<'_>) -> Result<(usize, Matrix<R>), MatrixError>,
    ) -> Result<Option<Self>, Failure> {
        let opened = open::run(run)?;
        let mut worlds = vec![WorldName::Radiosity];
        preflight::suits_a_matrix(&opened.description, &mut worlds, true)?;
        preflight::fits_in_a_matrix(&opened.scene, factors, &mut worlds, true)?;
        let patches = run.patches.unwrap_or(600) as usize;
        let settings =
            Settings { patches, factors, grading: run.grading, max_bounces: 0, seed: run.seed, ..Settings::default() };
        preflight::rows_fit_in_memory(&opened.scene, &settings)?;
        let name = format!("{}-{what}", opened.description.name);
        let folder = output::folder(run.shared.out.as_deref(), &name, &opened.command, run.shared.force)?;
        let bar = Bar::plain(run.shared.quiet);
        let progress = bar.progress();
        let made = make(&opened, &settings, progress);
        bar.finish();
        match made {
            Ok((patches, matrix)) => {
                if let Some(what) = notes::unlit(&matrix.unlit, &opened.description) {
                    super::note(&format!("note: {what}"));
                }
                Ok(Some(Self { opened, matrix, patches, folder }))
            }
            Err(e) => {
                let _ = std::fs::remove_dir(&folder); // only if it is empty
                if !matches!(e, MatrixError::Stopped) {
                    return Err(e.into());
                }
                super::note("nothing to save yet");
                Ok(None)
            }
        }
    }

    /// The channel asked for, or the slowest.
    fn channel(&self, asked: Option<Channel>) -> usize {
        let radii = DVec3::from_array(self.matrix.spectral.each_ref().map(|s| s.radius));
        asked.map_or(radii.max_position(), |c| c as usize)
    }

    fn patches(&self) -> usize {
        self.patches
    }

    fn caption(&self, run: &Run) -> Caption {
        Caption { command: self.opened.command.clone(), seed: run.seed, scene: self.opened.description.name.clone() }
    }

    /// Writes the summary that owns the folder, and removes what the last run left and this one did not write.
    fn sign(&self, run: &Run, files: &[String]) -> Result<(), Failure> {
        let record = summary::Summary {
            command: self.opened.command.clone(),
            scene: self.opened.description.name.clone(),
            scene_hash: self.opened.hash.clone(),
            seed: run.seed,
            threads: rayon::current_num_threads(),
            files: files.to_vec(),
            ..summary::Summary::default()
        };
        let old = output::left_by_the_last_run(&self.folder);
        summary::write(&self.folder.join("summary.json"), &record)?;
        output::remove_stale(&self.folder, &old, files);
        Ok(())
    }
}
