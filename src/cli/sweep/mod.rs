//! `fredholm sweep [SCENE] --over SETTING`: the terms again for every value of one setting, cost beside gain.
//!
//! Every row is what `fredholm series` gives with that value and the same seed, so rows may share random numbers: their
//! means are not independent of each other.

use super::args::{self, EstimatorName, Over, WorldName};
use super::progress::Bar;
use super::{Ending, Failure, output, preflight, solve};
use crate::cli::open::{self, Opened};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::Roulette;
use fredholm::progress::Progress;
use fredholm::report::sweep::{self, Row, Sweep};
use fredholm::report::typeset::Caption;
use fredholm::report::{summary, write_atomically};
use fredholm::scene::{Description, Scene};
use fredholm::study::roulette;
use fredholm::terms::Series;
use std::path::Path;
use std::time::Instant;

/// One value of the setting.
struct Case {
    value: String,
    estimator: Estimator,
    settings: Settings,
    /// The schedule is still to be found.
    optimal: bool,
}

/// Renders the terms for every value.
pub fn run(args: &args::Sweep) -> Result<Ending, Failure> {
    if args.over == Over::Patches {
        return super::sweep_patches::run(args);
    }
    refuse_what_has_no_part(args)?;
    match args.over {
        Over::Spp => return super::sweep_spp::run(args),
        Over::Split => return super::sweep_split::run(args),
        _ => {}
    }
    let args = &super::sweep_spp::one_of_each(args)?;
    let (run, over) = (&args.run, args.over);
    let started = Instant::now();
    let mut cases = cases(args)?;
    let Opened { command, description, scene, hash } = open::run(run)?;
    for case in &cases {
        preflight::tree_can_be_walked(case.estimator, &case.settings, description.camera.size)?;
        preflight::fits_in_memory(&case.settings, description.camera.size)?;
        preflight::light_is_seen(&scene, &[case.estimator], &case.settings, &[])?;
        preflight::light_is_lost(&scene, &case.settings, &[WorldName::Terms])?;
    }
    let folder =
        output::folder(run.shared.out.as_deref(), &format!("{}-{over}", description.name), &command, run.shared.force)?;
    let bar = Bar::plain(run.shared.quiet);
    let progress = bar.progress();
    for case in cases.iter_mut().filter(|c| c.optimal) {
        if let Some(best) = roulette::optimal(&scene, &case.settings, progress) {
            case.settings.roulette = best.roulette;
            super::note(&format!("{}: optimal is {}", case.value, case.settings.roulette));
        }
    }
    if args.equal_rays {
        share_rays(&mut cases, &scene);
        for case in &cases {
            preflight::tree_can_be_walked(case.estimator, &case.settings, description.camera.size)?;
        }
    }

    // every value in turn
    let (mut rows, mut series) = (vec![], vec![]);
    for case in &cases {
        if progress.stopped() {
            break;
        }
        let name = format!("{over} {}", case.value);
        let mut result = by_rays::terms(&scene, case.estimator, &case.settings, progress.named(&name));
        rows.push(Row::new(&case.value, &result));
        result.series.label = format!("{over} {}: {}", case.value, result.series.label);
        series.push(result.series);
    }
    bar.finish();
    let stopped = progress.stopped();
    if rows.is_empty() {
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    }

    let sweep = Sweep { over: over.to_string(), rows };
    let mut record = summary::Summary {
        command,
        scene: description.name.clone(),
        scene_hash: hash,
        seed: run.seed,
        spp: cases[0].settings.spp.into(),
        max_bounces: cases[0].settings.max_bounces,
        threads: rayon::current_num_threads(),
        width: description.camera.size[0] as usize,
        height: description.camera.size[1] as usize,
        ..summary::Summary::default()
    };
    record.series = series;
    record.seconds = started.elapsed().as_secs_f64();
    write(&folder, &sweep, &mut record)?;
    if run.shared.json {
        super::print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        super::print(&people(&sweep, &record, &description, &cases[0].settings, &folder))?;
    }
    Ok(if stopped { Ending::Interrupted } else { Ending::Ok })
}

