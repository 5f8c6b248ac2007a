//! Pieces of arguments that several commands share, and values as they are typed.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use fredholm::math::names::list;
use fredholm::scene::load::Options;
use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// What changes a scene.
#[derive(Clone, Debug, Args)]
pub struct Changes {
    /// Override a key of the scene
    ///
    /// For example materials.white.reflectance=[0.6,0.6,0.6]
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Let a material emit: lamp=17,12,4
    #[arg(long, value_name = "MATERIAL=R,G,B")]
    pub emit: Vec<String>,
    /// Take every surface for Lambertian, with its albedo as one colour: what a matrix can hold
    ///
    /// Another scene with another solution, for every world. Glass is black.
    #[arg(long)]
    pub lambertian: bool,
}

impl Changes {
    /// The same, and a size in pixels.
    pub fn options(&self, size: Option<[u32; 2]>) -> Options {
        let size = size.map(|[w, h]| format!("camera.size=[{w},{h}]"));
        Options {
            set: self.set.iter().cloned().chain(size).collect(),
            emit: self.emit.clone(),
            lambertian: self.lambertian,
        }
    }

    /// The first option that is given, if any is.
    pub fn first(&self) -> Option<&'static str> {
        let given =
            [("--set", !self.set.is_empty()), ("--emit", !self.emit.is_empty()), ("--lambertian", self.lambertian)];
        given.iter().find(|f| f.1).map(|f| f.0)
    }
}

/// What is rendered: scene, samples, seed, size and K.
#[derive(Clone, Debug, Args)]
pub struct Frame {
    /// Built-in scene, .toml, or .obj
    #[arg(value_name = "SCENE", default_value = "cornell")]
    pub scene: String,
    /// Samples per pixel [default: 256]
    ///
    /// [default in a sweep over branching: 32]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Seed: same seed, same bits, for any number of threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Image size in pixels [default: the scene's; 192x192 for the tour]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// K: keep the terms k = 0..=K; k counts applications of T [default: 8]
    ///
    /// [default in a sweep over branching: 4]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=1000))]
    pub max_bounces: Option<u16>,
}

/// What every study of a scene takes.
#[derive(Clone, Debug, Args)]
pub struct Shared {
    /// How the scene is changed.
    #[command(flatten)]
    pub changes: Changes,
    /// Output folder [default: one in fredholm-out, named after scene and study]
    ///
    /// The same command replaces its own output. Where another run's stands, the default becomes
    /// NAME-2, and a folder given here is refused without --force.
    #[arg(short, long, value_name = "DIR", verbatim_doc_comment)]
    pub out: Option<PathBuf>,
    /// Replace what another run left in the output folder
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]; results do not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
    /// Print every number behind the answer, not only the answer
    #[arg(short, long)]
    pub verbose: bool,
}

/// Options that every command has: output folder, number of threads, and what is printed.
#[derive(Clone, Debug, Default)]
pub struct Manner {
    /// The output folder that was asked for.
    pub out: Option<PathBuf>,
    /// Replace what is there.
    pub force: bool,
    /// Threads.
    pub threads: Option<u16>,
    /// JSON instead of text.
    pub json: bool,
    /// No progress.
    pub quiet: bool,
    /// Print every number behind the answer.
    pub verbose: bool,
}

impl From<&Shared> for Manner {
    fn from(s: &Shared) -> Self {
        Self {
            out: s.out.clone(),
            force: s.force,
            threads: s.threads,
            json: s.json,
            quiet: s.quiet,
            verbose: s.verbose,
        }
    }
}

/// A value of a type of the library by one of these names.
pub fn one_of<T>(names: impl IntoIterator<Item: Display>) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = String> + Clone + Send + Sync + 'static,
{
    // arguments live as long as the program
    let names: Vec<&'static str> = names.into_iter().map(|n| &*n.to_string().leak()).collect();
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

/// Help for an option: what it is, and its values.
pub fn among(what: &str, names: impl IntoIterator<Item: Display>) -> String {
    format!("{what}: {}", list(names))
}

/// Values with commas between them; the numbers of `table:0,0,0.5` stay together.
pub fn values(list: &str) -> Vec<String> {
    let mut all: Vec<String> = vec![];
    for word in list.split(',').map(str::trim) {
        match all.last_mut() {
            Some(last) if last.starts_with("table:") && word.parse::<f64>().is_ok() => *last += &format!(",{word}"),
            _ => all.push(word.into()),
        }
    }
    all
}

pub fn number(text: &str, most: u32) -> Result<u32, String> {
    let n = text.parse().ok().filter(|n| (1..=most).contains(n));
    n.ok_or_else(|| format!("`{text}` is not a whole number from 1 to {most}"))
}

pub fn size(s: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{s}` is not a size such as 128x128 (each side 1 to 32768)");
    let (w, h) = s.split_once('x').ok_or_else(wrong)?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=32768).contains(n)).ok_or_else(wrong);
    Ok([side(w)?, side(h)?])
}

pub fn grading(s: &str) -> Result<f64, String> {
    let g: f64 = s.parse().map_err(|_| format!("`{s}` is not a number"))?;
    if (1.0..=8.0).contains(&g) { Ok(g) } else { Err("a grading is a number from 1 to 8".into()) }
}

/// `30s`, `1.5m`, `500ms`; a bare number is seconds.
pub fn duration(s: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, unit) = units.iter().find_map(|(u, f)| Some((s.strip_suffix(u)?, *f))).unwrap_or((s, 1.0));
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x <= 1e6);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 30s, 1.5m or 500ms"))
}

pub fn fraction(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite()).ok_or(format!("`{s}` is not a number from 0 on"))
}

pub fn probability(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|p| *p > 0.0 && *p < 1.0).ok_or(format!("`{s}` is not between 0 and 1"))
}
