//! Every chapter's program runs, its claims hold, each of them fails if the result is made wrong, the program writes every
//! file that the text includes, and every exercise judges right and wrong answers.
#![allow(clippy::unwrap_used)]

use fredholm::report::book::{Chapter, Claim, Folder, Found};
use programs::*;
use std::{fs, path::Path};

#[path = "../src/cli/programs.rs"]
#[allow(unreachable_pub)] // part of a program, not of a library
mod programs;

// every claim of a chapter fails with a mistake that it is about
#[path = "chapters/08_change_of_measure.rs"]
mod claims_of_change_of_measure;
#[path = "chapters/03_choosing_directions.rs"]
mod claims_of_choosing_directions;
#[path = "chapters/04_furnace.rs"]
mod claims_of_furnace;
#[path = "chapters/14_is_it_right.rs"]
mod claims_of_is_it_right;
#[path = "chapters/12_mirrors_and_glass.rs"]
mod claims_of_mirrors_and_glass;
#[path = "chapters/11_multiple_importance_sampling.rs"]
mod claims_of_multiple_importance_sampling;
#[path = "chapters/05_naive_recursion.rs"]
mod claims_of_naive_recursion;
#[path = "chapters/06_neumann_series.rs"]
mod claims_of_neumann_series;
#[path = "chapters/13_noise.rs"]
mod claims_of_noise;
#[path = "chapters/01_one_box_three_answers.rs"]
mod claims_of_one_box_three_answers;
#[path = "chapters/09_path_tracing.rs"]
mod claims_of_path_tracing;
#[path = "chapters/07_radiosity.rs"]
mod claims_of_radiosity;
#[path = "chapters/02_reflection_equation.rs"]
mod claims_of_reflection_equation;
#[path = "chapters/10_russian_roulette.rs"]
mod claims_of_russian_roulette;
#[path = "chapters/15_spectrum_and_guiding.rs"]
mod claims_of_spectrum_and_guiding;
#[path = "chapters/16_where_it_breaks.rs"]
mod claims_of_where_it_breaks;

#[path = "chapters/exercises.rs"]
mod exercises;

/// Every claim holds for the right result. Each wrong result refutes the one claim that contains its words, and no other. Every
/// claim is refuted by at least one of them.
fn each_claim_fails_alone<M>(
    right: &M,
    claims: fn(&M) -> Vec<Claim>,
    wrong: impl IntoIterator<Item = (&'static str, M)>,
) {
    let refuted = |m: &M| claims(m).into_iter().filter(|c| !c.holds).map(|c| c.says).collect::<Vec<_>>();
    assert_eq!(refuted(right), [""; 0]);
    let mut left: Vec<&str> = claims(right).iter().map(|c| c.says).collect();
    for (words, wrong) in wrong {
        let found = refuted(&wrong);
        assert!(matches!(found[..], [says] if says.contains(words)), "`{words}` refutes {found:?}");
        left.retain(|says| !found.contains(says));
    }
    assert_eq!(left, [""; 0], "claims without a mistake that refutes them");
}

/// Runs the short form of a chapter in a folder of its own.
fn quick(chapter: &Chapter, out: &Path) -> Found {
    chapter.run(&Folder::new(out, "test").unwrap().quick(true)).unwrap()
}

/// What follows `figures/NAME/` in the text, up to the end of the file name.
fn included<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let file_name = |rest: &'a str| rest.split(|c: char| !(c.is_alphanumeric() || "._-".contains(c))).next().unwrap();
    text.split(&format!("figures/{name}/")).skip(1).map(file_name).collect()
}

/// The names behind `:` of what the text includes from `file`.
fn anchors<'a>(text: &'a str, file: &str) -> Vec<&'a str> {
    text.split(&format!("{file}:")).skip(1).map(|rest| rest.split('}').next().unwrap()).collect()
}

/// The files in `chapters` from which the text includes code, with the names of the anchors.
fn code(text: &str) -> Vec<(&str, &str)> {
    let included = text.split("{{#include ../../chapters/").skip(1).map(|rest| rest.split('}').next().unwrap());
    included.map(|place| place.split_once(':').unwrap()).collect()
}

#[test]
fn claims_hold_and_every_file_of_the_text_is_written() {
    for chapter in CHAPTERS {
        let name = chapter.name;
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(root.join(format!("book/src/{name}.md"))).unwrap();
        let out = tempfile::tempdir().unwrap();
        let found = quick(&chapter, out.path());
        assert!(found.holds(), "{name}: a claim fails\n{}", found.text);
        let (files, code) = (included(&text, name), code(&text));
        assert!(!files.is_empty() && !code.is_empty(), "{name}: the text includes nothing");
        for file in files {
            let bytes = fs::metadata(out.path().join(file)).unwrap_or_else(|e| panic!("{name}: {file}: {e}")).len();
            assert!(bytes > 0, "{name}: {file} is empty");
        }
        for (file, anchor) in code {
            let program = fs::read_to_string(root.join("chapters").join(file)).unwrap();
            for mark in [format!("// ANCHOR: {anchor}\n"), format!("// ANCHOR_END: {anchor}\n")] {
                assert_eq!(program.matches(&mark).count(), 1, "{name}: {file}: {mark}");
            }
        }
        let numbers = fs::read_to_string(out.path().join("numbers.md")).unwrap_or_default();
        for anchor in anchors(&text, &format!("figures/{name}/numbers.md")) {
            assert!(numbers.contains(&format!("ANCHOR: {anchor}\n")), "{name}: there is no number `{anchor}`");
        }
    }
}

#[test]
fn every_chapter_has_exercises_that_its_text_names() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for chapter in CHAPTERS {
        let text = fs::read_to_string(root.join(format!("book/src/{}.md", chapter.name))).unwrap();
        assert!(!chapter.exercises.is_empty(), "{}: no exercise that the program judges", chapter.name);
        let mut numbers: Vec<u32> = chapter.exercises.iter().map(|e| e.number).collect();
        for n in &numbers {
            let number = format!("{}.{n}", chapter.number);
            for part in [format!("**{number}**"), format!("fredholm exercise {number} --student")] {
                assert!(text.contains(&part), "{}: the text lacks `{part}`", chapter.name);
            }
        }
        numbers.dedup();
        assert_eq!(numbers.len(), chapter.exercises.len(), "{}: a number twice", chapter.name);
    }
}

#[test]
fn every_chapter_is_run() {
    let files = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("chapters")).unwrap();
    let mut found: Vec<String> =
        files.map(|f| f.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    // chapters have numbers; what has none is no chapter
    found.retain(|name| name.starts_with(|c: char| c.is_ascii_digit()));
    found.sort();
    assert_eq!(found, CHAPTERS.map(|c| c.name));
}
