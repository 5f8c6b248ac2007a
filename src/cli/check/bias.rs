//! `fredholm check bias`: tests the difference of two estimators while samples accumulate.
//!
//! Both sides are rendered in batches, from separate random numbers. After every batch an anytime-valid test looks at all terms,
//! the whole image and the regions. Whatever ends the watch (a decision, the time, Ctrl-C), the probability of a false alarm
//! stays below α.

use super::bias_args::Bias;
use super::common::Common;
use super::sides::{Against, FinishedRun, check_sides, finished, side};
use crate::cli::base::{Ending, Failure, names, note, usage};
use crate::cli::notes;
use crate::cli::session::Session;
use fredholm::engine::batches::Side;
use fredholm::report::figures::watch::{self, Glimpse};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table;
use fredholm::scene::Scene;
use fredholm::stats::{Criterion, Detector, Finding, Outcome};
use fredholm::terms::{Functional, Series, World};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Largest width and height of the image of a batch: a mean needs samples, not pixels.
const SMALL: u32 = 64;

/// The result of a watch, as `--json` prints it.
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

/// Renders batches until the watch ends, writes the files and prints the verdict.
pub(super) fn run(args: &Bias) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.common.shared, args.common.seed)?;
    let finished = finished(args)?;
    // the regions of both sides are the same only if their images have the same size
    let same = Common { size: finished.as_ref().map(|f| f.1).or(args.common.size), ..args.common.clone() };
    let loaded = same.load(&mut session, &args.scene, SMALL)?;
    let [w, h] = loaded.description.camera.size;
    let spp = args.batch.unwrap_or_else(|| 4096u32.div_ceil(w * h));
    let (first, against) = sides(args, finished, spp)?;
    check_sides(&loaded.scene, &first, &against)?;
    session.make_folder(&format!("{}-bias", loaded.description.name))?;

    let limits = [Some(first.limits(&loaded.scene)), against.limits(&loaded.scene)];
    let gap = match &limits {
        [Some(a), Some(b)] => a.gap(b),
        _ => None,
    };
    let criterion = Criterion { of_term: args.delta, alpha: args.alpha, ..Criterion::default() };
    let watched = watch(&session, args, &loaded.scene, (&first, &against), &limits, gap.as_ref(), spp);
    let mut findings = watched.detector.findings();
    if findings.is_empty() {
        return Err(usage("the two sides have nothing in common to compare", "compare estimators that share a term"));
    }
    let why = limits.iter().flatten().find_map(|s| s.undecided.as_deref());
    let outcome = if why.is_some() { Outcome::Inconclusive } else { watched.detector.outcome() };
    if why.is_some() {
        findings.iter_mut().for_each(|f| f.outcome = Outcome::Inconclusive);
    }
    let [paths, rays, non_finite] = watched.cost;
    let record = Record {
        command: session.command(),
        first: first.label(),
        second: against.label(),
        outcome,
        alpha: args.alpha,
        comparisons: watched.detector.family(),
        batches: watched.detector.batches(),
        paths,
        rays,
        non_finite,
        findings: &findings,
    };
    write(&session, args, &record, &watched.curve, spp)?;
    session.show(&record, || {
        let judged = watch::judgement(outcome, &findings, args.alpha, criterion.beta);
        let mut foot = why.map_or(judged, notes::undecided);
        if let Some((from, why)) = &gap {
            foot += &format!("\nT{from} and everything longer: not compared, {why}");
        }
        people(&session, args, &record, &foot, u64::from(spp * w * h))
    })?;
    Ok(match outcome {
        Outcome::Differs => Ending::Failed,
        _ => session.ending(false),
    })
}

/// The two sides: the estimator that is checked, and another estimator or a finished run.
fn sides(args: &Bias, finished: Option<FinishedRun>, spp: u32) -> Result<(Side, Against), Failure> {
    let first = side(args, &args.estimator, args.technique, args.sampling, args.roulette.clone(), spp)?;
    let against = match finished {
        Some((series, _)) => Against::Finished(series),
        None => {
            let technique = args.against_technique.unwrap_or(args.technique);
            let sampling = args.against_sampling.unwrap_or(args.sampling);
            Against::Rendered(side(args, &args.against, technique, sampling, args.against_roulette.clone(), spp)?)
        }
    };
    Ok((first, against))
}

/// The result of a watch.
struct Watched {
    detector: Detector,
    curve: Vec<Glimpse>,
    /// Numbers of paths, of rays, and of samples that are not finite.
    cost: [u64; 3],
}

