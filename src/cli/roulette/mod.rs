//! `fredholm roulette [SCENE]`: predicts schedules from the cross moments of one recording, verifies them by rendering, and
//! finds the best one for the whole image and for indirect light.

mod args;
mod enumerate;
mod measure;

use super::base::{Ending, Failure, names, usage};
use super::open::Opened;
use super::options::values;
use super::preflight;
use super::session::Session;
use super::suggest::hint;
pub use args::{Args, HELP};
use fredholm::engine::Settings;
use fredholm::engine::by_matrix;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator;
use fredholm::report::figures::roulette::{self as rows, Row, Shares, Shown};
use fredholm::report::text::prose::{listed, wrapped};
use fredholm::report::text::summary::{self, Summary};
use fredholm::report::text::table;
use fredholm::report::write_atomically;
use fredholm::scene::load;
use fredholm::scene::{Description, Scene};
use fredholm::stats::schedule::share;
use fredholm::stats::{Noise, Part};
use fredholm::study::roulette::{self, Aim, Optimal, Radii, Relative, Schedule};
use fredholm::terms::World;
use fredholm::terms::cross_moments::Recorded;
use measure::{measure, rivals};

/// Schedules that are compared unless others are given.
const USUAL: &str = "none,lecture,constant:0.1@0,constant:0.2@0,constant:0.3@0,constant:0.5@0,constant:0.3@2,\
                     table:0,0.1,0.2,0.3,albedo";

/// A schedule as it was typed.
type Asked = (String, Schedule);

/// Predicts, verifies, optimises.
pub fn run(args: &Args) -> Result<Ending, Failure> {
    let asked = schedules(args)?;
    let mut session = Session::new(&args.shared, args.seed)?;
    let opened = scene(args, &mut session)?;
    let (description, scene) = (opened.description, opened.scene.select_lights(args.lights));
    let settings = Settings {
        spp: args.spp,
        seed: args.seed,
        max_bounces: args.max_bounces.into(),
        technique: args.technique,
        sampling: args.sampling,
        ..Settings::default()
    };
    preflight::light_is_seen(&scene, &[Estimator::Prefix], &settings, &[])?;
    preflight::light_is_lost(&scene, &settings, &[World::Terms])?;
    session.make_folder(&format!("{}-roulette", description.name))?;
    if args.enumerate {
        return enumerate::run(args, &asked, &scene, &mut session);
    }

    // the recording, and what follows from it
    let Some(recorded) = roulette::pilot(&scene, &settings, args.spp, session.progress()) else {
        return Ok(session.nothing_to_save(""));
    };
    let best: Vec<Optimal> = Aim::ALL.into_iter().filter_map(|aim| roulette::best(&recorded, &scene, aim)).collect();
    let given = |(name, asked): Asked| {
        let found = || best.iter().find(|b| asked.aim() == Some(b.aim)).map(|b| b.roulette.clone());
        Some((name, asked.given().or_else(found)?))
    };
    let predicted = asked.into_iter().filter_map(given);
    let predicted = predicted.map(|(name, s)| predict(name, s, &recorded, &scene, settings.max_bounces));
    let (mut all, schedules): (Vec<Row>, Vec<estimator::Roulette>) = predicted.unzip();
    let shown = measure(args, (&scene, &settings), &mut all, &schedules, session.progress());

    let beyond = roulette::beyond(&scene);
    let doubts = doubts(&all, &description, &scene);
    let doubtful: Vec<&str> = doubts.iter().map(|d| d.0.as_str()).collect();
    let mut record = Summary {
        spp: args.spp.into(),
        max_bounces: settings.max_bounces,
        cross_moments: Some(summary::cross_moments(&recorded, beyond)),
        files: write(&session, args.spp, &all, &shown, &doubtful)?,
        ..session.record()
    };
    record.bounds.max_albedo = scene.max_albedo().as_dvec3();
    session.sign(&record)?;
    session.warn(&warnings(&doubts, &recorded));
    // a variance that cannot be measured contradicts nothing
    let told = || all.iter().filter(|r| doubts.iter().all(|d| d.0 != r.name));
    let critical = critical(all.len(), recorded.replicates());
    let contradicted = told().flat_map(|r| [r.z(), r.indirect_z()]).flatten().any(|z| z.abs() > critical);
    session.show(&record, || {
        let verified = args.verify.then(|| rows::verified(told(), critical)).flatten().unwrap_or_default();
        let mut details = vec![
            head(args, &record, &recorded, beyond),
            rows::table(&all),
            optimal_details(&all, &best),
            warnings(&doubts, &recorded).iter().map(|w| format!("warning: {w}\n")).collect(),
        ];
        let (answer, mut tables) = if args.optimise {
            rows::optima(&all, &shares(&recorded), &args.aims())
        } else {
            (rows::answer(&all, &args.aims()), vec![rows::small_table(&all, &doubtful)])
        };
        let named = |d: &&(String, Radii)| !args.optimise || rivals(args).contains(&d.0.as_str());
        let doubts: Vec<&(String, Radii)> = doubts.iter().filter(named).collect();
        let warning = short_warning(&doubts, &recorded, args.verify, (settings.max_bounces, beyond));
        // with --optimise a prediction that holds is a detail
        let quiet = args.optimise && !contradicted;
        details.insert(1, if quiet { verified.clone() } else { String::new() });
        let below = [if quiet { "" } else { &verified }, &warning].map(str::trim_end).join("\n");
        match tables.last_mut().filter(|last| quiet && !last.is_empty()) {
            Some(last) => *last += &below,
            None => tables.push(below.trim_start().into()),
        }
        session.text(&answer, &tables, &details, &record.files)
    })?;
    Ok(session.ending(contradicted))
}

