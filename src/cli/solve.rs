//! `tour`, `series`, `render`, `radiosity`: load, solve in the worlds asked for, compare, write, print.

use super::args::{EstimatorName, FactorsName, GuideName, Run, Schedule, WorldName};
use super::progress::Bar;
use super::radiosity::Export;
use super::{Ending, Failure, notes, output, preflight, write};
use crate::cli::open::{self, Opened};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::{self, Discrete, Matrix, MatrixError};
use fredholm::engine::by_rays::{self, Estimator, Sampled};
use fredholm::engine::discretisation::{Difference, Factors};
use fredholm::engine::guided::{self, Prepared};
use fredholm::estimator::Roulette;
use fredholm::guide::ByExpectation;
use fredholm::math::Points;
use fredholm::progress::Progress;
use fredholm::report::text::{summary, table};
use fredholm::scene::bsdf::Sampling;
use fredholm::scene::{Description, Scene};
use fredholm::solver::Radiosity;
use fredholm::stats::{Criterion, compare, discretisation};
use fredholm::study::roulette;
use fredholm::study::roulette::Radii;
use fredholm::study::strategies::{self, Strategy};
use fredholm::study::surface;
use fredholm::terms::functional::Replicates;
use fredholm::terms::{Recorded, Series, Variance};
use std::path::PathBuf;
use std::time::Instant;

/// Everything a run found.
pub struct Solved {
    pub command: String,
    pub folder: PathBuf,
    pub description: Description,
    pub hash: String,
    pub scene: Scene,
    pub settings: Settings,
    pub threads: usize,
    pub started: Instant,
    /// The first is the one whose images are shown.
    pub terms: Vec<Sampled>,
    pub path: Option<Sampled>,
    /// What guided both, if anything did.
    pub guide: Option<Prepared>,
    pub radiosity: Option<Discrete>,
    /// How far stored rays are from the matrix, where both were asked for.
    pub by_rays: Option<Difference>,
    /// Three meshes, coarse to fine, for the order of convergence: patches and image means.
    pub orders: Vec<Series>,
    /// Every strategy of the bidirectional estimator, where they were asked for.
    pub strategies: Vec<Strategy>,
    /// Surface norms by estimator.
    pub surface: Vec<(Estimator, Replicates)>,
    /// Whether the moments of the path tracer are finite, where its roulette is constant.
    pub radii: Option<Radii>,
    /// Moments of paths without roulette, where the terms are estimated by prefixes.
    pub moments: Option<Recorded>,
    pub verdicts: Vec<summary::VerdictRecord>,
}

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
        by_expectation: by_expectation(run.roulette.as_ref(), run.guide != GuideName::Bsdf)?,
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
    let preview = write::preview(&folder, &description, &command, run.seed);
    let bar = Bar::new(run.shared.quiet, preview);
    let progress = bar.progress();
    let stopped = || progress.stopped();

    let mut found = Solved {
        hash,
        threads: rayon::current_num_threads(),
        command,
        folder,
        description,
        scene,
        settings,
        started,
        terms: vec![],
        path: None,
        guide: None,
        radiosity: None,
        by_rays: None,
        orders: vec![],
        surface: vec![],
        strategies: vec![],
        radii: None,
        moments: None,
        verdicts: vec![],
    };

    if run.roulette == Some(Schedule::Optimal)
        && let Some(best) = roulette::optimal(&found.scene, &found.settings, progress)
    {
        (found.settings.roulette, found.settings.path_roulette) = (best.roulette.clone(), best.roulette);
    }
    if run.guide == GuideName::Radiosity {
        let patches = run.patches.map_or(guided::PATCHES, |n| n as usize);
        found.guide = guided::prepare(&found.description, patches, &found.settings, progress)?;
        // without its guide the run would not be the one that was asked for
        if found.guide.is_none() {
            bar.finish();
            return Ok(nothing_to_save(&found));
        }
    }
    // the quick estimator first, so that there is something to see
    for &estimator in estimators.iter().rev() {
        if !stopped() {
            let (scene, settings) = (&found.scene, &found.settings);
            let guided = found.guide.as_ref().and_then(|g| g.terms(scene, estimator, settings, progress));
            let result = guided.unwrap_or_else(|| by_rays::terms(scene, estimator, settings, progress));
            found.terms.insert(0, result);
        }
    }
    if run.strategies && !stopped() {
        found.strategies = strategies::strategies(&found.scene, &found.settings, progress);
    }
    if worlds.contains(&WorldName::Path) && !stopped() {
        let (scene, settings) = (&found.scene, &found.settings);
        found.path = Some(match &found.guide {
            Some(guide) => guide.path(scene, settings, progress),
            None => by_rays::path(scene, settings, progress),
        });
    }
    if worlds.contains(&WorldName::Radiosity) && !stopped() {
        match by_matrix::radiosity(&found.description, &found.scene, &found.settings, progress) {
            Ok(result) => found.radiosity = Some(result),
            Err(MatrixError::Stopped) => {}
            Err(e) => return Err(e.into()),
        }
        if run.factors == Some(FactorsName::Both) && !stopped() {
            found.by_rays = apart(run, &found, progress)?;
        }
        if run.orders && !stopped() {
            found.orders = orders(&found, progress)?;
        }
    }
    if !estimators.is_empty() {
        let reached = found.terms.iter().map(|t| t.spp).min().unwrap_or(0);
        let paths = reached.min(found.settings.spp).max(1).saturating_mul(1024).min(1 << 22);
        for estimator in [Estimator::Single, Estimator::Prefix] {
            if !stopped() {
                let norms = surface::norms(&found.scene, estimator, paths, &found.settings, progress);
                found.surface.push((estimator, norms));
            }
        }
    }
    if let (true, Some(spp)) = (estimators.contains(&Estimator::Prefix) && !stopped(), aside(&found.settings)) {
        found.moments = roulette::pilot(&found.scene, &found.settings, spp, progress);
    }
    bar.finish();

    if found.terms.is_empty() && found.path.is_none() && found.radiosity.is_none() {
        return Ok(nothing_to_save(&found));
    }
    found.radii = radii(&found);
    // a matrix knows more than walkers that may have missed where light is trapped
    if found.radii.and_then(|r| r.variance()) == Some(Variance::Infinite) {
        let alike = found.settings.roulette == found.settings.path_roulette;
        let terms = found.terms.iter_mut().filter(|_| alike);
        found.path.iter_mut().chain(terms).for_each(|s| s.distrust(Variance::Infinite));
    }
    found.verdicts = verdicts(&found);
    let summary = write::all(&found, default.export)?;
    if run.shared.json {
        notes::warnings(&found).iter().for_each(|w| super::note(&format!("warning: {w}")));
        super::print(&serde_json::to_string_pretty(&summary)?)?;
    } else {
        super::print(&people(&found, &summary, run.verbose))?;
    }
    if stopped() {
        return Ok(Ending::Interrupted);
    }
    let differs = found.verdicts.iter().any(|v| v.outcome == fredholm::stats::Outcome::Differs);
    let worlds = found.terms.iter().chain(&found.path).chain(found.radiosity.as_ref().map(|r| &r.fine));
    let broken = worlds.map(|s| s.series.cost.non_finite).sum::<u64>() > 0;
    Ok(if differs || broken { Ending::Failed } else { Ending::Ok })
}

