//! `tour`, `series`, `render`, `radiosity`: load, solve in the worlds asked for, compare, write, print.

use super::args::{EstimatorName, FactorsName, GuideName, Run, Schedule, WorldName};
use super::progress::Bar;
use super::write::Export;
use super::{Ending, Failure, notes, output, preflight, write};
use crate::cli::open::{self, Opened};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{Estimator, Sampled};
use fredholm::engine::discretisation::Factors;
use fredholm::engine::guided;
use fredholm::estimator::Roulette;
use fredholm::math::Points;
use fredholm::report::{summary, table};
use fredholm::study;
use fredholm::study::run::Asked;
use std::path::Path;
use std::time::Instant;

/// What a command computes unless told otherwise.
struct Default {
    worlds: &'static [WorldName],
    both_estimators: bool,
    size: Option<[u32; 2]>,
    roulette: Option<Roulette>,
    patches: u32,
    export: Option<Export>,
}

const ALL: &[WorldName] = &[WorldName::Terms, WorldName::Path, WorldName::Radiosity];

/// The tour: all worlds, both estimators.
pub fn tour(run: &Run) -> Result<Ending, Failure> {
    solve(
        run,
        Default {
            worlds: ALL,
            both_estimators: true,
            size: Some([192, 192]),
            roulette: None,
            patches: 2400,
            export: None,
        },
    )
}

/// Each T^k E and the sum.
pub fn series(run: &Run) -> Result<Ending, Failure> {
    solve(run, Default { worlds: ALL, both_estimators: false, size: None, roulette: None, patches: 600, export: None })
}

/// The full path tracer, with the lecture's roulette.
pub fn render(run: &Run) -> Result<Ending, Failure> {
    solve(
        run,
        Default {
            worlds: &[WorldName::Path],
            both_estimators: false,
            size: None,
            roulette: Some(Roulette::LECTURE),
            patches: 600,
            export: None,
        },
    )
}

/// The matrix.
pub fn radiosity(run: &Run, export: Option<Export>) -> Result<Ending, Failure> {
    let worlds = &[WorldName::Radiosity];
    solve(run, Default { worlds, both_estimators: false, size: None, roulette: None, patches: 600, export })
}

