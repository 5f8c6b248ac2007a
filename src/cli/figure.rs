//! `fredholm figure ID`: makes a figure by its name. Each is a recipe here, or another command that writes it.

use super::base::{Ending, Failure, names, paragraphs, print, usage};
use super::options::{Changes, Manner, OUTPUT, WHAT, size};
use super::progress::stop_flag;
use super::session::Session;
use super::{preflight, sweep};
use clap::{Args, Parser};
use fredholm::engine::Settings;
use fredholm::math::names::suggest;
use fredholm::report::figures::stages as report;
use fredholm::report::text::prose::wrapped;
use fredholm::report::text::summary::Summary;
use fredholm::report::write_atomically;
use fredholm::study::stages::{Grown, KAJIYA, NOISE, Recipe, Stage, reference_seed, render_stages};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Below `figure --help`.
pub const HELP: &str = "Examples:
  fredholm figure --list
  fredholm figure kajiya-series
  fredholm figure noise-paths -o slides/noise --seed 3
  fredholm figure --all -o figures

Each figure is a folder with pictures, the numbers as CSV, and summary.json. Every figure carries the command that makes it. An \
image of few paths looks darker than one of many only because the screen cuts off values above white; the mean and the mean shown \
are both printed.";

/// Arguments of `figure`.
#[derive(Clone, Debug, Args)]
pub struct Figure {
    /// Name of the figure; --list prints the names
    #[arg(value_name = "NAME", conflicts_with_all = ["list", "all"], help_heading = WHAT)]
    pub id: Option<String>,
    /// List the figures
    #[arg(long, help_heading = WHAT)]
    pub list: bool,
    /// Make every figure, each in its own folder
    #[arg(long, conflicts_with = "list", help_heading = WHAT)]
    pub all: bool,
    /// Image size in pixels [default: the figure's]
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = WHAT)]
    pub size: Option<[u32; 2]>,
    /// Seed: the same seed gives the same bits
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = WHAT)]
    pub seed: u64,
    /// Output folder [default: fredholm-out/NAME]
    ///
    /// With --all, the folder for all figures.
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Print no progress
    #[arg(short, long, help_heading = OUTPUT)]
    pub quiet: bool,
}

/// The way in which a figure is made.
enum Kind {
    /// One image at growing numbers of paths per pixel.
    Stages(&'static Recipe),
    /// The figure of another command: id, title, and the words of that command.
    Command(&'static str, &'static str, &'static [&'static str]),
}

const FIGURES: &[Kind] = &[
    Kind::Stages(&KAJIYA),
    Kind::Stages(&NOISE),
    Kind::Command(
        "variance-cornell",
        "Variance against samples per pixel: single, prefix, path tracer",
        &[
            "sweep",
            "cornell",
            "--over",
            "spp",
            "--estimator",
            "single,prefix,path",
            "--size",
            "64x64",
            "--max-bounces",
            "6",
        ],
    ),
    Kind::Command(
        "sobol-cornell",
        "Independent and Sobol points: where their slopes differ",
        &[
            "sweep",
            "cornell",
            "--over",
            "spp",
            "--points",
            "independent,sobol",
            "--size",
            "64x64",
            "--max-bounces",
            "4",
        ],
    ),
    Kind::Command(
        "drifting-eigenvalues",
        "Eigenvalues on finer meshes: the scene's settle, the mesh's drift",
        &[
            "sweep",
            "cornell",
            "--over",
            "patches",
            "--values",
            "129,516,2064",
            "--eigenvalues",
            "8",
            "--spp",
            "16",
            "--size",
            "32x32",
            "--max-bounces",
            "2",
        ],
    ),
    Kind::Command(
        "split-cornell",
        "Where samples go: equal split, optimal split, one path for all terms",
        &["sweep", "cornell", "--over", "split", "--size", "64x64", "--max-bounces", "6"],
    ),
];

impl Kind {
    fn id(&self) -> &'static str {
        match self {
            Self::Stages(recipe) => recipe.id,
            Self::Command(id, ..) => id,
        }
    }
    fn title(&self) -> &'static str {
        match self {
            Self::Stages(recipe) => recipe.title,
            Self::Command(_, title, _) => title,
        }
    }
}

/// Lists the figures, or makes one or all.
pub fn run(args: &Figure) -> Result<Ending, Failure> {
    if args.list {
        let widest = FIGURES.iter().map(|f| f.id().len()).max().unwrap_or(0);
        let lines: Vec<String> = FIGURES.iter().map(|f| format!("{:widest$}  {}", f.id(), f.title())).collect();
        let answer = format!(
            "{} figures can be made: `fredholm figure ID` makes one, `fredholm figure --all` makes them all.",
            FIGURES.len()
        );
        return print(&paragraphs(&[wrapped(&answer), lines.join("\n")])).map(|()| Ending::Ok);
    }
    if args.id.is_none() && !args.all {
        return Err(usage("which figure?", "`fredholm figure --list` names them, --all makes them all"));
    }
    let chosen: Vec<&Kind> = FIGURES.iter().filter(|f| args.all || args.id.as_deref() == Some(f.id())).collect();
    if chosen.is_empty() {
        let ids: Vec<_> = FIGURES.iter().map(Kind::id).collect();
        let id = args.id.as_deref().unwrap_or_default();
        return Err(usage(&format!("no figure is called `{id}`"), &suggest(id, "figures", &ids)));
    }
    let mut ending = Ending::Ok;
    for figure in chosen {
        if stop_flag().load(Ordering::Relaxed) {
            return Ok(Ending::Interrupted);
        }
        let folder = args.out.as_ref().map(|dir| if args.all { dir.join(figure.id()) } else { dir.clone() });
        let one = match figure {
            Kind::Stages(recipe) => stages(args, recipe, folder.as_deref()),
            Kind::Command(id, _, words) => command(args, id, words, folder),
        }?;
        ending = if one == Ending::Ok { ending } else { one };
    }
    Ok(ending)
}

