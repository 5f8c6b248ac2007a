//! `fredholm radiosity [SCENE]`: the matrix through the camera, or with `--solver` all ways to solve it.

use super::args::Run;
use super::progress::{Progress, stop_flag};
use super::{Ending, Failure, args::WorldName, guard, output, solve};
use clap::{Args, ValueEnum};
use fredholm::operator::matrix::{LinearOperator, Rows};
use fredholm::report::solvers;
use fredholm::report::typeset::Caption;
use fredholm::report::{summary, write_atomically};
use fredholm::scene::Scene;
use fredholm::scene::load::{self, Loaded, Options};
use fredholm::solver::study::{History, Limits, Solver, System};
use fredholm::terms::TermFilm;
use fredholm::worlds::Observer;
use fredholm::worlds::discrete::{self, Matrix, MatrixError};
use serde_json::{Value, json};
use std::sync::atomic::Ordering;

/// Arguments of `radiosity`.
#[derive(Clone, Debug, Args)]
pub struct Radiosity {
    /// Solve (I − T) L = E step by step instead of showing L: all, or the name of one solver
    ///
    /// neumann: partial sums of Σ TᵏE. jacobi: the same unless patches are curved and see themselves.
    /// gauss-seidel, sor: patch by patch. southwell: progressive shooting, the brightest first.
    /// chebyshev: needs the ends of the spectrum. cg: conjugate gradients in the weight 1/ρ. gmres.
    /// lu: the direct solve that all others are held against.
    #[arg(long, value_enum, value_name = "NAME", hide_possible_values = true, verbatim_doc_comment)]
    pub solver: Option<SolverName>,
    /// Channel that --solver solves [default: the one with the largest spectral radius]
    #[arg(long, value_enum, value_name = "NAME", requires = "solver")]
    pub channel: Option<Channel>,
    /// File for every step of every solver, as CSV, in the output folder
    #[arg(long, value_name = "FILE", requires = "solver")]
    pub history: Option<String>,
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
    /// What it stands for; LU is the reference and always there.
    fn solvers(self) -> Vec<Solver> {
        let one = match self {
            Self::All => return Solver::ALL.to_vec(),
            Self::Neumann => Solver::Neumann,
            Self::Jacobi => Solver::Jacobi,
            Self::GaussSeidel => Solver::GaussSeidel,
            Self::Sor => Solver::Sor,
            Self::Southwell => Solver::Southwell,
            Self::Chebyshev => Solver::Chebyshev,
            Self::Cg => Solver::ConjugateGradients,
            Self::Gmres => Solver::Gmres,
            Self::Lu => return vec![Solver::Lu],
        };
        vec![one, Solver::Lu]
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

const NAMES: [&str; 3] = ["red", "green", "blue"];

/// Shows the matrix, or solves it in every way.
pub fn run(args: &Radiosity) -> Result<Ending, Failure> {
    match args.solver {
        Some(name) => solve_step_by_step(args, name),
        None => solve::radiosity(&args.run),
    }
}

/// A scene, its matrix and where the results go.
struct Laboratory {
    command: String,
    loaded: Loaded,
    matrix: Matrix,
    folder: std::path::PathBuf,
}

/// Loads, meshes and computes form factors; `None` if interrupted.
fn laboratory(run: &Run, what: &str) -> Result<Option<Laboratory>, Failure> {
    if let Some(n) = run.threads {
        rayon::ThreadPoolBuilder::new().num_threads(n.into()).build_global()?;
    }
    let command = output::canonical_command();
    let loaded = load::scene(&run.scene, &Options { set: run.set.clone(), emit: run.emit.clone() })?;
    loaded.warnings.iter().for_each(|w| super::note(&format!("warning: {w}")));
    let scene = Scene::new(&loaded.description);
    let mut worlds = vec![WorldName::Radiosity];
    guard::suits_a_matrix(&loaded.description, &mut worlds, true)?;
    guard::fits_in_a_matrix(&scene, &mut worlds, true)?;
    let name = format!("{}-{what}", loaded.description.name);
    let folder = output::folder(run.out.as_deref(), &name, &command, run.force)?;
    let progress = Progress::new(run.quiet, |_: &TermFilm| {});
    let patches = run.patches.unwrap_or(600) as usize;
    let matrix = discrete::matrix(&loaded.description, &scene, patches, 0, &progress, stop_flag());
    progress.finish();
    match matrix {
        Ok(matrix) => Ok(Some(Laboratory { command, loaded, matrix, folder })),
        Err(MatrixError::Stopped) => {
            super::note("nothing to save yet");
            let _ = std::fs::remove_dir(&folder); // only if it is empty
            Ok(None)
        }
        Err(e) => Err(e.into()),
    }
}

/// Good enough, and too many.
const ERROR: f64 = 1e-12;
const APPLICATIONS: f64 = 2000.0;

fn solve_step_by_step(args: &Radiosity, name: SolverName) -> Result<Ending, Failure> {
    let Some(lab) = laboratory(&args.run, "solvers")? else { return Ok(Ending::Interrupted) };
    let radius = lab.matrix.spectral.each_ref().map(|s| s.radius);
    let slowest = (0..3).fold(0, |best, c| if radius[c] > radius[best] { c } else { best });
    let channel = args.channel.map_or(slowest, |c| c as usize);
    let radiosity = &lab.matrix.radiosity;
    let operator = radiosity.operator(channel);
    let system = System::new(&operator, radiosity.emission(channel)).map_err(|_| MatrixError::Singular)?;
    let stopped = || stop_flag().load(Ordering::Relaxed);
    let limits = Limits { error: ERROR, applications: APPLICATIONS, stopped: &stopped };
    let progress = Progress::new(args.run.quiet, |_: &TermFilm| {});
    let solvers = name.solvers();
    progress.begin(&format!("solvers, {} patches", radiosity.patches.len()), solvers.len() as u64);
    let mut histories: Vec<History> = vec![];
    for solver in solvers {
        let history = system.history(solver, limits);
        progress.advance(1);
        if !history.points.is_empty() {
            histories.push(history);
        }
    }
    progress.finish();
    let files = write(args, &lab, &histories, (channel, radius[channel]))?;
    let [low, high] = [system.ends.smallest, system.ends.largest];
    let record = record(args, &lab, channel, [low, high], solvers::machine(&histories));
    write_atomically(&lab.folder.join("solvers.json"), serde_json::to_string_pretty(&record)?.as_bytes())?;
    if args.run.json {
        super::say(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let sees_itself = (0..operator.len()).any(|i| operator.entry(i, i) > 0.0);
        let mut head = format!(
            "{}\n{} patches, {} channel: eigenvalues {low:.5} to {high:.5}\n\
             products with T, then seconds, until ‖x − L‖/‖L‖ in the weight A/ρ is below 1e-3, 1e-6, 1e-10\n\
             the reference is LU, which counts as n/3 products; Chebyshev and SOR spend {} on the spectrum first",
            lab.command,
            radiosity.patches.len(),
            NAMES[channel],
            system.ends.steps,
        );
        if !sees_itself {
            head += "\nno patch sees itself, so Jacobi is the Neumann series here";
        }
        let table = solvers::table(&histories);
        let written = format!("written to {}: {}", lab.folder.display(), files.join(", "));
        super::say(&super::paragraphs(&[head, table, written]))?;
    }
    Ok(if stopped() { Ending::Interrupted } else { Ending::Ok })
}

fn record(args: &Radiosity, lab: &Laboratory, channel: usize, ends: [f64; 2], solvers: Value) -> Value {
    json!({
        "command": lab.command,
        "scene": lab.loaded.description.name,
        "scene_hash": solve::scene_hash(&lab.loaded.canonical),
        "seed": args.run.seed,
        "threads": rayon::current_num_threads(),
        "patches": lab.matrix.radiosity.patches.len(),
        "channel": NAMES[channel],
        "eigenvalues": { "smallest": ends[0], "largest": ends[1] },
        "solvers": solvers,
    })
}

/// Writes the figure, the steps and the summary; returns the names of the files.
fn write(
    args: &Radiosity,
    lab: &Laboratory,
    histories: &[History],
    (channel, radius): (usize, f64),
) -> Result<Vec<String>, Failure> {
    let description = &lab.loaded.description;
    let caption = Caption { command: lab.command.clone(), seed: args.run.seed, scene: description.name.clone() };
    let title = format!(
        "Solvers of (I − T) L = E: {}, {} patches, {}",
        description.name,
        lab.matrix.radiosity.patches.len(),
        NAMES[channel]
    );
    let mut files = vec!["solvers.json".to_string(), "summary.json".into()];
    if histories.iter().any(|h| h.points.len() > 1) {
        solvers::draw(histories, radius, &title, &caption)?.write(&lab.folder, "solvers")?;
        files.extend(["solvers.png", "solvers.svg"].map(String::from));
    }
    if let Some(name) = &args.history {
        write_atomically(&lab.folder.join(name), solvers::csv(histories).as_bytes())?;
        files.push(name.clone());
    }
    let record = summary::Summary {
        command: lab.command.clone(),
        scene: description.name.clone(),
        scene_hash: solve::scene_hash(&lab.loaded.canonical),
        seed: args.run.seed,
        threads: rayon::current_num_threads(),
        files: files.clone(),
        ..summary::Summary::default()
    };
    let old = output::left_by_the_last_run(&lab.folder);
    summary::write(&lab.folder.join("summary.json"), &record)?;
    output::remove_stale(&lab.folder, &old, &files);
    Ok(files)
}
