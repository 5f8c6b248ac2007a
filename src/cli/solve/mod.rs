//! The commands `tour`, `series`, `render` and `radiosity`: load a scene, solve it, compare the results, write and print them.

mod args;
pub mod help;
mod resume;
mod shard;
mod text;

use super::base::{Ending, Failure, usage};
use super::keep::{self, Merged};
use super::open::Opened;
use super::output::command_of;
use super::session::Session;
use super::write::{self, Export};
use super::{notes, preflight};
pub use args::{Mesh, Pictures, Pixels, Render, Request, Series, Solving, Tour};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{Begins, Estimator};
use fredholm::engine::discretisation::{Factors, Form};
use fredholm::engine::guided::{self, Guiding};
use fredholm::estimator::Roulette;
use fredholm::report::image::exposure::Exposure;
use fredholm::study::roulette::Schedule;
use fredholm::study::run::{Asked, Run};
use fredholm::terms::{Part, World};
use std::path::Path;

/// What a command computes, and how, if its options do not say so.
pub struct Default {
    /// The command's name in the default output folder; empty for the tour.
    name: &'static str,
    worlds: &'static [World],
    both_estimators: bool,
    size: Option<[u32; 2]>,
    roulette: Roulette,
    patches: u32,
    export: Option<Export>,
    /// Suggestions for the next command, printed at the end.
    next: &'static str,
}

/// The defaults of `series`: all three results.
pub const SERIES: Default = Default {
    name: "-series",
    worlds: &World::ALL,
    both_estimators: false,
    size: None,
    roulette: Roulette::Albedo { from: 2 },
    patches: 600,
    export: None,
    next: "",
};

/// The suggestions at the end of the tour.
const NEXT: &str = "Next: fredholm chapter 1, series veach-ajar, diagnose YOURS.exr --against cornell";

/// The defaults of `render`.
pub const RENDER: Default = Default { name: "-render", worlds: &[World::Path], roulette: Roulette::LECTURE, ..SERIES };

/// `tour`: all three results, the terms by two estimators.
pub fn tour(args: &Tour) -> Result<Ending, Failure> {
    let tour = Default { name: "", both_estimators: true, size: Some([192, 192]), patches: 3600, next: NEXT, ..SERIES };
    solve(&args.into(), &tour)
}

/// `series`: each T^k E and the sum.
pub fn series(args: &Series) -> Result<Ending, Failure> {
    solve_or_shard(&args.into(), &SERIES)
}

/// `render`: the full path tracer, with the roulette of the lecture.
pub fn render(args: &Render) -> Result<Ending, Failure> {
    solve_or_shard(&args.into(), &RENDER)
}

/// `series`, `render` or `radiosity` from the films and rows of all parts.
pub fn merge(args: &Request, default: &Default, parts: &Merged) -> Result<Ending, Failure> {
    let mut session = Session::of(&args.shared, command_of(&parts.header.words), args.frame.seed)?;
    let (mut run, hash) = opened(args, default, &mut session)?;
    parts.check(&run, &keep::header(args, &run, &hash, &default.roulette, Part::WHOLE))?;
    session.make_folder(&format!("{}{}", run.description.name, default.name))?;
    run.solve_kept(session.progress(), Some(parts))?;
    finish(args, default, &mut session, &run)
}

/// Solves, or renders one part.
fn solve_or_shard(args: &Request, default: &Default) -> Result<Ending, Failure> {
    match args.sharding.shard {
        Some(shard) => shard::render(args, default, shard),
        None => solve(args, default),
    }
}

/// `radiosity`: the matrix.
pub fn radiosity(args: &Request, export: Option<Export>) -> Result<Ending, Failure> {
    solve_or_shard(args, &of_radiosity(export))
}

/// The defaults of `radiosity`.
pub fn of_radiosity(export: Option<Export>) -> Default {
    Default { name: "-radiosity", worlds: &[World::Radiosity], export, ..SERIES }
}

fn solve(args: &Request, default: &Default) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.frame.seed)?;
    let (mut run, hash) = opened(args, default, &mut session)?;
    let name = format!("{}{}", run.description.name, default.name);
    let resumes = |dir: &Path| args.keeping.resume && resume::is_of_this_run(dir, args.shared.out.is_some());
    session.make_folder_or(&name, &resumes)?;
    let header = keep::header(args, &run, &hash, &default.roulette, Part::WHOLE);
    let keeper = resume::keeper(args, &run, &session, header)?;
    session.preview(write::preview(&session.folder, session.caption(), args.pictures.exposure));
    run.solve_kept(session.progress(), Some(&keeper))?;
    if !session.stopped() {
        keeper.tidy();
    }
    let ending = finish(args, default, &mut session, &run);
    if session.stopped() && keeper.kept() {
        resume::tell(&session);
    }
    ending
}

/// Opens the scene and plans the run. Also returns the hash of the scene.
fn opened(args: &Request, default: &Default, session: &mut Session) -> Result<(Run, String), Failure> {
    let built_in_size = if args.frame.scene == "cornell" { default.size } else { None };
    let opened = session.open(&args.frame.scene, &args.shared.changes, args.frame.size.or(built_in_size))?;
    let hash = opened.hash.clone();
    let run = plan(args, default, opened)?;
    session.sized(run.size());
    Ok((run, hash))
}

