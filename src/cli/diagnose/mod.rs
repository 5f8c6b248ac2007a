//! `fredholm diagnose RENDER… --against SCENE|RUN`: names the mistake in another renderer's pictures.

mod against;
mod args;
mod evidence;
mod found;
mod read;
mod suspects;
mod text;

use super::base::{Ending, Failure, usage};
use super::session::Session;
use against::{Right, Source};
pub use args::{Diagnose, HELP};
use found::Diagnosed;
use fredholm::diagnosis::candidates::Members;
use fredholm::diagnosis::encoding::is_encoded;
use fredholm::diagnosis::picture::{Code, Layer, Pictures};
use fredholm::diagnosis::{self, Case, Conclusion, Effort, evidence as counting};
use fredholm::engine::known::coplanar;
use fredholm::progress::Progress;
use fredholm::report::figures::diagnosis as figure;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use read::File;
use std::collections::BTreeMap;
use std::path::Path;
use suspects::{Suspect, size_mismatch, suspects};

/// Diagnoses every picture, writes the figures and prints the text.
pub fn run(args: &Diagnose) -> Result<Ending, Failure> {
    let mut session = Session::new(&args.shared, args.seed)?;
    let (suspects, how) = suspects(args)?;
    let scaled = args.scale.as_ref().map(|(s, file)| Ok::<_, Failure>((*s, read::file(file)?))).transpose()?;
    let source = against::source(args)?;
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
    session.reads(&args.against);
    session.make_folder(&format!("{}-diagnose", source.name))?;
    let judged = judge(args, &suspects, scaled.as_ref(), &source, session.progress())?;
    session.clear();
    let Judged { found, label, rare_paths } = judged;
    let page = text::Text { how, label: &label, rare_paths: rare_paths.as_deref() };
    let files = write(&session, &found)?;
    session.show(&text::json(&found), || page.people(&session, &found, &files))?;
    Ok(session.ending(found.iter().any(|f| f.diagnosis.verdict == Conclusion::Wrong)))
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
        let candidates = right.scene.as_ref().map(|s| Members::new(s, *max_bounces, args.seed, progress));
        for (i, suspect) in members {
            if progress.stopped() {
                break;
            }
            is_linear(suspect, &right)?;
            let progress = progress.named(&suspect.name);
            found.insert(*i, one(args, suspect, scaled, &right, candidates.as_ref(), progress));
        }
    }
    Ok(Judged { found: found.into_values().collect(), label, rare_paths })
}

/// Refuses floats that are encoded for a display: the commonest mistake of all is one of the file, not of the light.
fn is_linear(suspect: &Suspect, right: &Right) -> Result<(), Failure> {
    let file = &suspect.file;
    if file.pictures.code == Code::EightBit {
        return Ok(());
    }
    let small = file.pictures.shrunk(right.factor);
    let twin =
        |l: &Layer| right.pictures.layers.iter().find(|r| r.slot == l.slot).map(|r| (l.mean.clone(), r.mean.clone()));
    match small.layers.iter().rev().find_map(twin) {
        Some((picture, right)) if is_encoded(&picture, &right) => Err(Failure::Input(format!(
            "error: the values of the picture are encoded for a display (sRGB, or a gamma of about 2.2)\n  --> {}\n\
             help: write linear radiance into float files, without a view transform; or give the picture as PNG",
            suspect.name
        ))),
        _ => Ok(()),
    }
}

/// K of the reference: the last term of the picture, else `--max-bounces`, else the file's attribute, else 8.
fn last_term(args: &Diagnose, file: &File) -> usize {
    let told = || file.attribute("max_bounces").and_then(|k| k.parse().ok());
    let asked = args.max_bounces.map(usize::from);
    file.pictures.last_term().or(asked).or_else(told).unwrap_or(8)
}

/// Diagnoses one picture, averaged down to the size of the reference.
fn one(
    args: &Diagnose,
    suspect: &Suspect,
    scaled: Option<&(f64, File)>,
    right: &Right,
    candidates: Option<&Members>,
    progress: Progress<'_>,
) -> Diagnosed {
    let file = &suspect.file;
    let gain = args.gain.unwrap_or(if file.pictures.code == Code::EightBit { 0.0 } else { 1.0 });
    let any_gain = gain == 0.0;
    let prepare = |p: &Pictures| {
        let small = p.shrunk(right.factor);
        if any_gain { small } else { small.times(1.0 / gain) }
    };
    let pictures = prepare(&file.pictures);
    let by_samples: Vec<(u32, Pictures)> = suspect.by_samples.iter().map(|(n, p)| (*n, prepare(p))).collect();
    let large = scaled.map(|(s, f)| (*s, prepare(&f.pictures)));
    let mask = file.mask.as_ref().map_or(vec![], |m| shrink_mask(m, file.pictures.size[0], right.factor));
    let case = Case {
        suspect: &pictures,
        reference: &right.pictures,
        reference_spp: right.spp,
        seen: &right.seen,
        counts: counting::count(&file.pictures, &right.pictures, file.clipped),
        mask: &mask,
        by_samples: &by_samples,
        scaled: large.as_ref().map(|(s, p)| (*s, p)),
        candidates: candidates.map(|c| c as &dyn diagnosis::Simulate),
        alpha: args.alpha,
        effort: Effort { paths: args.paths, any_gain, ..Effort::default() },
    };
    let diagnosis = diagnosis::diagnose(&case, progress);
    let terms = pictures.last_term().is_some();
    let told = file.attribute("spp").and_then(|n| n.parse().ok());
    let (name, ignored) = (suspect.name.clone(), file.ignored.clone());
    Diagnosed { name, terms, any_gain, ignored, told, factor: right.factor, diagnosis }
}

/// Shrinks a mask. A pixel of the small picture is masked if one of its own or of its neighbours' large pixels is masked: noise
/// decides which of them are clipped, and must not decide which are compared.
fn shrink_mask(mask: &[bool], width: usize, factor: usize) -> Vec<bool> {
    let height = mask.len() / width;
    let (w, h) = (width / factor, height / factor);
    let at = |i: usize| {
        let (x, y) = (i % w, i / w);
        let columns = x.saturating_sub(1) * factor..((x + 2) * factor).min(width);
        (y.saturating_sub(1) * factor..((y + 2) * factor).min(height))
            .any(|y| columns.clone().any(|x| mask[y * width + x]))
    };
    (0..w * h).map(at).collect()
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
        let title = format!("{}: {}", text::short(&f.name), text::headline(&f.diagnosis));
        figure::draw(&f.diagnosis, &title, &caption)?.write(&session.folder, &stem)?;
        files.extend([format!("{stem}.png"), format!("{stem}.svg")]);
    }
    files.sort();
    let json = serde_json::to_string_pretty(&text::json(found))? + "\n";
    write_atomically(&session.folder.join("diagnosis.json"), json.as_bytes())?;
    session.sign(&Summary { files: files.clone(), ..session.record() })?;
    Ok(files)
}
