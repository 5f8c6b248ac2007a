//! `fredholm roulette [SCENE]`: schedules predicted from the cross moments of one recording, verified by rendering them, and
//! the best one found.

use super::base::{Ending, Failure, names, paragraphs, usage};
use super::choices::{LIGHTS, SAMPLINGS, TECHNIQUES};
use super::open::Opened;
use super::options::{HOW, Shared, WHAT, one_of, size, values};
use super::preflight;
use super::session::Session;
use super::suggest::hint;
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::{self, Technique};
use fredholm::progress::Progress;
use fredholm::report::figures::roulette::{self as rows, Row};
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table;
use fredholm::report::write_atomically;
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene, Selection};
use fredholm::stats::Noise;
use fredholm::study::roulette::{self, Radii, Schedule};
use fredholm::terms::World;
use fredholm::terms::cross_moments::{Recorded, Value};

/// Below `roulette --help`.
pub const HELP: &str = "Examples:
  fredholm roulette cornell
  fredholm roulette cornell --verify
  fredholm roulette cornell --optimise
  fredholm roulette furnace --schedules none,constant:0.1@0,table:0,0.2,0.4

Paths are recorded without roulette up to vertex K. V is the variance of one sample of the whole image, averaged over pixels and \
channels; 1/(V rays) is the efficiency. A schedule that does not depend on the path is predicted up to vertex K; beyond K, all \
schedules continue with q = 1 − the largest albedo of the scene. albedo and throughput depend on the path, so they are only \
measured.

The command writes roulette.csv, roulette.svg, roulette.png and summary.json (with the cross moments). Exit code 1: a measured \
variance contradicts its prediction.";

/// What is shown unless other schedules are asked for.
const USUAL: &str = "none,lecture,constant:0.1@0,constant:0.2@0,constant:0.3@0,constant:0.5@0,constant:0.3@2,\
                     table:0,0.1,0.2,0.3,albedo";

/// Arguments of `roulette`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Built-in scene, .toml or .obj
    #[arg(value_name = "SCENE", default_value = "cornell", help_heading = WHAT, value_hint = clap::ValueHint::FilePath)]
    pub scene: String,
    /// Schedules to compare [default: nine usual ones]
    ///
    /// A list separated by commas: none, lecture, constant:Q[@V], table:q0,q1,…, albedo[@V], throughput[@V], optimal.
    /// `fredholm series --help` describes them.
    #[arg(long, value_name = "RULE,…", help_heading = WHAT)]
    pub schedules: Option<String>,
    /// Render every schedule, and check the predictions
    #[arg(long, help_heading = WHAT)]
    pub verify: bool,
    /// Find the best schedule, and measure its gain
    ///
    /// The gain is measured over the lecture's roulette and over albedo roulette. --optimize is the same option.
    #[arg(long, alias = "optimize", help_heading = WHAT)]
    pub optimise: bool,
    /// Samples per pixel of every render
    ///
    /// The recording has the same number of samples.
    #[arg(long, value_name = "N", default_value_t = 128, help_heading = WHAT, value_parser = clap::value_parser!(u32).range(4..=1 << 20))]
    pub spp: u32,
    /// Image size in pixels [default: at most 64 a side]
    ///
    /// By default the size of the scene, reduced to at most 64 pixels a side.
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = WHAT)]
    pub size: Option<[u32; 2]>,
    /// K: predict up to this vertex
    #[arg(long, value_name = "K", default_value_t = 16, help_heading = WHAT, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub max_bounces: u16,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Light: scatter, connect, mis, mis-power
    ///
    /// The technique by which a path finds light.
    #[arg(long, default_value_t = Technique::Mis, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Technique>(TECHNIQUES))]
    pub technique: Technique,
    /// Light choice: uniform or power
    ///
    /// How a connection selects a light.
    #[arg(long, default_value_t = Selection::Uniform, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Selection>(LIGHTS))]
    pub lights: Selection,
    /// Directions: uniform, cosine or bsdf
    ///
    /// The density of the sampled directions at a surface.
    #[arg(long, default_value_t = Sampling::Bsdf, value_name = "NAME", help_heading = HOW, value_parser = one_of::<Sampling>(SAMPLINGS))]
    pub sampling: Sampling,
    /// Changes to the scene, output, threads.
    #[command(flatten)]
    pub shared: Shared,
}

/// A schedule by the name it was typed with; `None` is to be found.
type Asked = (String, Option<estimator::Roulette>);

