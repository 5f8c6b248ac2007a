//! `fredholm zoo`: estimators that are wrong on purpose, each beside the right one.

use super::progress::Bar;
use super::{Ending, Failure, output, paragraphs, print, quiz};
use clap::Args;
use fredholm::engine::Settings;
use fredholm::engine::by_rays::Sampled;
use fredholm::report::contact_sheet::{self, Cell};
use fredholm::report::picture::auto_gain_beside_lamps;
use fredholm::report::plot::Point;
use fredholm::report::signature::{self, Signature};
use fredholm::report::table::significant;
use fredholm::report::typeset::{Caption, superscript};
use fredholm::report::{ReportError, exr, half_width_95, write_atomically};
use fredholm::scene::Scene;
use fredholm::terms::Functional;
use fredholm::zoo::signature::{Ratio, measured};
use fredholm::zoo::{self, Bug, Stage};
use fredholm::{engine::by_rays, estimator::Roulette};
use std::path::{Path, PathBuf};

/// K of the zoo.
const BOUNCES: usize = 6;

/// Arguments of `zoo`.
#[derive(Clone, Debug, Args)]
#[allow(clippy::struct_excessive_bools)] // switches of a command line
pub struct Zoo {
    /// A member; none: all of them
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
    /// List the members and render nothing
    #[arg(long)]
    pub list: bool,
    /// Predict, then reveal: which member made these numbers?
    #[arg(long, conflicts_with_all = ["name", "list"])]
    pub quiz: bool,
    /// Rounds of the quiz
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub rounds: u32,
    /// With NAME: another built-in scene than the one that shows it
    #[arg(long, value_name = "SCENE", requires = "name")]
    pub scene: Option<String>,
    /// Samples per pixel [default: 16; with NAME: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub spp: Option<u32>,
    /// Image size in pixels
    #[arg(long, value_name = "WxH", value_parser = super::args::size, default_value = "64x64")]
    pub size: [u32; 2],
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Output folder [default: zoo-out; with NAME: zoo-out/NAME]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]; results do not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
}

/// Lists, renders, or asks.
pub fn run(args: &Zoo) -> Result<Ending, Failure> {
    super::open::threads(args.threads)?;
    match &args.name {
        _ if args.quiz => quiz::run(args),
        None if args.list => {
            print(&list())?;
            Ok(Ending::Ok)
        }
        None => everyone(args),
        Some(name) => {
            let bug = zoo::find(name).ok_or_else(|| unknown(name))?;
            if args.list {
                print(&introduction(bug))?;
                return Ok(Ending::Ok);
            }
            one(args, bug)
        }
    }
}

fn unknown(name: &str) -> Failure {
    let near = zoo::all().into_iter().map(|b| (strsim(b.name, name), b.name)).min().map_or("", |n| n.1);
    Failure::Usage(format!("error: the zoo has no `{name}`\nhelp: perhaps `{near}`; `fredholm zoo --list` shows all"))
}

