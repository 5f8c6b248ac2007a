//! What can be typed.

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::scene::{Selection, bsdf::Sampling};
use std::path::PathBuf;
use std::time::Duration;

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

/// The operator view of global illumination: L = E + T L = Σ T^k E, measured
#[derive(Debug, Parser)]
#[command(name = "fredholm", version, max_term_width = 100, about = TOUR, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; nothing is the tour
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Arguments of the tour
    #[command(flatten)]
    pub tour: Run,
}

/// Parses the command line, or prints help or what is wrong with it and ends the program.
pub fn read() -> Cli {
    // the tour's options are explained by `fredholm tour --help`; here they would hide the commands
    let cli = Cli::command().mut_args(|arg| arg.hide(true));
    // nor does a sweep know matrices
    let matrix =
        ["worlds", "patches", "grading", "factors", "rays", "read_patches", "orders", "verbose", "guide", "time"];
    let cli = cli.mut_subcommand("sweep", |c| matrix.iter().fold(c, |c, name| c.mut_arg(name, |arg| arg.hide(true))));
    let cli = cli.mut_subcommand("sweep", super::sweep_spp::several_values);
    let mut matches = cli.get_matches();
    Cli::from_arg_matches_mut(&mut matches).unwrap_or_else(|e| e.exit())
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// One scene solved three ways and compared: what happens with no arguments
    Tour(Run),
    /// Each T^k E and the sum, beside the path tracer and the radiosity matrix
    #[command(after_help = "Examples:
  fredholm series cornell --spp 256 --max-bounces 8 --size 128x128 --seed 1 -o a
  fredholm series furnace --technique scatter --sampling cosine --spp 64 --json
  fredholm series scene.obj --emit lamp=17,12,4
  fredholm series veach-ajar --guide radiosity --time 30s --worlds terms

How k counts: k is the number of applications of T, so k = 0 is emission seen directly, k = 1 direct
light, k = 2 one bounce of indirect light. --max-bounces K keeps k = 0..=K; everything longer is the
tail. (Elsewhere the same images are Mitsuba's max_depth = K + 1 and pbrt's maxdepth = K.)")]
    Series(Run),
    /// The full path tracer alone
    #[command(after_help = "Example:\n  fredholm render cornell --spp 256 --roulette constant:0.3@2")]
    Render(Run),
    /// The matrix alone: form factors, terms, solve
    #[command(after_help = "Examples:
  fredholm radiosity cornell --patches 2400 --orders
  fredholm radiosity cornell --patches 2400 --factors both --rays 1024   both, compared
  fredholm radiosity cornell --patches 130000 --rays 256                 too many for a matrix
  fredholm radiosity cornell --patches 2000 --solver all --history history.csv
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
    Radiosity(super::radiosity::Radiosity),
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
    Compare(Compare),
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
    Diagnose(super::diagnose::Diagnose),
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
    Sweep(Sweep),
    /// The same estimators on the radiosity matrix, beside its powers
    #[command(after_help = "Examples:
  fredholm walk cornell --patches 500 --estimator prefix
  fredholm walk cornell --patches 500 --estimator absorption --spp 65536
  fredholm walk cornell --patches 500 --estimator zero-variance

On a matrix T^k E is known to rounding, so the walk is compared patch by patch with the truth.
zero-variance: absorption with p_ij ∝ T_ij B_j and q_i = E_i/B_i, B the solution itself; then with worse
and worse guides, to see what a guide is worth (walk.png, walk.csv).")]
    Walk(super::walk::Walk),
    /// Is an estimator biased? Does the equation hold?
    #[command(after_help = "Examples:
  fredholm check bias --estimator prefix --against path --scene cornell --alpha 1e-3
  fredholm check equilibrium cornell

Exit code 1: a bias was found, or the equation was rejected.")]
    Check(super::check::Check),
    /// Rebuilds a figure: data, pictures, and the command that makes them
    #[command(after_help = super::figure::EXAMPLES)]
    Figure(super::figure::Figure),
    /// Roulette schedules: predicted without rendering, verified, optimised
    #[command(after_help = super::roulette::EXAMPLES)]
    Roulette(super::roulette::Args),
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
    Zoo(super::zoo::Zoo),
    /// Scenes, materials, lights, bounds on the norm of T
    #[command(after_help = "Examples:
  fredholm info            the built-in scenes
  fredholm info cornell
  fredholm info box.toml   also a check of the file")]
    Info(Info),
    /// Runs a chapter of the book
    Chapter(Chapter),
}

