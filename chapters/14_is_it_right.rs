//! Chapter 14.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "is_it_right/exercises.rs"]
mod exercises;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 14,
    name: "14_is_it_right",
    title: "Is it right? A bug zoo and proof by testing",
    shows: "false alarms and power, the bug zoo, the diagnosis of your own renderer",
    next: &["fredholm chapter 15"],
    program,
    exercises: exercises::EXERCISES,
};

fn program(_: &Folder<'_>) -> book::Result<Vec<Claim>> {
    Ok(vec![])
}

fn main() -> book::Result<ExitCode> {
    let found = CHAPTER.example(std::env::args().skip(1))?;
    print!("{}", found.text);
    Ok(found.exit_code())
}