/// Letters to change, at least: Levenshtein's distance.
fn strsim(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = i;
        row[0] = i + 1;
        for j in 0..b.len() {
            let change = diagonal + usize::from(x != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// Who lives there.
fn list() -> String {
    let mut blocks = vec![format!("{} estimators, each wrong in one place", zoo::all().len())];
    for bug in zoo::all() {
        let blind = bug.blind.map_or("the whole image of every scene", |s| s.label);
        blocks.push(format!("{}\n  {}\n  seen in {}; not in {blind}", bug.name, bug.what, bug.exposed_by.label));
    }
    paragraphs(&blocks)
}

/// A member in words.
pub fn introduction(bug: &Bug) -> String {
    let blind = bug.blind.map_or("the whole image of every scene: its sum is right", |s| s.label);
    let mut lines = vec![format!("{}: {}", bug.name, bug.what)];
    let seen = format!("{}, from {} samples per pixel at {p}x{p}", bug.exposed_by.label, bug.spp, p = zoo::PIXELS);
    for (what, text) in [
        ("where", bug.place),
        ("gives", bug.expected),
        ("signature", bug.signature),
        ("seen in", &seen),
        ("not in", blind),
    ] {
        lines.extend(wrapped(&format!("  {what:10} "), text));
    }
    lines.join("\n")
}

/// Text in lines of at most 96 characters, the later ones indented.
fn wrapped(head: &str, text: &str) -> Vec<String> {
    let mut lines = vec![head.to_string()];
    for word in text.split(' ') {
        let last = lines.last().map_or(0, |l| l.chars().count());
        if last + word.chars().count() > 96 {
            lines.push(format!("  {:10} ", ""));
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(word);
            line.push(' ');
        }
    }
    lines.into_iter().map(|l| l.trim_end().to_string()).collect()
}

/// What a run of the zoo is made with.
pub fn settings(args: &Zoo, spp: u32) -> Settings {
    let roulette = Roulette::Albedo { from: 2 }.after(BOUNCES);
    Settings { spp: args.spp.unwrap_or(spp), seed: args.seed, max_bounces: BOUNCES, roulette, ..Settings::default() }
}

/// A folder that is absent, empty, or holds what this very command left.
fn folder(args: &Zoo, default: &str) -> Result<PathBuf, Failure> {
    let wanted = args.out.clone().unwrap_or_else(|| PathBuf::from(default));
    let marked = std::fs::read_to_string(wanted.join(MARK)).is_ok_and(|text| text.starts_with(&mark()));
    output::folder(Some(&wanted), "zoo", &output::canonical_command(), args.force || marked)
}

/// The numbers of a run, under a line that says whose folder this is.
const MARK: &str = "ratios.csv";

fn mark() -> String {
    format!("# {}\n", output::canonical_command())
}

/// Every member on the scene that shows it, and the control.
fn everyone(args: &Zoo) -> Result<Ending, Failure> {
    let folder = folder(args, "zoo-out")?;
    let (settings, bar) = (settings(args, 16), Bar::plain(args.quiet));
    let progress = bar.progress();
    let stopped = || progress.stopped();
    let mut rights: Vec<(Stage, Scene, Functional)> = vec![];
    let mut csv = format!("{}member,scene,k,ratio,std_error,predicted\n", mark());
    // first, so that the folder is known as this command's even if the rest never comes
    write_atomically(&folder.join(MARK), csv.as_bytes())?;
    let mut table = vec![format!("{:24} {:18} r₀         r₁         r₂         r₃         whole", "member", "scene")];
    for bug in zoo::all() {
        let stage = bug.exposed_by;
        if !rights.iter().any(|r| r.0 == stage) {
            let scene = Scene::new(&stage.load(args.size)?);
            let few = Settings { spp: 4 * settings.spp, ..settings.clone() };
            let right = by_rays::terms(&scene, by_rays::Estimator::Prefix, &few, progress);
            write(&place(&folder, stage, "correct")?, args.size, &right)?;
            rights.push((stage, scene, right.series.image().clone()));
        }
        let Some((_, scene, right)) = rights.iter().find(|r| r.0 == stage) else { continue };
        let settings = enough(bug, &settings);
        let wrong = zoo::render(bug, scene, &settings, progress);
        if stopped() {
            break;
        }
        write(&place(&folder, stage, bug.name)?, args.size, &wrong)?;
        let image = wrong.series.image();
        let ratios = measured(image, right);
        for (k, r) in ratios.iter().enumerate() {
            let predicted = (bug.ratio)(k).map_or(String::new(), |r| r.to_string());
            csv += &format!("{},{},{k},{},{},{predicted}\n", bug.name, stage.label, r.value, r.std_error);
        }
        let cells: Vec<String> = ratios[..4].iter().chain([&whole(image, right)]).map(brief).collect();
        let cells: Vec<String> = cells.iter().map(|c| format!("{c:10}")).collect();
        table.push(format!("{:24} {:18} {}", bug.name, stage.label, cells.join(" ").trim_end()));
    }
    bar.finish();
    write_atomically(&folder.join(MARK), csv.as_bytes())?;
    let note =
        "rₖ = Tₖ wrong / Tₖ right, mean of the image and the channels; the last digits' 95 % interval in brackets";
    let left =
        format!("{}: NAME.exr seen in cornell, SCENE/NAME.exr seen elsewhere, correct.exr, {MARK}", folder.display());
    print(&paragraphs(&[table.join("\n"), note.into(), left]))?;
    Ok(if stopped() { Ending::Interrupted } else { Ending::Ok })
}

/// A generator that starts again shows only where more samples are drawn than it has: four times as many.
fn enough(bug: &Bug, settings: &Settings) -> Settings {
    let least = if bug.name == "same-numbers" { 4 * zoo::bookkeeping::DIFFERENT } else { 1 };
    Settings { spp: settings.spp.max(least), ..settings.clone() }
}

/// The whole against the whole, or the sum where paths are cut at K.
pub fn whole(wrong: &Functional, right: &Functional) -> Ratio {
    Ratio::of(&wrong.total, if wrong.tail.is_none() { &right.sum } else { &right.total })
}

/// `2.001(12)`: a value with the half width of its 95 % interval in units of the last digit.
pub fn brief(r: &Ratio) -> String {
    if r.value.is_nan() {
        return "–".into();
    }
    let half = half_width_95(r.std_error, r.replicates);
    if !(half > 0.0 && half.is_finite()) || half < 1e-4 * r.value.abs() {
        return significant(r.value, 4);
    }
    // two digits of the error
    let decimals = (1 - half.log10().floor() as i32).clamp(0, 6) as usize;
    format!("{:.decimals$}({:.0})", r.value, half * 10f64.powi(decimals as i32))
}

/// `DIR/NAME.exr` on cornell, `DIR/SCENE/NAME.exr` elsewhere.
fn place(folder: &Path, stage: Stage, name: &str) -> Result<PathBuf, Failure> {
    let folder = if stage == Stage::CORNELL { folder.to_path_buf() } else { folder.join(stage.label) };
    std::fs::create_dir_all(&folder).map_err(|e| ReportError::new(&folder, e, "choose another folder with -o"))?;
    Ok(folder.join(format!("{name}.exr")))
}

/// What a stranger's renderer would leave: the image, its terms, their standard errors; nothing that tells what is wrong.
fn write(path: &Path, [w, h]: [u32; 2], result: &Sampled) -> Result<(), Failure> {
    let names: Vec<[String; 2]> = (0..result.terms.len()).map(|k| ["", "_se"].map(|e| format!("T{k:02}{e}"))).collect();
    let layer = |name, pixels| exr::Layer { name, pixels };
    let mut layers = vec![layer("", &result.total.mean), layer("se", &result.total.std_error)];
    for (image, [mean, error]) in result.terms.iter().zip(&names) {
        layers.extend([layer(mean, &image.mean), layer(error, &image.std_error)]);
    }
    let attributes =
        [("spp", result.spp.to_string()), ("replicates", result.series.image().total.replicates.to_string())];
    exr::write(path, w as usize, h as usize, &layers, &attributes)?;
    Ok(())
}

/// One member beside the right estimator, in the scene that shows it and in the one that cannot.
fn one(args: &Zoo, bug: &'static Bug) -> Result<Ending, Failure> {
    let settings = settings(args, 256);
    let stage = match &args.scene {
        None => bug.exposed_by,
        Some(name) => {
            let built_in = fredholm::scene::builtin::find(name);
            let scene = built_in.ok_or_else(|| {
                Failure::Usage(format!("error: `{name}` is no built-in scene\nhelp: `fredholm info` lists them"))
            })?;
            Stage { label: scene.name, scene: scene.name, set: &[] }
        }
    };
    let folder = folder(args, &format!("zoo-out/{}", bug.name))?;
    let bar = Bar::plain(args.quiet);
    let progress = bar.progress();
    let pair = |stage: Stage| -> Result<(Sampled, Sampled), Failure> {
        let scene = Scene::new(&stage.load(args.size)?);
        let right = zoo::render_right(bug, &scene, &settings, progress);
        Ok((zoo::render(bug, &scene, &settings, progress), right))
    };
    let (wrong, right) = pair(stage)?;
    let blind = bug.blind.map(|stage| pair(stage).map(|p| (stage, p))).transpose()?;
    bar.finish();

    let judgement = zoo::judge::judge(&wrong, &right);
    let theory = stage == bug.exposed_by;
    let mut blocks = vec![introduction(bug), format!("{}\n{}", stage.label, rows(bug, &wrong, &right, theory))];
    blocks.push(format!("p = {:.1e} that the right renderer gives this: judged by {}", judgement.p, judgement.what));
    if let Some((stage, (wrong, right))) = &blind {
        blocks.push(format!("{}, which is blind to it\n{}", stage.label, rows(bug, wrong, right, false)));
    }

    let caption = Caption { command: output::canonical_command(), seed: args.seed, scene: stage.label.into() };
    write(&folder.join(format!("{}.exr", bug.name)), args.size, &wrong)?;
    write(&folder.join("correct.exr"), args.size, &right)?;
    pictures(bug, args.size, &wrong, &right, &caption)?.picture.write(&folder.join(format!("{}.png", bug.name)))?;
    let ratios = measured(wrong.series.image(), right.series.image());
    signature::draw(&plot(&format!("{}: {}", bug.name, bug.what), bug, &ratios, theory), &caption)?
        .write(&folder, &format!("{}-ratios", bug.name))?;
    let mut csv = format!("{}k,ratio,std_error\n", mark());
    ratios.iter().enumerate().for_each(|(k, r)| csv += &format!("{k},{},{}\n", r.value, r.std_error));
    write_atomically(&folder.join(MARK), csv.as_bytes())?;
    blocks.push(format!(
        "{}: {n}.exr, correct.exr, {n}.png, {n}-ratios.svg and .png, {MARK}",
        folder.display(),
        n = bug.name
    ));
    print(&paragraphs(&blocks))?;
    Ok(if progress.stopped() { Ending::Interrupted } else { Ending::Ok })
}

/// A row per term: right, wrong, r_k measured and predicted.
fn rows(bug: &Bug, wrong: &Sampled, right: &Sampled, theory: bool) -> String {
    let (w, r) = (wrong.series.image(), right.series.image());
    let mean = |e: &fredholm::terms::Estimate| significant(e.mean.element_sum() / 3.0, 4);
    let line = |name: &str, w: &fredholm::terms::Estimate, r: &fredholm::terms::Estimate, predicted: Option<f64>| {
        let predicted = predicted.map_or(String::new(), |r| significant(r, 4));
        let line =
            format!("{name:6} {:>10}  {:>10}  {:>12}  {predicted:>10}", mean(r), mean(w), brief(&Ratio::of(w, r)));
        line.trim_end().to_string()
    };
    let mut lines = vec![format!("{:6} {:>10}  {:>10}  {:>12}  {:>10}", "k", "right", "wrong", "rₖ", "predicted")];
    for (k, (a, b)) in w.terms.iter().zip(&r.terms).enumerate() {
        lines.push(line(&k.to_string(), a, b, if theory { (bug.ratio)(k) } else { None }));
    }
    let last = w.terms.len().saturating_sub(1);
    if !w.tail.is_none() {
        lines.push(line(&format!("k > {last}"), &w.tail, &r.tail, None));
    }
    lines.push(line("whole", &w.total, &r.total, None));
    let bad = wrong.series.cost.non_finite;
    if bad > 0 {
        lines.push(format!("{bad} samples are no number"));
    }
    lines.join("\n")
}

/// r_k as a figure.
pub fn plot(title: &str, bug: &Bug, ratios: &[Ratio], theory: bool) -> Signature {
    let point = |(k, r): (usize, &Ratio)| Point {
        x: k as f64,
        value: r.value,
        std_error: r.std_error,
        replicates: r.replicates,
    };
    let predicted = (0..ratios.len()).filter_map(|k| Some(Point::exact(k as f64, (bug.ratio)(k)?)));
    Signature {
        title: title.into(),
        measured: ratios.iter().enumerate().map(point).collect(),
        predicted: if theory { predicted.collect() } else { vec![] },
    }
}

/// Right, wrong and how they differ, for the whole and for k = 1 to 3: each row at one exposure, the difference signed.
fn pictures(
    bug: &Bug,
    [w, h]: [u32; 2],
    wrong: &Sampled,
    right: &Sampled,
    caption: &Caption,
) -> Result<contact_sheet::Sheet, ReportError> {
    let black = vec![[0.0; 3]; (w * h) as usize];
    let emitted = right.terms.first().map_or(&black, |t| &t.mean);
    let mut shown = vec![("whole".to_string(), &right.total.mean, &wrong.total.mean)];
    for k in 1..4.min(right.terms.len()) {
        shown.push((format!("T{}E", superscript(k)), &right.terms[k].mean, &wrong.terms[k].mean));
    }
    // what is too bright in red, what is too dark in blue
    let signed = |a: &[[f32; 3]], b: &[[f32; 3]]| -> Vec<[f32; 3]> {
        let mean = |p: &[f32; 3]| (p[0] + p[1] + p[2]) / 3.0;
        let differ = |(a, b): (&[f32; 3], &[f32; 3])| {
            let d = mean(b) - mean(a);
            if d.is_nan() { [f32::NAN; 3] } else { [d.max(0.0), 0.0, (-d).max(0.0)] }
        };
        a.iter().zip(b).map(differ).collect()
    };
    let differences: Vec<Vec<[f32; 3]>> = shown.iter().map(|(_, a, b)| signed(a, b)).collect();
    let mut cells = vec![];
    for ((name, a, b), difference) in shown.iter().zip(&differences) {
        let gain = Some(auto_gain_beside_lamps(a, emitted));
        cells.push(Cell { label: format!("{name}, right"), pixels: a, gain });
        cells.push(Cell { label: format!("{name}, wrong"), pixels: b, gain });
        cells.push(Cell { label: "difference: + red, − blue".into(), pixels: difference, gain });
    }
    contact_sheet::grid_of(3, &format!("{}: {}", bug.name, bug.what), w as usize, h as usize, &cells, caption)
}
