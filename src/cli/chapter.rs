//! `fredholm chapter [N]`: runs a chapter's own program, compiled in.

use super::base::{Ending, Failure, print, usage};
use clap::Args;
use std::path::PathBuf;

#[path = "../../chapters/01_one_box_three_answers.rs"]
#[allow(dead_code)] // its `main` is for `cargo run --example`
mod one_box_three_answers;

type Run = fn(&std::path::Path) -> Result<bool, Box<dyn std::error::Error>>;

const CHAPTERS: [(u32, &str, Run); 1] = [(1, "One box, three answers", one_box_three_answers::run)];

/// Arguments of `chapter`.
#[derive(Clone, Debug, Args)]
pub struct Chapter {
    /// Number of the chapter; nothing lists them
    pub number: Option<u32>,
    /// Folder for its figures [default: fredholm-out/chapter-<number>]
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Runs a chapter or lists them all.
pub fn run(args: &Chapter) -> Result<Ending, Failure> {
    let Some(number) = args.number else {
        let lines: Vec<String> = CHAPTERS.iter().map(|(n, title, _)| format!("{n:>2}  {title}")).collect();
        print(&lines.join("\n"))?;
        return Ok(Ending::Ok);
    };
    let Some((_, _, run)) = CHAPTERS.iter().find(|c| c.0 == number) else {
        return Err(usage(&format!("there is no chapter {number}"), "`fredholm chapter` lists those there are"));
    };
    let out = args.out.clone().unwrap_or_else(|| format!("fredholm-out/chapter-{number:02}").into());
    match run(&out) {
        Ok(true) => Ok(Ending::Ok),
        Ok(false) => Ok(Ending::Failed),
        Err(e) => Err(Failure::input(&e.to_string())),
    }
}
