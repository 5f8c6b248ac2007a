//! Chapter 9.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "path_tracing/exercises.rs"]
mod exercises;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 9,
    name: "09_path_tracing",
    title: "Path tracing: one path, all terms",
    shows: "one path for all terms, the rules of emission, reuse against separate paths",
    next: &["fredholm chapter 10"],
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
