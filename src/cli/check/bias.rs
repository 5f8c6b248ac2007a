//! `fredholm check bias`: the difference of two estimators, watched while it accumulates.
//!
//! Both sides are rendered in batches from streams of their own. After every batch an anytime-valid test looks at all terms,
//! the whole and the regions; whatever ends the watch (a decision, the time, Ctrl-C), the chance of a false alarm stays below α.

use super::super::args;
use super::super::progress::stop_flag;
use super::super::{Ending, Failure, note, notes, output, paragraphs, print};
use super::sides::{Against, check_sides, finished, side};
use super::{Common, fraction, usage};
use crate::cli::open::Opened;
use clap::Args;
use fredholm::estimator::{Roulette, Technique};
use fredholm::report::figures::watch::{self, Glimpse};
use fredholm::report::image::typeset::Caption;
use fredholm::report::text::{summary, table};
use fredholm::scene::bsdf::Sampling;
use fredholm::stats::{Criterion, Detector, Finding, Outcome};
use fredholm::terms::{Functional, Series, World};
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

pub(super) const EXAMPLES: &str = "Examples:
  fredholm check bias --estimator prefix --against path --scene cornell --alpha 1e-3
  fredholm check bias --technique scatter --against prefix --against-technique connect --time 20s
  fredholm check bias --against fredholm-out/cornell        a finished run; its errors are allowed for

The watch ends when a bias is found (exit code 1), when every image mean is bounded within ±δ of 0
(δ = --delta of the term + 1e-4 of the whole image), at --time or --spp, or with Ctrl-C. None of this
inflates the error rate: the e-value of a mean exceeds 1/α at any time ever with probability α only.

Assumed: the mean of a batch is nearly normal. A batch has --batch samples of every pixel; where fewer
than 400 events carry a mean, or are to be expected, nothing is rejected.";

/// Width and height of a batch: means need samples, not pixels.
const SMALL: u32 = 64;

/// Arguments of `check bias`.
#[derive(Clone, Debug, Args)]
pub struct Bias {
    /// Built-in scene, .toml, or .obj
    #[arg(long, value_name = "SCENE", default_value = "cornell")]
    pub(super) scene: String,
    /// The estimator that is checked: prefix, single, branching, light, bidirectional, path
    #[arg(long, value_name = "NAME", default_value = "prefix")]
    pub(super) estimator: String,
    /// What it is checked against: an estimator, path, or the folder of a finished run
    #[arg(long, value_name = "NAME|DIR", default_value = "path")]
    pub(super) against: String,
    /// How light is found: scatter, connect, mis, mis-power
    #[arg(long, default_value = "mis", value_parser = args::technique, value_name = "NAME")]
    pub(super) technique: Technique,
    /// The same of the other side [default: as --technique]
    #[arg(long, value_parser = args::technique, value_name = "NAME")]
    pub(super) against_technique: Option<Technique>,
    /// Russian roulette [default: none for k ≤ K, then albedo; path: albedo@2]
    #[arg(long, value_name = "SCHEDULE")]
    pub(super) roulette: Option<Roulette>,
    /// The same of the other side [default: as without --roulette]
    #[arg(long, value_name = "SCHEDULE")]
    pub(super) against_roulette: Option<Roulette>,
    /// How directions are drawn: uniform, cosine, bsdf
    #[arg(long, default_value = "bsdf", value_parser = args::sampling, value_name = "NAME")]
    pub(super) sampling: Sampling,
    /// The same of the other side [default: as --sampling]
    #[arg(long, value_parser = args::sampling, value_name = "NAME")]
    pub(super) against_sampling: Option<Sampling>,
    /// Children of every vertex of a branching estimator
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) branching: u32,
    /// K: terms k = 0..=K are watched, everything longer as the tail
    #[arg(long, value_name = "K", default_value_t = 8, value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub(super) max_bounces: u16,
    /// Chance of a false alarm, whenever the watch ends
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = fraction)]
    pub(super) alpha: f64,
    /// δ as a fraction of the term: the watch ends when every bias is proved smaller
    #[arg(long, value_name = "FRACTION", default_value_t = 0.01, value_parser = fraction)]
    pub(super) delta: f64,
    /// Samples per pixel of one batch [default: enough for 4096 paths]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub(super) batch: Option<u32>,
    /// At most this long: 20s, 5m [default: 60s, or no limit with --spp]
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub(super) time: Option<Duration>,
    /// At most this many samples per pixel of each side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    pub(super) spp: Option<u32>,
    #[command(flatten)]
    pub(super) common: Common,
}

