//! What is refused before a run starts, because it could only end badly.

use super::base::{Failure, note, usage};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::MatrixError;
use fredholm::engine::by_rays::{Begins, Estimator};
use fredholm::engine::discretisation::{Factors, Form};
use fredholm::engine::known::length::{Length, length};
use fredholm::engine::known::trap::trapped;
use fredholm::engine::known::unsampled::unsampled;
use fredholm::estimator::{Roulette, Technique};
use fredholm::scene::{Description, Scene, bsdf::Sampling};
use fredholm::study::roulette::Schedule;
use fredholm::terms::World;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// The sums of all terms, pixels and replicates are held at once: better refused now than killed later.
pub fn fits_in_memory(settings: &Settings, [w, h]: [u32; 2]) -> Result<(), Failure> {
    let replicates = u64::from(settings.spp.min(16));
    let bytes = u64::from(w) * u64::from(h) * (settings.max_bounces as u64 + 2) * (replicates + 2) * 24;
    let what = format!("{w}×{h} pixels with terms up to k = {}", settings.max_bounces);
    fits(bytes, &what, "choose a smaller --size or --max-bounces")
}

/// A guide steers walks from the eye, at surfaces that scatter by the cosine.
pub fn can_be_guided(
    scene: &Scene,
    estimators: &[Estimator],
    settings: &Settings,
    worlds: &[World],
) -> Result<(), Failure> {
    let wrong = |what: &str, help: &str| Err(usage(what, help));
    if estimators.iter().any(|e| e.begins() != Begins::AtEye) {
        return wrong("a guide steers walks from the eye only", "use --estimator prefix, single or branching");
    }
    if !worlds.iter().any(|w| matches!(w, World::Terms | World::Path)) {
        return wrong("--guide is for rays, and none are asked for", "leave --guide out, or use `fredholm series`");
    }
    if settings.sampling == Sampling::Uniform {
        return wrong("a guide replaces the cosine, and --sampling uniform has none", "leave --sampling out");
    }
    let sides = reflecting(scene);
    if sides > POSSIBLE {
        let what = format!("{sides} sides make at least as many patches, more than the {POSSIBLE} a guide may have");
        return wrong(&what, "leave --guide out");
    }
    Ok(())
}

/// N^K rays for every path grow beyond all patience long before they grow beyond memory.
pub fn tree_can_be_walked(estimator: Estimator, settings: &Settings, [w, h]: [u32; 2]) -> Result<(), Failure> {
    const MOST: f64 = 1e11;
    let Estimator::Branching { children } = estimator else { return Ok(()) };
    // of a render by the clock only the first pass must be possible
    let spp = if settings.time.is_some() { settings.spp.min(16) } else { settings.spp };
    let paths = f64::from(w) * f64::from(h) * f64::from(spp);
    let deepest = f64::from(children).powi(settings.max_bounces as i32) * paths;
    if deepest <= MOST {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "error: {children} children at every vertex make {deepest:.1e} rays at depth {}\n\
         help: choose fewer children, or a smaller --max-bounces, --spp or --size",
        settings.max_bounces
    )))
}

/// A matrix holds Lambertian surfaces of one colour that are lit by surfaces. Not asked for by name it is left out, with a
/// word, where the scene has others.
pub fn suits_a_matrix(description: &Description, worlds: &mut Vec<World>, asked: bool) -> Result<(), Failure> {
    let Err(why) = description.radiosity_suits() else { return Ok(()) };
    if !worlds.contains(&World::Radiosity) {
        return Ok(());
    }
    if asked {
        let help = if description.lights.is_empty() {
            "--lambertian takes all its surfaces for Lambertian; rays take it as it is: --worlds terms,path"
        } else {
            "rays take it as it is: --worlds terms,path"
        };
        return Err(Failure::Usage(format!("error: no radiosity matrix can hold this scene: {why}\nhelp: {help}")));
    }
    worlds.retain(|w| *w != World::Radiosity);
    note(&format!("note: no radiosity: {why}"));
    Ok(())
}

