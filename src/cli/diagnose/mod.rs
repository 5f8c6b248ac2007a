//! `fredholm diagnose RENDER… --against SCENE|RUN`: names the mistake in another renderer's pictures.

mod against;
mod args;
mod evidence;
mod found;
mod grouping;
mod suspects;
mod text;

use super::base::{Ending, Failure, print, usage};
use super::session::Session;
use against::{Right, Source};
pub use args::{Diagnose, HELP};
use found::Diagnosed;
use fredholm::diagnosis::candidates::Members;
use fredholm::diagnosis::{self, Case, Conclusion, Effort};
use fredholm::engine::MOST_BOUNCES;
use fredholm::engine::known::coplanar;
use fredholm::progress::Progress;
use fredholm::report::figures::diagnosis as figure;
use fredholm::report::image::foreign::{self, File};
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use std::collections::BTreeMap;
use std::path::Path;
use suspects::{Suspect, size_mismatch, suspects};

/// Diagnoses every picture, writes the figures and prints the text.
pub fn run(args: &Diagnose) -> Result<Ending, Failure> {
    let Some(against) = args.against.as_deref().filter(|_| !args.how) else {
        print(&how())?;
        return Ok(Ending::Ok);
    };
    let mut session = Session::new(&args.shared, args.seed)?;
    let (suspects, how) = suspects(args)?;
    let scaled = args.scale.as_ref().map(|(s, file)| Ok::<_, Failure>((*s, foreign::read(file)?))).transpose()?;
    let source = against::source(args, against)?;
    for s in &suspects {
        source.suits(&s.name, s.file.pictures.size)?;
    }
    if let (Some((_, large)), Some(first)) = (&scaled, suspects.first())
        && large.pictures.size != first.file.pictures.size
    {
        return Err(size_mismatch("--scale", large.pictures.size, first.file.pictures.size));
    }
    session.about(&source.name, &source.hash);
    let inputs = args.renders.iter().chain(args.scale.iter().map(|(_, file)| file));
    inputs.for_each(|input| session.reads(input));
    session.reads(against);
    session.make_folder(&format!("{}-diagnose", source.name))?;
    let judged = judge(args, &suspects, scaled.as_ref(), &source, session.progress())?;
    session.clear();
    let Judged { found, label, rare_paths } = judged;
    let page = text::Text { how, label: &label, rare_paths: rare_paths.as_deref() };
    let files = write(&session, &found)?;
    session.show(&text::json(&found), || page.people(&session, &found, &files))?;
    Ok(session.ending(found.iter().any(|f| f.diagnosis.verdict != Conclusion::Correct)))
}

/// How to write the pictures. The book shows parts of the same text, between marks.
fn how() -> String {
    include_str!("how.txt").lines().filter(|l| !l.starts_with("ANCHOR")).collect::<Vec<_>>().join("\n")
}

/// The diagnoses of all pictures, and the reference.
struct Judged {
    found: Vec<Diagnosed>,
    label: String,
    rare_paths: Option<String>,
}

/// Pictures with their positions on the command line, by size and K.
type Groups<'a> = BTreeMap<([usize; 2], usize), Vec<(usize, &'a Suspect)>>;

/// Diagnoses every picture. Pictures of one size and one K share a reference and the simulated mistakes.
fn judge(
    args: &Diagnose,
    suspects: &[Suspect],
    scaled: Option<&(f64, File)>,
    source: &Source,
    progress: Progress<'_>,
) -> Result<Judged, Failure> {
    let mut groups: Groups<'_> = BTreeMap::new();
    for (i, s) in suspects.iter().enumerate() {
        groups.entry((s.file.pictures.size, last_term(args, &s.file))).or_default().push((i, s));
    }
    let mut found: BTreeMap<usize, Diagnosed> = BTreeMap::new();
    let (mut rare_paths, mut label) = (None, String::new());
    for ((size, max_bounces), members) in &groups {
        let right = source.right(args, *size, *max_bounces, progress)?;
        rare_paths = rare_paths.or(right.rare_paths.clone());
        label.clone_from(&right.label);
        if scaled.is_some() && right.scene.as_ref().is_some_and(|s| s.lights.any_delta()) {
            let what = "the light of a point or a direction changes with the scale of the scene";
            return Err(usage(what, "leave --scale out"));
        }
        if let Some(why) = right.scene.as_ref().and_then(coplanar::undecided) {
            return Err(Failure::Input(format!(
                "error: {why}, so no picture of this scene is the right one\nhelp: move one of them by a thousandth of the scene"
            )));
        }
        let deepest =
            if members.iter().any(|(_, s)| s.file.pictures.last_term().is_some()) { usize::MAX } else { SIMULATED };
        let candidates =
            right.scene.as_ref().map(|s| Members::new(s, (*max_bounces).min(deepest), args.seed, progress));
        for (i, suspect) in members {
            if progress.stopped() {
                break;
            }
            let progress = progress.named(&suspect.name);
            found.insert(*i, one(args, suspect, scaled, &right, candidates.as_ref(), progress));
        }
    }
    Ok(Judged { found: found.into_values().collect(), label, rare_paths })
}