/// Runs another command for its figure.
fn command(args: &Figure, id: &str, words: &[&str], folder: Option<PathBuf>) -> Result<Ending, Failure> {
    let seed = args.seed.to_string();
    let folder = folder.unwrap_or_else(|| Path::new("fredholm-out").join(id)).to_string_lossy().into_owned();
    let mut line: Vec<String> = words.iter().map(|w| (*w).to_string()).collect();
    if let Some([w, h]) = args.size
        && let Some(at) = line.iter().position(|w| w == "--size")
    {
        line[at + 1] = format!("{w}x{h}");
    }
    line.extend(["--seed".into(), seed, "--out".into(), folder]);
    line.extend(args.force.then(|| "--force".into()));
    line.extend(args.quiet.then(|| "--quiet".into()));
    // the words are constants of this file, so a mistake in them is a defect; the tests make every figure
    let wrong = |e: clap::Error| usage(&format!("this is a defect of the program: {e}"), "please report it");
    match Words::try_parse_from(line).map_err(wrong)? {
        Words::Sweep(args) => sweep::run(&args),
    }
}

/// The commands that make figures.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
enum Words {
    /// A sweep.
    Sweep(sweep::Sweep),
}

/// Makes a figure of one image at growing numbers of paths per pixel.
fn stages(args: &Figure, recipe: &Recipe, folder: Option<&Path>) -> Result<Ending, Failure> {
    let manner =
        Manner { out: folder.map(Path::to_path_buf), force: args.force, quiet: args.quiet, ..Manner::default() };
    let mut session = Session::new(manner, args.seed)?;
    let as_it_is = Changes { set: vec![], emit: vec![], lambertian: false };
    let opened = session.open(recipe.scene, &as_it_is, Some(args.size.unwrap_or(recipe.size)))?;
    let settings = Settings { spp: recipe.reference_spp, seed: args.seed, ..Settings::default() };
    preflight::fits_in_memory(&settings, opened.description.camera.size)?;
    session.make_folder(recipe.id)?;
    let Some(grown) = render_stages(&opened.scene, recipe, &settings, session.progress()) else {
        return Ok(session.nothing_to_save(""));
    };
    let (png, csv) = (format!("{}.png", recipe.id), format!("{}.csv", recipe.id));
    let record = Summary {
        spp: grown.stages.last().map_or(0, |s| s.paths).into(),
        max_bounces: settings.max_bounces,
        path: grown.stages.last().map(|s| s.mean),
        files: names([&csv, &png, "summary.json"]),
        ..session.record()
    };
    let size = [record.width, record.height];
    report::sheet(recipe.title, size, &grown, &session.caption())?.picture.write(&session.folder.join(&png))?;
    write_atomically(&session.folder.join(&csv), report::csv(&grown).as_bytes())?;
    session.sign(&record)?;
    session.show(&record, || people(&session, recipe, &grown, &record))?;
    Ok(session.ending(false))
}

/// The text: how far the error falls, and a row per stage.
fn people(session: &Session, recipe: &Recipe, grown: &Grown, record: &Summary) -> String {
    let Summary { scene, seed, width, height, .. } = record;
    let error = |s: &Stage| report::rmse(s.scatter.squared_error().unwrap_or(f64::NAN));
    let answer = match (grown.stages.first(), grown.stages.last()) {
        (Some(few), Some(many)) => format!(
            "With {} paths per pixel the root-mean-square error of a pixel of {scene} is {}; with {} it is {}.",
            few.paths,
            error(few),
            many.paths,
            error(many)
        ),
        _ => "No stage was rendered.".into(),
    };
    let above = format!(
        "{}, by the path tracer: the mean of the samples, the mean shown, with everything above white cut off as on a \
         screen, the light lost by that, the share of clipped pixels, and the error from the reference ({}, {} spp, seed {}; \
         its variance is subtracted). Seed {seed}, {width}×{height} pixels.",
        recipe.title,
        grown.reference.label,
        recipe.reference_spp,
        reference_seed(*seed)
    );
    let below =
        "The reference loses lamps and bright light on a screen, too; what an image loses beyond that is noise.";
    let table = format!("{}\n{}{}", wrapped(&above), report::table(grown).trim_start(), wrapped(below));
    session.text(&wrapped(&answer), &[table], &[], &record.files)
}
