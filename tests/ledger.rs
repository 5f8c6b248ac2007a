//! The significance of the whole suite is spent once, and by tests that exist.
#![allow(clippy::unwrap_used)]

mod common;

use common::ledger::{Account, ENTRIES, SUITE_ALPHA, open, share};
use fredholm::stats::hypothesis::ROUNDING;
use fredholm::terms::Estimate;
use glam::DVec3;
use std::panic::{AssertUnwindSafe, catch_unwind};
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
    for folder in ["tests", "chapters"] {
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

/// The message of the panic, or "" if it passes. Names the account that the example in the module text owns.
fn outcome(judge: impl FnOnce(&mut Account)) -> String {
    let mut account = open("example_of_the_ledger", 7);
    match catch_unwind(AssertUnwindSafe(|| judge(&mut account))) {
        Ok(()) => String::new(),
        Err(e) => e.downcast_ref::<String>().cloned().unwrap(),
    }
}

fn measured(mean: f64, std_error: f64) -> Estimate {
    Estimate { mean: DVec3::splat(mean), std_error: DVec3::splat(std_error), replicates: 256, events: None }
}

const ONE: DVec3 = DVec3::ONE;

#[test]
fn equivalence_needs_the_whole_interval_inside() {
    let t = share("example_of_the_ledger").threshold(255.0);
    let delta = DVec3::splat(0.01);
    let edge = (0.01 - 0.002) / t;
    assert_eq!(outcome(|a| a.assert_equivalent("T1", &measured(1.002, 0.999 * edge), ONE, delta)), "");
    let hidden = outcome(|a| a.assert_equivalent("T1", &measured(1.002, 1.001 * edge), ONE, delta));
    assert!(hidden.contains("noise hides"), "{hidden}");
    let off = outcome(|a| a.assert_equivalent("T1", &measured(1.02, edge), ONE, delta));
    assert!(off.contains("differs") && off.contains("expected") && off.contains("1.02"), "{off}");
    assert!(off.contains("FREDHOLM_SEED=7 cargo test --release example_of_the_ledger"), "{off}");
}

#[test]
fn consistency_and_difference_split_at_the_critical_value() {
    let t = share("example_of_the_ledger").threshold(255.0);
    let (inside, outside) = (measured(1.0 + 0.999 * t * 0.01, 0.01), measured(1.0 - 1.001 * t * 0.01, 0.01));
    assert_eq!(outcome(|a| a.assert_consistent("T1", &inside, ONE)), "");
    assert!(outcome(|a| a.assert_consistent("T1", &outside, ONE)).contains("differs"));
    assert_eq!(outcome(|a| a.assert_differs("T1", &outside, ONE)), "");
    assert!(outcome(|a| a.assert_differs("T1", &inside, ONE)).contains("is not told apart"));
}

#[test]
fn values_without_noise_pass_to_rounding_only() {
    let exact = |x| Estimate::exact(DVec3::splat(x));
    assert_eq!(outcome(|a| a.assert_consistent("T1", &exact(1.0 + 0.9 * ROUNDING), ONE)), "");
    assert_ne!(outcome(|a| a.assert_consistent("T1", &exact(1.0 + 1.1 * ROUNDING), ONE)), "");
}

#[test]
fn nan_never_passes() {
    for broken in [measured(f64::NAN, 0.1), measured(1.0, f64::NAN), Estimate { replicates: 1, ..measured(1.0, 0.1) }] {
        assert_ne!(outcome(|a| a.assert_equivalent("x", &broken, ONE, ONE)), "");
        assert_ne!(outcome(|a| a.assert_consistent("x", &broken, ONE)), "");
        assert_ne!(outcome(|a| a.assert_differs("x", &broken, 2.0 * ONE)), "");
    }
}

#[test]
fn an_account_cannot_be_overdrawn() {
    let message = outcome(|a| {
        a.assert_consistent("first", &measured(1.0, 0.1), ONE);
        a.assert_consistent("second", &measured(1.0, 0.1), ONE);
    });
    assert!(message.contains("more than the 3 comparisons"), "{message}");
}

#[test]
#[should_panic(expected = "not in the ledger")]
fn an_undeclared_test_is_refused() {
    let _ = share("nobody declared me");
}

#[test]
fn seeds_belong_to_names_and_to_runs() {
    let seed = |name, base| open(name, base).seed();
    let a = seed("example_of_the_ledger", 0);
    assert_eq!(a, seed("example_of_the_ledger", 0));
    assert_ne!(a, seed("example_of_the_ledger", 1));
    assert_ne!(a, seed(ENTRIES[1].name, 0));
}
