//! Every claim of chapter 6 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::neumann_series::{Measured, claims, measure};
use fredholm::report::book::Folder;
use fredholm::study::bounces::guaranteed;

/// s^k.
fn power(s: f64, k: usize) -> f64 {
    s.powi(k as i32)
}

#[test]
fn every_claim_of_chapter_6_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, "furnace", power).unwrap();

    // a closed room whose walls differ is no furnace
    let uneven = Measured { furnace: measure(&folder, "cube", power).unwrap().furnace, ..right.clone() };
    // the formula of the slide, taken literally: every ratio is the rate
    let mut literal = right.clone();
    literal.ratios.iter_mut().for_each(|r| r.0 = right.radius.0);
    // a fit that begins too early
    let early = Measured { rates: [right.rates[0]; 2], ..right.clone() };
    // the mean albedo in place of the largest
    let mean_albedo = Measured { albedo: 0.5, ..right.clone() };
    // r(T) in place of the largest albedo
    let mut no_bound = right.clone();
    for (i, [_, bound]) in no_bound.enough.iter_mut().enumerate() {
        *bound = guaranteed(right.radius.0, [0, 2][i / 3], [0.1, 0.01, 0.001][i % 3]);
    }
    // the term k has k + 1 reflections
    let shifted = measure(&folder, "furnace", |s, k| power(s, k + 1)).unwrap();
    let shifted = Measured { scaled: shifted.scaled, ..right.clone() };
    // a pole at 1/γ, far from the room of the last point
    let mut elsewhere = right.clone();
    let far = |s: f64| 1.0 / (1.0 - s * right.albedo);
    elsewhere.towards_pole.iter_mut().for_each(|point| point.1 = far(point.0));

    let mutants = [
        ("in the furnace", uneven),
        ("in the Cornell box", literal),
        ("the rate of the late terms", early),
        ("no remainder", mean_albedo),
        ("less than a third", no_bound),
        ("albedos times 0.8", shifted),
        ("ten times closer", elsewhere),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