fn solve(run: &Run, default: Default) -> Result<Ending, Failure> {
    let started = Instant::now();
    open::threads(run.shared.threads)?;
    let built_in_size = if run.scene == "cornell" { default.size } else { None };
    let Opened { command, description, scene, hash } =
        open::scene(&run.scene, &run.shared.changes, run.size.or(built_in_size))?;
    let scene = scene.select_lights(run.lights);

    // what to do with it
    let max_bounces = usize::from(run.max_bounces.unwrap_or(8));
    let fallback = default.roulette.unwrap_or(Roulette::Albedo { from: 2 });
    let asked = given(run.roulette.as_ref());
    let patches = run.patches.unwrap_or(default.patches);
    let settings = Settings {
        spp: run.spp.unwrap_or(if run.time.is_some() { 1 << 24 } else { 256 }),
        time: run.time,
        seed: run.seed,
        points: run.points,
        max_bounces,
        technique: run.technique,
        sampling: run.sampling,
        roulette: asked.clone().unwrap_or(fallback.clone().after(max_bounces)),
        path_roulette: asked.unwrap_or(fallback),
        patches: patches as usize,
        factors: preflight::factors(run, patches)?,
        read_patches: run.read_patches,
        grading: run.grading,
    };
    let mut worlds: Vec<WorldName> = if run.worlds.is_empty() { default.worlds.to_vec() } else { run.worlds.clone() };
    let by_name = !run.worlds.is_empty() || default.worlds.len() == 1;
    preflight::suits_a_matrix(&description, &mut worlds, by_name)?;
    preflight::fits_in_a_matrix(&scene, settings.factors, &mut worlds, by_name)?;
    let estimators = match (
        worlds.contains(&WorldName::Terms),
        default.both_estimators,
        run.estimator.unwrap_or(EstimatorName::Prefix),
    ) {
        (false, ..) => vec![],
        (_, true, _) => vec![Estimator::Single, Estimator::Prefix],
        (_, _, name) => vec![estimator(name, run.branching)],
    };
    if let (true, Some(_)) = (estimators.is_empty(), run.estimator) {
        let help = "leave --estimator out, or use `fredholm series`";
        return Err(Failure::Usage(format!(
            "error: --estimator is for the terms, which are not asked for\nhelp: {help}"
        )));
    }
    for &estimator in &estimators {
        preflight::tree_can_be_walked(estimator, &settings, description.camera.size)?;
    }
    if run.strategies && estimators != [Estimator::Bidirectional] {
        let help = "add --estimator bidirectional";
        return Err(Failure::Usage(format!("error: only the bidirectional estimator has strategies\nhelp: {help}")));
    }
    if run.guide != GuideName::Bsdf {
        preflight::can_be_guided(&scene, &estimators, &settings, &worlds)?;
    }
    preflight::light_is_seen(&scene, &estimators, &settings, &worlds)?;
    preflight::fits_in_memory(&settings, description.camera.size)?;
    if worlds.contains(&WorldName::Radiosity) {
        preflight::rows_fit_in_memory(&scene, &settings)?;
    }
    preflight::light_is_lost(&scene, &settings, &worlds)?;
    if default.export == Some(Export::Matrix) && settings.factors != Factors::Dense {
        let help = "use --factors dense (up to 20000 patches), or --export mesh";
        return Err(Failure::Usage(format!("error: stored rays have no matrix to write\nhelp: {help}")));
    }
    let folder = output::folder(run.shared.out.as_deref(), &description.name, &command, run.shared.force)?;
    let bar = Bar::new(run.shared.quiet, write::preview(&folder, &description, &command, run.seed));
    let progress = bar.progress();
    let asked = Asked {
        worlds: worlds.iter().map(|w| w.world()).collect(),
        estimators,
        optimal_roulette: run.roulette == Some(Schedule::Optimal),
        guide: (run.guide == GuideName::Radiosity).then(|| run.patches.map_or(guided::PATCHES, |n| n as usize)),
        strategies: run.strategies,
        against_rays: (run.factors == Some(FactorsName::Both)).then(|| preflight::rays(run)),
        orders: run.orders,
        ..Asked::default()
    };
    let mut found = study::run::Run::new(description, scene, settings, asked);
    found.solve(progress)?;
    bar.finish();
    if found.is_empty() {
        super::note("nothing to save yet");
        let _ = std::fs::remove_dir(&folder); // only if it is empty
        return Ok(Ending::Interrupted);
    }
    let size = found.description.camera.size;
    let record = || summary::Summary {
        command: command.clone(),
        scene: found.description.name.clone(),
        scene_hash: hash.clone(),
        seed: run.seed,
        threads: rayon::current_num_threads(),
        seconds: started.elapsed().as_secs_f64(),
        width: size[0] as usize,
        height: size[1] as usize,
        ..summary::Summary::default()
    };
    let summary = write::all(&found, &folder, default.export, record)?;
    let old = output::left_by_the_last_run(&folder);
    summary::write(&folder.join("summary.json"), &summary)?;
    output::remove_stale(&folder, &old, &summary.files);
    if run.shared.json {
        notes::warnings(&found).iter().for_each(|w| super::note(&format!("warning: {w}")));
        super::print(&serde_json::to_string_pretty(&summary)?)?;
    } else {
        super::print(&people(&found, &summary, &folder, run.verbose))?;
    }
    Ok(match (progress.stopped(), found.failed()) {
        (true, _) => Ending::Interrupted,
        (_, true) => Ending::Failed,
        _ => Ending::Ok,
    })
}

/// The schedule that was typed; none if there is none, or if it is yet to be found.
pub fn given(asked: Option<&Schedule>) -> Option<Roulette> {
    match asked {
        Some(Schedule::Given(roulette)) => Some(roulette.clone()),
        _ => None,
    }
}