fn write(folder: &Path, sweep: &Sweep, record: &mut summary::Summary) -> Result<(), Failure> {
    let caption = Caption { command: record.command.clone(), seed: record.seed, scene: record.scene.clone() };
    write_atomically(&folder.join("sweep.csv"), sweep::csv(sweep).as_bytes())?;
    let title = match sweep.over.as_str() {
        "branching" => "What branching costs, and what it gains".into(),
        over => format!("The noise of every term, by {over}"),
    };
    sweep::draw(sweep, &title, &caption)?.write(folder, "sweep")?;
    record.files = ["summary.json", "sweep.csv", "sweep.png", "sweep.svg"].map(String::from).into();
    let old = output::left_by_the_last_run(folder);
    summary::write(&folder.join("summary.json"), record)?;
    output::remove_stale(folder, &old, &record.files);
    Ok(())
}

fn people(sweep: &Sweep, record: &summary::Summary, d: &Description, s: &Settings, folder: &Path) -> String {
    let [w, h] = d.camera.size;
    let broken = record.series.iter().filter(|s: &&Series| s.cost.non_finite > 0);
    let broken = broken.map(|s| format!("warning: {}: {} samples were not finite", s.label, s.cost.non_finite));
    let head = format!("{}\nseed {}, {w}×{h} pixels, k ≤ {}", record.command, record.seed, s.max_bounces);
    let files = format!("written to {}: {}", folder.display(), record.files.join(", "));
    super::paragraphs(&[head, sweep::table(sweep), broken.collect::<Vec<_>>().join("\n"), files])
}

/// Options of `series` that a sweep of the terms would silently ignore.
fn refuse_what_has_no_part(args: &args::Sweep) -> Result<(), Failure> {
    let run = &args.run;
    let given = [
        ("--worlds", !run.worlds.is_empty()),
        ("--patches", run.patches.is_some()),
        ("--read-patches", run.read_patches),
        ("--orders", run.orders),
        ("--strategies", run.strategies),
        ("--guide", run.guide != args::GuideName::Bsdf),
        ("--time", run.time.is_some()),
    ];
    if let Some((name, _)) = given.iter().find(|g| g.1) {
        return Err(usage(&format!("{name} has no part in a sweep, which renders the terms"), "leave it out"));
    }
    if args.eigenvalues.is_some() || run.grading != 1.0 {
        return Err(usage("--eigenvalues and --grading are for matrices", "leave them out, or use --over patches"));
    }
    if args.equal_rays && args.over == Over::Spp {
        return Err(usage("--equal-rays would make every spp the same", "leave it out, or sweep something else"));
    }
    if args.equal_rays && args.over == Over::Split {
        return Err(usage("--over split gives every way about the same rays already", "leave --equal-rays out"));
    }
    if args.values.is_some() && args.over == Over::Split {
        return Err(usage(
            "--over split has no values: it always compares equal, optimal and prefix",
            "leave them out",
        ));
    }
    if args.reference.is_some() && args.over != Over::Spp {
        return Err(usage("--reference is for --over spp", "leave it out, or sweep over spp"));
    }
    if args.pilot.is_some() && args.over != Over::Split {
        return Err(usage("--pilot is for --over split", "leave it out, or sweep over split"));
    }
    Ok(())
}

pub(super) fn usage(what: &str, help: &str) -> Failure {
    Failure::Usage(format!("error: {what}\nhelp: {help}"))
}