/// Interrupted before anything was found.
fn nothing_to_save(found: &Solved) -> Ending {
    super::note("nothing to save yet");
    let _ = std::fs::remove_dir(&found.folder); // only if it is empty
    Ending::Interrupted
}

/// Whether the variance of the path tracer is finite can be known from the matrix; a coarse one will do. Where there is none,
/// the largest albedo gives a bound.
fn radii(found: &Solved) -> Option<Radii> {
    let q = match &found.settings.path_roulette {
        Roulette::Constant { q, .. } => *q,
        Roulette::Table(q) => *q.last()?,
        _ => return None,
    };
    // both speak of directions drawn by the cosine, without a guide
    if found.path.is_none() || found.guide.is_some() || found.settings.sampling == Sampling::Uniform {
        return None;
    }
    if let Some(matrix) = found.radiosity.as_ref().and_then(|r| r.matrix.radiosity.dense()) {
        return Some(Radii::new(Some(matrix), &found.scene, q));
    }
    let coarse = coarse(&found.description, &found.scene);
    Some(Radii::new(coarse.as_ref().map(|m| &m.radiosity), &found.scene, q))
}

/// A coarse matrix, where the scene has one that costs little.
pub fn coarse(description: &Description, scene: &Scene) -> Option<Matrix<Radiosity>> {
    if scene.sides() > 400 || description.radiosity_suits().is_err() {
        return None;
    }
    by_matrix::dense_matrix(description, scene, 150, 1.0, 0, Progress::NONE).ok()
}

/// The schedule that was typed; none if there is none, or if it is yet to be found.
pub fn given(asked: Option<&Schedule>) -> Option<Roulette> {
    match asked {
        Some(Schedule::Given(roulette)) => Some(roulette.clone()),
        Some(Schedule::ByExpectation(end)) => Some(end.plain()),
        _ => None,
    }
}

/// How guided walks end, where that was typed.
///
/// # Errors
/// Without a guide nobody knows what to expect.
pub fn by_expectation(asked: Option<&Schedule>, guide: bool) -> Result<Option<ByExpectation>, Failure> {
    match asked {
        Some(Schedule::ByExpectation(end)) if !guide => Err(Failure::Usage(format!(
            "error: --roulette {end} goes by what a guide expects, and there is none\nhelp: add --guide radiosity (series, render), or choose albedo"
        ))),
        Some(Schedule::ByExpectation(end)) => Ok(Some(*end)),
        _ => Ok(None),
    }
}

