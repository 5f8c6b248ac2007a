//! Commands: each folder or file parses its own arguments, calls the library and reports.
//!
//! ```text
//! base ← options, open, output, progress, preflight, notes, answer, write ← session ← commands ← here
//! ```
//!
//! Results go to stdout, progress and errors to stderr. Exit codes: 0 ok, 1 a comparison failed, 2 usage, 3 scene or file,
//! 130 interrupted with what exists saved.
#![allow(clippy::print_stdout, clippy::print_stderr)]
#![allow(unreachable_pub)] // in a binary `pub` reaches no further than `pub(crate)` and reads better

mod answer;
mod base;
mod chapter;
mod check;
mod compare;
mod diagnose;
mod figure;
mod info;
mod notes;
mod open;
mod options;
mod output;
mod preflight;
mod progress;
mod radiosity;
mod roulette;
mod session;
mod solve;
mod sweep;
mod verdict;
mod walk;
mod write;
mod zoo;

use base::{Ending, Failure, note};
use clap::{Parser, Subcommand};
use solve::RunArgs;
use std::process::ExitCode;

const TOUR: &str = "The operator view of global illumination: L = E + T L = Σ T^k E, measured.

With no arguments: the tour. A Cornell box is solved three ways (each bounce by its own estimator,
the full path tracer, the radiosity matrix), compared with error bars, and written to
fredholm-out/cornell with pictures, plots and a report.";

const EXAMPLES: &str = "Examples:
  fredholm                                        the tour
  fredholm series cornell --spp 64                each bounce, and their sum
  fredholm series box.toml --set materials.white.reflectance=[0.6,0.6,0.6]
  fredholm compare fredholm-out/cornell other     verdict per term
  fredholm sweep cornell --over technique         one setting, several values: cost and gain
  fredholm roulette cornell --optimise            how paths should end, predicted and measured
  fredholm info                                   the built-in scenes
  fredholm info cornell                           materials, lights, bounds

Options: `fredholm tour --help`, `fredholm series --help`, …

Exit codes: 0 ok, 1 a comparison failed, 2 usage, 3 scene or file,
130 interrupted (what exists is saved).";

/// The tour's options are explained by `fredholm tour --help`; here they would hide the commands.
const HELP: &str = "{about-with-newline}
{usage-heading} {usage}

Commands:
{subcommands}

Options:
  -h, --help     Print help
  -V, --version  Print version{after-help}";

/// The operator view of global illumination: L = E + T L = Σ T^k E, measured
#[derive(Debug, Parser)]
#[command(name = "fredholm", version, max_term_width = 100, about = TOUR, after_help = EXAMPLES, help_template = HELP)]
#[command(override_usage = "fredholm\n       fredholm <COMMAND>", args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; nothing is the tour
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Arguments of the tour
    #[command(flatten)]
    pub tour: RunArgs,
}

