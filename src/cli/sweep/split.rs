//! `--over split`: separate samples for each term, shared equally or optimally, against one path for all terms.

use super::args::Sweep;
use crate::cli::base::{Ending, Failure, names, usage};
use crate::cli::preflight;
use crate::cli::session::Session;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::report::figures::split as report;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::split::{self, Study};

/// Measures the three ways.
pub fn run(args: &Sweep) -> Result<Ending, Failure> {
    if args.estimators.is_some() {
        return Err(usage("--over split always compares single with prefix", "leave --estimator out"));
    }
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let settings = settings(args)?;
    let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size)?;
    let scene = opened.scene.select_lights(args.lights);
    preflight::can_be_sampled(&scene, Some(Estimator::Prefix), &settings)?;
    session.make_folder(&format!("{}-sweep-split", opened.description.name))?;
    let pilot = args.pilot.unwrap_or(settings.spp / 4);
    let Some(study) = split::study(&scene, &settings, pilot, session.progress()) else {
        return Ok(session.nothing_to_save(": the comparison needs all its renders"));
    };
    write(&session, &study)?;
    let record = Summary {
        spp: settings.spp.into(),
        max_bounces: settings.max_bounces,
        files: names(["covariance.csv", "covariance.png", "covariance.svg", "split.csv", "summary.json"]),
        ..session.record()
    };
    session.sign(&record)?;
    session.show(&record, || {
        let Summary { command, seed, width, height, max_bounces, threads, .. } = &record;
        let head = format!(
            "{command}\nseed {seed}, {width}×{height} pixels, k ≤ {max_bounces}, technique {}, {threads} threads; cost per pixel",
            settings.technique
        );
        let tables = [report::small_table(&study), report::samples(&study)];
        session.text(&report::answer(&study), &tables, &[head, report::table(&study)], &record.files)
    })?;
    Ok(Ending::Ok)
}

fn settings(args: &Sweep) -> Result<Settings, Failure> {
    let (one, mut settings) = (args.one_of_each()?, args.settings(256));
    (settings.points, settings.technique) = (one.points, one.technique);
    if let Some(given) = preflight::fixed(one.roulette.as_ref())? {
        settings.roulette = given;
    }
    if settings.spp < 16 {
        let what = format!("{} samples are fewer than the 16 replicates", settings.spp);
        return Err(usage(&what, "choose at least --spp 16"));
    }
    Ok(settings)
}

fn write(session: &Session, study: &Study) -> Result<(), Failure> {
    let (folder, covariance) = (&session.folder, &study.reuse.covariance);
    write_atomically(&folder.join("split.csv"), report::csv(study).as_bytes())?;
    write_atomically(&folder.join("covariance.csv"), report::covariance_csv(covariance).as_bytes())?;
    report::draw(covariance, study.pilot.len(), "How the terms of one path are correlated", &session.caption())?
        .write(folder, "covariance")?;
    Ok(())
}
