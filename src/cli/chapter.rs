//! `fredholm chapter [N]`: runs a chapter's own program, compiled in.

use super::base::{Ending, Failure, print, usage};
use super::options::{Manner, OUTPUT, WHAT};
use super::programs::CHAPTERS;
use super::session::Session;
use clap::Args;
use fredholm::report::book::{Chapter, Folder};
use fredholm::report::text::prose::wrapped_after;
use fredholm::report::text::summary::Summary;
use std::path::PathBuf;

/// Below `chapter --help`.
pub const HELP: &str = "Examples:
  fredholm chapter
  fredholm chapter 1
  fredholm chapter 1 --quick

Without NUMBER, the chapters are listed. The program of a chapter makes its figures and tables, and checks every claim of its text. \
Exit code 1: a claim does not hold.";

/// Arguments of `chapter`.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Number of the chapter [default: list them]
    #[arg(value_name = "NUMBER", help_heading = WHAT)]
    pub number: Option<String>,
    /// Take fewer samples and make smaller pictures: seconds instead of up to a minute
    #[arg(long, help_heading = WHAT)]
    pub quick: bool,
    /// Output folder [default: fredholm-out/chapter-NN]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// Replace another run's output
    #[arg(long, help_heading = OUTPUT)]
    pub force: bool,
    /// Print no progress
    #[arg(short, long, help_heading = OUTPUT)]
    pub quiet: bool,
}

/// Runs a chapter or lists them all.
pub fn run(args: &Options) -> Result<Ending, Failure> {
    let Some(word) = &args.number else {
        let line = |c: &Chapter| format!("{:>2}  {}\n    {}", c.number, c.title, wrapped_after(c.shows, "    "));
        let lines: Vec<String> = CHAPTERS.iter().map(line).collect();
        print(&lines.join("\n"))?;
        return Ok(Ending::Ok);
    };
    let chapter = find(word)?;
    let manner = Manner { out: args.out.clone(), force: args.force, quiet: args.quiet, ..Manner::default() };
    let mut session = Session::new(manner, 0)?;
    session.make_folder(&format!("chapter-{:02}", chapter.number))?;
    let folder = Folder::new(&session.folder, session.command())?.quick(args.quick).progress(session.progress());
    let found = chapter.run(&folder);
    if session.stopped() {
        folder.clear();
        return Ok(session.nothing_to_save(": the claims of a chapter need all of its results"));
    }
    let found = found.map_err(|e| Failure::input(&e.to_string()))?;
    let mut files = folder.written();
    files.push("summary.json".into());
    session.sign(&Summary { files, ..session.record() })?;
    print(found.text.trim_end())?;
    Ok(session.ending(!found.holds()))
}

/// The chapter with this number.
pub fn find(word: &str) -> Result<Chapter, Failure> {
    let number: Option<u32> = word.parse().ok();
    CHAPTERS.into_iter().find(|c| Some(c.number) == number).ok_or_else(|| unknown(word))
}

/// There is no such chapter: suggests the number for a number in words, or for a word of a title.
fn unknown(word: &str) -> Failure {
    const WORDS: [&str; 16] = [
        "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve", "thirteen",
        "fourteen", "fifteen", "sixteen",
    ];
    const ORDINALS: [&str; 8] = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth"];
    let lower = word.to_lowercase();
    let digits = lower.trim_matches(|c: char| !c.is_ascii_digit()).trim_start_matches('0');
    let spelt =
        [&WORDS[..], &ORDINALS].iter().find_map(|all| all.iter().position(|w| *w == lower)).map(|i| i as u32 + 1);
    let number = spelt.or(digits.parse().ok());
    let by_number = number.and_then(|n| CHAPTERS.iter().find(|c| c.number == n));
    let near = by_number.or_else(|| CHAPTERS.iter().find(|c| c.title.to_lowercase().contains(&lower)));
    let question = near.map_or(String::new(), |c| format!("did you mean `fredholm chapter {}`? ", c.number));
    usage(&format!("there is no chapter `{word}`"), &(question + "`fredholm chapter` lists the chapters"))
}
