//! `fredholm walk [SCENE]`: runs the estimators on the radiosity matrix, where every term is known to rounding.

use super::base::{Ending, Failure, names};
use super::choices::{TECHNIQUES, WALKERS};
use super::open::Opened;
use super::options::{HOW, Shared, WHAT, one_of};
use super::session::Session;
use super::{preflight, verdict};
use clap::Args;
use fredholm::engine::by_matrix::{self, Matrix, MatrixError};
use fredholm::engine::discretisation::Factors;
use fredholm::engine::{MOST_BOUNCES, Settings};
use fredholm::estimator::{Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::figures::walk as report;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table::{self, significant};
use fredholm::report::write_atomically;
use fredholm::scene::Description;
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, Outcome, compare};
use fredholm::study::walk::{self, Study, Walked, Walker};
use fredholm::study::zero_variance::{self, Guide, ZeroVariance};
use fredholm::terms::Channel;

/// Below `walk --help`.
pub const HELP: &str = "Examples:
  fredholm walk cornell --patches 500 --estimator prefix
  fredholm walk cornell --patches 500 --estimator absorption --spp 65536
  fredholm walk cornell --patches 500 --estimator zero-variance

On a matrix, T^k E is known to rounding, so the walk is compared with the exact value patch by patch.

zero-variance is absorption with p_ij ∝ T_ij B_j and q_i = E_i/B_i, where B is the solution itself. It is repeated with worse and \
worse guides in place of B, which shows what a guide is worth (walk.png, walk.csv).";

/// Arguments of `walk`.
#[derive(Clone, Debug, Args)]
pub struct Walk {
    /// Built-in scene, .toml or .obj
    #[arg(value_name = "SCENE", default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub scene: String,
    /// About how many patches the matrix has
    #[arg(long, value_name = "N", default_value_t = 500, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(1..=4000))]
    pub patches: u32,
    /// Walks from every patch
    ///
    /// At most 1024 with --estimator zero-variance.
    #[arg(long, value_name = "N", default_value_t = 4096, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub spp: u32,
    /// K: keep the terms k = 0..=K
    #[arg(long, value_name = "K", default_value_t = 8, help_heading = WHAT, value_parser = clap::value_parser!(u16).range(0..=i64::from(MOST_BOUNCES)))]
    pub max_bounces: u16,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Estimator: prefix, zero-variance, …
    #[arg(long, value_parser = one_of::<Study>(WALKERS), value_name = "NAME", default_value = "prefix", help_heading = HOW)]
    pub estimator: Study,
    /// Children of every vertex of the branching estimator
    #[arg(long, value_name = "N", default_value_t = 2, hide_short_help = true, help_heading = HOW, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which a walk finds light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    pub technique: Technique,
    /// Roulette: none, lecture, constant:Q@V, albedo, …
    ///
    /// `fredholm series --help` lists the rules. [default: none for k ≤ K, then albedo]
    #[arg(long, value_name = "RULE", help_heading = HOW)]
    pub roulette: Option<Roulette>,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// Builds the matrix, walks on it, and compares the walks with the powers of the matrix.
pub fn run(args: &Walk) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.seed)?;
    let opened = session.open(&args.scene, &args.shared.changes, None)?;
    preflight::has_a_matrix(&opened.description, &opened.scene, Factors::Dense)?;
    let study = args.estimator.with_children(args.branching);
    refuse_lost_light(&opened.description, study)?;
    let settings = settings(args);
    if let Study::Walk(Walker::Terms(estimator)) = study {
        preflight::tree_can_be_walked(estimator, &settings, [args.patches, 1])?;
    }
    session.make_folder(&format!("{}-walk", opened.description.name))?;
    let Some(matrix) = mesh(&opened, settings.patches, &settings, session.progress())? else {
        return Ok(session.nothing_to_save(""));
    };
    let patches = matrix.radiosity.patches.len();
    session.sized([patches as u32, 1]);
    let Told { answer, table, details, record, failed } = match study {
        Study::Walk(walker) => {
            let walked = walk::walk(&matrix, walker, &settings, session.progress());
            beside_the_powers(&walked, args, patches, session.record())
        }
        Study::ZeroVariance => guided(&session, &opened, &matrix, &settings)?,
    };
    let mut record = Summary { spp: args.spp.into(), max_bounces: settings.max_bounces, ..record };
    record.files.push("summary.json".into());
    session.sign(&record)?;
    session.show(&record, || {
        let head = format!(
            "{}\nseed {}, {} walks from each of {patches} patches; spectral radius ({})",
            session.command(),
            args.seed,
            args.spp,
            matrix.spectral.each_ref().map(|s| format!("{:.5}", s.radius)).join(", ")
        );
        let details: Vec<String> = std::iter::once(head).chain(details).collect();
        session.text(&wrapped(&answer), &[table], &details, &record.files)
    })?;
    Ok(session.ending(failed))
}

/// The text about a study, its record, and whether a comparison failed.
struct Told {
    answer: String,
    table: String,
    details: Vec<String>,
    record: Summary,
    failed: bool,
}

fn settings(args: &Walk) -> Settings {
    let (max_bounces, end) = (usize::from(args.max_bounces), Roulette::Albedo { from: 2 });
    Settings {
        spp: args.spp,
        seed: args.seed,
        max_bounces,
        technique: args.technique,
        roulette: args.roulette.clone().unwrap_or(end.clone().after(max_bounces)),
        path_roulette: args.roulette.clone().unwrap_or(end),
        patches: args.patches as usize,
        ..Settings::default()
    }
}

