//! `fredholm diagnose RENDER… --against SCENE|RUN`: what is wrong with somebody else's pictures.

mod against;
mod read;
mod text;

use super::progress::Bar;
use super::{Ending, Failure, output};
use against::Right;
use clap::Args;
use fredholm::diagnosis::candidates::Members;
use fredholm::diagnosis::picture::{Code, Pictures, Slot};
use fredholm::diagnosis::{self, Case, Diagnosis, Effort, Verdict, evidence};
use fredholm::engine::known::coplanar;
use fredholm::progress::Progress;
use fredholm::report::{figures::diagnosis as figure, image::typeset::Caption, text::summary};
use read::{File, Grouping};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Arguments of `diagnose`.
#[derive(Clone, Debug, Args)]
pub struct Diagnose {
    /// Pictures of one scene: EXR with layers, EXR, PNG, JPEG or HDR
    ///
    /// Files named T00.exr, T01.exr, … are taken for the terms of one render, files named r_16.exr,
    /// r_64.exr, … for one render at growing samples per pixel, all others each for itself (--as).
    #[arg(required = true, value_name = "RENDER", verbatim_doc_comment)]
    pub renders: Vec<PathBuf>,
    /// What they should show: a built-in scene, .toml, .obj, or the output folder of a run
    #[arg(long, value_name = "SCENE|DIR")]
    pub against: String,
    /// How several files belong together: auto, separate, bounces, spp
    #[arg(long = "as", value_enum, default_value = "auto", value_name = "HOW", hide_possible_values = true)]
    pub grouping: Grouping,
    /// The same render of the scene made so many times larger: --scale 10=FILE
    #[arg(long, value_name = "S=FILE", value_parser = scale)]
    pub scale: Option<(f64, PathBuf)>,
    /// Divide the pictures by this first; 0: exposure unknown [default: 1; 0 for 8-bit pictures]
    #[arg(long, value_name = "G", value_parser = gain)]
    pub gain: Option<f64>,
    /// K of the reference where the file has no terms [default: as the file says, or 8]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=64))]
    pub max_bounces: Option<u16>,
    /// Samples per pixel of the reference [default: 8 million paths in all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 24))]
    pub spp: Option<u32>,
    /// Paths that all candidates together may take in one stage
    #[arg(long, default_value_t = Effort::default().paths, value_name = "N")]
    pub paths: u64,
    /// Chance that a correct renderer is called wrong
    #[arg(long, default_value_t = 1e-3, value_name = "P", value_parser = super::args::probability)]
    pub alpha: f64,
    /// Seed of the reference and of the candidates
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Scene, output, threads.
    #[command(flatten)]
    pub shared: crate::cli::open::Shared,
    /// Also the candidates that were struck off
    #[arg(short, long)]
    pub verbose: bool,
}

fn scale(s: &str) -> Result<(f64, PathBuf), String> {
    let wrong = || format!("`{s}` is not SCALE=FILE, such as 10=large.exr");
    let (factor, file) = s.split_once('=').ok_or_else(wrong)?;
    let factor = factor.parse().ok().filter(|f: &f64| *f > 0.0 && f.is_finite()).ok_or_else(wrong)?;
    Ok((factor, file.into()))
}

fn gain(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite()).ok_or(format!("`{s}` is not a number from 0 on"))
}

/// One suspect: a file, or several that belong together.
struct Suspect {
    name: String,
    file: File,
    by_samples: Vec<(u32, Pictures)>,
}

/// Suspects with their places, by size and K.
type Groups<'a> = BTreeMap<([usize; 2], usize), Vec<(usize, &'a Suspect)>>;

/// What came out for one suspect.
pub struct Diagnosed {
    /// File, or files.
    pub name: String,
    /// Its pictures hold terms.
    pub terms: bool,
    /// Exposure unknown.
    pub any_gain: bool,
    /// Layers that were not understood.
    pub ignored: Vec<String>,
    /// Samples per pixel as the file tells them.
    pub told: Option<f64>,
    /// Factor by which pictures were averaged down.
    pub factor: usize,
    /// The rest.
    pub diagnosis: Diagnosis,
}

