//! `fredholm compare A B`: compares two results, with a verdict for every term and a map of z = difference/standard error.

use super::base::{Ending, Failure};
use super::options::{HOW, Manner, OUTPUT, WHAT, fraction, probability};
use super::session::Session;
use super::{notes, verdict, write};
use clap::Args;
use fredholm::report::ReportError;
use fredholm::report::image::exr;
use fredholm::report::image::typeset::Caption;
use fredholm::report::image::zmap;
use fredholm::report::text::prose::{wrapped, wrapped_after};
use fredholm::report::text::summary::{self, Summary, VerdictRecord};
use fredholm::report::text::table;
use fredholm::stats::{Comparison, Criterion, Outcome, compare, discretisation};
use fredholm::terms::{Functional, Series, World};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Below `compare --help`.
pub const HELP: &str = "Examples:
  fredholm series cornell --seed 1 -o a
  fredholm series cornell --seed 2 -o b
  fredholm compare a b

Agrees: the difference is proved smaller than δ = 2 % of the term + 1e-4 of the whole image. Differs: the difference is proved not \
to be zero. Inconclusive: more samples are needed; the text says how many. The exit code is 0 only if the results agree.";

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct Compare {
    /// A result: an output folder or its summary.json
    #[arg(help_heading = WHAT, value_hint = clap::ValueHint::AnyPath)]
    pub a: PathBuf,
    /// Another result
    #[arg(help_heading = WHAT, value_hint = clap::ValueHint::AnyPath)]
    pub b: PathBuf,
    /// δ: this fraction of the term
    #[arg(long, default_value_t = 0.02, value_name = "X", value_parser = fraction, help_heading = HOW)]
    pub of_term: f64,
    /// δ: plus this fraction of the whole image
    #[arg(long, default_value_t = 1e-4, value_name = "X", value_parser = fraction, help_heading = HOW)]
    pub of_total: f64,
    /// Probability of a false difference
    ///
    /// The probability that equal results are found to differ anywhere.
    #[arg(long, default_value_t = 1e-3, value_name = "P", value_parser = probability, help_heading = HOW)]
    pub alpha: f64,
    /// Output folder [default: fredholm-out/compare]
    ///
    /// The map of z = difference/standard error is written there.
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Print JSON instead of tables
    #[arg(long, help_heading = OUTPUT)]
    pub json: bool,
}

/// Compares two results.
pub fn run(args: &Compare) -> Result<Ending, Failure> {
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    if (a.1.width, a.1.height) != (b.1.width, b.1.height) {
        return Err(Failure::Input(format!(
            "error: the images have different sizes, {}×{} and {}×{}\nhelp: render both with the same --size",
            a.1.width, a.1.height, b.1.width, b.1.height
        )));
    }
    let Some((x, y)) = pair(&a.1, &b.1) else {
        return Err(Failure::Input(
            "error: one of the results holds no world (terms, path or radiosity)\nhelp: render it again".into(),
        ));
    };
    // a term that one of the results does not see in full is not compared
    let gap = x.gap(y);
    let whole = gap.as_ref().map_or(Cow::Borrowed(x), |(from, _)| Cow::Owned(x.before(*from)));
    let criterion = criterion(args);
    let comparison = compare(&whole, y, &criterion, &allowance((&a.1, &whole), (&b.1, y)));
    let verdicts = summary::verdicts("", &comparison);

    let pictures = (images(&a)?, images(&b)?);
    if let (Some(a), Some(b)) = &pictures
        && (a.from, a.of) != (b.from, b.of)
    {
        let place = |i: &exr::Image| format!("({}, {}) of {}×{}", i.from[0], i.from[1], i.of[0], i.of[1]);
        return Err(Failure::Input(format!(
            "error: these are different parts of pictures: they begin at pixel {} and {}\nhelp: render both with the same --size and --crop",
            place(a),
            place(b)
        )));
    }
    let manner = Manner { out: args.out.clone(), force: args.force, json: args.json, ..Manner::default() };
    let mut session = Session::new(manner, 0)?;
    session.about(&format!("{} | {}", a.1.scene, b.1.scene), &a.1.scene_hash);
    session.sized([a.1.width, a.1.height].map(|side| side as u32));
    [&args.a, &args.b].into_iter().for_each(|input| session.reads(input));
    session.make_folder("compare")?;
    let map = z_map(&pictures, (x.world, y.world), (&a.1, &session))?;
    let files = map.iter().map(|_| "z.png".to_string()).chain(["summary.json".to_string()]).collect();
    let record = Summary { verdicts: verdicts.clone(), files, ..session.record() };
    session.sign(&record)?;
    session.show(&comparison, || {
        let mut answer = verdict::sentence("The two results", &comparison, &criterion);
        if let Some((from, why)) = &gap {
            answer += &format!("\nT{from} and everything longer is not compared: {why}.");
        }
        let sides = [('A', &args.a, &*whole, &a.1), ('B', &args.b, y, &b.1)].map(|(n, path, s, r)| line(n, path, s, r));
        let blocks = [sides.join("\n"), rows(&comparison, &verdicts), remarks([&whole, y], [&a.1, &b.1], map)];
        session.text(&wrapped(&answer), &blocks, &[], &record.files)
    })?;
    let agrees = comparison.outcome == Outcome::Agrees && gap.is_none();
    Ok(if agrees { Ending::Ok } else { Ending::Failed })
}