/// Seconds by themselves or with an s; minutes with an m.
fn duration(s: &str) -> Result<Duration, String> {
    let (number, unit) = match s.strip_suffix('m') {
        Some(number) => (number, 60.0),
        None => (s.strip_suffix('s').unwrap_or(s), 1.0),
    };
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x < 1e9);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 20s or 5m"))
}

/// What a watch came to, for programs.
#[derive(Serialize)]
struct Record<'a> {
    command: &'a str,
    first: String,
    second: String,
    outcome: Outcome,
    alpha: f64,
    comparisons: usize,
    batches: u64,
    paths: u64,
    rays: u64,
    non_finite: u64,
    findings: &'a [Finding],
}

/// Watches.
pub(super) fn run(args: &Bias) -> Result<Ending, Failure> {
    let started = Instant::now();
    let finished = finished(args)?;
    // regions are parts of an image of one size
    let same = Common { size: finished.as_ref().map(|f| f.1).or(args.common.size), ..args.common.clone() };
    let loaded = same.load(&args.scene, SMALL)?;
    let scene = &loaded.scene;
    let [w, h] = loaded.description.camera.size;
    let spp = args.batch.unwrap_or_else(|| 4096u32.div_ceil(w * h));
    let first = side(args, &args.estimator, args.technique, args.sampling, args.roulette.clone(), spp)?;
    let against = match finished {
        Some((series, _)) => Against::Finished(series),
        None => {
            let technique = args.against_technique.unwrap_or(args.technique);
            let sampling = args.against_sampling.unwrap_or(args.sampling);
            Against::Rendered(side(args, &args.against, technique, sampling, args.against_roulette.clone(), spp)?)
        }
    };
    check_sides(&loaded, &first, &against)?;
    let folder = output::folder(
        args.common.shared.out.as_deref(),
        &format!("bias-{}", loaded.description.name),
        &loaded.command,
        args.common.shared.force,
    )?;

    let limits = [Some(first.limits(scene)), against.limits(scene)];
    let gap = match &limits {
        [Some(a), Some(b)] => a.gap(b),
        _ => None,
    };
    let criterion = Criterion { of_term: args.delta, alpha: args.alpha, ..Criterion::default() };
    let mut detector = match against {
        Against::Rendered(_) => Detector::new(criterion),
        Against::Finished(_) => Detector::against_finished(criterion),
    };
    for side in limits.iter().flatten() {
        detector = detector.doubting(side);
    }
    let most = args.spp.map_or(u32::MAX, |n| n.div_ceil(spp));
    let time = args.time.or(args.spp.is_none().then_some(Duration::from_secs(60)));
    // batches are short: one that is begun is finished, so that all are alike
    let stop = stop_flag();
    let (mut curve, mut cost, mut found) = (vec![], [0u64; 3], None);
    let mut said = Instant::now();
    for i in 0..most {
        let a = first.batch(scene, "first", i);
        cost = [cost[0] + a.paths, cost[1] + a.rays, cost[2] + a.non_finite];
        let a = cut(a.functionals, gap.as_ref());
        match &against {
            Against::Rendered(side) => {
                let b = side.batch(scene, "second", i);
                cost = [cost[0] + b.paths, cost[1] + b.rays, cost[2] + b.non_finite];
                detector.push(&a, &b.functionals);
            }
            Against::Finished(series) => detector.push(&a, &series.functionals),
        }
        let n = detector.batches();
        // a bias that has been found is followed for as long again, so that one sees how large it is
        let decided = match detector.outcome() {
            Outcome::Inconclusive => false,
            Outcome::Agrees => true,
            Outcome::Differs => n >= 2 * *found.get_or_insert(n),
        };
        let over = stop.load(Ordering::Relaxed) || time.is_some_and(|t| started.elapsed() >= t);
        let last = decided || over || i + 1 == most;
        if last || n as f64 >= 1.04 * curve.last().map_or(0.0, |g: &Glimpse| g.batches as f64) {
            curve.push(Glimpse { batches: n, image: detector.image() });
        }
        if !args.common.shared.quiet && (last || said.elapsed() >= Duration::from_secs(2)) {
            said = Instant::now();
            note(&progress(&detector, started));
        }
        if last {
            break;
        }
    }

    let mut findings = detector.findings();
    if findings.is_empty() {
        return Err(usage("the two sides have nothing in common to compare", "compare estimators that share a term"));
    }
    let second = against.label();
    let why = limits.iter().flatten().find_map(|s| s.undecided.as_deref());
    let outcome = if why.is_some() { Outcome::Inconclusive } else { detector.outcome() };
    if why.is_some() {
        findings.iter_mut().for_each(|f| f.outcome = Outcome::Inconclusive);
    }
    let record = Record {
        command: &loaded.command,
        first: first.label(),
        second: second.clone(),
        outcome,
        alpha: args.alpha,
        comparisons: detector.family(),
        batches: detector.batches(),
        paths: cost[0],
        rays: cost[1],
        non_finite: cost[2],
        findings: &findings,
    };
    write(&folder, args, &loaded, &record, &curve, spp, started)?;
    if args.common.shared.json {
        print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let judged = watch::judgement(outcome, &findings, args.alpha, criterion.beta);
        let mut foot = why.map_or(judged, notes::undecided);
        if let Some((from, why)) = &gap {
            foot += &format!("\nT{from} and everything longer: not compared, {why}");
        }
        if cost[2] > 0 {
            foot += &format!("\nwarning: {} samples were not finite; they are left in the sums", cost[2]);
        }
        let head = format!(
            "{}\nfirst   {}\nsecond  {second}\n{} batches of {} paths a side, seed {}; {} comparisons share α = {}",
            loaded.command,
            first.label(),
            record.batches,
            table::count(u64::from(spp * w * h)),
            args.common.seed,
            record.comparisons,
            args.alpha
        );
        let files = format!("written to {}: bias.png, bias.svg, summary.json", folder.display());
        print(&paragraphs(&[head, watch::table(&findings), foot, files]))?;
    }
    Ok(match outcome {
        Outcome::Differs => Ending::Failed,
        _ if stop.load(Ordering::Relaxed) => Ending::Interrupted,
        _ => Ending::Ok,
    })
}

