//! The significance of the whole suite is spent once, and by tests that exist.
#![allow(clippy::unwrap_used)]

use fredholm::stats::ledger::{ENTRIES, SUITE_ALPHA};
use std::{collections::BTreeSet, fs, path::Path};

#[test]
fn the_shares_stay_within_the_budget() {
    let spent: f64 = ENTRIES.iter().map(|e| e.share).sum();
    assert!(spent <= SUITE_ALPHA, "the shares add up to {spent:e}, more than {SUITE_ALPHA:e}");
    for e in ENTRIES {
        assert!(e.share > 0.0 && e.comparisons > 0, "{e:?}");
        let t = e.threshold(255.0);
        assert!(t > 5.0 && t < 9.0, "{}: critical value {t} at 255 degrees of freedom", e.name);
    }
}

#[test]
fn names_are_unique() {
    let names: BTreeSet<_> = ENTRIES.iter().map(|e| e.name).collect();
    assert_eq!(names.len(), ENTRIES.len());
}

/// Both ways: an entry without a test wastes budget, and a test without an entry panics when it is run, which for an
/// ignored one would be in the night.
#[test]
fn entries_and_tests_are_the_same_set() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut sources = String::new();
    for folder in ["tests", "src/stats", "chapters"] {
        let Ok(files) = fs::read_dir(root.join(folder)) else { continue };
        for file in files.map(|f| f.unwrap().path()).filter(|f| f.extension().is_some_and(|e| e == "rs")) {
            sources += &fs::read_to_string(file).unwrap();
        }
    }
    let opened: BTreeSet<&str> = sources
        .split("open(\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .filter(|n| !n.contains('…'))
        .collect();
    for e in ENTRIES {
        assert!(opened.contains(e.name), "no test opens the account `{}`", e.name);
        let is_test = sources.contains(&format!("fn {}(", e.name)) || e.name == "example_of_the_ledger";
        assert!(is_test, "`{}` is not the name of a test function: its replay line would run nothing", e.name);
    }
    let declared: BTreeSet<&str> = ENTRIES.iter().map(|e| e.name).collect();
    let undeclared: Vec<_> = opened.difference(&declared).collect();
    assert!(undeclared.is_empty(), "accounts that the ledger does not know: {undeclared:?}");
}
