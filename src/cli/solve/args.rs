//! What everything that renders takes.

use crate::cli::options::{Frame, Shared, among, duration, grading, one_of};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::{Factors, Form};
use fredholm::engine::guided::Guiding;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::scene::{Selection, bsdf::Sampling};
use fredholm::study::roulette::Schedule;
use fredholm::terms::World;
use std::time::Duration;

/// The names of the estimators.
const ESTIMATORS: [&str; 5] = ["single", "prefix", "branching", "light", "bidirectional"];

/// Arguments of everything that renders.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// What is rendered.
    #[command(flatten)]
    pub frame: Frame,
    /// Estimator of the terms: prefix, single, light, … [default: prefix]
    ///
    /// single: each term from paths of its own; prefix: all terms from the prefixes of one path;
    /// branching: a tree, --branching children at every vertex; light: particles from the lights;
    /// bidirectional: walks from both ends, joined in every way. The tour runs the first two.
    #[arg(long, value_parser = one_of::<Estimator>(ESTIMATORS), value_name = "NAME", hide_possible_values = true, verbatim_doc_comment)]
    pub estimator: Option<Estimator>,
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
    /// How samples lie in a pixel.
    #[arg(long, default_value_t = Points::Independent, value_name = "NAME", help = among(POINTS.0, Points::ALL),
        long_help = among(POINTS.0, Points::ALL) + POINTS.1)]
    pub points: Points,
    /// What tells rays where to look.
    #[arg(long, default_value_t = Guiding::Bsdf, value_parser = one_of::<Guiding>(Guiding::ALL), value_name = "NAME",
        hide_possible_values = true, help = among(GUIDE.0, Guiding::ALL), long_help = among(GUIDE.0, Guiding::ALL) + GUIDE.1)]
    pub guide: Guiding,
    /// Time for each world of rays, instead of --spp: 30s, 5m
    ///
    /// Passes are added while they are expected to end in time; a guide's preparation counts.
    /// The first pass, 16 samples per pixel, is always finished. The result is, bit for bit, that
    /// of --spp with the number of samples that was reached.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "spp", verbatim_doc_comment)]
    pub time: Option<Duration>,
    /// How light is found.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help = among(TECHNIQUE.0, Technique::ALL),
        long_help = among(TECHNIQUE.0, Technique::ALL) + TECHNIQUE.1)]
    pub technique: Technique,
    /// How a light is selected.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", help = among("How a light is selected", Selection::ALL))]
    pub lights: Selection,
    /// How directions are drawn.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help = among("How directions are drawn", Sampling::ALL))]
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
    ///   contribution[@V]     needs --guide: q = 1 − expected of the rest/expected of the pixel,
    ///                        at most 0.9, from vertex V on (1)
    ///   window[@V]           needs --guide, from vertex V on (0), for w = expected of the rest/expected
    ///                        of the pixel: below 0.5 q = 1 − 2w, at most 0.9; above 1 the path splits
    ///                        into w walks in the mean, at most 8
    ///                        (both: prefix and path tracer; single and branching end by albedo,
    ///                        and so does a path at surfaces that the guide knows nothing of)
    ///   optimal              the table with the most efficiency, found by a pilot of 2^18 paths
    #[arg(long, value_name = "SCHEDULE", verbatim_doc_comment)]
    pub roulette: Option<Schedule>,
    /// Which worlds to solve.
    #[arg(long, value_parser = one_of::<World>(World::ALL), value_delimiter = ',', value_name = "WORLD,…",
        hide_possible_values = true, help = among(WORLDS.0, World::ALL), long_help = among(WORLDS.0, World::ALL) + WORLDS.1)]
    pub worlds: Vec<World>,
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
    #[arg(long, value_parser = one_of::<Form>(Form::ALL), value_name = "HOW", hide_possible_values = true, verbatim_doc_comment)]
    pub factors: Option<Form>,
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
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

const POINTS: (&str, &str) = (
    "How samples lie in a pixel",
    "\n\nindependent: they know nothing of each other; sobol: Owen-scrambled Sobol points,\none scramble per replicate.",
);

const GUIDE: (&str, &str) = (
    "What tells rays where to look",
    "\n\nbsdf: the surface alone; radiosity: at Lambertian surfaces directions are drawn from what a
radiosity solution of the scene (--patches, default 4000) expects from them, mixed with
the cosine, and a connection chooses its lamp by what each sends to the patch (in place
of --lights uniform). Other surfaces scatter as before. The matrix is only a guide: it takes
every surface for Lambertian and glass for black; what it gets wrong costs noise, never a
bias. Goes well with --roulette window.",
);

const TECHNIQUE: (&str, &str) = (
    "How light is found",
    "\n\nscatter: paths must hit it; connect: next-event estimation (and hits after a mirror);
mis: both, weighed by the balance heuristic; mis-power: by the power heuristic.",
);

const WORLDS: (&str, &str) = (
    "Which worlds to solve, with commas",
    "\n\nterms: each term by its own estimator; path: the full path tracer;
radiosity: the matrix over patches. [default: all; render and radiosity: their own]",
);

impl RunArgs {
    /// What is rendered with unless a schedule is given: `fallback`, in the terms only after K.
    pub fn settings(&self, fallback: Roulette, patches: u32, factors: Factors) -> Settings {
        let max_bounces = usize::from(self.frame.max_bounces.unwrap_or(8));
        let asked = self.roulette.as_ref().and_then(Schedule::given);
        let by_expectation = match self.roulette {
            Some(Schedule::ByExpectation(end)) => Some(end),
            _ => None,
        };
        Settings {
            spp: self.frame.spp.unwrap_or(if self.time.is_some() { 1 << 24 } else { 256 }),
            time: self.time,
            seed: self.frame.seed,
            points: self.points,
            max_bounces,
            technique: self.technique,
            sampling: self.sampling,
            roulette: asked.clone().unwrap_or(fallback.clone().after(max_bounces)),
            path_roulette: asked.unwrap_or(fallback),
            by_expectation,
            patches: patches as usize,
            factors,
            read_patches: self.read_patches,
            grading: self.grading,
        }
    }

    /// The estimator of the terms that was asked for.
    pub fn estimator(&self) -> Option<Estimator> {
        self.estimator.map(|e| e.with_children(self.branching))
    }
}
