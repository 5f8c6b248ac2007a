//! `fredholm roulette [SCENE]`: schedules predicted from the cross moments of one recording, verified by rendering them, and
//! the best one found.

use super::progress::Bar;
use super::{Ending, Failure, args, output, preflight, solve, sweep};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::engine::known::resort::with_last_resort;
use fredholm::estimator::{self, Technique};
use fredholm::report::figures::roulette::{self as rows, Row};
use fredholm::report::image::typeset::Caption;
use fredholm::report::{
    text::{summary, table},
    write_atomically,
};
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene, Selection};
use fredholm::stats::Noise;
use fredholm::study::roulette::{self, Radii};
use fredholm::terms::cross_moments::{Recorded, Value};
use std::time::Instant;

/// Shown below the help.
pub const EXAMPLES: &str = "Examples:
  fredholm roulette cornell                                     predictions alone
  fredholm roulette cornell --verify                            each also rendered: z beside it
  fredholm roulette cornell --optimise                          the best schedule, and by how much
  fredholm roulette furnace --schedules none,constant:0.1@0,table:0,0.2,0.4

Paths are recorded without roulette up to vertex K. V is the variance of one sample of the whole image,
averaged over pixels and channels; 1/(V rays) is the efficiency. Every schedule that does not depend on the
path is predicted up to vertex K; from there on all go on with q = 1 − the largest albedo of the scene.
albedo and throughput depend on the path: they are measured only.

Written: roulette.csv, roulette.svg, roulette.png, summary.json (with the cross moments).
Exit code 1: a measured variance contradicts its prediction.";

/// What is shown unless other schedules are asked for.
const USUAL: &str = "none,lecture,constant:0.1@0,constant:0.2@0,constant:0.3@0,constant:0.5@0,constant:0.3@2,\
                     table:0,0.1,0.2,0.3,albedo";

/// Arguments of `roulette`.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// Built-in scene, .toml, or .obj
    #[arg(value_name = "SCENE", default_value = "cornell")]
    pub scene: String,
    /// Schedules to compare, with commas [default: nine usual ones]
    ///
    /// none, lecture, constant:Q[@V], table:q0,q1,…, albedo[@V], throughput[@V], optimal
    #[arg(long, value_name = "SCHEDULE,…", verbatim_doc_comment)]
    pub schedules: Option<String>,
    /// Render every schedule and compare what is measured with what was predicted
    #[arg(long)]
    pub verify: bool,
    /// Find the best schedule, and measure its gain over the lecture's and over albedo roulette
    #[arg(long, visible_alias = "optimize")]
    pub optimise: bool,
    /// Samples per pixel, of the recording and of every render
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(4..=1 << 20))]
    pub spp: u32,
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Image size in pixels [default: the scene's, made smaller to at most 64 pixels a side]
    #[arg(long, value_name = "WxH", value_parser = args::size)]
    pub size: Option<[u32; 2]>,
    /// K: schedules are predicted up to this vertex
    #[arg(long, value_name = "K", default_value_t = 16, value_parser = clap::value_parser!(u16).range(1..=64))]
    pub max_bounces: u16,
    /// How light is found: scatter, connect, mis, mis-power
    #[arg(long, default_value = "mis", value_parser = args::technique, value_name = "NAME")]
    pub technique: Technique,
    /// How a light is selected: uniform, power
    #[arg(long, default_value = "uniform", value_parser = args::selection, value_name = "NAME")]
    pub lights: Selection,
    /// How directions are drawn: uniform, cosine, bsdf
    #[arg(long, default_value = "bsdf", value_parser = args::sampling, value_name = "NAME")]
    pub sampling: Sampling,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: crate::cli::open::Shared,
}

/// A schedule by the name it was typed with; `None` is to be found.
type Asked = (String, Option<estimator::Roulette>);

