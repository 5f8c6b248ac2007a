//! Chapter 11.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "multiple_importance_sampling/exercises.rs"]
mod exercises;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 11,
    name: "11_multiple_importance_sampling",
    title: "Multiple importance sampling",
    shows: "two strategies, weights that sum to 1, what goes wrong when they do not",
    next: &["fredholm chapter 12"],
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