/// The terms that both sides see in full.
fn cut(functionals: Vec<Functional>, gap: Option<&(usize, String)>) -> Vec<Functional> {
    let Some((from, _)) = gap else { return functionals };
    let series = Series {
        world: World::Terms,
        label: String::new(),
        functionals,
        cost: fredholm::terms::Cost::default(),
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    };
    series.before(*from).functionals
}

/// One line: how far, the bias of the whole with its interval, the evidence.
fn progress(detector: &Detector, started: Instant) -> String {
    let image = detector.image();
    let widest = image.iter().max_by(|a, b| (a.effect / a.scale).abs().total_cmp(&(b.effect / b.scale).abs()));
    let Some(f) = widest else { return String::new() };
    let percent = |x: f64| 100.0 * x / f.scale;
    let half = 0.5 * (f.interval.1 - f.interval.0);
    let to =
        if half.is_finite() { format!(" ± {:.2} %", percent(half)) } else { " (interval not yet bounded)".into() };
    format!(
        "{:>4.0} s, {} batches: {} ({}) {:+.3} %{to}, e = {}",
        started.elapsed().as_secs_f64(),
        detector.batches(),
        f.name,
        f.functional,
        percent(f.effect),
        watch::e_value(f.log_e)
    )
}

fn write(
    folder: &Path,
    args: &Bias,
    loaded: &Opened,
    record: &Record,
    curve: &[Glimpse],
    spp: u32,
    started: Instant,
) -> Result<(), Failure> {
    let caption =
        Caption { command: loaded.command.clone(), seed: args.common.seed, scene: loaded.description.name.clone() };
    let [w, h] = loaded.description.camera.size;
    let title = format!("{} − {}", record.first, record.second);
    let paths = u64::from(spp) * u64::from(w) * u64::from(h);
    watch::draw(&title, curve, record.findings, paths, args.delta, &caption)?.write(folder, "bias")?;
    let verdict = |f: &Finding| summary::VerdictRecord {
        name: format!("{} ({})", f.name, f.functional),
        effect: f.effect,
        interval: f.interval,
        p: f.p,
        min_detectable: f.min_detectable,
        outcome: f.outcome,
    };
    let files = ["bias.png", "bias.svg", "summary.json"].map(String::from).to_vec();
    let summary = summary::Summary {
        command: loaded.command.clone(),
        scene: loaded.description.name.clone(),
        scene_hash: loaded.hash.clone(),
        seed: args.common.seed,
        spp: record.batches * u64::from(spp),
        max_bounces: args.max_bounces.into(),
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: w as usize,
        height: h as usize,
        verdicts: record.findings.iter().map(verdict).collect(),
        files: files.clone(),
        ..summary::Summary::default()
    };
    let old = output::left_by_the_last_run(folder);
    summary::write(&folder.join("summary.json"), &summary)?;
    output::remove_stale(folder, &old, &files);
    Ok(())
}