/// K of the reference if a file has no terms. The tail after K cannot be taken apart, so it should be dim.
const DEEP: usize = 20;
/// Largest K of the simulated mistakes, if a file has no terms.
const SIMULATED: usize = 8;

/// K of the reference: the last term of the picture, else `--max-bounces`, else the file's attribute, else [`DEEP`].
fn last_term(args: &Diagnose, file: &File) -> usize {
    let told =
        || file.attribute("max_bounces").and_then(|k| k.parse().ok()).filter(|&k| k <= usize::from(MOST_BOUNCES));
    let asked = args.max_bounces.map(usize::from);
    file.pictures.last_term().or(asked).or_else(told).unwrap_or(DEEP)
}

/// Diagnoses one picture.
fn one(
    args: &Diagnose,
    suspect: &Suspect,
    scaled: Option<&(f64, File)>,
    right: &Right,
    candidates: Option<&Members>,
    progress: Progress<'_>,
) -> Diagnosed {
    let file = &suspect.file;
    let usual = if file.pictures.code.for_display() { 0.0 } else { 1.0 };
    let gain = args.gain.unwrap_or(usual);
    let case = Case {
        suspect: &file.pictures,
        factor: right.factor,
        reference: &right.pictures,
        reference_spp: right.spp,
        seen: &right.seen,
        by_samples: &suspect.by_samples,
        scaled: scaled.map(|(s, f)| (*s, &f.pictures)),
        candidates: candidates.map(|c| c as &dyn diagnosis::Simulate),
        alpha: args.alpha,
        gain: (gain > 0.0).then_some(gain),
        effort: Effort { paths: args.paths, ..Effort::default() },
    };
    let diagnosis = diagnosis::diagnose(&case, progress);
    let told = file.attribute("spp").and_then(|n| n.parse().ok());
    Diagnosed {
        name: suspect.name.clone(),
        terms: file.pictures.last_term().is_some(),
        code: file.pictures.code,
        ignored: file.ignored.clone(),
        told,
        factor: right.factor,
        diagnosis,
    }
}

/// Writes the figures, `diagnosis.json` and `summary.json`; returns the names of the files.
fn write(session: &Session, found: &[Diagnosed]) -> Result<Vec<String>, Failure> {
    let caption = session.caption();
    let mut files = vec!["summary.json".to_owned(), "diagnosis.json".to_owned()];
    let mut used = std::collections::BTreeSet::new();
    for (i, f) in found.iter().enumerate() {
        let stem = if found.len() == 1 {
            "diagnosis".to_owned()
        } else {
            let name =
                Path::new(&f.name).file_stem().map_or_else(|| i.to_string(), |s| s.to_string_lossy().into_owned());
            let name = if used.insert(name.clone()) { name } else { format!("{name}-{i}") };
            format!("diagnosis-{name}")
        };
        figure::draw(&f.diagnosis, &text::title(f), &caption)?.write(&session.folder, &stem)?;
        files.extend([format!("{stem}.png"), format!("{stem}.svg")]);
    }
    files.sort();
    let json = serde_json::to_string_pretty(&text::json(found))? + "\n";
    write_atomically(&session.folder.join("diagnosis.json"), json.as_bytes())?;
    session.sign(&Summary { files: files.clone(), ..session.record() })?;
    Ok(files)
}