/// Writes the numbers, the figure, and the pictures of the schedules that were rendered. Returns the names of all files.
fn write(session: &Session, spp: u32, all: &[Row], shown: &[Shown], doubtful: &[&str]) -> Result<Vec<String>, Failure> {
    let (folder, caption, record) = (&session.folder, session.caption(), session.record());
    write_atomically(&folder.join("roulette.csv"), rows::csv(all).as_bytes())?;
    let title = format!("Roulette schedules of {}: predicted from paths without roulette", record.scene);
    rows::draw(all, &title, &caption)?.write(folder, "roulette")?;
    let mut files = names(["roulette.csv", "roulette.png", "roulette.svg", "summary.json"]);
    if !shown.is_empty() {
        let size = [record.width, record.height];
        rows::pictures(all, shown, spp, size, doubtful, &caption)?.write(&folder.join("pictures.png"))?;
        files.insert(0, "pictures.png".into());
    }
    Ok(files)
}

/// The settings, for --verbose.
fn head(args: &Args, record: &Summary, recorded: &Recorded, beyond: f64) -> String {
    let Summary { command, seed, spp, width, height, max_bounces, .. } = record;
    format!(
        "{command}\nseed {seed}, {spp} spp, {width}×{height} pixels, technique {}; {} paths recorded in {:.1} s\n\
         from vertex K = {max_bounces} on every predicted schedule continues with q = {beyond:.2}",
        args.technique,
        table::count(recorded.paths),
        recorded.seconds
    )
}

/// Shares of the variance without roulette.
fn shares(recorded: &Recorded) -> Shares {
    let terms = (0..recorded.all.slots / 2).map(|k| share(recorded, Part::Term(k))).collect();
    Shares { terms, indirect: share(recorded, Part::INDIRECT) }
}

/// |z| beyond which a prediction is contradicted. The family level 10⁻³ is shared by two quantities of every schedule.
fn critical(schedules: usize, replicates: u64) -> f64 {
    fredholm::stats::critical(1e-3 / (2 * schedules) as f64, replicates as f64 - 1.0)
}

fn schedules(args: &Args) -> Result<Vec<Asked>, Failure> {
    let list = args.schedules.as_deref().unwrap_or(USUAL);
    let mut all: Vec<Asked> = vec![];
    for name in values(list) {
        let schedule: Schedule = name.parse().map_err(|why: String| usage(&why, &hint("--roulette", &name, &[])))?;
        all.push((name, schedule));
    }
    if args.optimise {
        for rival in rivals(args) {
            if let (false, Ok(schedule)) = (all.iter().any(|(name, _)| name == rival), rival.parse()) {
                all.push((rival.into(), schedule));
            }
        }
    }
    Ok(all)
}

/// The scene, with an image of at most 64 pixels a side unless --size is given.
fn scene(args: &Args, session: &mut Session) -> Result<Opened, Failure> {
    const SIDE: u32 = 64;
    let size = match args.size {
        Some(size) => Some(size),
        None => {
            let as_it_is = load::scene(&args.scene, &args.shared.changes.options(None))?;
            let [w, h] = as_it_is.description.camera.size;
            (w.max(h) > SIDE).then(|| [w, h].map(|side| (side * SIDE / w.max(h)).max(1)))
        }
    };
    session.open(&args.scene, &args.shared.changes, size)
}

