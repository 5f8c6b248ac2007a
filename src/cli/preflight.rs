//! Checks before a run starts: refuses runs that cannot succeed, and notes what a run will not show.

use super::base::{Failure, note, usage};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix::MatrixError;
use fredholm::engine::by_rays::{Begins, Estimator};
use fredholm::engine::discretisation::{Factors, Form};
use fredholm::engine::known::length::{Length, length};
use fredholm::engine::known::trap::trapped;
use fredholm::engine::known::unsampled::unsampled;
use fredholm::estimator::{Roulette, Technique};
use fredholm::scene::{Crop, Description, Scene, bsdf::Sampling};
use fredholm::study::roulette::Schedule;
use fredholm::terms::World;
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Refuses a film that needs more memory than is free: the sums of all terms, pixels and replicates are held at the same time.
pub fn fits_in_memory(settings: &Settings, size: [u32; 2]) -> Result<(), Failure> {
    part_fits_in_memory(settings, size, 1)
}

/// The same for one of several parts, which touches only its own blocks of the film.
pub fn part_fits_in_memory(settings: &Settings, [w, h]: [u32; 2], parts: u32) -> Result<(), Failure> {
    let replicates = u64::from(settings.replicates_of(settings.spp));
    let bytes = u64::from(w) * u64::from(h) * (settings.max_bounces as u64 + 2) * (replicates + 2) * 24;
    let bytes = bytes / u64::from(parts);
    let what = format!("{w}×{h} pixels with terms up to k = {}", settings.max_bounces);
    fits(bytes, &what, "choose a smaller --size or --max-bounces")
}

/// The rectangle between two corners of a picture: x0,y0,x1,y1.
pub fn crop([x0, y0, x1, y1]: [u32; 4], [w, h]: [u32; 2]) -> Result<Crop, Failure> {
    if x1 > w || y1 > h {
        let what = format!("--crop {x0},{y0},{x1},{y1} is not inside the picture of {w}×{h} pixels");
        return Err(usage(&what, &format!("choose corners from 0,0 to {w},{h}")));
    }
    Ok(Crop { from: [x0, y0], size: [x1 - x0, y1 - y0] })
}

/// Refuses a guide that has no effect: it guides walks from the eye, at surfaces where directions are drawn by the cosine.
pub fn can_be_guided(
    scene: &Scene,
    estimators: &[Estimator],
    settings: &Settings,
    worlds: &[World],
) -> Result<(), Failure> {
    let wrong = |what: &str, help: &str| Err(usage(what, help));
    if estimators.iter().any(|e| e.begins() != Begins::AtEye) {
        return wrong("a guide acts on walks from the eye only", "use --estimator prefix, single or branching");
    }
    if !worlds.iter().any(|w| matches!(w, World::Terms | World::Path)) {
        return wrong(
            "--guide is for rays, and --worlds radiosity traces no paths",
            "leave --guide out, or add terms or path to --worlds",
        );
    }
    if settings.sampling == Sampling::Uniform {
        return wrong(
            "a guide replaces the cosine density, which --sampling uniform does not use",
            "leave --sampling out",
        );
    }
    let sides = reflecting(scene);
    if sides > POSSIBLE {
        let what = format!("the scene has {sides} sides, each at least one patch; a guide may have {POSSIBLE} patches");
        return wrong(&what, "leave --guide out");
    }
    Ok(())
}