/// The matrix of a mesh of about `patches` patches; `None` if interrupted.
fn mesh(
    opened: &Opened,
    patches: usize,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Option<Matrix<Radiosity>>, Failure> {
    let Opened { description, scene, .. } = opened;
    match by_matrix::dense_matrix(description, scene, patches, 1.0, settings.max_bounces, progress) {
        Ok(m) => Ok(Some(m)),
        Err(MatrixError::Stopped) => Ok(None),
        Err(e) => Err(e.into()),
    }
}

/// Terms in the table that is printed without `--verbose`.
const SHOWN: usize = 10;

/// The estimator compared with the powers of the matrix.
fn beside_the_powers(walked: &Walked, args: &Walk, patches: usize, record: Summary) -> Told {
    let criterion = Criterion::default();
    let comparison = compare(&walked.sampled.series, &walked.exact, &criterion, &[]);
    let verdicts = summary::verdicts("walk − powers", &comparison);
    let label = &walked.sampled.series.label;
    let who = format!("The walks of `{}` and the powers of the matrix", args.estimator.name());
    let above = format!(
        "The mean of every term TᵏE over {patches} patches: by {} walks from each patch ({label}) with the 95 % interval, and \
         exactly, as a power of the matrix. A verdict holds for all three channels; ✓ means proved smaller than {}.",
        args.spp,
        verdict::delta(&criterion)
    );
    let left = walked.exact.image().terms.len().saturating_sub(SHOWN);
    let below = if left > 0 { format!("{left} more terms in summary.json") } else { String::new() };
    Told {
        answer: verdict::sentence(&who, &comparison, &criterion),
        table: format!("{}\n{}{below}", wrapped(&above), report::table(walked, &comparison, SHOWN)),
        details: vec![
            format!(
                "Every term with its difference; z is the difference in standard errors, patch by patch.\n{}",
                report::full_table(walked)
            ),
            format!("Every comparison, in the channel where it is closest to failing.\n{}", table::verdicts(&verdicts)),
        ],
        failed: comparison.outcome == Outcome::Differs,
        record: Summary { verdicts, series: vec![walked.sampled.series.clone(), walked.exact.clone()], ..record },
    }
}

/// The zero-variance study: walks that are guided by approximations of the solution, with tables and a figure.
fn guided(
    session: &Session,
    opened: &Opened,
    matrix: &Matrix<Radiosity>,
    settings: &Settings,
) -> Result<Told, Failure> {
    // the coarsest mesh first; every next one has three times as many patches
    let mut coarse = vec![];
    for patches in [81, 27, 9, 3].map(|f| settings.patches / f).into_iter().filter(|&n| n > 0) {
        coarse.extend(mesh(opened, patches, settings, session.progress())?);
    }
    coarse.dedup_by_key(|m| m.radiosity.patches.len());
    let study = |c| zero_variance::study(matrix, &coarse, c, settings, session.progress());
    let found: Vec<ZeroVariance> = (0..3).map(study).collect();
    write_atomically(&session.folder.join("walk.csv"), report::csv(&found).as_bytes())?;
    report::draw(&found, &session.caption())?.write(&session.folder, "walk")?;
    let above = "The variance of one walk divided by B², by channel, for guides v of growing quality; the error of v is \
                 ‖v − B‖/‖B − E‖ in the first channel. A guide chooses the steps, p ∝ T v, and the end of a walk.";
    let details = vec![
        format!(
            "The whole series: walks are absorbed with probability q = E/(E + T v) and guided by p ∝ T v.\n{}",
            report::guides(&found)
        ),
        format!("One term at a time: walks of k steps, guided by the lower terms.\n{}", report::terms(&found)),
    ];
    Ok(Told {
        answer: without_variance(&found),
        table: format!("{}\n{}", wrapped(above), report::variances(&found)),
        details,
        record: Summary { files: names(["walk.csv", "walk.png", "walk.svg"]), ..session.record() },
        failed: false,
    })
}

/// The answer of the zero-variance study: the variance without a guide and with the solution as the guide.
fn without_variance(found: &[ZeroVariance]) -> String {
    let of = |z: &ZeroVariance, guide: Guide| {
        z.guides.iter().find(|l| l.guide == guide).map_or(f64::NAN, |l| l.spread.variance)
    };
    let worst = found.iter().max_by(|a, b| of(a, Guide::Analog).total_cmp(&of(b, Guide::Analog)));
    let Some(worst) = worst else { return "No walk was made.".into() };
    let channel = Channel::ALL[worst.channel];
    let [analog, exact] = [Guide::Analog, Guide::Exact].map(|g| of(worst, g));
    let zero = if exact < 1e-10 { ", which is zero to rounding" } else { "" };
    format!(
        "The better the guide, the smaller the variance: without one a walk has {} B² in the {channel} channel, and guided by the \
         solution B itself it has {} B²{zero}.",
        significant(analog, 3),
        significant(exact, 2)
    )
}

/// Refuses a scene in which an emitter absorbs nothing: the absorption estimator scores where walks are absorbed, so it would
/// lose the emitted light.
fn refuse_lost_light(d: &Description, study: Study) -> Result<(), Failure> {
    let analog = matches!(study, Study::Walk(Walker::Absorption) | Study::ZeroVariance);
    let bright = |m: usize| d.materials[m].lambertian().is_some_and(|r| r.max_element() >= 1.0);
    if analog && d.shapes.iter().any(|s| s.emission.max_element() > 0.0 && bright(s.material)) {
        return Err(Failure::Usage(
            "error: an emitter of this scene absorbs nothing, and the absorption estimator scores where walks are absorbed\n\
             help: lower its reflectance below 1, or use --estimator prefix"
                .into(),
        ));
    }
    Ok(())
}