fn criterion(args: &Compare) -> Criterion {
    Criterion { of_term: args.of_term, of_total: args.of_total, alpha: args.alpha, ..Criterion::default() }
}

/// The error of the mesh, where one side is a radiosity matrix and the other is not; empty otherwise.
fn allowance((a, x): (&Summary, &Series), (b, y): (&Summary, &Series)) -> Vec<Functional> {
    match (x.world, y.world) {
        (World::Radiosity, World::Radiosity) => vec![],
        (World::Radiosity, _) => coarse(a).map_or(vec![], |c| discretisation(x, c)),
        (_, World::Radiosity) => coarse(b).map_or(vec![], |c| discretisation(y, c)),
        _ => vec![],
    }
}

/// One line about a side: its folder, its world, scene, seed and samples.
fn line(name: char, path: &Path, world: &Series, s: &Summary) -> String {
    let (path, world) = (path.display(), &world.label);
    let text =
        format!("{name} = {path}: {world}; scene {} ({}), seed {}, {} spp", s.scene, s.scene_hash, s.seed, s.spp);
    wrapped_after(&text, "    ")
}

/// Rows that are printed; all of them are in `summary.json`.
const SHOWN: usize = 10;

/// The verdicts as a table with a sentence above it; of many, first those that do not agree.
fn rows(comparison: &Comparison, verdicts: &[VerdictRecord]) -> String {
    if verdicts.is_empty() {
        return String::new();
    }
    let above = format!(
        "A − B for each term, in the functional and channel closest to failing: the difference, where it lies at 1 − α for all \
         {} comparisons together, and the smallest difference that would have been found.",
        comparison.family
    );
    let mut chosen: Vec<usize> = (0..verdicts.len()).collect();
    chosen.sort_by_key(|&i| verdicts[i].outcome == Outcome::Agrees);
    chosen.truncate(SHOWN);
    chosen.sort_unstable();
    let shown: Vec<VerdictRecord> = chosen.iter().map(|&i| verdicts[i].clone()).collect();
    let left = verdicts.len() - shown.len();
    let below = if left > 0 { format!("{left} more terms in summary.json") } else { String::new() };
    format!("{}\n{}{below}", wrapped(&above), table::verdicts(&shown))
}