/// Roulette as it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// This schedule.
    Given(Roulette),
    /// The one with the most efficiency, which only the scene can tell.
    Optimal,
}

/// A result as a choice on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WorldName {
    /// Each term by its own estimator
    Terms,
    /// The full path tracer
    Path,
    /// The matrix over patches
    Radiosity,
}

/// Estimators of the terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EstimatorName {
    /// Each term from paths of its own
    Single,
    /// All terms from the prefixes of one path
    Prefix,
    /// A tree of paths
    Branching,
    /// All terms from particles, walked from the light
    Light,
    /// All terms from walks from both ends
    Bidirectional,
}

/// What decides where rays look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GuideName {
    /// The surface alone
    Bsdf,
    /// The matrix over patches
    Radiosity,
}

/// Arguments of everything that renders.
#[derive(Clone, Debug, Args)]
pub struct Run {
    /// Built-in scene, .toml, or .obj
    #[arg(value_name = "SCENE", default_value = "cornell")]
    pub scene: String,
    /// Samples per pixel [default: 256]
    ///
    /// [default in a sweep over branching: 32]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Image size in pixels [default: the scene's; 192x192 for the tour]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// K: keep the terms k = 0..=K; k counts applications of T [default: 8]
    ///
    /// [default in a sweep over branching: 4]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub max_bounces: Option<u16>,
    /// Estimator of the terms: prefix, single, light, … [default: prefix]
    ///
    /// single: each term from paths of its own; prefix: all terms from the prefixes of one path;
    /// branching: a tree, --branching children at every vertex; light: particles from the lights;
    /// bidirectional: walks from both ends, joined in every way. The tour runs the first two.
    #[arg(long, value_enum, value_name = "NAME", hide_possible_values = true, verbatim_doc_comment)]
    pub estimator: Option<EstimatorName>,
    /// With --estimator bidirectional: every strategy apart
    ///
    /// Writes strategies.png, strategies-alone.png and strategies.exr, and prints a table:
    /// for each term, what is found with s = 0 to k + 1 vertices walked from the light.
    #[arg(long, verbatim_doc_comment)]
    pub strategies: bool,
    /// Children of every vertex of --estimator branching
    ///
    /// Term k takes N^k rays.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// How samples lie in a pixel: independent, sobol
    ///
    /// independent: they know nothing of each other; sobol: Owen-scrambled Sobol points,
    /// one scramble per replicate.
    #[arg(long, default_value = "independent", value_parser = points, value_name = "NAME", verbatim_doc_comment)]
    pub points: Points,
    /// What tells rays where to look: bsdf, radiosity
    ///
    /// bsdf: the surface alone; radiosity: at Lambertian surfaces directions are drawn from what a
    /// radiosity solution of the scene (--patches, default 1000) expects from them, mixed with
    /// the cosine. Other surfaces scatter as before. The matrix is only a guide: it takes every
    /// surface for Lambertian and glass for black; what it gets wrong costs noise, never a bias.
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value = "bsdf",
        hide_possible_values = true,
        verbatim_doc_comment
    )]
    pub guide: GuideName,
    /// Time for each world of rays, instead of --spp: 30s, 5m
    ///
    /// Passes are added while they are expected to end in time; a guide's preparation counts.
    /// The first pass, 16 samples per pixel, is always finished. The result is, bit for bit, that
    /// of --spp with the number of samples that was reached.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "spp", verbatim_doc_comment)]
    pub time: Option<Duration>,
    /// How light is found: scatter, connect, mis, mis-power
    ///
    /// scatter: paths must hit it; connect: next-event estimation (and hits after a mirror);
    /// mis: both, weighed by the balance heuristic; mis-power: by the power heuristic.
    #[arg(long, default_value = "mis", value_parser = technique, value_name = "NAME", verbatim_doc_comment)]
    pub technique: Technique,
    /// How a light is selected: uniform, power
    #[arg(long, default_value = "uniform", value_parser = selection, value_name = "NAME")]
    pub lights: Selection,
    /// How directions are drawn: uniform, cosine, bsdf
    #[arg(long, default_value = "bsdf", value_parser = sampling, value_name = "NAME")]
    pub sampling: Sampling,
    /// Russian roulette: none, lecture, constant:Q@V, … (all: --help)
    ///
    /// [default: render: lecture; else none for k ≤ K, then albedo]
    ///
    /// q is the probability of TERMINATION, tested at vertex v = 0, 1, … after it is scored:
    ///   none                 never; nothing longer than K is estimated
    ///   lecture              q = 0, 0, then 0.5
    ///   constant:Q[@V]       q = Q from vertex V on (2)
    ///   table:q0,q1,…        as listed, the last for all that follow
    ///   albedo[@V]           q = 1 − albedo from vertex V on (2)
    ///   throughput[@V]       q = 1 − throughput from vertex V on (2)
    ///   contribution[@V]     with --guide: q = 1 − expected of the rest/expected of the pixel,
    ///                        at most 0.9, from vertex V on (1); elsewhere as albedo
    ///   optimal              the table with the most efficiency, found by a pilot of 2^18 paths
    #[arg(long, value_name = "SCHEDULE", value_parser = schedule, verbatim_doc_comment)]
    pub roulette: Option<Schedule>,
    /// Which worlds to solve, with commas: terms, path, radiosity
    ///
    /// terms: each term by its own estimator; path: the full path tracer;
    /// radiosity: the matrix over patches. [default: all; render and radiosity: their own]
    #[arg(
        long,
        value_enum,
        value_delimiter = ',',
        value_name = "WORLD,…",
        hide_possible_values = true,
        verbatim_doc_comment
    )]
    pub worlds: Vec<WorldName>,
    /// About how many patches the matrix has [default: 600; tour: 2400]
    ///
    /// Up to 20000 for a dense matrix, 2000000 for stored rays.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2_000_000))]
    pub patches: Option<u32>,
    /// How much narrower patches get towards edges where faces meet: 1 (not) to 8
    ///
    /// Widths across an edge go like distance^(1 − 1/G); about 1.5 to 2 give eigenvalues and sums
    /// their order 2 in h where edges are all that spoils it. Quadrilaterals are graded, whole
    /// faces and pieces cut by others; triangles and curved surfaces keep patches of equal area.
    #[arg(long, value_name = "G", default_value_t = 1.0, value_parser = grading, verbatim_doc_comment)]
    pub grading: f64,
    /// How form factors are held: dense, rays or both
    ///
    /// dense: a matrix, deterministic; rays: rows of stored rays, with an error bar;
    /// both: the matrix, and how far rays on the same patches are from it.
    /// [default: dense up to 10000 patches, rays beyond]
    #[arg(long, value_enum, value_name = "HOW", hide_possible_values = true, verbatim_doc_comment)]
    pub factors: Option<FactorsName>,
    /// Rays of every patch, where they are stored [default: 256]
    ///
    /// 2 to 65536; powers of two are best.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65_536))]
    pub rays: Option<u32>,
    /// Show patches as they are, without gathering a last bounce from them
    #[arg(long)]
    pub read_patches: bool,
    /// Fit the order of convergence of the radiosity from three meshes
    #[arg(long)]
    pub orders: bool,
    /// Override a key of the scene
    ///
    /// For example materials.white.reflectance=[0.6,0.6,0.6]
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Let a material emit: lamp=17,12,4
    #[arg(long, value_name = "MATERIAL=R,G,B")]
    pub emit: Vec<String>,
    /// Output folder [default: fredholm-out/<scene>]
    ///
    /// The same command replaces its own output. Where another run's stands, the default becomes
    /// <scene>-2, and a folder given here is refused without --force.
    #[arg(short, long, value_name = "DIR", verbatim_doc_comment)]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]; results do not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print summary.json instead of tables
    #[arg(long)]
    pub json: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
    /// More about the matrix and the cost
    #[arg(short, long)]
    pub verbose: bool,
}