/// Refuses what would only be dark, and says what will be missing.
pub fn light_is_seen(
    scene: &Scene,
    estimators: &[Estimator],
    settings: &Settings,
    worlds: &[World],
) -> Result<(), Failure> {
    let walks: Vec<Option<Estimator>> =
        estimators.iter().map(|&e| Some(e)).chain(worlds.contains(&World::Path).then_some(None)).collect();
    let from_eye = |e: &Option<Estimator>| e.is_none_or(|e| e.begins() == Begins::AtEye);
    if settings.technique == Technique::Scatter && scene.lights.all_delta() && walks.iter().any(from_eye) {
        return Err(Failure::Usage(
            "error: no ray ever hits a point or a direction, and nothing else emits light here\n\
             help: use --technique connect or mis"
                .into(),
        ));
    }
    for walk in walks {
        for missing in unsampled(scene, walk, settings.technique) {
            let who = walk.map_or("the path tracer".into(), |e| e.to_string());
            let who = if walk.is_some_and(|e| e.begins() == Begins::AtLight) {
                who
            } else {
                format!("{who}, {}", settings.technique)
            };
            let (from, what) = (missing.from, missing.what);
            note(&format!("note: not supported by {who}, from k = {from} on: {what}"));
        }
    }
    Ok(())
}

/// Most patches that a matrix or a guide may have.
const POSSIBLE: usize = 20_000;

/// A side of a primitive is at least one patch, and the matrix is dense. Where the radiosity was not asked for by name it is
/// left out of scenes with many primitives; asked for by name it is refused beyond what any machine holds.
pub fn fits_in_a_matrix(scene: &Scene, factors: Factors, worlds: &mut Vec<World>, asked: bool) -> Result<(), Failure> {
    const COMFORTABLE: usize = 4000;
    if let Factors::Rays(_) = factors {
        return Ok(());
    }
    let sides = reflecting(scene);
    if !worlds.contains(&World::Radiosity) || sides <= if asked { POSSIBLE } else { COMFORTABLE } {
        return Ok(());
    }
    if asked {
        return Err(Failure::Usage(format!(
            "error: {sides} sides make a matrix of at least {sides}², more than the {POSSIBLE}² it may have\n\
             help: store rays instead: --factors rays; or leave the radiosity world out: --worlds terms,path"
        )));
    }
    worlds.retain(|w| *w != World::Radiosity);
    note(&format!(
        "note: no radiosity: {sides} sides are many for a dense matrix (--worlds terms,path,radiosity insists)"
    ));
    Ok(())
}

/// Beyond this a matrix is refused.
const MOST_DENSE: u32 = 20_000;
/// Beyond this rays are stored unless a matrix is asked for.
const DENSE: u32 = 10_000;
/// Rays of a row unless told otherwise.
const RAYS: u32 = 256;

/// Rays of a row, where rays are stored.
pub fn rays(asked: Option<u32>) -> u32 {
    asked.unwrap_or(RAYS)
}

/// How form factors are held.
pub fn factors(form: Option<Form>, per_row: Option<u32>, patches: u32) -> Result<Factors, Failure> {
    let dense = form.map_or(patches <= DENSE, |f| f != Form::Rays);
    if dense && patches > MOST_DENSE {
        return Err(Failure::Usage(format!(
            "error: {patches} patches make a matrix of {patches}², more than the {MOST_DENSE}² it may have\n\
             help: use --factors rays"
        )));
    }
    if dense && per_row.is_some() && form != Some(Form::Both) {
        return Err(Failure::Usage(
            "error: --rays is for stored rays, and this is a matrix\nhelp: add --factors rays or --factors both".into(),
        ));
    }
    Ok(if dense { Factors::Dense } else { Factors::Rays(rays(per_row)) })
}

/// A dense matrix that was asked for by name can be had.
pub fn has_a_matrix(description: &Description, scene: &Scene, factors: Factors) -> Result<(), Failure> {
    let mut worlds = vec![World::Radiosity];
    suits_a_matrix(description, &mut worlds, true)?;
    fits_in_a_matrix(scene, factors, &mut worlds, true)
}

/// What a study of one way of sampling asks: it sees light, its trees can be walked, its film fits, and light gets out.
pub fn can_be_sampled(scene: &Scene, estimator: Option<Estimator>, settings: &Settings) -> Result<(), Failure> {
    let size = scene.camera.size;
    let world = [if estimator.is_some() { World::Terms } else { World::Path }];
    let estimators: Vec<Estimator> = estimator.into_iter().collect();
    estimators.iter().try_for_each(|&e| tree_can_be_walked(e, settings, size))?;
    fits_in_memory(settings, size)?;
    light_is_seen(scene, &estimators, settings, &world)?;
    light_is_lost(scene, settings, &world)
}