/// The values asked for, or the usual ones, each with what is to be rendered.
fn cases(args: &args::Sweep) -> Result<Vec<Case>, Failure> {
    let (run, over) = (&args.run, args.over);
    let max_bounces = usize::from(run.max_bounces.unwrap_or(if over == Over::Branching { 4 } else { 8 }));
    let after = Roulette::Albedo { from: 2 }.after(max_bounces);
    let (given, wish) = (solve::given(run.roulette.as_ref()), run.roulette == Some(args::Schedule::Optimal));
    let common = Settings {
        spp: run.spp.unwrap_or(if over == Over::Branching { 32 } else { 256 }),
        seed: run.seed,
        points: run.points,
        max_bounces,
        technique: run.technique,
        sampling: run.sampling,
        roulette: given.unwrap_or(after),
        ..Settings::default()
    };
    let usual = match over {
        Over::Branching => "1,2,3,4",
        Over::Technique => "scatter,connect,mis,mis-power",
        Over::Sampling => "uniform,cosine,bsdf",
        Over::Estimator => "prefix,single,branching,light,bidirectional",
        Over::Points => "independent,sobol",
        Over::Roulette => "none,lecture,albedo",
        Over::Spp | Over::Split | Over::Patches => "", // commands of their own
    };
    let case = |value: String| {
        let (mut estimator, mut settings) =
            (solve::estimator(run.estimator.unwrap_or(EstimatorName::Prefix), run.branching), common.clone());
        let mut optimal = wish;
        let set = || -> Result<(), String> {
            match over {
                Over::Branching => estimator = Estimator::Branching { children: number(&value, 1000)? },
                Over::Spp | Over::Split | Over::Patches => {}
                Over::Technique => settings.technique = args::technique(&value)?,
                Over::Sampling => settings.sampling = args::sampling(&value)?,
                Over::Points => settings.points = args::points(&value)?,
                Over::Roulette => {
                    let asked = args::schedule(&value)?;
                    optimal = asked == args::Schedule::Optimal;
                    settings.roulette = solve::given(Some(&asked)).unwrap_or(settings.roulette.clone());
                }
                Over::Estimator => {
                    let name = <args::EstimatorName as clap::ValueEnum>::from_str(&value, false);
                    let wrong = |_| format!("`{value}` is none of prefix, single, branching, light, bidirectional");
                    estimator = solve::estimator(name.map_err(wrong)?, run.branching);
                }
            }
            Ok(())
        };
        let mut set = set;
        set().map_err(|why| usage(&why, &format!("values of --over {over} are such as --values {usual}")))?;
        Ok(Case { value, estimator, settings, optimal })
    };
    values(args.values.as_deref().unwrap_or(usual)).into_iter().map(case).collect()
}

/// Values with commas between them; the numbers of `table:0,0,0.5` stay together.
pub(super) fn values(list: &str) -> Vec<String> {
    let mut all: Vec<String> = vec![];
    for word in list.split(',').map(str::trim) {
        match all.last_mut() {
            Some(last) if last.starts_with("table:") && word.parse::<f64>().is_ok() => *last += &format!(",{word}"),
            _ => all.push(word.into()),
        }
    }
    all
}

pub(super) fn number(text: &str, most: u32) -> Result<u32, String> {
    let n = text.parse().ok().filter(|n| (1..=most).contains(n));
    n.ok_or_else(|| format!("`{text}` is not a whole number from 1 to {most}"))
}

/// Gives every case about the rays that the dearest takes with its samples: a trial with one sample tells the price.
fn share_rays(cases: &mut [Case], scene: &Scene) {
    let price = |case: &Case| {
        let trial = Settings { spp: 1, ..case.settings.clone() };
        let cost = by_rays::terms(scene, case.estimator, &trial, Progress::NONE).series.cost;
        cost.rays as f64 / cost.paths as f64
    };
    let prices: Vec<f64> = cases.iter().map(price).collect();
    let dearest = prices.iter().copied().fold(0.0, f64::max);
    for (case, price) in cases.iter_mut().zip(prices) {
        let spp = f64::from(case.settings.spp) * dearest / price;
        case.settings.spp = (spp.round() as u32).clamp(1, 1 << 24);
    }
}