/// The same where nothing else will do: the study keeps all samples of its terms, or compares them, and has none to find.
pub fn fixed(asked: Option<&Schedule>) -> Result<Option<Roulette>, Failure> {
    match asked {
        Some(Schedule::Optimal) => Err(Failure::Usage(
            "error: --roulette optimal has no part in this\nhelp: `fredholm roulette SCENE --optimise` finds it; give its table here".into(),
        )),
        asked => by_expectation(asked, false).map(|_| given(asked)),
    }
}

/// Samples per pixel of the moments that `series` records aside: 3 % of the run; none where that is less than two, or where
/// the moments of so many slots would fill the memory.
fn aside(settings: &Settings) -> Option<u32> {
    (settings.spp >= 64 && settings.max_bounces <= 64).then(|| (settings.spp / 32).min(16))
}

/// How far stored rays on the same patches are from the matrix.
fn apart(run: &Run, found: &Solved, progress: Progress<'_>) -> Result<Option<Difference>, Failure> {
    let Some(r) = &found.radiosity else { return Ok(None) };
    match r.matrix.against_rays(&found.scene, preflight::rays(run), found.settings.seed, progress) {
        Ok(difference) => Ok(Some(difference)),
        Err(MatrixError::Stopped) => Ok(None),
        Err(e) => Err(e.into()),
    }
}

/// Meshes of N/16, N/4 and N patches through the camera, for the order of convergence.
fn orders(found: &Solved, progress: Progress<'_>) -> Result<Vec<Series>, Failure> {
    let coarsest = (found.settings.patches / 16).max(1);
    let matrix = by_matrix::matrix(&found.description, &found.scene, coarsest, &found.settings, progress);
    let picture = match matrix {
        Ok(m) => m.through_camera(&found.scene, &found.settings, progress),
        Err(MatrixError::Stopped) => return Ok(vec![]),
        Err(e) => return Err(e.into()),
    };
    let Some(discrete) = &found.radiosity else { return Ok(vec![]) };
    Ok(vec![picture.series, discrete.coarse.series.clone(), discrete.fine.series.clone()])
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

fn verdicts(found: &Solved) -> Vec<summary::VerdictRecord> {
    let criterion = Criterion::default();
    let mut all = vec![];
    let mut judge = |name: &str, a: &Series, b: &Series, allowance: &[fredholm::terms::Functional]| {
        // terms that one of them does not see in full are not compared
        let comparison = match a.gap(b) {
            None => compare(a, b, &criterion, allowance),
            Some((from, _)) => compare(&a.before(from), b, &criterion, allowance),
        };
        all.extend(summary::verdicts(name, &comparison));
    };
    let Some(terms) = found.terms.first().map(|t| &t.series) else { return all };
    if let Some(other) = found.terms.get(1) {
        judge("single − prefix", terms, &other.series, &[]);
    }
    if let Some(path) = &found.path {
        judge("terms − path", terms, &path.series, &[]);
    }
    if let Some(r) = &found.radiosity {
        judge("terms − radiosity", terms, &r.fine.series, &discretisation(&r.fine.series, &r.coarse.series));
    }
    all
}

/// What a run prints: the settings, a table per world, what is known about the decay, the verdicts, the folder.
fn people(found: &Solved, summary: &summary::Summary, verbose: bool) -> String {
    let s = &found.settings;
    let spp = if s.time.is_none() && summary.spp < s.spp.into() {
        format!("{} of {}", summary.spp, s.spp)
    } else {
        summary.spp.to_string()
    };
    let mut head =
        format!("{}\nseed {}, {spp} spp, {}×{} pixels", found.command, s.seed, summary.width, summary.height);
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
        blocks.push(fredholm::report::figures::pyramid::table(&found.strategies));
    }
    blocks.extend(found.path.iter().map(|p| world(p, &[])));
    blocks.extend(found.radiosity.iter().map(|r| world(&r.fine, &[])));
    let mut lines: Vec<String> = found.radiosity.iter().map(|r| notes::matrix_facts(r, verbose)).collect();
    lines.extend(found.radiosity.as_ref().and_then(|r| notes::unlit(&r.matrix.unlit, &found.description)));
    lines.extend(found.by_rays.iter().map(notes::difference));
    lines.extend(notes::decay_facts(found));
    lines.extend(notes::orders(&found.orders));
    blocks.push(lines.join("\n"));
    blocks.extend(notes::extrapolated(found));
    blocks.push(fredholm::report::text::pixel_errors::words(&summary.pixel_errors));
    if !found.verdicts.is_empty() {
        blocks.push(table::verdicts(&found.verdicts));
        let why = found.terms.first().and_then(|t| t.series.undecided.as_deref());
        blocks.extend(why.map(notes::undecided));
    }
    blocks.push(notes::warnings(found).iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"));
    blocks.push(format!(
        "{} files after {:.1} s; open {}",
        summary.files.len(),
        summary.seconds,
        found.folder.join("index.html").display()
    ));
    super::paragraphs(&blocks)
}
