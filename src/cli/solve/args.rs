//! Arguments of `tour`, `series`, `render` and `radiosity`, in groups: each command takes the groups that act there.
//!
//! | group | options | tour | series | render | radiosity |
//! |---|---|---|---|---|---|
//! | [`Frame`], [`Shared`] | scene, samples, size, K, seed; output | yes | yes | yes | yes |
//! | [`Worlds`] | the ways to solve | yes | yes | | |
//! | [`Terms`] | estimator of the terms | | yes | | |
//! | [`Light`] | technique, guide, roulette | yes | yes | yes | |
//! | [`Pixels`] | directions, lights, points, time | yes | yes | yes | yes |
//! | [`Mesh`] | patches, form factors | yes | yes | | yes |
//! | [`Pictures`] | exposure of the terms | yes | yes | | yes |
//! | [`Keeping`] | going on with an earlier run | yes | yes | yes | |
//! | [`Sharding`] | one part of a run | | yes | yes | |

use crate::cli::choices::{ESTIMATORS, FORMS, GUIDES, LIGHTS, POINTS, SAMPLINGS, TECHNIQUES, WORLDS};
use crate::cli::keep::{Keeping, Sharding};
use crate::cli::options::{Frame, HOW, MATRIX, OUTPUT, Shared, WHAT, corners, duration, grading, one_of};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::{Factors, Form};
use fredholm::engine::guided::Guiding;
use fredholm::estimator::render::Amount;
use fredholm::estimator::{Roulette, Technique};
use fredholm::math::Points;
use fredholm::report::image::exposure::Exposure;
use fredholm::scene::{Selection, bsdf::Sampling};
use fredholm::stats::evidence::PIXEL_REPLICATES;
use fredholm::study::roulette::Schedule;
use fredholm::terms::World;
use std::time::Duration;

