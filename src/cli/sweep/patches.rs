//! `fredholm sweep [SCENE] --over patches`: the matrix on finer and finer meshes against the truth from rays.

use super::progress::Bar;
use super::{Ending, Failure, args, output, preflight, solve};
use crate::cli::open::{self, Opened};
use fredholm::engine::Settings;
use fredholm::engine::discretisation::Factors;
use fredholm::estimator::Roulette;
use fredholm::report::typeset::Caption;
use fredholm::report::{drift, refine as report, summary, write_atomically};
use fredholm::study::refinement;
use std::time::Instant;

/// Meshes of these sizes unless told otherwise: h halves from one to the next.
const USUAL: &str = "38,150,600,2400";

/// Solves on every mesh and holds the terms against rays.
pub fn run(args: &args::Sweep) -> Result<Ending, Failure> {
    let run = &args.run;
    let started = Instant::now();
    let mut sizes = args
        .values
        .as_deref()
        .unwrap_or(USUAL)
        .split(',')
        .map(|v| v.trim().parse().ok().filter(|n| (1..=20_000).contains(n)).ok_or(v))
        .collect::<Result<Vec<usize>, _>>()
        .map_err(|v| {
            Failure::Usage(format!(
                "error: `{v}` is not a number of patches from 1 to 20000\n\
                 help: values of --over patches are such as --values {USUAL}"
            ))
        })?;
    sizes.sort_unstable();
    sizes.dedup();
    let Opened { command, description, scene, hash } = open::run(run)?;
    let mut worlds = vec![args::WorldName::Radiosity];
    preflight::suits_a_matrix(&description, &mut worlds, true)?;
    preflight::fits_in_a_matrix(&scene, Factors::Dense, &mut worlds, true)?;
    let max_bounces = usize::from(run.max_bounces.unwrap_or(8));
    let settings = Settings {
        spp: run.spp.unwrap_or(256),
        seed: run.seed,
        points: run.points,
        max_bounces,
        technique: run.technique,
        sampling: run.sampling,
        roulette: solve::fixed(run.roulette.as_ref())?.unwrap_or(Roulette::Albedo { from: 2 }.after(max_bounces)),
        read_patches: run.read_patches,
        grading: run.grading,
        ..Settings::default()
    };
    preflight::fits_in_memory(&settings, description.camera.size)?;
    preflight::light_is_lost(&scene, &settings, &[args::WorldName::Terms])?;
    let folder = output::folder(
        run.shared.out.as_deref(),
        &format!("{}-patches", description.name),
        &command,
        run.shared.force,
    )?;
    let bar = Bar::plain(run.shared.quiet);
    let progress = bar.progress();
    let eigenvalues = args.eigenvalues.unwrap_or(0).into();
    let found = refinement::refine(&description, &scene, &sizes, eigenvalues, &settings, progress)?;
    bar.finish();
    let stopped = progress.stopped();
    if found.meshes.is_empty() {
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    }
    let caption = Caption { command: command.clone(), seed: run.seed, scene: description.name.clone() };
    write_atomically(&folder.join("patches.csv"), report::csv(&found, max_bounces).as_bytes())?;
    report::draw(&found, max_bounces, &caption)?.write(&folder, "patches")?;
    let [w, h] = description.camera.size.map(|s| s as usize);
    report::places(&found, [w, h], 0.1, &caption)?.picture.write(&folder.join("places.png"))?;
    let mut files: Vec<String> =
        ["summary.json", "patches.csv", "patches.png", "patches.svg", "places.png"].map(String::from).into();
    let channel = found.meshes.last().and_then(|m| m.spectrum.as_ref()).map(|e| super::radiosity::NAMES[e.channel]);
    if let Some(channel) = channel {
        let title = format!("Eigenvalues and the mesh: {}, {channel}", description.name);
        write_atomically(&folder.join("eigenvalues.csv"), drift::csv(&found).as_bytes())?;
        drift::draw(&found, &title, &caption)?.write(&folder, "eigenvalues")?;
        files.extend(["eigenvalues.csv", "eigenvalues.png", "eigenvalues.svg"].map(String::from));
    }
    let record = summary::Summary {
        command: command.clone(),
        scene: description.name.clone(),
        scene_hash: hash,
        seed: run.seed,
        spp: settings.spp.into(),
        max_bounces,
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: w,
        height: h,
        files,
        series: std::iter::once(&found.truth)
            .chain(found.meshes.iter().map(|m| &m.picture))
            .map(|s| s.series.clone())
            .collect(),
        ..summary::Summary::default()
    };
    let old = output::left_by_the_last_run(&folder);
    summary::write(&folder.join("summary.json"), &record)?;
    output::remove_stale(&folder, &old, &record.files);
    if run.shared.json {
        super::print(&serde_json::to_string_pretty(&record)?)?;
    } else {
        let head = format!(
            "{command}\nseed {}, {w}×{h} pixels, {} spp for the truth and for every mesh, k ≤ {max_bounces}",
            run.seed, settings.spp
        );
        let foot = "T0 and T1 are controls: there a mesh reads E itself.\n\
                    An order stands where two or more errors exceed 3 standard errors and have one sign."
            .to_string();
        let names: Vec<String> = record.files.chunks(5).map(|line| line.join(", ")).collect();
        let files = format!("written to {}:\n{}", folder.display(), names.join(",\n"));
        let mut blocks = vec![head, report::table(&found, max_bounces), foot];
        blocks.extend(channel.map(|c| drift::table(&found, c)));
        blocks.push(files);
        super::print(&super::paragraphs(&blocks))?;
    }
    Ok(if stopped { Ending::Interrupted } else { Ending::Ok })
}