/// Predicts, verifies, optimises.
pub fn run(args: &Args) -> Result<Ending, Failure> {
    let started = Instant::now();
    let asked = schedules(args)?;
    super::open::threads(args.shared.threads)?;
    let command = output::canonical_command();
    let (description, scene, hash) = scene(args)?;
    let settings = Settings {
        spp: args.spp,
        seed: args.seed,
        max_bounces: args.max_bounces.into(),
        technique: args.technique,
        sampling: args.sampling,
        ..Settings::default()
    };
    preflight::light_is_seen(&scene, &[fredholm::engine::by_rays::Estimator::Prefix], &settings, &[])?;
    preflight::light_is_lost(&scene, &settings, &[args::WorldName::Terms])?;
    let name = format!("{}-roulette", description.name);
    let folder = output::folder(args.shared.out.as_deref(), &name, &command, args.shared.force)?;
    let bar = Bar::plain(args.shared.quiet);
    let progress = bar.progress();

    // the recording, and what follows from it
    let Some(recorded) = roulette::pilot(&scene, &settings, args.spp, progress) else {
        bar.finish();
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    };
    let best = roulette::best(&recorded, &scene);
    let beyond = roulette::beyond(&scene);
    let mut schedules: Vec<estimator::Roulette> = vec![];
    let mut all: Vec<Row> = vec![];
    for (name, given) in asked {
        let Some(schedule) = given.or(best.as_ref().map(|b| b.roulette.clone())) else { continue };
        let (row, schedule) = predict(name, schedule, &recorded, settings.max_bounces, beyond);
        all.push(row);
        schedules.push(schedule);
    }

    // rendered
    if args.verify || args.optimise {
        for (row, schedule) in all.iter_mut().zip(&schedules) {
            let rival = ["optimal", "lecture", "albedo"].contains(&row.name.as_str());
            if args.verify || rival {
                let measured = roulette::measure(&scene, &settings, schedule, args.spp, progress);
                row.measured = measured.map(|m| Noise::measured(&m));
            }
        }
    }
    if args.optimise && !progress.stopped() {
        let spp = (args.spp / 4).max(1);
        let seconds = roulette::seconds_per_path(&scene, &settings, &schedules, spp);
        all.iter_mut().zip(seconds).for_each(|(row, s)| row.seconds = Some(s));
    }
    bar.finish();
    let stopped = progress.stopped();

    // written and printed
    let mut record = summary::Summary {
        command,
        scene: description.name.clone(),
        scene_hash: hash,
        seed: args.seed,
        spp: args.spp.into(),
        max_bounces: settings.max_bounces,
        threads: rayon::current_num_threads(),
        width: description.camera.size[0] as usize,
        height: description.camera.size[1] as usize,
        cross_moments: Some(summary::cross_moments(&recorded, beyond)),
        ..summary::Summary::default()
    };
    record.bounds.max_albedo = scene.max_albedo().as_dvec3();
    record.files = ["roulette.csv", "roulette.png", "roulette.svg", "summary.json"].map(String::from).into();
    record.seconds = started.elapsed().as_secs_f64();
    let caption = Caption { command: record.command.clone(), seed: record.seed, scene: record.scene.clone() };
    write_atomically(&folder.join("roulette.csv"), rows::csv(&all).as_bytes())?;
    let title = format!("Roulette schedules of {}: predicted from paths without roulette", record.scene);
    rows::draw(&all, &title, &caption)?.write(&folder, "roulette")?;
    let old = output::left_by_the_last_run(&folder);
    summary::write(&folder.join("summary.json"), &record)?;
    output::remove_stale(&folder, &old, &record.files);

    let doubts = doubts(&all, &description, &scene);
    let warnings = warnings(&doubts, &recorded);
    if args.shared.json {
        warnings.iter().for_each(|w| super::note(&format!("warning: {w}")));
        super::print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let [w, h] = description.camera.size;
        let head = format!(
            "{}\nseed {}, {} spp, {w}×{h} pixels, technique {}; {} paths recorded in {:.1} s\n\
             from vertex K = {} on every predicted schedule goes on with q = {beyond:.2}",
            record.command,
            args.seed,
            args.spp,
            args.technique,
            table::count(recorded.paths),
            recorded.seconds,
            settings.max_bounces
        );
        let found = if args.optimise { gains(&all, best.as_ref()) } else { String::new() };
        let warned = warnings.iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n");
        let files = format!("written to {}: {}", folder.display(), record.files.join(", "));
        super::print(&super::paragraphs(&[head, rows::table(&all), found, warned, files]))?;
    }
    // a variance that cannot be measured contradicts nothing
    let told = all.iter().filter(|r| doubts.iter().all(|d| d.0 != r.name));
    let contradicted = told.filter_map(Row::z).any(|z| z.abs() > critical(all.len(), recorded.replicates()));
    Ok(match (stopped, contradicted) {
        (true, _) => Ending::Interrupted,
        (_, true) => Ending::Failed,
        _ => Ending::Ok,
    })
}

/// |z| beyond which a prediction is contradicted: family level 10⁻³ over the schedules.
fn critical(schedules: usize, replicates: u64) -> f64 {
    fredholm::stats::critical(1e-3 / schedules as f64, replicates as f64 - 1.0)
}

fn schedules(args: &Args) -> Result<Vec<Asked>, Failure> {
    let list = args.schedules.as_deref().unwrap_or(USUAL);
    let mut all: Vec<Asked> = vec![];
    for name in sweep::values(list) {
        let schedule = args::schedule(&name)
            .map_err(|why| Failure::Usage(format!("error: {why}\nhelp: for example --schedules {USUAL}")))?;
        all.push((name, solve::given(Some(&schedule))));
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

fn scene(args: &Args) -> Result<(Description, Scene, String), Failure> {
    const SIDE: u32 = 64;
    let load = |size: Option<[u32; 2]>| load::scene(&args.scene, &args.shared.changes.options(size));
    let mut loaded = load(args.size)?;
    let [w, h] = loaded.description.camera.size;
    if args.size.is_none() && w.max(h) > SIDE {
        loaded = load(Some([w, h].map(|side| (side * SIDE / w.max(h)).max(1))))?;
    }
    loaded.warnings.iter().for_each(|w| super::note(&format!("warning: {w}")));
    let scene = with_last_resort(Scene::new(&loaded.description)).select_lights(args.lights);
    Ok((loaded.description, scene, solve::scene_hash(&loaded.canonical)))
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