/// Renders batch after batch, until the test decides, the time is over, or Ctrl-C is pressed.
fn watch(
    session: &Session,
    args: &Bias,
    scene: &Scene,
    (first, against): (&Side, &Against),
    limits: &[Option<Series>; 2],
    gap: Option<&(usize, String)>,
    spp: u32,
) -> Watched {
    let criterion = Criterion { of_term: args.delta, alpha: args.alpha, ..Criterion::default() };
    let empty = match against {
        Against::Rendered(_) => Detector::new(criterion),
        Against::Finished(_) => Detector::against_finished(criterion),
    };
    let mut detector = limits.iter().flatten().fold(empty, Detector::doubting);
    let most = args.spp.map_or(u32::MAX, |n| n.div_ceil(spp));
    let time = args.time.or(args.spp.is_none().then_some(Duration::from_secs(60)));
    let (mut curve, mut cost, mut found) = (vec![], [0u64; 3], None);
    let mut said = Instant::now();
    // batches are short: a batch that has begun is finished, so that all have the same size
    for i in 0..most {
        let a = first.batch(scene, "first", i);
        cost = [cost[0] + a.paths, cost[1] + a.rays, cost[2] + a.non_finite];
        let a = cut(a.functionals, gap);
        match against {
            Against::Rendered(side) => {
                let b = side.batch(scene, "second", i);
                cost = [cost[0] + b.paths, cost[1] + b.rays, cost[2] + b.non_finite];
                detector.push(&a, &b.functionals);
            }
            Against::Finished(series) => detector.push(&a, &series.functionals),
        }
        let n = detector.batches();
        // after a bias is found, the watch goes on for as many batches again, to measure how large the bias is
        let decided = match detector.outcome() {
            Outcome::Inconclusive => false,
            Outcome::Agrees => true,
            Outcome::Differs => n >= 2 * *found.get_or_insert(n),
        };
        let over = session.stopped() || time.is_some_and(|t| session.since().elapsed() >= t);
        let last = decided || over || i + 1 == most;
        if last || n as f64 >= 1.04 * curve.last().map_or(0.0, |g: &Glimpse| g.batches as f64) {
            curve.push(Glimpse { batches: n, image: detector.image() });
        }
        if !session.quiet() && (last || said.elapsed() >= Duration::from_secs(2)) {
            said = Instant::now();
            note(&progress(&detector, session.since()));
        }
        if last {
            break;
        }
    }
    Watched { detector, curve, cost }
}

/// Rows that are printed without `--verbose`.
const SHOWN: usize = 12;

/// The text: the verdict, the terms, and with `--verbose` e-values and p-values.
fn people(session: &Session, args: &Bias, record: &Record<'_>, answer: &str, paths: u64) -> String {
    let Record { command, first, second, batches, comparisons, non_finite, findings, .. } = record;
    let mut above = format!(
        "First ({first}) − second ({second}), in percent of the value: the bias, the interval it lies in, and the smallest bias \
         that would have been found. The intervals hold all at once and at every moment."
    );
    if *non_finite > 0 {
        above += &format!("\nwarning: {non_finite} samples were not finite; they are left in the sums");
    }
    let mut chosen: Vec<usize> = (0..findings.len()).collect();
    chosen.sort_by_key(|&i| (findings[i].outcome == Outcome::Agrees, i + 1 < findings.len()));
    chosen.truncate(SHOWN);
    chosen.sort_unstable();
    let shown: Vec<&Finding> = chosen.iter().map(|&i| &findings[i]).collect();
    let left = findings.len() - shown.len();
    let below = if left > 0 { format!("{left} more terms in summary.json") } else { String::new() };
    let head = format!(
        "{command}\nfirst   {first}\nsecond  {second}\n{batches} batches of {} paths on each side, seed {}; {comparisons} comparisons share α = {}",
        table::count(paths),
        args.common.seed,
        args.alpha
    );
    let full = format!("All terms with their e-values and p-values.\n{}", watch::full_table(findings));
    let tables = [format!("{}\n{}{below}", wrapped(&above), watch::table(&shown))];
    session.text(&wrapped(answer), &tables, &[head, full], &names(FILES))
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

/// The progress line: time, batches, the bias of the whole image with its interval, and the e-value.
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

const FILES: [&str; 3] = ["bias.png", "bias.svg", "summary.json"];

fn write(session: &Session, args: &Bias, record: &Record<'_>, curve: &[Glimpse], spp: u32) -> Result<(), Failure> {
    let common = session.record();
    let title = format!("{} − {}", record.first, record.second);
    let paths = u64::from(spp) * (common.width * common.height) as u64;
    watch::draw(&title, curve, record.findings, paths, args.delta, &session.caption())?
        .write(&session.folder, "bias")?;
    let verdict = |f: &Finding| summary::VerdictRecord {
        name: format!("{} ({})", f.name, f.functional),
        effect: f.effect,
        interval: f.interval,
        p: f.p,
        min_detectable: f.min_detectable,
        outcome: f.outcome,
    };
    session.sign(&Summary {
        spp: record.batches * u64::from(spp),
        max_bounces: args.max_bounces.into(),
        verdicts: record.findings.iter().map(verdict).collect(),
        files: names(FILES),
        ..common
    })
}