/// Writes and prints what a run has found.
fn finish(args: &Request, default: &Default, session: &mut Session, run: &Run) -> Result<Ending, Failure> {
    if run.is_empty() {
        return Ok(session.nothing_to_save(""));
    }
    session.clear();
    let summary = write::all(run, &session.folder, default.export, args.pictures.exposure, || session.record())?;
    session.sign(&summary)?;
    session.warn(&notes::warnings(run));
    session.show(&summary, || text::people(run, &summary, session, default.next))?;
    Ok(session.ending(run.failed()))
}

/// The run that is asked for; refused if it cannot succeed.
fn plan(args: &Request, default: &Default, opened: Opened) -> Result<Run, Failure> {
    let Opened { description, scene, .. } = opened;
    let scene = scene.select_lights(args.pixels.lights);
    let patches = args.mesh.patches.unwrap_or(default.patches);
    let factors = preflight::factors(args.mesh.factors, args.mesh.rays, patches)?;
    let crop = args.pixels.crop.map(|corners| preflight::crop(corners, description.camera.size)).transpose()?;
    let settings = Settings { crop, ..args.settings(default.roulette.clone(), patches, factors) };
    let size = crop.map_or(description.camera.size, |crop| crop.size);
    let mut worlds = if args.worlds.is_empty() { default.worlds.to_vec() } else { args.worlds.clone() };
    let by_name = !args.worlds.is_empty() || default.worlds.len() == 1;
    preflight::suits_a_matrix(&description, &mut worlds, by_name)?;
    preflight::fits_in_a_matrix(&scene, factors, &mut worlds, by_name)?;
    let estimators = estimators(args, default, &worlds)?;
    can_be_exposed(args.pictures.exposure, settings.max_bounces, &worlds)?;
    for &estimator in &estimators {
        preflight::tree_can_be_walked(estimator, &settings, size)?;
    }
    if args.terms.strategies && estimators != [Estimator::Bidirectional] {
        return Err(usage("only the bidirectional estimator has strategies", "add --estimator bidirectional"));
    }
    match args.light.guide {
        Guiding::Bsdf => preflight::needs_no_guide(args.light.roulette.as_ref())?,
        Guiding::Radiosity => preflight::can_be_guided(&scene, &estimators, &settings, &worlds)?,
    }
    preflight::light_is_seen(&scene, &estimators, &settings, &worlds)?;
    // where paths start at the lights, every part touches the whole film
    let splats = estimators.iter().any(|e| e.begins() != Begins::AtEye);
    if splats && crop.is_some() {
        let what =
            format!("--crop saves nothing with {}: its paths from the lights add to the whole picture", estimators[0]);
        return Err(usage(&what, "leave --crop out, or use --estimator prefix"));
    }
    let parts = args.sharding.shard.filter(|_| !splats).map_or(1, |s| s.0.of);
    preflight::part_fits_in_memory(&settings, size, parts)?;
    if worlds.contains(&World::Radiosity) {
        preflight::rows_fit_in_memory(&scene, &settings, args.sharding.shard.map_or(1, |s| s.0.of))?;
    }
    preflight::light_is_lost(&scene, &settings, &worlds)?;
    if default.export == Some(Export::Matrix) && factors != Factors::Dense {
        let help = "use --factors dense (up to 20000 patches), or --export mesh";
        return Err(usage("stored rays have no matrix to write", help));
    }
    let asked = asked(args, worlds, estimators);
    Ok(Run::new(description, scene, settings, asked))
}

/// Refuses an exposure if no term is shown, or if its term is not among those that are kept.
fn can_be_exposed(exposure: Exposure, last: usize, worlds: &[World]) -> Result<(), Failure> {
    if exposure != Exposure::Auto && !worlds.iter().any(|w| *w != World::Path) {
        let what = "--exposure is for the pictures of the terms T^k E, but --worlds asks for no terms";
        return Err(usage(what, "leave --exposure out, or add terms to --worlds"));
    }
    match exposure {
        Exposure::Term(k) if k > last => {
            let what = format!("--exposure T{k} needs the term k = {k}, but the terms end at K = {last}");
            Err(usage(&what, &format!("choose T0 to T{last}, or raise --max-bounces")))
        }
        _ => Ok(()),
    }
}

/// The estimators of the terms, if these are asked for.
fn estimators(args: &Request, default: &Default, worlds: &[World]) -> Result<Vec<Estimator>, Failure> {
    match (worlds.contains(&World::Terms), args.estimator()) {
        (false, Some(_)) => Err(usage(
            "--estimator selects how the terms T^k E are estimated, but --worlds asks for no terms",
            "leave --estimator out, or add terms to --worlds",
        )),
        (false, None) => Ok(vec![]),
        _ if default.both_estimators => Ok(vec![Estimator::Single, Estimator::Prefix]),
        (_, asked) => Ok(vec![asked.unwrap_or(Estimator::Prefix)]),
    }
}

fn asked(args: &Request, worlds: Vec<World>, estimators: Vec<Estimator>) -> Asked {
    let Request { terms, light, mesh, .. } = args;
    Asked {
        worlds,
        estimators,
        optimal_roulette: light.roulette.as_ref().and_then(Schedule::aim),
        guide: (light.guide == Guiding::Radiosity).then(|| mesh.patches.map_or(guided::PATCHES, |n| n as usize)),
        strategies: terms.strategies,
        against_rays: (mesh.factors == Some(Form::Both)).then(|| preflight::rays(mesh.rays)),
        orders: mesh.orders,
        surface: if terms.pictures_only { vec![] } else { Asked::default().surface },
        bounces: !terms.pictures_only && args.pixels.crop.is_none(),
        moments: !terms.pictures_only && args.pixels.crop.is_none(),
    }
}
