//! Chapter 16.
#![allow(clippy::print_stdout)] // a program, not the library

use fredholm::report::book::{self, Chapter, Claim, Folder};
use std::process::ExitCode;

#[path = "where_it_breaks/exercises.rs"]
mod exercises;

/// This chapter.
pub const CHAPTER: Chapter = Chapter {
    number: 16,
    name: "16_where_it_breaks",
    title: "Where it breaks",
    shows: "high dimension, heavy tails, caustics, corners, what a passed test does not say",
    next: &["fredholm chapter 17"],
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
