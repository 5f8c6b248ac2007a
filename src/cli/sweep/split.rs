//! `fredholm sweep [SCENE] --over split`: the samples of separate terms shared equally, shared best, and one path for all.

use super::args::{self, WorldName};
use super::progress::Bar;
use super::sweep::usage;
use super::{Ending, Failure, output, preflight, solve};
use crate::cli::open::{self, Opened};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::Roulette;
use fredholm::report::{split as report, summary, typeset::Caption, write_atomically};
use fredholm::study::split;
use std::time::Instant;

/// Measures the three ways.
pub fn run(args: &args::Sweep) -> Result<Ending, Failure> {
    let started = Instant::now();
    if args.several.estimators.is_some() {
        return Err(usage("--over split always compares single with prefix", "leave --estimator out"));
    }
    let args = &super::sweep_spp::one_of_each(args)?;
    let run = &args.run;
    let max_bounces = usize::from(run.max_bounces.unwrap_or(8));
    let spp = run.spp.unwrap_or(256);
    let settings = Settings {
        spp,
        seed: run.seed,
        points: run.points,
        max_bounces,
        technique: run.technique,
        sampling: run.sampling,
        roulette: solve::fixed(run.roulette.as_ref())?.unwrap_or(Roulette::Albedo { from: 2 }.after(max_bounces)),
        ..Settings::default()
    };
    if spp < 16 {
        return Err(usage(&format!("{spp} samples are fewer than the 16 replicates"), "choose at least --spp 16"));
    }
    let Opened { command, description, scene, hash } = open::run(run)?;
    preflight::fits_in_memory(&settings, description.camera.size)?;
    preflight::light_is_seen(&scene, &[Estimator::Prefix], &settings, &[])?;
    preflight::light_is_lost(&scene, &settings, &[WorldName::Terms])?;
    let folder =
        output::folder(run.shared.out.as_deref(), &format!("{}-split", description.name), &command, run.shared.force)?;
    let bar = Bar::plain(run.shared.quiet);
    let progress = bar.progress();
    let pilot = args.pilot.unwrap_or(spp / 4);
    let study = split::study(&scene, &settings, pilot, progress);
    bar.finish();
    let Some(study) = study else {
        super::note("nothing to save yet: the comparison needs all its renders");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    };

    let caption = Caption { command: command.clone(), seed: run.seed, scene: description.name.clone() };
    write_atomically(&folder.join("split.csv"), report::csv(&study).as_bytes())?;
    write_atomically(&folder.join("covariance.csv"), report::covariance_csv(&study.reuse.covariance).as_bytes())?;
    let slots = study.pilot.len();
    report::draw(&study.reuse.covariance, slots, "What terms of one path share", &caption)?
        .write(&folder, "covariance")?;
    let files = ["covariance.csv", "covariance.png", "covariance.svg", "split.csv", "summary.json"];
    let record = summary::Summary {
        command,
        scene: description.name.clone(),
        scene_hash: hash,
        seed: run.seed,
        spp: spp.into(),
        max_bounces,
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: description.camera.size[0] as usize,
        height: description.camera.size[1] as usize,
        files: files.map(String::from).into(),
        ..summary::Summary::default()
    };
    let old = output::left_by_the_last_run(&folder);
    summary::write(&folder.join("summary.json"), &record)?;
    output::remove_stale(&folder, &old, &record.files);
    if run.shared.json {
        return super::print(&serde_json::to_string_pretty(&record)?).map(|()| Ending::Ok);
    }
    let head = format!(
        "{}\nseed {}, {}×{} pixels, k ≤ {max_bounces}, technique {}, {} threads; cost per pixel",
        record.command, run.seed, record.width, record.height, settings.technique, record.threads
    );
    let files = format!("written to {}:\n{}", folder.display(), record.files.join(", "));
    super::print(&super::paragraphs(&[head, report::table(&study), files]))?;
    Ok(Ending::Ok)
}