/// Arguments of `tour`.
#[derive(Clone, Debug, Args)]
pub struct Tour {
    /// Scene, samples, size, K, seed.
    #[command(flatten)]
    pub frame: Frame,
    /// The ways to solve the scene.
    #[command(flatten)]
    pub worlds: Worlds,
    /// How paths find light and when they end.
    #[command(flatten)]
    pub light: Light,
    /// How samples are drawn.
    #[command(flatten)]
    pub pixels: Pixels,
    /// The matrix.
    #[command(flatten)]
    pub mesh: Mesh,
    /// The pictures of the terms.
    #[command(flatten)]
    pub pictures: Pictures,
    /// Going on with an earlier run.
    #[command(flatten)]
    pub keeping: Keeping,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// What `series` solves, and how: on this machine, or in the tasks of a cluster.
#[derive(Clone, Debug, Args)]
pub struct Solving {
    /// Scene, samples, size, K, seed.
    #[command(flatten)]
    pub frame: Frame,
    /// The ways to solve the scene.
    #[command(flatten)]
    pub worlds: Worlds,
    /// The estimator of the terms.
    #[command(flatten)]
    pub terms: Terms,
    /// How paths find light and when they end.
    #[command(flatten)]
    pub light: Light,
    /// How samples are drawn.
    #[command(flatten)]
    pub pixels: Pixels,
    /// The matrix.
    #[command(flatten)]
    pub mesh: Mesh,
    /// The pictures of the terms.
    #[command(flatten)]
    pub pictures: Pictures,
}

/// Arguments of `series`: all groups.
#[derive(Clone, Debug, Args)]
pub struct Series {
    /// What is solved, and how.
    #[command(flatten)]
    pub solving: Solving,
    /// One part of the run.
    #[command(flatten)]
    pub sharding: Sharding,
    /// Going on with an earlier run.
    #[command(flatten)]
    pub keeping: Keeping,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// Arguments of `render`.
#[derive(Clone, Debug, Args)]
pub struct Render {
    /// Scene, samples, size, K, seed.
    #[command(flatten)]
    pub frame: Frame,
    /// How paths find light and when they end.
    #[command(flatten)]
    pub light: Light,
    /// How samples are drawn.
    #[command(flatten)]
    pub pixels: Pixels,
    /// One part of the run.
    #[command(flatten)]
    pub sharding: Sharding,
    /// Going on with an earlier run.
    #[command(flatten)]
    pub keeping: Keeping,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// The ways to solve the scene, each called a world.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = WHAT)]
pub struct Worlds {
    /// Ways to solve: terms,path,radiosity [default: all]
    ///
    /// This program calls each way a world. A list is separated by commas.
    #[arg(long, value_parser = one_of::<World>(WORLDS), value_delimiter = ',', value_name = "WORLD,…")]
    pub worlds: Vec<World>,
}

/// The estimator of the terms.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = HOW)]
pub struct Terms {
    /// Estimator of the terms: prefix, single, light, …
    ///
    /// [default: prefix]
    #[arg(long, value_parser = one_of::<Estimator>(ESTIMATORS), value_name = "NAME")]
    pub estimator: Option<Estimator>,
    /// Children of every vertex of the branching estimator
    ///
    /// Term k takes N^k rays.
    #[arg(long, value_name = "N", default_value_t = Terms::default().branching, hide_short_help = true, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// Show every strategy of the bidirectional estimator separately
    ///
    /// For each term, the strategies have s = 0 to k + 1 vertices walked from the light. A table is printed, and
    /// strategies.png, strategies-alone.png and strategies.exr are written.
    #[arg(long, hide_short_help = true)]
    pub strategies: bool,
    /// Leave out what needs no picture
    ///
    /// Norms over the surfaces, the terms up to k = 100, the light of each surface, and moments. All together take less than a tenth of
    /// a long run, but most of a very short one.
    #[arg(long, hide_short_help = true)]
    pub pictures_only: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self { estimator: None, branching: 2, strategies: false, pictures_only: false }
    }
}

/// How paths find light, what guides them and when they end.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = HOW)]
pub struct Light {
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which a path finds light.
    #[arg(long, default_value_t = Light::default().technique, value_name = "NAME", value_parser = one_of::<Technique>(TECHNIQUES))]
    pub technique: Technique,
    /// Roulette: none, lecture, constant:Q@V, albedo, …
    #[arg(long, value_name = "RULE", long_help = ROULETTE)]
    pub roulette: Option<Schedule>,
    /// Guide for rays: bsdf or radiosity
    ///
    /// With `radiosity`, a rough radiosity solution of 4000 patches says where light comes from; `series` and `tour` can change that
    /// number. At Lambertian surfaces it mixes those directions with the cosine, and it selects lights by what they send to the patch, in
    /// place of --lights. Other surfaces scatter as before. The guide treats every surface as Lambertian and glass as black. Its
    /// errors cost noise, never bias. It works well with --roulette window.
    #[arg(long, default_value_t = Light::default().guide, value_parser = one_of::<Guiding>(GUIDES), value_name = "NAME")]
    pub guide: Guiding,
}

impl Default for Light {
    fn default() -> Self {
        Self { technique: Technique::Mis, roulette: None, guide: Guiding::Bsdf }
    }
}

/// How samples are drawn, and for how long.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = HOW)]
pub struct Pixels {
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub sampling: Sampling,
    /// Light choice: uniform or power
    ///
    /// How a connection selects a light.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", value_parser = one_of::<Selection>(LIGHTS))]
    pub lights: Selection,
    /// Points: independent, sobol
    ///
    /// How the samples of a pixel are spread.
    #[arg(long, default_value_t = Points::Independent, value_name = "NAME", value_parser = one_of::<Points>(POINTS))]
    pub points: Points,
    /// Less noise in the same time: Sobol points, 8 replicates
    ///
    /// Chooses --points sobol, and 8 replicates in place of 16, so that each replicate holds twice as many points of its own
    /// sequence. The result stays unbiased. It is not the default, because the samples of a pixel are then no longer independent: their
    /// variance may fall faster than 1/N, and the moments of single samples do not predict it. Standard errors come from 8 numbers.
    #[arg(long, conflicts_with = "points")]
    pub fast: bool,
    /// Render only the pixels x0 ≤ x < x1, y0 ≤ y < y1
    ///
    /// x0,y0,x1,y1 count from the top left corner of the picture. These pixels have the bits that they have in the whole picture, and all
    /// means are means over them. In terms.exr they are the data window. Measurements on the whole picture, such as how many bounces are enough,
    /// are left out.
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = corners, hide_short_help = true)]
    pub crop: Option<[u32; 4]>,
    /// Time per way to solve, in place of --spp: 30s, 5m
    ///
    /// Passes are added while they are expected to end in time; the preparation of a guide counts. The first pass of 16 samples per pixel
    /// (8 with --fast) is always finished. The result has the same bits as --spp with the number of samples that was reached.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "spp")]
    pub time: Option<Duration>,
}

