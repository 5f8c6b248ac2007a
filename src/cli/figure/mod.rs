//! `fredholm figure NAME`: makes a figure by its name. Each is a program of the lecture, a recipe, or another command that writes
//! it; `lecture` and `--all` make many.

mod args;
mod growth;
mod homework;
mod named;
mod set;
mod slides;
mod stages;

use super::base::{Ending, Failure, paragraphs, print, usage};
use super::options::Manner;
use super::session::Session;
use super::{check, radiosity, solve, sweep};
use clap::Parser;
use fredholm::math::names::suggest;
use fredholm::report::text::prose::wrapped;
use named::{Kind, Named};
use std::path::Path;

pub use args::{Figure, HELP};

/// The name of the set of all figures of the lecture.
const LECTURE: &str = "lecture";

/// Lists the figures, or makes one, those of the lecture, or all.
pub fn run(args: &Figure) -> Result<Ending, Failure> {
    let figures = named::all();
    if args.list {
        return list(&figures).map(|()| Ending::Ok);
    }
    if let Some(point) = &args.measure {
        return growth::measured(args, point);
    }
    let session = || Session::new(manner(args), args.seed);
    let id = match (args.all, args.id.as_deref()) {
        (true, _) => return set::run(args, "All figures", &figures, session()?, "figures"),
        (_, None) => return Err(usage("which figure?", "`fredholm figure --list` names them, --all makes them all")),
        (_, Some(LECTURE)) => {
            let lecture: Vec<_> = figures.into_iter().filter(|f| named::LECTURE.contains(&f.id)).collect();
            return set::run(args, "The figures of the lecture", &lecture, session()?, LECTURE);
        }
        (_, Some(id)) => id,
    };
    let Some(figure) = figures.iter().find(|f| f.id == id) else {
        let ids: Vec<_> = figures.iter().map(|f| f.id).chain([LECTURE]).collect();
        return Err(usage(&format!("no figure is called `{id}`"), &suggest(id, "figures", &ids)));
    };
    match figure.kind {
        Kind::Slide(slide) => slides::run(args, slide, session()?),
        Kind::Stages(recipe) => stages::run(args, recipe, session()?),
        Kind::Homework => homework::run(args, id, session()?),
        Kind::Growth => growth::run(args, id, session()?),
        Kind::Command(words, quick) => command(args, id, words, quick),
    }
}

/// The names and the topics of all figures.
fn list(figures: &[Named]) -> Result<(), Failure> {
    let widest = figures.iter().map(|f| f.id.len()).max().unwrap_or(0);
    let lines: Vec<String> = figures.iter().map(|f| format!("{:widest$}  {}", f.id, f.topic)).collect();
    let answer = format!(
        "{} figures can be made: `fredholm figure NAME` makes one, `fredholm figure lecture` the first {}, one for every topic \
         of the lecture, with a page that shows them; `fredholm figure --all` makes them all.",
        figures.len(),
        named::LECTURE.len()
    );
    print(&paragraphs(&[wrapped(&answer), lines.join("\n")]))
}

fn manner(args: &Figure) -> Manner {
    Manner { out: args.out.clone(), force: args.force, quiet: args.quiet, ..Manner::default() }
}

/// Runs another command for its figure.
fn command(args: &Figure, id: &str, words: &[&str], quick: &[&str]) -> Result<Ending, Failure> {
    let folder = args.out.clone().unwrap_or_else(|| Path::new("fredholm-out").join(id)).to_string_lossy().into_owned();
    let mut line: Vec<String> = words.iter().map(|w| (*w).to_string()).collect();
    // an option that is already there gets the new value
    let mut set = |option: &str, value: String| match line.iter().position(|w| w == option) {
        Some(at) => line[at + 1] = value,
        None => line.extend([option.to_string(), value]),
    };
    for pair in quick.chunks(2).filter(|_| args.quick) {
        set(pair[0], pair[1].into());
    }
    if let Some([w, h]) = args.size {
        set("--size", format!("{w}x{h}"));
    }
    set("--seed", args.seed.to_string());
    set("--out", folder);
    line.extend(args.force.then(|| "--force".into()));
    line.extend(args.quiet.then(|| "--quiet".into()));
    // the words are constants of this file, so a mistake in them is a defect; the tests make every figure
    let wrong = |e: clap::Error| usage(&format!("this is a defect of the program: {e}"), "please report it");
    match Words::try_parse_from(line).map_err(wrong)? {
        Words::Sweep(args) => sweep::run(&args),
        Words::Series(args) => solve::series(&args),
        Words::Radiosity(args) => radiosity::run(&args),
        Words::Check(args) => check::run(&args),
    }
}

/// The commands that make figures.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
enum Words {
    /// A sweep.
    Sweep(sweep::Sweep),
    /// The terms.
    Series(solve::Series),
    /// The matrix.
    Radiosity(radiosity::Radiosity),
    /// A check.
    Check(check::Check),
}