/// Predicts, verifies, optimises.
pub fn run(args: &Args) -> Result<Ending, Failure> {
    let asked = schedules(args)?;
    let mut session = Session::new(&args.shared, args.seed)?;
    let opened = scene(args, &mut session)?;
    let (description, scene) = (opened.description, opened.scene.select_lights(args.lights));
    let settings = Settings {
        spp: args.spp,
        seed: args.seed,
        max_bounces: args.max_bounces.into(),
        technique: args.technique,
        sampling: args.sampling,
        ..Settings::default()
    };
    preflight::light_is_seen(&scene, &[Estimator::Prefix], &settings, &[])?;
    preflight::light_is_lost(&scene, &settings, &[World::Terms])?;
    session.make_folder(&format!("{}-roulette", description.name))?;

    // the recording, and what follows from it
    let Some(recorded) = roulette::pilot(&scene, &settings, args.spp, session.progress()) else {
        return Ok(session.nothing_to_save(""));
    };
    let best = roulette::best(&recorded, &scene);
    let beyond = roulette::beyond(&scene);
    let given = |(name, given): Asked| Some((name, given.or(best.as_ref().map(|b| b.roulette.clone()))?));
    let predicted = asked.into_iter().filter_map(given);
    let predicted = predicted.map(|(name, s)| predict(name, s, &recorded, settings.max_bounces, beyond));
    let (mut all, schedules): (Vec<Row>, Vec<estimator::Roulette>) = predicted.unzip();
    measure(args, (&scene, &settings), &mut all, &schedules, session.progress());

    let mut record = Summary {
        spp: args.spp.into(),
        max_bounces: settings.max_bounces,
        cross_moments: Some(summary::cross_moments(&recorded, beyond)),
        files: names(["roulette.csv", "roulette.png", "roulette.svg", "summary.json"]),
        ..session.record()
    };
    record.bounds.max_albedo = scene.max_albedo().as_dvec3();
    write_atomically(&session.folder.join("roulette.csv"), rows::csv(&all).as_bytes())?;
    let title = format!("Roulette schedules of {}: predicted from paths without roulette", record.scene);
    rows::draw(&all, &title, &session.caption())?.write(&session.folder, "roulette")?;
    session.sign(&record)?;
    let doubts = doubts(&all, &description, &scene);
    let warnings = warnings(&doubts, &recorded);
    session.warn(&warnings);
    session.show(&record, || {
        let found = if args.optimise { gains(&all, best.as_ref()) } else { String::new() };
        let warned = warnings.iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n");
        let head = head(args, &record, &recorded, beyond);
        paragraphs(&[head, rows::table(&all), found, warned, session.written(&record.files)])
    })?;
    // a variance that cannot be measured contradicts nothing
    let told = all.iter().filter(|r| doubts.iter().all(|d| d.0 != r.name));
    let contradicted = told.filter_map(Row::z).any(|z| z.abs() > critical(all.len(), recorded.replicates()));
    Ok(session.ending(contradicted))
}

/// Renders what is to be rendered.
fn measure(
    args: &Args,
    (scene, settings): (&Scene, &Settings),
    all: &mut [Row],
    schedules: &[estimator::Roulette],
    progress: Progress<'_>,
) {
    if args.verify || args.optimise {
        for (row, schedule) in all.iter_mut().zip(schedules) {
            let rival = ["optimal", "lecture", "albedo"].contains(&row.name.as_str());
            if args.verify || rival {
                let measured = roulette::measure(scene, settings, schedule, args.spp, progress);
                row.measured = measured.map(|m| Noise::measured(&m));
            }
        }
    }
    if args.optimise && !progress.stopped() {
        let spp = (args.spp / 4).max(1);
        let seconds = roulette::seconds_per_path(scene, settings, schedules, spp);
        all.iter_mut().zip(seconds).for_each(|(row, s)| row.seconds = Some(s));
    }
}

fn head(args: &Args, record: &Summary, recorded: &Recorded, beyond: f64) -> String {
    let Summary { command, seed, spp, width, height, max_bounces, .. } = record;
    format!(
        "{command}\nseed {seed}, {spp} spp, {width}×{height} pixels, technique {}; {} paths recorded in {:.1} s\n\
         from vertex K = {max_bounces} on every predicted schedule goes on with q = {beyond:.2}",
        args.technique,
        table::count(recorded.paths),
        recorded.seconds
    )
}