/// Refuses a tree of more than 10¹¹ rays at its deepest level, which would take days.
pub fn tree_can_be_walked(estimator: Estimator, settings: &Settings, [w, h]: [u32; 2]) -> Result<(), Failure> {
    const MOST: f64 = 1e11;
    let Estimator::Branching { children } = estimator else { return Ok(()) };
    // with --time, only the first pass must be possible
    let spp = if settings.time.is_some() { settings.replicates_of(settings.spp) } else { settings.spp };
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

/// A matrix can hold only Lambertian surfaces of one colour that are lit by surfaces. If the scene has others, the matrix is
/// refused if it was asked for by name, and otherwise left out with a note.
pub fn suits_a_matrix(description: &Description, worlds: &mut Vec<World>, asked: bool) -> Result<(), Failure> {
    let Err(why) = description.radiosity_suits() else { return Ok(()) };
    if !worlds.contains(&World::Radiosity) {
        return Ok(());
    }
    if asked {
        let help = if description.lights.is_empty() {
            "--lambertian makes all its surfaces Lambertian; `fredholm series --worlds terms,path` renders it as it is"
        } else {
            "`fredholm series --worlds terms,path` renders it as it is"
        };
        return Err(Failure::Usage(format!("error: no radiosity matrix can hold this scene: {why}\nhelp: {help}")));
    }
    worlds.retain(|w| *w != World::Radiosity);
    note(&format!("note: no radiosity: {why}"));
    Ok(())
}

/// Refuses a render that would be black, and notes which light an estimator cannot find.
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
            "error: no ray ever hits a point light or a directional light, and the scene has no other lights\n\
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

/// Every side of a primitive is at least one patch of the dense matrix. If the scene has too many, the matrix is refused if it
/// was asked for by name, and otherwise left out with a note.
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
            "error: the scene has {sides} sides, so a dense matrix has at least {sides}² entries; {POSSIBLE}² are possible\n\
             help: use --factors rays, or solve without a matrix: `fredholm series --worlds terms,path`"
        )));
    }
    worlds.retain(|w| *w != World::Radiosity);
    note(&format!(
        "note: no radiosity: {sides} sides are many for a dense matrix (to force it: --worlds terms,path,radiosity)"
    ));
    Ok(())
}

/// Most patches of a dense matrix.
const MOST_DENSE: u32 = 20_000;
/// With more patches than this, rays are stored by default.
const DENSE: u32 = 10_000;
/// Rays of a row by default.
const RAYS: u32 = 256;

/// Rays of a row if rays are stored: the number given, or the default.
pub fn rays(asked: Option<u32>) -> u32 {
    asked.unwrap_or(RAYS)
}

/// How form factors are held: as asked, or by the number of patches. Refuses options that contradict each other.
pub fn factors(form: Option<Form>, per_row: Option<u32>, patches: u32) -> Result<Factors, Failure> {
    let dense = form.map_or(patches <= DENSE, |f| f != Form::Rays);
    if dense && patches > MOST_DENSE {
        return Err(Failure::Usage(format!(
            "error: {patches} patches make a dense matrix of {patches}² entries; {MOST_DENSE}² are possible\n\
             help: use --factors rays"
        )));
    }
    if dense && per_row.is_some() && form != Some(Form::Both) {
        return Err(Failure::Usage(
            "error: --rays is for stored rays, and this matrix is dense\nhelp: add --factors rays or --factors both"
                .into(),
        ));
    }
    Ok(if dense { Factors::Dense } else { Factors::Rays(rays(per_row)) })
}

/// Refuses a scene that a matrix cannot hold, for commands that need one.
pub fn has_a_matrix(description: &Description, scene: &Scene, factors: Factors) -> Result<(), Failure> {
    let mut worlds = vec![World::Radiosity];
    suits_a_matrix(description, &mut worlds, true)?;
    fits_in_a_matrix(scene, factors, &mut worlds, true)
}

/// All checks for one way of sampling: it finds light, its tree is not too large, its film fits, and light gets out.
pub fn can_be_sampled(scene: &Scene, estimator: Option<Estimator>, settings: &Settings) -> Result<(), Failure> {
    let size = scene.camera.size;
    let world = [if estimator.is_some() { World::Terms } else { World::Path }];
    let estimators: Vec<Estimator> = estimator.into_iter().collect();
    estimators.iter().try_for_each(|&e| tree_can_be_walked(e, settings, size))?;
    fits_in_memory(settings, size)?;
    light_is_seen(scene, &estimators, settings, &world)?;
    light_is_lost(scene, settings, &world)
}

