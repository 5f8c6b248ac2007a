//! A sweep over a setting of the terms: renders again for every value, and compares cost and noise.
//!
//! Every row has the numbers that `fredholm series` gives with this value and the same seed. Rows may therefore share random
//! numbers, and their means are not independent of each other.

use super::args::Sweep;
use super::budget;
use super::case::{Case, cases};
use crate::cli::base::{Ending, Failure, names, note};
use crate::cli::session::Session;
use crate::cli::{notes, preflight};
use fredholm::engine::by_rays;
use fredholm::engine::passes::{Look, Watch};
use fredholm::progress::Progress;
use fredholm::report::figures::sweep::{self, Shown};
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::study::roulette;

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

    let (mut rows, mut shown, mut series) = (vec![], vec![], vec![]);
    for case in &cases {
        if session.stopped() {
            break;
        }
        let name = format!("{} {}", args.over, case.value);
        let mut reflected = None;
        let look: Look<'_> = &mut |film| {
            reflected = sweep::reflected(film);
            None
        };
        let progress = session.progress().named(&name);
        let mut result = by_rays::watched(
            &scene,
            Some(case.estimator),
            &case.settings,
            progress,
            Watch { look: Some(look), ..Watch::NONE },
        );
        rows.push(sweep::Row::new(&case.value, &result));
        shown.push(Shown::new(&result, reflected));
        result.series.label = format!("{name}: {}", result.series.label);
        series.push(result.series);
    }
    if rows.is_empty() {
        return Ok(session.nothing_to_save(""));
    }
    let first = &cases[0].settings;
    let record = Summary { spp: first.spp.into(), max_bounces: first.max_bounces, series, ..session.record() };
    let found = sweep::Sweep { over: args.over.to_string(), rows };
    let record = write(&session, &found, &shown, record)?;
    let budget = args.budget().map_or(String::new(), |budget| sweep::budget_table(&found, &shown, budget));
    session.show(&record, || people(&session, &found, &budget, &record))?;
    Ok(session.ending(false))
}

/// Finds the optimal schedules that were asked for, and with --equal-rays or --equal-time shares out the samples.
fn prepare(args: &Sweep, cases: &mut [Case], scene: &Scene, progress: Progress<'_>) -> Result<(), Failure> {
    for case in cases.iter_mut() {
        let Some(aim) = case.optimal else { continue };
        if let Some(best) = roulette::optimal(scene, &case.settings, aim, progress) {
            case.settings.roulette = best.roulette;
            note(&format!("{}: {} is {}", case.value, aim.schedule_name(), case.settings.roulette));
        }
    }
    if let Some(shared) = args.budget() {
        budget::share(shared, cases, scene, progress);
        for case in cases {
            preflight::tree_can_be_walked(case.estimator, &case.settings, scene.camera.size)?;
        }
    }
    Ok(())
}

fn write(session: &Session, found: &sweep::Sweep, shown: &[Shown], record: Summary) -> Result<Summary, Failure> {
    write_atomically(&session.folder.join("sweep.csv"), sweep::csv(found).as_bytes())?;
    let title = match found.over.as_str() {
        "branching" => "What branching costs, and what it gains".into(),
        over => format!("The noise of every term, by {over}"),
    };
    sweep::draw(found, &title, &session.caption())?.write(&session.folder, "sweep")?;
    let size = [record.width, record.height];
    sweep::pictures(found, shown, size, &session.caption())?.write(&session.folder.join("pictures.png"))?;
    let files = names(["pictures.png", "summary.json", "sweep.csv", "sweep.png", "sweep.svg"]);
    let record = Summary { files, ..record };
    session.sign(&record)?;
    Ok(record)
}

fn people(session: &Session, found: &sweep::Sweep, budget: &str, record: &Summary) -> String {
    let Summary { command, seed, width, height, max_bounces, .. } = record;
    let head = format!("{command}\nseed {seed}, {width}×{height} pixels, k ≤ {max_bounces}");
    let tables = [budget.into(), sweep::small_table(found), notes::not_finite(&record.series)];
    session.text(&sweep::answer(found), &tables, &[head, sweep::table(found)], &record.files)
}
