//! Groups of arguments that several commands share, and parsers for values.

use super::choices::Choices;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};
use fredholm::engine::MOST_BOUNCES;
use fredholm::scene::load::Options;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Heading of options that say what is computed.
pub const WHAT: &str = "What";
/// Heading of options that say how it is computed.
pub const HOW: &str = "How";
/// Heading of options for the matrix.
pub const MATRIX: &str = "Matrix";
/// Heading of options for files, threads and the screen.
pub const OUTPUT: &str = "Output";

/// Changes to a scene.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = WHAT)]
pub struct Changes {
    /// Override a key of the scene
    ///
    /// For example: --set materials.white.reflectance=[0.6,0.6,0.6]. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Let a material emit light: lamp=17,12,4
    ///
    /// The three numbers are radiance in W sr⁻¹ m⁻². May be repeated.
    #[arg(long, value_name = "NAME=R,G,B", hide_short_help = true)]
    pub emit: Vec<String>,
    /// Make every surface Lambertian, as a matrix needs it
    ///
    /// Each surface keeps its albedo as one colour; glass becomes black. This is another scene with another solution, for every
    /// way to solve it.
    #[arg(long, hide_short_help = true)]
    pub lambertian: bool,
}

impl Changes {
    /// The same changes for the loader, with the image size in pixels if one is given.
    pub fn options(&self, size: Option<[u32; 2]>) -> Options {
        let size = size.map(|[w, h]| format!("camera.size=[{w},{h}]"));
        Options {
            set: self.set.iter().cloned().chain(size).collect(),
            emit: self.emit.clone(),
            lambertian: self.lambertian,
        }
    }

    /// The name of the first of these options that is given, if any is.
    pub fn first(&self) -> Option<&'static str> {
        let given =
            [("--set", !self.set.is_empty()), ("--emit", !self.emit.is_empty()), ("--lambertian", self.lambertian)];
        given.iter().find(|f| f.1).map(|f| f.0)
    }
}

/// What is rendered: scene, samples, seed, size and K.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = WHAT)]
pub struct Frame {
    /// Built-in scene, .toml or .obj
    ///
    /// `fredholm info` lists the built-in scenes. scenes/README.md describes the .toml format.
    #[arg(value_name = "SCENE", default_value = "cornell", value_hint = ValueHint::FilePath)]
    pub scene: String,
    /// Samples per pixel [default: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Image size in pixels [default: the scene's]
    ///
    /// For example 128x96. The tour of `cornell` has 192x192 pixels by default.
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// K: keep the terms k = 0..=K [default: 8]
    ///
    /// k is the number of applications of T: 0 is emission seen directly, 1 direct light, 2 one bounce of indirect light.
    /// Everything longer than K is estimated as one sum, the tail.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(0..=i64::from(MOST_BOUNCES)))]
    pub max_bounces: Option<u16>,
    /// Seed: the same seed gives the same bits
    ///
    /// The number of threads does not matter.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

/// Arguments of every study of a scene: changes to the scene, the output folder, threads, and what is printed.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = OUTPUT)]
pub struct Shared {
    /// Output folder [default: fredholm-out/SCENE-COMMAND]
    ///
    /// The same command replaces its own output. If another run's output is there, the default becomes NAME-2, and a folder
    /// given here is refused without --force. The tour writes to fredholm-out/SCENE.
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long)]
    pub force: bool,
    /// Threads [default: all]
    ///
    /// Results do not depend on the number of threads.
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub threads: Option<u16>,
    /// Print JSON instead of tables
    #[arg(long)]
    pub json: bool,
    /// Print no progress
    #[arg(short, long)]
    pub quiet: bool,
    /// Print every number behind the answer
    #[arg(short, long)]
    pub verbose: bool,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
}

/// Options that every command has: output folder, number of threads, and what is printed.
#[derive(Clone, Debug, Default)]
pub struct Manner {
    /// The output folder given with `--out`.
    pub out: Option<PathBuf>,
    /// Replace another run's output.
    pub force: bool,
    /// Number of threads.
    pub threads: Option<u16>,
    /// Print JSON instead of text.
    pub json: bool,
    /// Print no progress.
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

/// Parser for a value of the library that is chosen by name.
pub fn one_of<T>(choices: Choices) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = String> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(described(choices)).try_map(|name| name.parse::<T>())
}

/// Parser for a name out of a list.
pub fn name_of(choices: Choices) -> impl TypedValueParser<Value = String> {
    PossibleValuesParser::new(described(choices))
}

fn described(choices: Choices) -> Vec<PossibleValue> {
    let value = |&(name, what): &(&'static str, &'static str)| {
        let value = PossibleValue::new(name);
        if what.is_empty() { value } else { value.help(what) }
    };
    choices.iter().map(value).collect()
}

/// Values separated by commas; the numbers of `table:0,0,0.5` stay together.
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

/// Parses a whole number from 1 to `most`.
pub fn number(text: &str, most: u32) -> Result<u32, String> {
    let n = text.parse().ok().filter(|n| (1..=most).contains(n));
    n.ok_or_else(|| format!("`{text}` is not a whole number from 1 to {most}"))
}

/// Parses an image size such as `128x96`.
pub fn size(s: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{s}` is not a size such as 128x128 (each side 1 to 32768)");
    let (w, h) = s.split_once('x').ok_or_else(wrong)?;
    let side = |s: &str| s.parse().ok().filter(|n| (1..=32768).contains(n)).ok_or_else(wrong);
    Ok([side(w)?, side(h)?])
}

/// Parses the corners of a rectangle of pixels: x0,y0,x1,y1.
pub fn corners(s: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = s.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        _ => Err(format!("`{s}` is not a rectangle x0,y0,x1,y1 with x0 < x1 and y0 < y1, such as 32,32,64,64")),
    }
}

/// Parses a grading: a number from 1 to 8.
pub fn grading(s: &str) -> Result<f64, String> {
    let g: f64 = s.parse().map_err(|_| format!("`{s}` is not a number"))?;
    if (1.0..=8.0).contains(&g) { Ok(g) } else { Err("a grading is a number from 1 to 8".into()) }
}

/// Parses `30s`, `1.5m`, `500ms` or `2h`; a number without a unit is in seconds.
pub fn duration(s: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, unit) = units.iter().find_map(|(u, f)| Some((s.strip_suffix(u)?, *f))).unwrap_or((s, 1.0));
    let seconds = number.parse().ok().map(|x: f64| x * unit).filter(|x| *x > 0.0 && *x <= 1e6);
    seconds.map(Duration::from_secs_f64).ok_or(format!("`{s}` is not a time such as 30s, 1.5m or 500ms"))
}

/// Parses a number of at least 0, such as the fraction of a term that a comparison tolerates.
pub fn fraction(s: &str) -> Result<f64, String> {
    let number = s.parse().ok().filter(|x: &f64| *x >= 0.0 && x.is_finite());
    number.ok_or(format!("`{s}` is not a number of at least 0"))
}

/// Parses a number between 0 and 1.
pub fn probability(s: &str) -> Result<f64, String> {
    s.parse().ok().filter(|p| *p > 0.0 && *p < 1.0).ok_or(format!("`{s}` is not between 0 and 1"))
}
