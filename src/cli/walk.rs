//! `fredholm walk [SCENE]`: the estimators on the radiosity matrix, where the terms are known to rounding.

use super::base::{Ending, Failure, names, paragraphs};
use super::choices::{TECHNIQUES, WALKERS};
use super::open::Opened;
use super::options::{HOW, Shared, WHAT, one_of};
use super::session::Session;
use super::{notes, preflight};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{self, Matrix, MatrixError};
use fredholm::engine::discretisation::Factors;
use fredholm::estimator::{Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::figures::walk as report;
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table;
use fredholm::report::write_atomically;
use fredholm::scene::Description;
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, Outcome, compare};
use fredholm::study::walk::{self, Study, Walked, Walker};
use fredholm::study::zero_variance::{self, ZeroVariance};

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
    #[arg(long, value_name = "K", default_value_t = 8, help_heading = WHAT, value_parser = clap::value_parser!(u16).range(0..=1000))]
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

/// Builds the matrix, walks on it, and says whether the walk gives its powers.
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
    let (text, record, failed) = match study {
        Study::Walk(walker) => {
            let walked = walk::walk(&matrix, walker, &settings, session.progress());
            beside_the_powers(&walked, session.record())
        }
        Study::ZeroVariance => led(&session, &opened, &matrix, &settings)?,
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
        paragraphs(&[head, text, session.written(&record.files)])
    })?;
    Ok(session.ending(failed))
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

/// A matrix of about so many patches; nothing when stopped.
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

/// The table and the verdicts of an estimator against the powers.
fn beside_the_powers(walked: &Walked, record: Summary) -> (String, Summary, bool) {
    let comparison = compare(&walked.sampled.series, &walked.exact, &Criterion::default(), &[]);
    let verdicts = summary::verdicts("walk − powers", &comparison);
    let text = [report::table(walked), table::verdicts(&verdicts), notes::judgement(&comparison)];
    let series = vec![walked.sampled.series.clone(), walked.exact.clone()];
    (paragraphs(&text), Summary { verdicts, series, ..record }, comparison.outcome == Outcome::Differs)
}

/// The tables and the figure of the zero-variance study.
fn led(
    session: &Session,
    opened: &Opened,
    matrix: &Matrix<Radiosity>,
    settings: &Settings,
) -> Result<(String, Summary, bool), Failure> {
    // meshes a third as fine at each step, the coarsest first
    let mut coarse = vec![];
    for patches in [81, 27, 9, 3].map(|f| settings.patches / f).into_iter().filter(|&n| n > 0) {
        coarse.extend(mesh(opened, patches, settings, session.progress())?);
    }
    coarse.dedup_by_key(|m| m.radiosity.patches.len());
    let study = |c| zero_variance::study(matrix, &coarse, c, settings, session.progress());
    let found: Vec<ZeroVariance> = (0..3).map(study).collect();
    write_atomically(&session.folder.join("walk.csv"), report::csv(&found).as_bytes())?;
    report::draw(&found, &session.caption())?.write(&session.folder, "walk")?;
    let text = [
        "the whole series: absorbed with q = E/(E + T v), led by p ∝ T v".to_string(),
        report::guides(&found),
        "one term at a time: k steps, led by the lower terms".to_string(),
        report::terms(&found),
    ];
    let files = names(["walk.csv", "walk.png", "walk.svg"]);
    Ok((paragraphs(&text), Summary { files, ..session.record() }, false))
}

/// Absorption scores where walks end; where nothing is absorbed, what is emitted would be lost.
fn refuse_lost_light(d: &Description, study: Study) -> Result<(), Failure> {
    let analog = matches!(study, Study::Walk(Walker::Absorption) | Study::ZeroVariance);
    let bright = |m: usize| d.materials[m].lambertian().is_some_and(|r| r.max_element() >= 1.0);
    if analog && d.shapes.iter().any(|s| s.emission.max_element() > 0.0 && bright(s.material)) {
        return Err(Failure::Usage(
            "error: a surface that shines absorbs nothing, and the absorption estimator scores where walks are absorbed\n\
             help: lower its reflectance below 1, or use --estimator prefix"
                .into(),
        ));
    }
    Ok(())
}