/// The schedule that is given, for studies that cannot search for the optimal one.
pub fn fixed(asked: Option<&Schedule>) -> Result<Option<Roulette>, Failure> {
    match asked {
        Some(Schedule::Optimal(_)) => Err(Failure::Usage(
            "error: this command cannot search for the optimal roulette\nhelp: `fredholm roulette SCENE --optimise` finds it; give its table here".into(),
        )),
        asked => needs_no_guide(asked).map(|()| asked.and_then(Schedule::given)),
    }
}

/// Refuses a schedule that needs the expected values of a guide, where there is no guide.
pub fn needs_no_guide(asked: Option<&Schedule>) -> Result<(), Failure> {
    match asked {
        Some(Schedule::ByExpectation(end)) => Err(usage(
            &format!("--roulette {end} needs the expected values of a guide, and there is no guide"),
            "add --guide radiosity (in series or render), or use --roulette albedo",
        )),
        _ => Ok(()),
    }
}

/// Number of sides that reflect or emit: each is at least one patch.
fn reflecting(scene: &Scene) -> usize {
    (0..scene.sides()).filter(|&s| scene.takes_part(s)).count()
}

/// Refuses a matrix that needs more memory than is free: rows, patches, terms and solution are held at the same time.
pub fn rows_fit_in_memory(scene: &Scene, settings: &Settings, parts: u32) -> Result<(), Failure> {
    let sides = reflecting(scene);
    if sides > settings.patches {
        note(&format!(
            "note: each of the scene's {sides} sides is at least one patch, so the mesh has more than {} patches",
            settings.patches
        ));
    }
    let n = settings.patches.max(sides) as u64;
    // measured: a patch of the mesh takes about 400 bytes, a vector over the patches 24, a stored ray 3; an entry of a dense matrix takes 4,
    // and 8 more for each channel while it is factorised
    let row = match settings.factors {
        Factors::Dense => (4 + 3 * 8) * n,
        Factors::Rays(rays) => 3 * u64::from(rays) / u64::from(parts),
    };
    let bytes = n * (row + 400 + 24 * (settings.max_bounces as u64 + 12));
    fits(bytes, &format!("the rows of {n} patches"), "choose fewer --patches or --rays")
}

/// Refuses what needs more memory than is free. If the system does not tell how much is free, nothing is refused.
fn fits(bytes: u64, what: &str, help: &str) -> Result<(), Failure> {
    let Some(free) = available().filter(|free| bytes > *free) else { return Ok(()) };
    let [need, have] = [bytes, free].map(|b| b as f64 / f64::from(1 << 30));
    Err(Failure::Usage(format!("error: {what} need {need:.1} GiB of memory; {have:.1} GiB are free\nhelp: {help}")))
}

/// Bytes of free memory; `None` if the system does not tell.
fn available() -> Option<u64> {
    let memory = MemoryRefreshKind::nothing().with_ram();
    let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory));
    Some(system.available_memory()).filter(|bytes| *bytes > 0)
}

/// Refuses a scene in which light never gets out, if paths longer than K are asked for: `L = E + T L` then has no solution, and
/// paths that end by absorption alone never end. Notes the cost of long paths.
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
            "note: an albedo is 1, or only known to be at most 1: from vertex {vertex} on, paths end with q ≥ {q}\n\
             (the second moment of light then loses more than {:.2} at a vertex, so that the variance stays finite)",
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
            note(&format!("note: paths are long: {} rays on average{time}", rays.round()));
        }
    }
    Ok(())
}

/// Largest albedo at which the length of paths is not worth a note.
const LONG: f32 = 0.99;
/// Rays per path above which a note is printed.
const MANY: f64 = 200.0;
