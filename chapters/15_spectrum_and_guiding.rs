//! Chapter 15.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "spectrum_and_guiding/exercises.rs"]
mod exercises;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 15,
    name: "15_spectrum_and_guiding",
    title: "The spectrum, and walking with a map",
    shows: "eigenfunctions of T, faster solvers, guides that remove variance",
    next: &["fredholm chapter 16"],
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
