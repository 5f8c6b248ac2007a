//! The significance of the whole suite is spent once, and by tests that exist.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::ledger::{Account, ENTRIES, RESERVE, SHARE, SUITE_ALPHA, open, share, share_among};
use fredholm::stats::critical;
use fredholm::stats::hypothesis::ROUNDING;
use fredholm::terms::Estimate;
use glam::DVec3;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::{collections::BTreeSet, fs};

#[test]
fn the_shares_stay_within_the_budget() {
    let spent = ENTRIES.len() as f64 * SHARE;
    println!("{} tests spend {spent:.3e} of {SUITE_ALPHA:e}, {SHARE:.3e} each", ENTRIES.len());
    assert!(spent <= (1.0 - RESERVE) * SUITE_ALPHA, "{spent:e} leaves no reserve in {SUITE_ALPHA:e}");
    for e in ENTRIES {
        assert!(e.comparisons > 0 && (e.level() * f64::from(e.comparisons) / SHARE - 1.0).abs() < 1e-12, "{e:?}");
        let t = e.threshold(255.0);
        assert!(t > 5.0 && t < 9.0, "{}: critical value {t} at 255 degrees of freedom", e.name);
    }
}

/// Any number of tests leaves the reserve, and none is made so poor that the budget lies idle.
#[test]
fn a_new_test_needs_no_tuning() {
    for tests in 1..1000 {
        let spent = tests as f64 * share_among(tests);
        assert!(spent <= (1.0 - RESERVE) * SUITE_ALPHA * (1.0 + 1e-12), "{tests} tests spend {spent:e}");
        assert!(tests < 128 || spent > 0.5 * SUITE_ALPHA, "{tests} tests spend no more than {spent:e}");
        assert!(share_among(tests + 1) <= share_among(tests));
    }
    for m in [1, 100, 1_000_000] {
        let t = |places: f64| critical(SUITE_ALPHA / places / f64::from(m), 255.0);
        assert!(t(256.0) - t(192.0) < 0.06, "{m} comparisons");
    }
}

#[test]
fn names_are_unique() {
    let names: BTreeSet<_> = ENTRIES.iter().map(|e| e.name).collect();
    assert_eq!(names.len(), ENTRIES.len());
}

/// Every source below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|e| e.unwrap().path()) {
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The names in quotes after `call`.
fn named<'a>(text: &'a str, call: &str) -> BTreeSet<&'a str> {
    let quoted = text.split(call).skip(1).filter_map(|rest| rest.split('"').next());
    quoted.filter(|n| !n.contains('…')).collect()
}

/// Whether `name` is a function with the attribute `#[test]`.
fn is_test(text: &str, name: &str) -> bool {
    let Some((before, _)) = text.split_once(&format!("\nfn {name}(")) else { return false };
    let attributes = before.lines().rev().take_while(|l| l.starts_with("#[") || l.starts_with("//"));
    attributes.into_iter().any(|l| l == "#[test]")
}

/// Both ways: an entry without a test wastes budget, and a test without an entry panics when it is run, which for an
/// ignored one would be in the night.
#[test]
fn entries_and_tests_are_the_same_set() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![];
    ["tests", "chapters"].iter().for_each(|folder| sources(&root.join(folder), &mut files));
    // the text of the ledger shows how an account is opened, and this file asks for one that is not there
    let shown = [root.join("tests/common/ledger.rs"), root.join("tests/ledger.rs")];
    let text: String = files.iter().filter(|f| !shown.contains(f)).map(|f| fs::read_to_string(f).unwrap()).collect();
    let (opened, asked) = (named(&text, "open(\""), named(&text, "ledger::share(\""));
    let declared: BTreeSet<&str> = ENTRIES.iter().map(|e| e.name).collect();
    for name in declared.iter().filter(|n| **n != "example_of_the_ledger") {
        assert!(opened.contains(name), "no test opens the account `{name}`");
        assert!(is_test(&text, name), "`{name}` is not the name of a test: its replay line would run nothing");
    }
    let undeclared: Vec<_> = opened.union(&asked).filter(|n| !declared.contains(*n)).collect();
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
