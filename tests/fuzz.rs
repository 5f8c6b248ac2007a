//! No reader panics, hangs or asks for much memory, whatever a file holds: all files of the corpus, and mutated copies of them.
//!
//! `fuzz/README.md` says how the corpus was found, and how to fuzz longer.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "fuzz/mutate.rs"]
#[allow(unreachable_pub)]
mod mutate;
#[path = "fuzz/targets.rs"]
#[allow(unreachable_pub)]
mod targets;

use mutate::{Random, dictionary, mutated};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use targets::{Desk, TARGETS, Target};

/// Only one test at a time may limit the memory of the process.
static ALONE: Mutex<()> = Mutex::new(());

/// Where a case that ends the process is found: in `target/tmp/fuzz`.
fn desk() -> Desk {
    Desk::new(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz"))
}

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fuzz"))
}

/// The files of a reader's corpus, in the order of their names.
fn corpus(target: &Target) -> Vec<Vec<u8>> {
    let folder = folder().join("corpus").join(target.name);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    files.iter().map(|f| std::fs::read(f).unwrap()).collect()
}

fn every_reader(cases: u64) {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let desk = desk();
    let only = std::env::var("FUZZ").ok();
    for target in TARGETS.iter().filter(|t| only.as_ref().is_none_or(|name| t.name == name)) {
        let corpus = corpus(target);
        let words = dictionary(&folder().join("dictionaries").join(format!("{}.txt", target.name)));
        let whole = corpus.iter().filter(|file| target.check(&desk, file)).count();
        assert!(whole > 2 && whole < corpus.len(), "{}: {whole} of {} are read", target.name, corpus.len());
        let case = |i: u64| target.check(&desk, &mutated(&corpus, &words, &mut Random(i << 32)));
        let read = (0..cases).filter(|&i| case(i)).count() as u64;
        println!("{}: {} files, {whole} read; {cases} mutated, {read} read", target.name, corpus.len());
        assert!(read > cases / 50 && read < cases * 49 / 50, "{}: {read} of {cases} are read", target.name);
    }
}

#[test]
fn no_reader_panics_hangs_or_takes_much_memory() {
    every_reader(5000);
}

#[test]
#[ignore = "nightly: 10⁶ cases of every reader"]
fn no_reader_panics_in_1_000_000_cases() {
    every_reader(1_000_000);
}