/// Diagnoses every suspect.
pub fn run(args: &Diagnose) -> Result<Ending, Failure> {
    super::open::threads(args.shared.threads)?;
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
    let command = output::canonical_command();
    let folder = output::folder(args.shared.out.as_deref(), "diagnose", &command, args.shared.force)?;
    let bar = Bar::plain(args.shared.quiet);
    let progress = bar.progress();

    // suspects of one size and one K share a reference and the pictures of the candidates
    let mut groups: Groups = BTreeMap::new();
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
            return Err(Failure::Usage(
                "error: the light of a point or a direction changes with the scale of the scene\nhelp: leave --scale out".into(),
            ));
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
            found.insert(
                *i,
                one(args, suspect, scaled.as_ref(), &right, candidates.as_ref(), progress.named(&suspect.name)),
            );
        }
    }
    bar.finish();
    let stopped = progress.stopped();
    let found: Vec<Diagnosed> = found.into_values().collect();
    let page =
        text::Text { args, how, label: &label, rare_paths: rare_paths.as_deref(), command: &command, folder: &folder };
    let files = write(&page, &found, &source)?;
    if args.shared.json {
        super::print(&serde_json::to_string_pretty(&text::json(&found))?)?;
    } else {
        super::print(&page.people(&found, &files))?;
    }
    let wrong = found.iter().any(|f| f.diagnosis.verdict == Verdict::Wrong);
    Ok(match (stopped, wrong) {
        (true, _) => Ending::Interrupted,
        (_, true) => Ending::Failed,
        _ => Ending::Ok,
    })
}

fn size_mismatch(name: &str, [a, b]: [usize; 2], [w, h]: [usize; 2]) -> Failure {
    Failure::Input(format!(
        "error: the pictures have different sizes, {a}×{b} and {w}×{h}\n  --> {name}\nhelp: give pictures of one size and one camera"
    ))
}

/// K of the reference: that of the suspect.
fn last_term(args: &Diagnose, file: &File) -> usize {
    let told = || file.attribute("max_bounces").and_then(|k| k.parse().ok());
    let asked = args.max_bounces.map(usize::from);
    file.pictures.last_term().or(asked).or_else(told).unwrap_or(8)
}

/// The files, put together.
fn suspects(args: &Diagnose) -> Result<(Vec<Suspect>, Grouping), Failure> {
    let (how, numbers) = read::grouping(args.grouping, &args.renders)?;
    let files = args.renders.iter().map(|p| read::file(p)).collect::<Result<Vec<File>, Failure>>()?;
    let shown = |p: &Path| p.display().to_string();
    if how != Grouping::Separate
        && let Some((i, file)) = files.iter().enumerate().find(|(_, f)| f.pictures.size != files[0].pictures.size)
    {
        return Err(size_mismatch(&shown(&args.renders[i]), file.pictures.size, files[0].pictures.size));
    }
    let all = match how {
        Grouping::Bounces => {
            let mut layers = vec![];
            let mut first: Option<File> = None;
            for (mut file, k) in files.into_iter().zip(numbers) {
                let mut layer = file.pictures.layers.swap_remove(0);
                layer.slot = Slot::Term(k as usize);
                layers.push(layer);
                first.get_or_insert(file);
            }
            let mut file = first.ok_or_else(|| Failure::Usage("error: no file\nhelp: name one".into()))?;
            file.pictures.layers = layers;
            vec![Suspect { name: format!("{} …", shown(&args.renders[0])), file, by_samples: vec![] }]
        }
        Grouping::Spp => {
            let mut by: Vec<(u32, File)> = numbers.into_iter().zip(files).collect();
            by.sort_by_key(|b| b.0);
            let by_samples = by.iter().map(|(n, f)| (*n, f.pictures.clone())).collect();
            let (most, file) = by.pop().ok_or_else(|| Failure::Usage("error: no file\nhelp: name one".into()))?;
            vec![Suspect { name: format!("{} … {most} spp", shown(&args.renders[0])), file, by_samples }]
        }
        _ => {
            let one = |(p, file): (&PathBuf, File)| Suspect { name: shown(p), file, by_samples: vec![] };
            args.renders.iter().zip(files).map(one).collect()
        }
    };
    Ok((all, how))
}

/// One suspect, brought to the size of the reference.
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
        counts: evidence::count(&file.pictures, &right.pictures, file.clipped),
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

/// A pixel of the small picture is masked if any of its own or of its neighbours' pixels is: noise decides which of them
/// are clipped, and must not decide which count.
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

/// Writes the figures, `diagnosis.json` and `summary.json`; the names of the files.
fn write(page: &text::Text, found: &[Diagnosed], source: &against::Source) -> Result<Vec<String>, Failure> {
    let caption = Caption { command: page.command.to_owned(), seed: page.args.seed, scene: source.name.clone() };
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
        figure::draw(&f.diagnosis, &title, &caption)?.write(page.folder, &stem)?;
        files.extend([format!("{stem}.png"), format!("{stem}.svg")]);
    }
    files.sort();
    let json = serde_json::to_string_pretty(&text::json(found))? + "\n";
    fredholm::report::write_atomically(&page.folder.join("diagnosis.json"), json.as_bytes())?;
    let old = output::left_by_the_last_run(page.folder);
    let record = summary::Summary {
        command: page.command.to_owned(),
        scene: source.name.clone(),
        scene_hash: source.hash.clone(),
        seed: page.args.seed,
        files: files.clone(),
        ..summary::Summary::default()
    };
    summary::write(&page.folder.join("summary.json"), &record)?;
    output::remove_stale(page.folder, &old, &files);
    Ok(files)
}