/// A row with its prediction, and the schedule as it is rendered: as a table up to vertex K if q does not depend on the path.
fn predict(
    name: String,
    schedule: estimator::Roulette,
    recorded: &Recorded,
    scene: &Scene,
    last: usize,
) -> (Row, estimator::Roulette) {
    let schedule = schedule.then(last, roulette::beyond(scene)).unwrap_or(schedule);
    let row = Row {
        name,
        schedule: schedule.to_string(),
        q: (0..last).filter_map(|v| schedule.fixed(v)).collect(),
        predicted: Noise::predicted(recorded, &schedule),
        relative: Relative::predicted(recorded, scene, &schedule),
        replicates: recorded.replicates(),
        ..Row::default()
    };
    (row, schedule)
}

/// The optimal schedules as tables that can be typed, their predicted gain, and for whole image the gain per second.
fn optimal_details(all: &[Row], best: &[Optimal]) -> String {
    let mut lines = vec![];
    for b in best {
        let name = b.aim.schedule_name();
        let Some(own) = all.iter().find(|r| r.name == name) else { continue };
        let gain = format!("{:.3} ± {:.3}", b.gain.value, b.gain.std_error);
        lines.push(format!("{name}: {}", b.roulette));
        lines.push(format!(
            "  predicted: {gain} times the efficiency of the lecture's\n  schedule for {}",
            rows::quantity(b.aim)
        ));
        let variance = |r: &Row| {
            let m = r.measured.as_ref()?;
            Some(if b.aim == Aim::Whole { m.all.value } else { m.indirect.value } * r.seconds?)
        };
        for rival in ["lecture", "albedo"] {
            let other = all.iter().find(|r| r.name == rival).and_then(variance);
            if let (Some(own), Some(other)) = (variance(own), other) {
                lines.push(format!("  measured: {:.3} times that of {rival} per second", other / own));
            }
        }
    }
    lines.join("\n")
}

/// The schedules whose variance, or whose measured variance, may be infinite if they continue for ever as they were typed.
fn doubts(all: &[Row], description: &Description, scene: &Scene) -> Vec<(String, Radii)> {
    let coarse = by_matrix::coarse(description, scene);
    let doubt = |row: &Row| {
        let q = roulette::constant(&row.name.parse().ok()?)?;
        let radii = Radii::new(coarse.as_ref().map(|m| &m.radiosity), scene, q);
        radii.warning().map(|_| (row.name.clone(), radii))
    };
    all.iter().filter_map(doubt).collect()
}

/// One line for each schedule whose error bars cannot be trusted.
fn warnings(doubts: &[(String, Radii)], recorded: &Recorded) -> Vec<String> {
    let mut out: Vec<String> = doubts.iter().filter_map(|(name, r)| Some(format!("{name} {}", r.warning()?))).collect();
    if !out.is_empty() {
        out.push("the predictions are finite: all schedules continue with the q above from vertex K on".into());
    }
    if recorded.non_finite > 0 {
        out.push(format!("{} samples were not finite; they are left in the sums", recorded.non_finite));
    }
    out
}

/// The same in one paragraph: with `measured` also the schedules whose measured variance has no error. `beyond` is K, and q
/// from vertex K on.
fn short_warning(
    doubts: &[&(String, Radii)],
    recorded: &Recorded,
    measured: bool,
    (last, beyond): (usize, f64),
) -> String {
    let of = |infinite: bool| {
        let chosen = doubts.iter().filter(|d| (d.1.second >= 1.0) == infinite);
        chosen.map(|d| format!("`{}`", d.0)).collect::<Vec<_>>()
    };
    let (infinite, without_error) = (of(true), if measured { of(false) } else { vec![] });
    let may = if doubts.iter().any(|d| d.1.bounds) { "may be" } else { "is" };
    let mut sentences = vec![];
    if !infinite.is_empty() {
        sentences.push(format!(
            "warning: the variance of {} {may} infinite; the predictions are finite because they continue with q = {beyond:.2} \
             from vertex {last} on.",
            listed(&infinite)
        ));
    }
    if !without_error.is_empty() {
        sentences.push(format!(
            "warning: the error of the measured variance of {} {may} infinite, so their z mean nothing.",
            listed(&without_error)
        ));
    }
    if recorded.non_finite > 0 {
        sentences.push(format!("warning: {} samples were not finite; they are left in the sums.", recorded.non_finite));
    }
    sentences.iter().map(|s| wrapped(s)).collect::<Vec<_>>().join("\n")
}
