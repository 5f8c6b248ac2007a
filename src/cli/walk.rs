//! `fredholm walk [SCENE]`: the estimators on the radiosity matrix, where the terms are known to rounding.

use super::progress::Bar;
use super::{Ending, Failure, args, notes, output, preflight};
use crate::cli::open::{self, Opened};
use clap::{Args, ValueEnum};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{self, Matrix, MatrixError};
use fredholm::engine::by_rays::Estimator;
use fredholm::engine::discretisation::Factors;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::image::typeset::Caption;
use fredholm::report::{
    figures::walk as report,
    text::{summary, table},
    write_atomically,
};
use fredholm::scene::Description;
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, Outcome, compare};
use fredholm::study::walk::{self, Walked, Walker};
use fredholm::study::zero_variance::{self, ZeroVariance};
use std::path::Path;
use std::time::Instant;

/// What walks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WalkerName {
    /// All terms from the prefixes of one walk
    Prefix,
    /// Each term from walks of its own
    Single,
    /// A tree of walks
    Branching,
    /// Walks from the light, on the transpose
    Light,
    /// Walks from both ends
    Bidirectional,
    /// The sum alone
    Path,
    /// Scored where the walk is absorbed
    Absorption,
    /// Absorption, led by the solution
    ZeroVariance,
}

/// Arguments of `walk`.
#[derive(Clone, Debug, Args)]
pub struct Walk {
    /// Built-in scene, .toml, or .obj
    #[arg(value_name = "SCENE", default_value = "cornell")]
    pub scene: String,
    /// About how many patches the matrix has
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=4000))]
    pub patches: u32,
    /// What walks: prefix, single, branching, light, bidirectional, path, absorption, zero-variance
    #[arg(long, value_enum, value_name = "NAME", default_value = "prefix", hide_possible_values = true)]
    pub estimator: WalkerName,
    /// Children of every vertex of --estimator branching
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub branching: u32,
    /// How light is found: scatter, connect, mis, mis-power
    #[arg(long, default_value = "mis", value_parser = args::technique, value_name = "NAME")]
    pub technique: Technique,
    /// Russian roulette, as in `fredholm series --help` [default: none for k ≤ K, then albedo]
    #[arg(long, value_name = "SCHEDULE")]
    pub roulette: Option<Roulette>,
    /// Walks from every patch (zero-variance: at most 1024)
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub spp: u32,
    /// K: keep the terms k = 0..=K
    #[arg(long, value_name = "K", default_value_t = 8, value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub max_bounces: u16,
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: crate::cli::open::Shared,
}

/// The walker of that name; nothing for the zero-variance study.
fn walker(args: &Walk) -> Option<Walker> {
    let children = args.branching;
    Some(Walker::Terms(match args.estimator {
        WalkerName::Prefix => Estimator::Prefix,
        WalkerName::Single => Estimator::Single,
        WalkerName::Branching => Estimator::Branching { children },
        WalkerName::Light => Estimator::Light,
        WalkerName::Bidirectional => Estimator::Bidirectional,
        WalkerName::Path => return Some(Walker::Path),
        WalkerName::Absorption => return Some(Walker::Absorption),
        WalkerName::ZeroVariance => return None,
    }))
}