/// The mesh, its form factors, and how they are shown.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = MATRIX)]
pub struct Mesh {
    /// About how many patches [default: 600; tour: 3600]
    ///
    /// At most 20000 for a dense matrix, at most 2000000 for stored rays.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2_000_000))]
    pub patches: Option<u32>,
    /// Form factors: dense, rays or both
    ///
    /// How form factors are computed and held. [default: dense up to 10000 patches, rays beyond]
    #[arg(long, value_parser = one_of::<Form>(FORMS), value_name = "HOW")]
    pub factors: Option<Form>,
    /// Stored rays per patch [default: 256]
    ///
    /// From 2 to 65536; powers of two are best.
    #[arg(long, value_name = "N", hide_short_help = true, value_parser = clap::value_parser!(u32).range(2..=65_536))]
    pub rays: Option<u32>,
    /// How much narrower patches are near edges: 1 (not) to 8
    ///
    /// The width of a patch at distance d from an edge grows like d^(1 − 1/G). Values from 1.5 to 2 give eigenvalues and sums their
    /// order 2 in h if only the edges spoil it. Quadrilaterals are graded, both whole faces and pieces cut by others; triangles and
    /// curved surfaces keep patches of equal area.
    #[arg(long, value_name = "G", default_value_t = Mesh::default().grading, hide_short_help = true, value_parser = grading)]
    pub grading: f64,
    /// Show patches without gathering a last bounce from them
    #[arg(long, hide_short_help = true)]
    pub read_patches: bool,
    /// Fit the order of convergence from three meshes
    #[arg(long, hide_short_help = true)]
    pub orders: bool,
}

impl Default for Mesh {
    fn default() -> Self {
        Self { patches: None, factors: None, rays: None, grading: 1.0, read_patches: false, orders: false }
    }
}

/// How the terms are shown.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = OUTPUT)]
pub struct Pictures {
    /// Exposure of the terms: auto, a gain, or T1
    ///
    /// With `auto` each picture of a term has the gain that suits it. A number is the gain of all of them and of terms.png, for
    /// example 2. A term, such as T1, gives all of them the gain that suits this term; then their brightness can be compared.
    #[arg(long, default_value_t = Exposure::Auto, value_name = "GAIN|Tk", hide_short_help = true)]
    pub exposure: Exposure,
}

/// Replicates of `--fast`: the fewest with which the standard error of a pixel is trusted.
const FAST_REPLICATES: u32 = PIXEL_REPLICATES as u32;

/// Long help for `--roulette`: the schedules.
const ROULETTE: &str = "Russian roulette: when paths end

q is the probability of TERMINATION. It is tested at vertex v = 0, 1, … after the vertex is scored. Default: lecture for \
`render`; for other commands none up to k = K, then albedo.