/// |z| beyond which a prediction is contradicted: family level 10⁻³ over the schedules.
fn critical(schedules: usize, replicates: u64) -> f64 {
    fredholm::stats::critical(1e-3 / schedules as f64, replicates as f64 - 1.0)
}

fn schedules(args: &Args) -> Result<Vec<Asked>, Failure> {
    let list = args.schedules.as_deref().unwrap_or(USUAL);
    let mut all: Vec<Asked> = vec![];
    for name in values(list) {
        let schedule: Schedule = name.parse().map_err(|why: String| usage(&why, &hint("--roulette", &name, &[])))?;
        all.push((name, schedule.given()));
    }
    if args.optimise {
        for rival in ["lecture", "albedo", "optimal"] {
            if !all.iter().any(|(name, _)| name == rival) {
                all.push((rival.into(), rival.parse().ok()));
            }
        }
    }
    Ok(all)
}

/// The scene, in a small picture unless a size was asked for.
fn scene(args: &Args, session: &mut Session) -> Result<Opened, Failure> {
    const SIDE: u32 = 64;
    let size = match args.size {
        Some(size) => Some(size),
        None => {
            let as_it_is = load::scene(&args.scene, &args.shared.changes.options(None))?;
            let [w, h] = as_it_is.description.camera.size;
            (w.max(h) > SIDE).then(|| [w, h].map(|side| (side * SIDE / w.max(h)).max(1)))
        }
    };
    session.open(&args.scene, &args.shared.changes, size)
}

/// A row with its prediction, and the schedule as it is rendered: as a table up to vertex K where there is one.
fn predict(
    name: String,
    schedule: estimator::Roulette,
    recorded: &Recorded,
    last: usize,
    beyond: f64,
) -> (Row, estimator::Roulette) {
    let schedule = schedule.then(last, beyond).unwrap_or(schedule);
    let row = Row {
        name,
        schedule: schedule.to_string(),
        q: (0..last).filter_map(|v| schedule.fixed(v)).collect(),
        predicted: Noise::predicted(recorded, &schedule),
        replicates: recorded.replicates(),
        ..Row::default()
    };
    (row, schedule)
}

/// What is gained by the best schedule: predicted, and measured by rays and by seconds.
fn gains(all: &[Row], best: Option<&roulette::Optimal>) -> String {
    let row = |name: &str| all.iter().find(|r| r.name == name);
    let (Some(best), Some(optimal)) = (best, row("optimal")) else { return String::new() };
    let mut lines = vec![format!(
        "optimal: {}\npredicted: {:.3} ± {:.3} times the efficiency of the lecture's schedule",
        best.roulette, best.gain.value, best.gain.std_error
    )];
    for rival in ["lecture", "albedo"] {
        if let (Some(a), Some(other)) = (optimal.measured.as_ref(), row(rival))
            && let Some(b) = other.measured.as_ref()
        {
            let by_rays = ratio(a.efficiency, b.efficiency);
            let mut line =
                format!("measured: {:.3} ± {:.3} times that of {rival} per ray", by_rays.value, by_rays.std_error);
            if let (Some(s), Some(t)) = (optimal.seconds, other.seconds) {
                line += &format!(", {:.3} times per second", b.all.value * t / (a.all.value * s));
            }
            lines.push(line);
        }
    }
    lines.join("\n")
}

/// a/b of two independent values.
fn ratio(a: Value, b: Value) -> Value {
    let value = a.value / b.value;
    Value { value, std_error: value * (a.std_error / a.value).hypot(b.std_error / b.value) }
}

/// The schedules whose variance, or whose measured variance, may be infinite, were they to go on for ever as they were typed.
fn doubts(all: &[Row], description: &Description, scene: &Scene) -> Vec<(String, String)> {
    let coarse = by_matrix::coarse(description, scene);
    let doubt = |row: &Row| {
        let q = roulette::constant(&row.name.parse().ok()?)?;
        let what = Radii::new(coarse.as_ref().map(|m| &m.radiosity), scene, q).warning()?;
        Some((row.name.clone(), what))
    };
    all.iter().filter_map(doubt).collect()
}

/// What spoils an error bar.
fn warnings(doubts: &[(String, String)], recorded: &Recorded) -> Vec<String> {
    let mut out: Vec<String> = doubts.iter().map(|(name, what)| format!("{name} {what}")).collect();
    if !out.is_empty() {
        out.push("predictions are finite, since all go on with the q above from vertex K on".into());
    }
    if recorded.non_finite > 0 {
        out.push(format!("{} samples were not finite; they are left in the sums", recorded.non_finite));
    }
    out
}