/// A schedule where nothing else will do: the study keeps all samples of its terms, or compares them, and has none to find.
pub fn fixed(asked: Option<&Schedule>) -> Result<Option<Roulette>, Failure> {
    match asked {
        Some(Schedule::Optimal(_)) => Err(Failure::Usage(
            "error: --roulette optimal has no part in this\nhelp: `fredholm roulette SCENE --optimise` finds it; give its table here".into(),
        )),
        asked => needs_no_guide(asked).map(|()| asked.and_then(Schedule::given)),
    }
}

/// A schedule that goes by what is expected needs a guide, and there is none.
pub fn needs_no_guide(asked: Option<&Schedule>) -> Result<(), Failure> {
    match asked {
        Some(Schedule::ByExpectation(end)) => Err(usage(
            &format!("--roulette {end} needs the light that a guide expects, and there is no guide"),
            "add --guide radiosity (series, render), or choose albedo",
        )),
        _ => Ok(()),
    }
}

/// Sides that reflect or emit: each is one patch at least.
fn reflecting(scene: &Scene) -> usize {
    (0..scene.sides()).filter(|&s| scene.takes_part(s)).count()
}

/// Rows, patches, terms and solution are held at once.
pub fn rows_fit_in_memory(scene: &Scene, settings: &Settings) -> Result<(), Failure> {
    let n = settings.patches.max(reflecting(scene)) as u64;
    // measured: a patch of the mesh takes about 400 bytes, a vector over the patches 24, a stored ray 3
    let row = match settings.factors {
        Factors::Dense => 4 * n,
        Factors::Rays(rays) => 3 * u64::from(rays),
    };
    let bytes = n * (row + 400 + 24 * (settings.max_bounces as u64 + 12));
    fits(bytes, &format!("the rows of {n} patches"), "choose fewer --patches or --rays")
}

/// Refuses what needs more memory than is free. Where the system does not say what is free, the allocator has the last word.
fn fits(bytes: u64, what: &str, help: &str) -> Result<(), Failure> {
    let Some(free) = available().filter(|free| bytes > *free) else { return Ok(()) };
    let [need, have] = [bytes, free].map(|b| b as f64 / f64::from(1 << 30));
    Err(Failure::Usage(format!("error: {what} need {need:.1} GiB of memory; {have:.1} GiB are free\nhelp: {help}")))
}

/// Bytes of memory that are free; nothing where the system does not say.
fn available() -> Option<u64> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory));
    Some(system.available_memory()).filter(|bytes| *bytes > 0)
}

/// Refuses a scene in which light never gets out, if anything longer than K is asked for: `L = E + T L` has no solution, and paths
/// that only absorption ends would never end. Says what long paths cost.
pub fn light_is_lost(scene: &Scene, settings: &Settings, worlds: &[World]) -> Result<(), Failure> {
    let has = |world| worlds.contains(&world);
    let walked = [
        (has(World::Terms) && settings.roulette.ends(), &settings.roulette),
        (has(World::Path) && settings.path_roulette.ends(), &settings.path_roulette),
    ];
    let walked: Vec<&Roulette> = walked.into_iter().filter(|w| w.0).map(|w| w.1).collect();
    if !has(World::Radiosity) && walked.is_empty() {
        return Ok(());
    }
    if trapped(scene).is_some() {
        return Err(MatrixError::Singular.into());
    }
    if let Some((vertex, q)) = scene.last_resort().filter(|_| walked.iter().any(|r| r.fixed(usize::MAX).is_none())) {
        note(&format!(
            "note: an albedo is 1, or only known to be at most 1: from vertex {vertex} on paths end with q ≥ {q}\n\
             (second moments of light lose more than {:.2} at a vertex, so that the variance stays finite)",
            4.0 * q
        ));
    }
    // only a bound near 1 makes paths long
    if let (Some(roulette), true) = (walked.last(), scene.max_albedo().max_element() > LONG) {
        let Length { rays, seconds } = length(scene, roulette, settings);
        if rays > MANY {
            let [w, h] = scene.camera.size.map(f64::from);
            let paths = w * h * f64::from(settings.spp) * walked.len() as f64;
            let each = seconds / rayon::current_num_threads() as f64;
            let time = if settings.time.is_some() {
                String::new()
            } else {
                format!(
                    "; {} paths take about {:.0} s",
                    fredholm::report::text::table::count(paths as u64),
                    paths * each
                )
            };
            note(&format!("note: paths are long, {} rays each in the mean{time}", rays.round()));
        }
    }
    Ok(())
}

/// Below this albedo nobody has to be told how long paths are.
const LONG: f32 = 0.99;
/// Rays of a path that are many.
const MANY: f64 = 200.0;