none              never; nothing longer than K is estimated
lecture           q = 0, 0, then 0.5
constant:Q[@V]    q = Q from vertex V on (default V = 2)
table:q0,q1,…     q as listed; the last value for all later vertices
albedo[@V]        q = 1 − albedo from vertex V on (2)
throughput[@V]    q = 1 − throughput from vertex V on (2)
contribution[@V]  q = 1 − w, at most 0.9, from vertex V on (1)
window[@V]        from vertex V on (0): q = 1 − 2w, at most 0.9, if
                  w < 0.5; a split into w walks on average, at most
                  8, if w > 1
optimal           the table that is most efficient for the whole
                  image, from 2^18 pilot paths
optimal-indirect  the same for indirect light, the terms k ≥ 2

contribution and window need --guide radiosity: w is the expected value of the rest of the path, divided by the expected value \
of the pixel. Both act on the prefix estimator and the path tracer; single and branching end by albedo, and so does every path \
at a surface that the guide does not know.";

/// What a command solves, with every group of options.
#[derive(Clone, Debug)]
pub struct Request {
    pub frame: Frame,
    pub worlds: Vec<World>,
    pub terms: Terms,
    pub light: Light,
    pub pixels: Pixels,
    pub mesh: Mesh,
    pub pictures: Pictures,
    pub sharding: Sharding,
    pub keeping: Keeping,
    pub shared: Shared,
}

impl From<&Tour> for Request {
    fn from(t: &Tour) -> Self {
        let Tour { frame, worlds: Worlds { worlds }, light, pixels, mesh, pictures, keeping, shared } = t.clone();
        let (terms, sharding) = (Terms::default(), Sharding::default());
        Self { frame, worlds, terms, light, pixels, mesh, pictures, sharding, keeping, shared }
    }
}

impl From<&Series> for Request {
    fn from(s: &Series) -> Self {
        let Series { solving, sharding, keeping, shared } = s.clone();
        let Solving { frame, worlds: Worlds { worlds }, terms, light, pixels, mesh, pictures } = solving;
        Self { frame, worlds, terms, light, pixels, mesh, pictures, sharding, keeping, shared }
    }
}

impl From<&Render> for Request {
    fn from(r: &Render) -> Self {
        let Render { frame, light, pixels, sharding, keeping, shared } = r.clone();
        let (terms, mesh, pictures) = (Terms::default(), Mesh::default(), Pictures::default());
        Self { frame, worlds: vec![], terms, light, pixels, mesh, pictures, sharding, keeping, shared }
    }
}

impl Request {
    /// The settings of a run, of the whole picture. Without `--roulette`, paths of the path tracer end by `fallback`, and paths of the terms by
    /// `fallback` after K.
    pub fn settings(&self, fallback: Roulette, patches: u32, factors: Factors) -> Settings {
        let Self { frame, light, pixels, mesh, .. } = self;
        let max_bounces = usize::from(frame.max_bounces.unwrap_or(8));
        let asked = light.roulette.as_ref().and_then(Schedule::given);
        let by_expectation = match light.roulette {
            Some(Schedule::ByExpectation(end)) => Some(end),
            _ => None,
        };
        Settings {
            spp: frame.spp.unwrap_or(if pixels.time.is_some() { 1 << 24 } else { 256 }),
            time: pixels.time,
            seed: frame.seed,
            points: if pixels.fast { Points::Sobol } else { pixels.points },
            replicates: if pixels.fast { FAST_REPLICATES } else { Amount::REPLICATES },
            max_bounces,
            technique: light.technique,
            sampling: pixels.sampling,
            roulette: asked.clone().unwrap_or(fallback.clone().after(max_bounces)),
            path_roulette: asked.unwrap_or(fallback),
            by_expectation,
            patches: patches as usize,
            factors,
            read_patches: mesh.read_patches,
            grading: mesh.grading,
            crop: None,
        }
    }

    /// The estimator given with `--estimator`.
    pub fn estimator(&self) -> Option<Estimator> {
        self.terms.estimator.map(|e| e.with_children(self.terms.branching))
    }
}