/// How form factors are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FactorsName {
    /// A matrix of deterministic form factors
    Dense,
    /// Rows of stored rays, with an error bar
    Rays,
    /// The matrix, and how far rays on the same patches are from it
    Both,
}

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
    pub several: super::sweep_spp::Several,
    /// What is rendered.
    #[command(flatten)]
    pub run: Run,
}

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct Compare {
    /// A result: an output folder or its summary.json
    pub a: PathBuf,
    /// Another result
    pub b: PathBuf,
    /// δ as a fraction of the term
    #[arg(long, default_value_t = 0.02, value_name = "FRACTION", value_parser = fraction)]
    pub of_term: f64,
    /// δ as a fraction of the whole image, added
    #[arg(long, default_value_t = 1e-4, value_name = "FRACTION", value_parser = fraction)]
    pub of_total: f64,
    /// Chance that equal results are told apart anywhere
    #[arg(long, default_value_t = 1e-3, value_name = "P", value_parser = probability)]
    pub alpha: f64,
    /// Where the z map goes [default: fredholm-out/compare]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `info`.
#[derive(Clone, Debug, Args)]
pub struct Info {
    /// Built-in scene, .toml, or .obj; nothing lists the built-in scenes
    pub scene: Option<String>,
    /// Override a key of the scene
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Let a material emit
    #[arg(long, value_name = "MATERIAL=R,G,B")]
    pub emit: Vec<String>,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `chapter`.
#[derive(Clone, Debug, Args)]
pub struct Chapter {
    /// Number of the chapter; nothing lists them
    pub number: Option<u32>,
    /// Folder for its figures [default: fredholm-out/chapter-<number>]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

pub fn size(s: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{s}` is not a size such as 128x128 (each side 1 to 32768)");
    let (w, h) = s.split_once('x').ok_or_else(wrong)?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=32768).contains(n)).ok_or_else(wrong);
    Ok([side(w)?, side(h)?])
}

fn grading(s: &str) -> Result<f64, String> {
    let g: f64 = s.parse().map_err(|_| format!("`{s}` is not a number"))?;
    if (1.0..=8.0).contains(&g) { Ok(g) } else { Err("a grading is a number from 1 to 8".into()) }
}

/// `30s`, `1.5m`, `500ms`; a bare number is seconds.
fn duration(s: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, unit) = units.iter().find_map(|(u, f)| Some((s.strip_suffix(u)?, *f))).unwrap_or((s, 1.0));
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x <= 1e6);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 30s, 1.5m or 500ms"))
}

fn fraction(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite()).ok_or(format!("`{s}` is not a number from 0 on"))
}

pub fn probability(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|p| *p > 0.0 && *p < 1.0).ok_or(format!("`{s}` is not between 0 and 1"))
}

pub(super) fn technique(s: &str) -> Result<Technique, String> {
    match s {
        "scatter" => Ok(Technique::Scatter),
        "connect" => Ok(Technique::Connect),
        "mis" => Ok(Technique::Mis),
        "mis-power" => Ok(Technique::Power),
        _ => Err(format!("`{s}` is none of scatter, connect, mis, mis-power")),
    }
}

pub(super) fn schedule(s: &str) -> Result<Schedule, String> {
    if s == "optimal" { Ok(Schedule::Optimal) } else { s.parse().map(Schedule::Given) }
}

pub(super) fn points(s: &str) -> Result<Points, String> {
    match s {
        "independent" => Ok(Points::Independent),
        "sobol" => Ok(Points::Sobol),
        _ => Err(format!("`{s}` is none of independent, sobol")),
    }
}

pub(super) fn selection(s: &str) -> Result<Selection, String> {
    match s {
        "uniform" => Ok(Selection::Uniform),
        "power" => Ok(Selection::Power),
        _ => Err(format!("`{s}` is none of uniform, power")),
    }
}

pub(super) fn sampling(s: &str) -> Result<Sampling, String> {
    match s {
        "uniform" => Ok(Sampling::Uniform),
        "cosine" => Ok(Sampling::Cosine),
        "bsdf" => Ok(Sampling::Bsdf),
        _ => Err(format!("`{s}` is none of uniform, cosine, bsdf")),
    }
}