/// Parses the command line, or prints help or what is wrong with it and ends the program.
pub fn read() -> Cli {
    Cli::parse()
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// One scene solved three ways and compared: what happens with no arguments
    Tour(RunArgs),
    /// Each T^k E and the sum, beside the path tracer and the radiosity matrix
    #[command(after_help = "Examples:
  fredholm series cornell --spp 256 --max-bounces 8 --size 128x128 --seed 1 -o a
  fredholm series furnace --technique scatter --sampling cosine --spp 64 --json
  fredholm series scene.obj --emit lamp=17,12,4
  fredholm series veach-ajar --guide radiosity --time 30s --worlds terms

How k counts: k is the number of applications of T, so k = 0 is emission seen directly, k = 1 direct
light, k = 2 one bounce of indirect light. --max-bounces K keeps k = 0..=K; everything longer is the
tail. (Elsewhere the same images are Mitsuba's max_depth = K + 1 and pbrt's maxdepth = K.)")]
    Series(RunArgs),
    /// The full path tracer alone
    #[command(after_help = "Example:\n  fredholm render cornell --spp 256 --roulette constant:0.3@2")]
    Render(RunArgs),
    /// The matrix alone: form factors, terms, solve
    #[command(after_help = "Examples:
  fredholm radiosity cornell --patches 2400 --orders
  fredholm radiosity cornell --patches 2400 --factors both --rays 1024   both, compared
  fredholm radiosity cornell --patches 130000 --rays 256                 too many for a matrix
  fredholm radiosity cornell --patches 2000 --solver all --history history.csv
  fredholm radiosity cornell --patches 130000 --solver gmres             on stored rays
  fredholm radiosity cornell --solver southwell --channel green --json
  fredholm radiosity cornell --modes 8 --size 128x128
  fredholm radiosity cornell --patches 2400 --export matrix              for another program

The spectral radius is that of the mesh, then extrapolated to h → 0, with the span that the
uncertainty of the order leaves: an estimate, no bound. A dense matrix has two coarser meshes for
it (N/4, N/16), stored rays of 50000 patches or more the unions of 4 and 16 patches.

With --export also written: mesh.csv (patch, primitive, front, centre, area, normal, albedo, E, L,
corners), mesh-terms.csv ((T^k E) of every patch), norms.csv (1-, 2- and 1/ρ-weighted norm of every
T^k E over the patches, as in summary.json); with `matrix` F.npy, n × n float32. Metres; W sr⁻¹ m⁻²;
radiosity B = π L.

With --solver nothing is rendered. Written: solvers.json, solvers.svg, solvers.png, summary.json,
and the file of --history. A product is one application of T; LU counts as n/3 of them.

With --modes the dense eigenproblem of every channel is solved. Written: modes.json, modes.svg,
modes.png, modes-painted.png, summary.json. Eigenvalues inside the band of the edges get no name:
they belong to the mesh, not to the scene.")]
    Radiosity(radiosity::Radiosity),
    /// Two results: verdict per term, z map
    #[command(
        after_help = "Agrees: the difference is proved smaller than δ = 2 % of the term + 1e-4 of the whole image.
Differs: it is proved not to be zero.
Inconclusive: more samples are needed (how many is printed); exit code 1, as for Differs.

Example:
  fredholm series cornell --seed 1 -o a
  fredholm series cornell --seed 2 -o b
  fredholm compare a b"
    )]
    Compare(compare::Compare),
    /// Somebody else's pictures: correct, or what is wrong with them
    #[command(
        after_help = "The pictures are compared with the right terms, region by region. If they differ, every known mistake
is rendered in the same scene, and those that the pictures contradict are struck off. What stays is
the answer: a name, or a short list that this data cannot tell apart.

A file with the terms in layers T00, T01, … says most; the whole image alone says less; 8 bits least.

Exit code 0: correct, as far as the data can tell; 1: something is wrong.

