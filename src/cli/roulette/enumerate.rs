//! `fredholm roulette --enumerate`: all the ways the roulette can fall, for some thousand paths of the scene.

use super::{Args, Asked};
use crate::cli::base::{Ending, Failure, names, usage};
use crate::cli::session::Session;
use fredholm::estimator::Roulette;
use fredholm::math::{Key, Purpose, Rng};
use fredholm::operator::{SceneTransport, Sensor};
use fredholm::report::text::csv::Csv;
use fredholm::report::text::grid::Grid;
use fredholm::report::text::number::{count, significant};
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::scene::Scene;
use fredholm::study::enumeration::{End, Errors, Stop, ends, follow};

/// Paths that are enumerated.
const PATHS: u32 = 4096;
/// Vertices after which a path without roulette is cut. The equality holds for cut paths, too.
const LONGEST: usize = 64;
/// Largest relative error that single precision explains: 64 factors of 6·10⁻⁸, with room.
const ROUNDING: f64 = 1e-4;
/// Ways that are shown one by one.
const SHOWN: usize = 8;

/// Enumerates and prints.
pub(super) fn run(args: &Args, asked: &[Asked], scene: &Scene, session: &mut Session) -> Result<Ending, Failure> {
    let fixed = |(name, schedule): &'_ Asked| schedule.given().map(|s| (name.clone(), s));
    let schedules: Vec<(String, Roulette)> = asked.iter().filter_map(fixed).collect();
    if let Some((name, _)) = asked.iter().find(|(_, s)| s.given().is_none()) {
        let what = format!("`{name}` is found from a recording, so it cannot be enumerated");
        return Err(usage(&what, "name schedules with numbers: --schedules lecture,constant:0.5"));
    }
    let last = usize::from(args.max_bounces);
    let paths = paths(args, scene);
    let errors = |schedule: &Roulette| {
        let mut errors = Errors::default();
        paths.iter().for_each(|path| errors.add(path, schedule, last));
        errors
    };
    let found: Vec<(&str, Errors)> = schedules.iter().map(|(name, s)| (name.as_str(), errors(s))).collect();
    let ends_paths = |s: &&(String, Roulette)| s.1 != Roulette::Never;
    let (name, schedule) = schedules.iter().find(ends_paths).unwrap_or(&schedules[0]);
    let example = paths.iter().max_by_key(|path| interest(path));
    let ways = example.map_or(vec![], |path| ends(path, schedule, last).0);
    let without = example.and_then(|path| ends(path, &Roulette::Never, last).0.pop());

    write_atomically(&session.folder.join("enumeration.csv"), csv(&ways).as_bytes())?;
    let files = names(["enumeration.csv", "summary.json"]);
    let record = Summary { files, max_bounces: last, ..session.record() };
    session.sign(&record)?;
    let failed = found.iter().any(|(_, e)| e.probability > ROUNDING || e.term > ROUNDING);
    session.show(&record, || {
        session.text(
            &answer(&found, failed),
            &[table(&found), one(name, &ways, without.as_ref().map_or(0.0, scored))],
            &[],
            &record.files,
        )
    })?;
    Ok(session.ending(failed))
}

/// Paths without roulette, spread over the image.
fn paths(args: &Args, scene: &Scene) -> Vec<Vec<Stop>> {
    let t = SceneTransport { scene, sampling: args.sampling };
    let key = Key::new(args.seed, "enumeration");
    let pixels = scene.camera.size[0] * scene.camera.size[1];
    let path = |i: u32| {
        let (pixel, sample) = ((u64::from(i) * u64::from(pixels) / u64::from(PATHS)) as u32, i);
        let start = scene.camera.start(&t, pixel, &mut Rng::at(key, pixel, sample, 0, Purpose::Start))?;
        Some(follow(&t, start, args.technique, (key, pixel, sample), LONGEST))
    };
    (0..PATHS).filter_map(path).collect()
}

/// How much a path shows: the number of terms to which it adds light, up to those that are shown.
fn interest(path: &[Stop]) -> usize {
    let (without, _) = ends(path, &Roulette::Never, SHOWN);
    without.last().map_or(0, |e| e.scored.iter().filter(|x| x.element_sum() > 0.0).count())
}

/// The mean of the channels of everything that a way has scored.
fn scored(way: &End) -> f64 {
    way.scored.iter().map(|x| x.element_sum() / 3.0).sum()
}

fn answer(found: &[(&str, Errors)], failed: bool) -> String {
    let paths = found.iter().map(|f| f.1.paths).max().unwrap_or(0);
    wrapped(&match failed {
        false => format!(
            "Roulette changes no term of any of {paths} paths: over all the ways it can fall, the mean of each term is the term \
             without roulette, to rounding."
        ),
        true => "A mean over all the ways the roulette can fall is not the term without roulette.".to_owned(),
    })
}

fn table(found: &[(&str, Errors)]) -> String {
    let head = ["schedule", "ways per path", "|Σ P − 1|", "|Σ P S/X − 1|"];
    let mut grid = Grid::new("The largest errors over all paths and terms.", head);
    for (name, e) in found {
        let ways = e.ends as f64 / e.paths.max(1) as f64;
        grid.push([
            name.to_string(),
            significant(ways, 3),
            format!("{:.0e}", e.probability),
            format!("{:.0e}", e.term),
        ]);
    }
    grid.to_string()
}

/// The ways of one path.
fn one(name: &str, ways: &[End], without: f64) -> String {
    let number = |x: f64| significant(x, 5);
    let product = |w: &End| w.probability * scored(w);
    let sentence = format!(
        "One path under `{name}`: it ends after vertex n with probability P and has then added S (mean of the channels, all terms)."
    );
    let mut grid = Grid::new(wrapped(&sentence), ["n", "P", "S", "P·S"]);
    for (n, w) in ways.iter().take(SHOWN).enumerate() {
        grid.push([n.to_string(), number(w.probability), number(scored(w)), number(product(w))]);
    }
    let sum = |f: fn(&End) -> f64, all: &[End]| number(all.iter().map(f).sum());
    if let Some(rest) = ways.get(SHOWN..).filter(|rest| !rest.is_empty()) {
        let label = format!("{} more", count(rest.len() as u64));
        grid.push([label, sum(|w| w.probability, rest), String::new(), sum(|w| w.probability * scored(w), rest)]);
    }
    grid.push(["sum".into(), sum(|w| w.probability, ways), String::new(), sum(|w| w.probability * scored(w), ways)]);
    format!("{grid}Without roulette the path adds {}.\n", number(without))
}

/// Every way of the example, one line each.
fn csv(ways: &[End]) -> String {
    let mut csv = Csv::new("n,probability,scored,product");
    for (n, w) in ways.iter().enumerate() {
        csv.put(n).numbers([w.probability, scored(w), w.probability * scored(w)]).end();
    }
    csv.text()
}
