//! Every claim of chapter 14 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::is_it_right::decisions::{p_values, rejected};
use crate::is_it_right::experiments::{ALPHA, BATCHES, Darker, SAMPLES, experiments};
use crate::is_it_right::signatures::{member, scales, signatures};
use crate::is_it_right::{Measured, claims, measure};
use fredholm::report::book::{Folder, Number};
use fredholm::stats::critical;

#[test]
fn every_claim_of_chapter_14_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder).unwrap();

    let bug = |name: &str| member(name).unwrap();

    // the p-values of a wrong renderer
    let wrong = experiments(&folder, bug("half-bounce").mistake, "wrong").unwrap();
    let biased = Measured { p: p_values(&wrong), ..right.clone() };
    // no correction in place of Holm's
    let uncorrected = Measured { families: [right.families[0]; 2], ..right.clone() };
    // the test for one look, used at any time
    let peeking = Measured { watched: [right.watched[0].clone(), right.watched[0].clone()], ..right.clone() };
    // the smallest bias without z_β: the bias that reaches the level
    let (t, n) = (critical(ALPHA, f64::INFINITY), SAMPLES as f64);
    let unplanned = Darker(1.0 / (1.0 + t / (3.0 * n).sqrt()));
    let unplanned = experiments(&folder, &unplanned, "unplanned").unwrap();
    let power = right.power.iter().map(|&(n, _)| (n, rejected(&unplanned, n))).collect();
    let unplanned = Measured { power, ..right.clone() };
    // "no difference found", taken for equality
    let (_, found) = right.power[right.power.len() - 1];
    let not_found = Number { value: 1.0 - found.value, ..found };
    let lazy = Measured { equal: [right.equal[0], not_found], ..right.clone() };
    // a mistake in the connection, taken for one in the bounce
    let mut confused = right.clone();
    confused.zoo[1].bug = bug("roulette-unweighted");
    // emission left out, in place of terms with wrong numbers
    let mut dark = right.clone();
    let missing = signatures(&folder, &["emission-missing"]).unwrap().remove(0);
    (dark.zoo[6].ratios, dark.zoo[6].whole) = (missing.ratios, missing.whole);
    // a density per area in the right renderer
    let per_area = scales(&folder, bug("area-density").mistake).unwrap();
    let per_area = Measured { scales: [per_area, right.scales[1].clone()], ..right.clone() };

    let mutants = [
        ("p-values of the right renderer", biased),
        ("with Holm", uncorrected),
        ("used after every batch", peeking),
        ("as planned", unplanned),
        ("test of equality", lazy),
        ("of their laws", confused),
        ("off-by-one", dark),
        ("8 times as large", per_area),
    ];
    each_claim_fails_alone(&right, claims, mutants);
    assert!(right.watched.iter().all(|rates| rates.len() == BATCHES));
}
