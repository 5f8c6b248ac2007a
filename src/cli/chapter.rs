//! `fredholm chapter [N]`: runs a chapter's own program, compiled in.

use super::base::{Ending, Failure, print, usage};
use super::options::{OUTPUT, WHAT};
use clap::Args;
use std::path::PathBuf;

#[path = "../../chapters/01_one_box_three_answers.rs"]
#[allow(dead_code)] // its `main` is for `cargo run --example`
mod one_box_three_answers;

type Run = fn(&std::path::Path) -> Result<bool, Box<dyn std::error::Error>>;

/// A chapter of the book.
struct Entry {
    number: u32,
    title: &'static str,
    /// What its program shows, in one line.
    shows: &'static str,
    run: Run,
}

const CHAPTERS: [Entry; 1] = [Entry {
    number: 1,
    title: "One box, three answers",
    shows: "Σ TᵏE, a path tracer and a matrix agree on a Cornell box; ‖TᵏE‖₁ stays below its bound",
    run: one_box_three_answers::run,
}];

/// Below `chapter --help`.
pub const HELP: &str = "Examples:
  fredholm chapter
  fredholm chapter 1

Without NUMBER, the chapters are listed. The program of a chapter makes its figures and tables, and checks every claim of its text. \
Exit code 1: a claim does not hold.";

/// Arguments of `chapter`.
#[derive(Clone, Debug, Args)]
pub struct Chapter {
    /// Number of the chapter [default: list them]
    #[arg(value_name = "NUMBER", help_heading = WHAT)]
    pub number: Option<String>,
    /// Output folder [default: fredholm-out/chapter-NN]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT, value_hint = clap::ValueHint::DirPath)]
    pub out: Option<PathBuf>,
}

/// Runs a chapter or lists them all.
pub fn run(args: &Chapter) -> Result<Ending, Failure> {
    let Some(word) = &args.number else {
        let lines: Vec<String> =
            CHAPTERS.iter().map(|c| format!("{:>2}  {}\n    {}", c.number, c.title, c.shows)).collect();
        print(&lines.join("\n"))?;
        return Ok(Ending::Ok);
    };
    let Some(chapter) = word.parse().ok().and_then(|n: u32| CHAPTERS.iter().find(|c| c.number == n)) else {
        return Err(unknown(word));
    };
    let out = args.out.clone().unwrap_or_else(|| format!("fredholm-out/chapter-{:02}", chapter.number).into());
    match (chapter.run)(&out) {
        Ok(true) => Ok(Ending::Ok),
        Ok(false) => Ok(Ending::Failed),
        Err(e) => Err(Failure::input(&e.to_string())),
    }
}

/// There is no such chapter: suggests the number for a number in words, or for a word of a title.
fn unknown(word: &str) -> Failure {
    const WORDS: [&str; 10] = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
    const ORDINALS: [&str; 5] = ["first", "second", "third", "fourth", "fifth"];
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