Examples:
  fredholm diagnose mine.exr --against cornell
  fredholm diagnose T00.exr T01.exr T02.exr T03.exr --against box.toml
  fredholm diagnose r_4.exr r_16.exr r_64.exr --against cornell         growing samples per pixel
  fredholm diagnose mine.exr --scale 10=large.exr --against cornell     the scene ten times larger
  fredholm diagnose mine.png --gain 2 --against fredholm-out/cornell
  fredholm diagnose zoo-out/*.exr --against cornell"
    )]
    Diagnose(diagnose::Diagnose),
    /// The terms for every value of one setting: cost beside gain
    #[command(after_help = "Examples:
  fredholm sweep furnace --over branching --sampling uniform --spp 64
  fredholm sweep cornell --over technique --max-bounces 4 --size 64x64
  fredholm sweep cornell --over estimator --values prefix,single --equal-rays
  fredholm sweep cornell --over patches        the matrix on finer meshes, against rays
  fredholm sweep cube --over patches --grading 1.5 --values 96,384,1536
  fredholm sweep cornell --over patches --values 129,516,2064,8256 --eigenvalues 6
  fredholm sweep cornell --over spp --estimator single,prefix,path
  fredholm sweep cornell --over spp --estimator prefix --points independent,sobol --reference 4096
  fredholm sweep cornell --over split --max-bounces 6 --size 64x64

--over spp: one render for every combination of --estimator (also path), --technique, --roulette and
--points, which may be lists; variance and squared error at 16, 32, 64, … samples are read off the
film as it fills. Written: variance.svg, variance.png, sweep.csv, summary.json.

--over split: the terms by equal split (--estimator single), by the optimal split n ∝ σ/√c, and
from the prefixes of one path, at about the same rays: variance × cost, predicted by a pilot and
measured.
Written: split.csv, covariance.csv, covariance.svg, covariance.png, summary.json.

All others. Written: sweep.csv, sweep.svg, sweep.png, summary.json. V is the variance of one sample,
averaged over the pixels; 1/(V rays) is the efficiency: twice of it is half the rays for the same
error.")]
    Sweep(sweep::Sweep),
    /// The same estimators on the radiosity matrix, beside its powers
    #[command(after_help = "Examples:
  fredholm walk cornell --patches 500 --estimator prefix
  fredholm walk cornell --patches 500 --estimator absorption --spp 65536
  fredholm walk cornell --patches 500 --estimator zero-variance

On a matrix T^k E is known to rounding, so the walk is compared patch by patch with the truth.
zero-variance: absorption with p_ij ∝ T_ij B_j and q_i = E_i/B_i, B the solution itself; then with worse
and worse guides, to see what a guide is worth (walk.png, walk.csv).")]
    Walk(walk::Walk),
    /// Is an estimator biased? Does the equation hold?
    #[command(after_help = "Examples:
  fredholm check bias --estimator prefix --against path --scene cornell --alpha 1e-3
  fredholm check equilibrium cornell

Exit code 1: a bias was found, or the equation was rejected.")]
    Check(check::Check),
    /// Rebuilds a figure: data, pictures, and the command that makes them
    #[command(after_help = figure::EXAMPLES)]
    Figure(figure::Figure),
    /// Roulette schedules: predicted without rendering, verified, optimised
    #[command(after_help = roulette::EXAMPLES)]
    Roulette(roulette::Args),
    /// Estimators that are wrong on purpose, each beside the right one
    #[command(after_help = "Examples:
  fredholm zoo                     all members: NAME.exr in zoo-out, and r_k of each
  fredholm zoo --list              who lives there, and what is wrong with them
  fredholm zoo double-emission     one beside the right estimator: table, picture, plot
  fredholm zoo mixed-measures --scene cornell
  fredholm zoo --quiz --seed 3     predict, then reveal

r_k = T_k wrong / T_k right. Flat in k: the connection to the light is wrong; c^(k-1): the bounce or
the roulette; c^k: the BSDF. Written: zoo-out/NAME.exr for what cornell shows, zoo-out/SCENE/NAME.exr
for what it does not, correct.exr as the control. Layers: the image, T00, T01, …, T00_se, ….")]
    Zoo(zoo::Zoo),
    /// Scenes, materials, lights, bounds on the norm of T
    #[command(after_help = "Examples:
  fredholm info            the built-in scenes
  fredholm info cornell
  fredholm info box.toml   also a check of the file")]
    Info(info::Info),
    /// Runs a chapter of the book
    Chapter(chapter::Chapter),
}

/// Runs a command to its exit code.
pub fn run(cli: Cli) -> ExitCode {
    let result = match &cli.command {
        None => solve::tour(&cli.tour),
        Some(Command::Tour(run)) => solve::tour(run),
        Some(Command::Series(run)) => solve::series(run),
        Some(Command::Render(run)) => solve::render(run),
        Some(Command::Radiosity(args)) => radiosity::run(args),
        Some(Command::Compare(args)) => compare::run(args),
        Some(Command::Diagnose(args)) => diagnose::run(args),
        Some(Command::Sweep(args)) => sweep::run(args),
        Some(Command::Walk(args)) => walk::run(args),
        Some(Command::Check(args)) => check::run(args),
        Some(Command::Figure(args)) => figure::run(args),
        Some(Command::Roulette(args)) => roulette::run(args),
        Some(Command::Zoo(args)) => zoo::run(args),
        Some(Command::Info(args)) => info::run(args),
        Some(Command::Chapter(args)) => chapter::run(args),
    };
    match result {
        Ok(Ending::Ok) => ExitCode::SUCCESS,
        Ok(Ending::Failed) => ExitCode::from(1),
        Ok(Ending::Interrupted) => ExitCode::from(130),
        Err(Failure::Usage(text)) => {
            note(&text);
            ExitCode::from(2)
        }
        Err(Failure::Input(text)) => {
            note(&text);
            ExitCode::from(3)
        }
    }
}
