//! A sweep over a setting of the terms: renders again for every value, and compares cost and noise.
//!
//! Every row has the numbers that `fredholm series` gives with this value and the same seed. Rows may therefore share random
//! numbers, and their means are not independent of each other.

use super::args::{Over, Sweep};
use crate::cli::base::{Ending, Failure, names, note, usage};
use crate::cli::options::{number, values};
use crate::cli::session::Session;
use crate::cli::suggest::question;
use crate::cli::{notes, preflight};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::progress::Progress;
use fredholm::report::figures::sweep;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::study::roulette::{self, Aim, Schedule};

/// One value of the setting.
struct Case {
    value: String,
    estimator: Estimator,
    settings: Settings,
    /// The quantity for which the best schedule must first be found; None if the schedule is given.
    optimal: Option<Aim>,
}

/// Renders the terms for every value.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let mut cases = cases(args)?;
    let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size)?;
    let scene = opened.scene.select_lights(args.lights);
    for case in &cases {
        preflight::can_be_sampled(&scene, Some(case.estimator), &case.settings)?;
    }
    session.make_folder(&format!("{}-sweep-{}", opened.description.name, args.over))?;
    prepare(args, &mut cases, &scene, session.progress())?;

    let (mut rows, mut series) = (vec![], vec![]);
    for case in &cases {
        if session.stopped() {
            break;
        }
        let name = format!("{} {}", args.over, case.value);
        let mut result = by_rays::terms(&scene, case.estimator, &case.settings, session.progress().named(&name));
        rows.push(sweep::Row::new(&case.value, &result));
        result.series.label = format!("{name}: {}", result.series.label);
        series.push(result.series);
    }
    if rows.is_empty() {
        return Ok(session.nothing_to_save(""));
    }
    let first = &cases[0].settings;
    let record = Summary { spp: first.spp.into(), max_bounces: first.max_bounces, series, ..session.record() };
    let found = sweep::Sweep { over: args.over.to_string(), rows };
    let record = write(&session, &found, record)?;
    session.show(&record, || people(&session, &found, &record))?;
    Ok(session.ending(false))
}

/// Finds the optimal schedules that were asked for, and with --equal-rays gives every value the same number of rays.
fn prepare(args: &Sweep, cases: &mut [Case], scene: &Scene, progress: Progress<'_>) -> Result<(), Failure> {
    for case in cases.iter_mut() {
        let Some(aim) = case.optimal else { continue };
        if let Some(best) = roulette::optimal(scene, &case.settings, aim, progress) {
            case.settings.roulette = best.roulette;
            note(&format!("{}: {} is {}", case.value, aim.schedule_name(), case.settings.roulette));
        }
    }
    if args.equal_rays {
        share_rays(cases, scene);
        for case in cases {
            preflight::tree_can_be_walked(case.estimator, &case.settings, scene.camera.size)?;
        }
    }
    Ok(())
}

fn write(session: &Session, found: &sweep::Sweep, record: Summary) -> Result<Summary, Failure> {
    write_atomically(&session.folder.join("sweep.csv"), sweep::csv(found).as_bytes())?;
    let title = match found.over.as_str() {
        "branching" => "What branching costs, and what it gains".into(),
        over => format!("The noise of every term, by {over}"),
    };
    sweep::draw(found, &title, &session.caption())?.write(&session.folder, "sweep")?;
    let record = Summary { files: names(["summary.json", "sweep.csv", "sweep.png", "sweep.svg"]), ..record };
    session.sign(&record)?;
    Ok(record)
}

fn people(session: &Session, found: &sweep::Sweep, record: &Summary) -> String {
    let Summary { command, seed, width, height, max_bounces, .. } = record;
    let head = format!("{command}\nseed {seed}, {width}×{height} pixels, k ≤ {max_bounces}");
    let tables = [sweep::small_table(found), notes::not_finite(&record.series)];
    session.text(&sweep::answer(found), &tables, &[head, sweep::table(found)], &record.files)
}

/// The default values of each setting.
fn usual(over: Over) -> &'static str {
    match over {
        Over::Branching => "1,2,3,4",
        Over::Technique => "scatter,connect,mis,mis-power",
        Over::Sampling => "uniform,cosine,bsdf",
        Over::Estimator => "prefix,single,branching,light,bidirectional",
        Over::Points => "independent,sobol",
        Over::Roulette => "none,lecture,albedo",
        Over::Spp | Over::Split | Over::Patches => "", // sweeps of their own
    }
}

/// The values that were asked for, or the default ones, each with its settings.
fn cases(args: &Sweep) -> Result<Vec<Case>, Failure> {
    let (one, mut common) = (args.one_of_each()?, args.settings(if args.over == Over::Branching { 32 } else { 256 }));
    (common.points, common.technique) = (one.points, one.technique);
    if let Some(given) = one.roulette.as_ref().and_then(Schedule::given) {
        common.roulette = given;
    }
    let case = |value: String| {
        let optimal = one.roulette.as_ref().and_then(Schedule::aim);
        let mut case = Case { value, estimator: one.estimator, settings: common.clone(), optimal };
        let help = || format!("values of --over {} are such as --values {}", args.over, usual(args.over));
        let asked =
            || question(&format!("--{}", args.over), &case.value, &usual(args.over).split(',').collect::<Vec<_>>());
        let asked = asked().map_or(String::new(), |q| q + "\n      ");
        case.set(args.over, args.branching).map_err(|why| usage(&why, &(asked + &help())))?;
        Ok(case)
    };
    values(args.values.as_deref().unwrap_or(usual(args.over))).into_iter().map(case).collect()
}

impl Case {
    /// Sets what is swept over to its value.
    fn set(&mut self, over: Over, children: u32) -> Result<(), String> {
        let value = &self.value;
        match over {
            Over::Branching => self.estimator = Estimator::Branching { children: number(value, 1000)? },
            Over::Spp | Over::Split | Over::Patches => {}
            Over::Technique => self.settings.technique = value.parse()?,
            Over::Sampling => self.settings.sampling = value.parse()?,
            Over::Points => self.settings.points = value.parse()?,
            Over::Roulette => {
                let asked: Schedule = value.parse()?;
                if let Schedule::ByExpectation(end) = asked {
                    return Err(format!("{end} needs a guide, and a sweep has none"));
                }
                self.optimal = asked.aim();
                if let Some(given) = asked.given() {
                    self.settings.roulette = given;
                }
            }
            Over::Estimator => self.estimator = value.parse::<Estimator>()?.with_children(children),
        }
        Ok(())
    }
}

/// Gives every case about the rays that the most expensive one takes with its samples. A trial with one sample per pixel
/// measures the rays of a path.
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
