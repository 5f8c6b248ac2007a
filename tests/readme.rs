//! Every command line of the README runs, at reduced size.
//!
//! A command may find a difference (exit code 1): that is an answer. It must not refuse its arguments (2) or its files (3).
#![allow(clippy::unwrap_used)]

mod common;

use common::program::run;
use std::fs;
use std::path::Path;

/// The lines of the README that start with `fredholm`, without their comments, in their order.
fn commands() -> Vec<String> {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let mut fenced = false;
    let mut found = vec![];
    for line in readme.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if fenced && line.starts_with("fredholm ") {
            found.push(line.split("  #").next().unwrap().trim().to_owned());
        }
    }
    found
}

/// Flags that make a command quick, by the words with which it starts.
const QUICK: [(&str, &str); 16] = [
    ("series", "--spp 16 --size 16x16 --patches 60"),
    ("sweep", "--spp 16 --size 16x16"),
    ("check bias", "--spp 64 --size 8x8"),
    ("check equilibrium", "--spp 256 --points 8 --size 8x8"),
    ("check scene", "--time 5s"),
    ("roulette", "--spp 16 --size 16x16"),
    ("radiosity", "--patches 60 --spp 16 --size 16x16"),
    ("walk", "--patches 60 --spp 64"),
    ("diagnose --how", ""),
    ("export", ""),
    ("diagnose", "--spp 64 --paths 4096"),
    ("zoo", "--spp 16 --size 16x16"),
    ("info", ""),
    ("slurm", "--spp 16 --shards 2"),
    ("figure --list", ""),
    ("figure", "--quick"),
];

/// The command with its quick flags in place of its own.
fn reduced(command: &str) -> String {
    let words = command.strip_prefix("fredholm ").unwrap();
    let (_, quick) = QUICK.iter().find(|(start, _)| words.starts_with(start)).unwrap_or_else(|| {
        panic!("README has a new command, `{command}`: say here how to make it quick");
    });
    let flags: Vec<&str> = quick.split_whitespace().step_by(2).collect();
    let mut kept = vec![];
    let mut words = words.split_whitespace();
    while let Some(word) = words.next() {
        if flags.contains(&word) {
            words.next();
        } else {
            kept.push(word);
        }
    }
    format!("{} {quick}", kept.join(" "))
}

/// A shell expands `zoo-out/*.exr`; here it is done by hand, with a few of the files.
fn expanded(desk: &Path, line: &str) -> String {
    let Some(pattern) = line.split(' ').find(|word| word.ends_with("*.exr")) else { return line.into() };
    let folder = pattern.trim_end_matches("/*.exr");
    let mut files: Vec<String> = fs::read_dir(desk.join(folder))
        .unwrap()
        .map(|file| format!("{folder}/{}", file.unwrap().file_name().to_string_lossy()))
        .filter(|name| name.ends_with(".exr"))
        .collect();
    files.sort();
    files.truncate(2);
    line.replace(pattern, &files.join(" "))
}

#[test]
fn every_command_of_the_readme_runs() {
    let desk = tempfile::tempdir().unwrap();
    let found = commands();
    assert!(found.len() >= 12, "a dozen commands by purpose: {found:?}");
    // the reader's own render
    let own = run(desk.path(), "series cornell --spp 16 --size 16x16 --patches 60 -q -o own");
    assert!(own.code <= 1, "{}", own.err);
    fs::copy(desk.path().join("own/terms.exr"), desk.path().join("mine.exr")).unwrap();
    fs::create_dir(desk.path().join("scenes")).unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.toml");
    fs::copy(scene, desk.path().join("scenes/furnace.toml")).unwrap();
    for command in found {
        let line = expanded(desk.path(), &reduced(&command));
        let said = run(desk.path(), &line);
        assert!(said.code <= 1, "{command}\n{line}\n{}{}", said.out, said.err);
        assert!(!said.out.trim().is_empty(), "{command} says nothing");
    }
}

/// The tour fits on a screen: at most 40 lines of at most 100 columns. Its answer comes first.
#[test]
fn the_tour_fits_on_a_screen_and_answers_first() {
    let desk = tempfile::tempdir().unwrap();
    let said = run(desk.path(), "-q --spp 64 --size 24x24 --patches 240");
    assert!(said.code <= 1, "{}", said.err);
    let lines: Vec<&str> = said.out.lines().collect();
    // few samples leave verdicts open, and their sentences take a second line; the tour as shipped has no such lines
    let unbroken = lines.iter().filter(|line| !line.starts_with("    ")).count();
    assert!(unbroken <= 40, "{unbroken} lines\n{}", said.out);
    assert!(lines.iter().all(|line| line.chars().count() <= 100), "{}", said.out);
    assert!(lines[0].starts_with("cornell, solved in 4 ways: "), "{}", said.out);
    for part in
        ["The terms T^k E", "How many bounces are enough?", "Which bounce lights what?", "spectral radius", "Next: "]
    {
        assert!(said.out.contains(part), "{part} is missing\n{}", said.out);
    }
    // the rest is behind --verbose
    let more = run(desk.path(), "-q --spp 64 --size 24x24 --patches 240 --verbose");
    assert!(more.out.lines().count() > 2 * lines.len() && more.out.contains("reciprocity"), "{}", more.out);
}