/// Doubts about the results, and the share of pixels of the z map beyond 2 and 3.
fn remarks(results: [&Series; 2], summaries: [&Summary; 2], map: Option<(f64, f64)>) -> String {
    let mut lines: Vec<String> = vec![];
    if summaries[0].command == summaries[1].command {
        lines.push("warning: both were made by the same command with the same seed: equal bits prove nothing".into());
    }
    lines.extend(notes::doubts(results.into_iter()).iter().map(|doubt| format!("warning: {doubt}")));
    if let Some((two, three)) = map {
        lines.push(if two.is_finite() {
            let (two, three) = (100.0 * two, 100.0 * three);
            format!(
                "z map: {two:.1} % of the pixels lie beyond 2 standard errors (4.6 % if equal and normal), {three:.2} % beyond \
                 3 (0.27 %)."
            )
        } else {
            "z map: no pixel has a known error.".into()
        });
    }
    wrapped(&lines.join("\n"))
}

/// The folder of a result, and its summary.
type Result2 = (PathBuf, Summary);

fn read(path: &Path) -> Result<Result2, Failure> {
    let (folder, file) = if path.is_dir() {
        (path.to_path_buf(), path.join("summary.json"))
    } else {
        (path.parent().unwrap_or(Path::new(".")).to_path_buf(), path.to_path_buf())
    };
    Ok((folder, summary::read(&file)?))
}

/// The pair that is compared: the same world of both results if they share one, terms before path before radiosity; else the
/// first of these worlds that each result has.
fn pair<'a>(a: &'a Summary, b: &'a Summary) -> Option<(&'a Series, &'a Series)> {
    let of = |s: &'a Summary, w: World| s.series.iter().find(|s| s.world == w);
    let order = [World::Terms, World::Path, World::Radiosity];
    let same = order.iter().find_map(|&w| Some((of(a, w)?, of(b, w)?)));
    same.or_else(|| Some((order.iter().find_map(|&w| of(a, w))?, order.iter().find_map(|&w| of(b, w))?)))
}

/// The radiosity on the coarse mesh, which a summary lists after the one on the fine mesh.
fn coarse(s: &Summary) -> Option<&Series> {
    s.series.iter().filter(|s| s.world == World::Radiosity).nth(1)
}

/// The images of a run, if it left them.
fn images((folder, record): &Result2) -> Result<Option<exr::Image>, Failure> {
    let file = folder.join("terms.exr");
    if !file.exists() {
        return Ok(None);
    }
    let image = exr::read_crop(&file)?;
    if (image.width, image.height) == (record.width, record.height) {
        return Ok(Some(image));
    }
    let size = |w: usize, h: usize| format!("{w}×{h} pixels");
    let (found, told) = (size(image.width, image.height), size(record.width, record.height));
    let what = format!("the images have {found}, and summary.json says {told}");
    Err(ReportError::new(&file, what, "repeat the run: its files do not belong together").into())
}

/// Writes the z map of the whole images, if both runs left `terms.exr`; returns the fractions of pixels beyond 2 and 3.
fn z_map(
    images: &(Option<exr::Image>, Option<exr::Image>),
    (x, y): (World, World),
    (record, session): (&Summary, &Session),
) -> Result<Option<(f64, f64)>, Failure> {
    let (Some(image_a), Some(image_b)) = images else { return Ok(None) };
    let whole = |image: &exr::Image, world: World| {
        let names: &[&str] = match world {
            World::Terms => &["Tall", "Tsum"],
            World::Path => &["path"],
            World::Radiosity => &["Rfull"],
        };
        let name = names.iter().find(|name| image.layer(name).is_some())?;
        Some((image.layer(name)?.to_vec(), image.layer(&format!("{name}_se"))?.to_vec()))
    };
    let (Some((m, s)), Some((n, t))) = (whole(image_a, x), whole(image_b, y)) else { return Ok(None) };
    let z = write::z_values((&m, &s), (&n, &t));
    let caption = Caption { command: session.command().into(), seed: record.seed, scene: record.scene.clone() };
    let map = zmap::draw("z of the whole image: A − B", image_a.width, image_a.height, &z, &caption)?;
    map.picture.write(&session.folder.join("z.png"))?;
    Ok(Some((map.beyond_2, map.beyond_3)))
}