/// The same where nothing else will do: the study keeps all samples of its terms, or compares them, and has none to find.
pub fn fixed(asked: Option<&Schedule>) -> Result<Option<Roulette>, Failure> {
    match asked {
        Some(Schedule::Optimal) => Err(Failure::Usage(
            "error: --roulette optimal has no part in this\nhelp: `fredholm roulette SCENE --optimise` finds it; give its table here".into(),
        )),
        asked => Ok(given(asked)),
    }
}

/// The estimator of that name.
pub fn estimator(name: EstimatorName, children: u32) -> Estimator {
    match name {
        EstimatorName::Single => Estimator::Single,
        EstimatorName::Prefix => Estimator::Prefix,
        EstimatorName::Branching => Estimator::Branching { children },
        EstimatorName::Light => Estimator::Light,
        EstimatorName::Bidirectional => Estimator::Bidirectional,
    }
}

/// FNV-1a of the scene as loaded.
pub fn scene_hash(canonical: &str) -> String {
    format!("{:016x}", fredholm::math::fnv1a(canonical.bytes()))
}

/// What a run prints: the settings, a table per world, what is known about the decay, the verdicts, the folder.
fn people(found: &study::run::Run, summary: &summary::Summary, folder: &Path, verbose: bool) -> String {
    let s = &found.settings;
    let spp = if s.time.is_none() && summary.spp < s.spp.into() {
        format!("{} of {}", summary.spp, s.spp)
    } else {
        summary.spp.to_string()
    };
    let mut head =
        format!("{}\nseed {}, {spp} spp, {}×{} pixels", summary.command, s.seed, summary.width, summary.height);
    if !found.terms.is_empty() || found.path.is_some() {
        head += &format!("; technique {}", s.technique);
        head += if s.points == Points::Sobol { "; Sobol points" } else { "" };
    }
    let used =
        [(!found.terms.is_empty(), "terms", &s.roulette), (found.path.is_some(), "path tracer", &s.path_roulette)];
    let roulette: Vec<_> = used.iter().filter(|r| r.0).map(|(_, who, r)| format!("{who} {r}")).collect();
    if !roulette.is_empty() {
        head += &format!("\nroulette: {} (q ends a path, survivors weigh 1/(1−q))", roulette.join(", "));
    }
    if let Some(guide) = &found.guide {
        head += "\n";
        head += &notes::guide(guide);
    }
    let mut blocks = vec![head];
    let world = |s: &Sampled, rays: &[u64]| table::series(&s.series.label, s.series.image(), rays);
    blocks.extend(found.terms.iter().map(|t| world(t, &t.rays)));
    if !found.strategies.is_empty() {
        blocks.push(fredholm::report::pyramid::table(&found.strategies));
    }
    blocks.extend(found.path.iter().map(|p| world(p, &[])));
    blocks.extend(found.radiosity.iter().map(|r| world(&r.fine, &[])));
    let mut lines: Vec<String> = found.radiosity.iter().map(|r| notes::matrix_facts(r, verbose)).collect();
    lines.extend(found.radiosity.as_ref().and_then(|r| notes::unlit(&r.matrix.unlit, &found.description)));
    lines.extend(found.against_rays.iter().map(notes::difference));
    lines.extend(notes::decay_facts(found));
    lines.extend(notes::orders(found));
    blocks.push(lines.join("\n"));
    blocks.extend(notes::extrapolated(found));
    blocks.push(fredholm::report::pixel_errors::words(&summary.pixel_errors));
    if !summary.verdicts.is_empty() {
        blocks.push(table::verdicts(&summary.verdicts));
        let why = found.terms.first().and_then(|t| t.series.undecided.as_deref());
        blocks.extend(why.map(notes::undecided));
    }
    blocks.push(notes::warnings(found).iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"));
    blocks.push(format!(
        "{} files after {:.1} s; open {}",
        summary.files.len(),
        summary.seconds,
        folder.join("index.html").display()
    ));
    super::paragraphs(&blocks)
}