/// Builds the matrix, walks on it, and says whether the walk gives its powers.
pub fn run(args: &Walk) -> Result<Ending, Failure> {
    let started = Instant::now();
    open::threads(args.shared.threads)?;
    let Opened { command, description, scene, hash } = open::scene(&args.scene, &args.shared.changes, None)?;
    let mut worlds = vec![args::WorldName::Radiosity];
    preflight::suits_a_matrix(&description, &mut worlds, true)?;
    preflight::fits_in_a_matrix(&scene, Factors::Dense, &mut worlds, true)?;
    let walker = walker(args);
    refuse_lost_light(&description, walker)?;

    let max_bounces = usize::from(args.max_bounces);
    let end = Roulette::Albedo { from: 2 };
    let settings = Settings {
        spp: args.spp,
        seed: args.seed,
        max_bounces,
        technique: args.technique,
        roulette: args.roulette.clone().unwrap_or(end.clone().after(max_bounces)),
        path_roulette: args.roulette.clone().unwrap_or(end),
        patches: args.patches as usize,
        ..Settings::default()
    };
    if let Some(Walker::Terms(estimator)) = walker {
        preflight::tree_can_be_walked(estimator, &settings, [args.patches, 1])?;
    }
    let folder =
        output::folder(args.shared.out.as_deref(), &format!("{}-walk", description.name), &command, args.shared.force)?;
    let bar = Bar::plain(args.shared.quiet);
    let progress = bar.progress();
    let mesh = |patches: usize| -> Result<Option<Matrix<Radiosity>>, Failure> {
        match by_matrix::dense_matrix(&description, &scene, patches, 1.0, max_bounces, progress) {
            Ok(m) => Ok(Some(m)),
            Err(MatrixError::Stopped) => Ok(None),
            Err(e) => Err(e.into()),
        }
    };
    let Some(matrix) = mesh(settings.patches)? else {
        bar.finish();
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    };
    let mut record = summary::Summary {
        command: command.clone(),
        scene: description.name.clone(),
        scene_hash: hash,
        seed: args.seed,
        spp: args.spp.into(),
        max_bounces,
        threads: rayon::current_num_threads(),
        width: matrix.radiosity.patches.len(),
        height: 1,
        ..summary::Summary::default()
    };
    let head = format!(
        "{command}\nseed {}, {} walks from each of {} patches; spectral radius ({})",
        args.seed,
        args.spp,
        matrix.radiosity.patches.len(),
        matrix.spectral.each_ref().map(|s| format!("{:.5}", s.radius)).join(", ")
    );
    let (text, failed) = match walker {
        Some(walker) => {
            let walked = walk::walk(&matrix, walker, &settings, progress);
            bar.finish();
            beside_the_powers(&walked, &mut record)
        }
        None => {
            // meshes a third as fine at each step, the coarsest first
            let mut coarse = vec![];
            for patches in [81, 27, 9, 3].map(|f| settings.patches / f).into_iter().filter(|&n| n > 0) {
                coarse.extend(mesh(patches)?);
            }
            coarse.dedup_by_key(|m| m.radiosity.patches.len());
            let study = |c| zero_variance::study(&matrix, &coarse, c, &settings, progress);
            let found: Vec<ZeroVariance> = (0..3).map(study).collect();
            bar.finish();
            led(&found, &folder, &mut record)?
        }
    };
    record.seconds = started.elapsed().as_secs_f64();
    record.files.push("summary.json".into());
    let old = output::left_by_the_last_run(&folder);
    summary::write(&folder.join("summary.json"), &record)?;
    output::remove_stale(&folder, &old, &record.files);
    if args.shared.json {
        super::print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let files = format!("written to {}: {}", folder.display(), record.files.join(", "));
        super::print(&super::paragraphs(&[head, text, files]))?;
    }
    Ok(match (progress.stopped(), failed) {
        (true, _) => Ending::Interrupted,
        (_, true) => Ending::Failed,
        _ => Ending::Ok,
    })
}

/// The table and the verdicts of an estimator against the powers.
fn beside_the_powers(walked: &Walked, record: &mut summary::Summary) -> (String, bool) {
    let comparison = compare(&walked.sampled.series, &walked.exact, &Criterion::default(), &[]);
    record.verdicts = summary::verdicts("walk − powers", &comparison);
    record.series = vec![walked.sampled.series.clone(), walked.exact.clone()];
    let text = [report::table(walked), table::verdicts(&record.verdicts), notes::judgement(&comparison)];
    (super::paragraphs(&text), comparison.outcome == Outcome::Differs)
}

/// The tables and the figure of the zero-variance study.
fn led(found: &[ZeroVariance], folder: &Path, record: &mut summary::Summary) -> Result<(String, bool), Failure> {
    let caption = Caption { command: record.command.clone(), seed: record.seed, scene: record.scene.clone() };
    write_atomically(&folder.join("walk.csv"), report::csv(found).as_bytes())?;
    report::draw(found, &caption)?.write(folder, "walk")?;
    record.files = ["walk.csv", "walk.png", "walk.svg"].map(String::from).into();
    let text = [
        "the whole series: absorbed with q = E/(E + T v), led by p ∝ T v".to_string(),
        report::guides(found),
        "one term at a time: k steps, led by the lower terms".to_string(),
        report::terms(found),
    ];
    Ok((super::paragraphs(&text), false))
}

/// Absorption scores where walks end; where nothing is absorbed, what is emitted would be lost.
fn refuse_lost_light(d: &Description, walker: Option<Walker>) -> Result<(), Failure> {
    let analog = matches!(walker, Some(Walker::Absorption) | None);
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
