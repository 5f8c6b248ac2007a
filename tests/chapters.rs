//! Every chapter's program runs, its claims hold, and it writes every file that its text includes.
#![allow(clippy::unwrap_used)]

use std::{fs, path::Path};

#[path = "../chapters/01_one_box_three_answers.rs"]
#[allow(dead_code, unreachable_pub)] // its `main`; a program, not a library
mod one_box_three_answers;

type Run = fn(&Path) -> Result<bool, Box<dyn std::error::Error>>;
const CHAPTERS: [(&str, Run); 1] = [("01_one_box_three_answers", one_box_three_answers::run)];

/// What follows `figures/NAME/` in the text, up to the end of the file name.
fn included<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let file_name = |rest: &'a str| rest.split(|c: char| !(c.is_alphanumeric() || "._-".contains(c))).next().unwrap();
    text.split(&format!("figures/{name}/")).skip(1).map(file_name).collect()
}

/// The names of the anchors of `chapters/NAME.rs` that the text includes.
fn anchors<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    text.split(&format!("chapters/{name}.rs:")).skip(1).map(|rest| rest.split('}').next().unwrap()).collect()
}

#[test]
fn claims_hold_and_every_file_of_the_text_is_written() {
    for (name, run) in CHAPTERS {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(root.join(format!("book/src/{name}.md"))).unwrap();
        let program = fs::read_to_string(root.join(format!("chapters/{name}.rs"))).unwrap();
        let out = tempfile::tempdir().unwrap();
        assert!(run(out.path()).unwrap(), "{name}: a claim fails; the list is above");
        let (files, anchors) = (included(&text, name), anchors(&text, name));
        assert!(!files.is_empty() && !anchors.is_empty(), "{name}: the text includes nothing");
        for file in files {
            let bytes = fs::metadata(out.path().join(file)).unwrap_or_else(|e| panic!("{name}: {file}: {e}")).len();
            assert!(bytes > 0, "{name}: {file} is empty");
        }
        for anchor in anchors {
            for mark in [format!("// ANCHOR: {anchor}\n"), format!("// ANCHOR_END: {anchor}\n")] {
                assert_eq!(program.matches(&mark).count(), 1, "{name}: {mark}");
            }
        }
    }
}

#[test]
fn every_chapter_is_run() {
    let files = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("chapters")).unwrap();
    let mut found: Vec<String> =
        files.map(|f| f.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    // chapters have numbers; what has none is no chapter yet
    found.retain(|name| name.starts_with(|c: char| c.is_ascii_digit()));
    found.sort();
    assert_eq!(found, CHAPTERS.map(|c| c.0));
}
