//! Every claim of chapter 13 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::noise::{Measured, With, claims, measure};
use fredholm::math::Points;
use fredholm::report::book::{Folder, Number};
use fredholm::report::image::picture::mean;
use fredholm::zoo::Right;

#[test]
fn every_claim_of_chapter_13_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &With::default()).unwrap();

    let all_wrong = With {
        // a screen that shows every value
        shown: |pixels, _| mean(pixels),
        // the second curve has independent points as well
        points: Points::Independent,
        // nothing repeats, nothing is clamped
        mistakes: [&Right, &Right],
        // ten runs with one seed
        seed: |_| 0,
        // one standard error instead of a 95 % interval
        half_width: |std_error, _| std_error,
        // the small lamp is large
        lamp: 0.2,
    };
    let wrong = measure(&folder, &all_wrong).unwrap();
    let [free, sobol, repeated, clamped] = right.curves.clone();
    let [no_sobol, no_repeat, no_clamp] = [1, 2, 3].map(|i| wrong.curves[i].clone());
    let [large, tiny] = right.covered.clone();
    let [narrow, large_again] = wrong.covered.clone();
    // an error that falls like 1/N
    let mut linear = right.clone();
    linear.display.ratio = linear.display.ratio.times(1.0 / 32f64.sqrt());
    let mut not_clipped = right.clone();
    not_clipped.display.darker = wrong.display.darker;

    let curves = |curves| Measured { curves, ..right.clone() };
    // the second part of the third claim: pixels that are independent
    let one = Number { value: 1.0, std_error: 0.03 };
    let independent = Measured { same: [one, one], ..right.clone() };
    let mutants = [
        ("The same numbers", independent),
        ("from 4 to 128 paths", linear),
        ("the variance has slope", curves([free.clone(), no_sobol, repeated.clone(), clamped.clone()])),
        ("numbers that repeat", curves([free.clone(), sobol.clone(), no_repeat, clamped])),
        ("clamped at", curves([free, sobol, repeated, no_clamp])),
        ("a screen shows", not_clipped),
        ("ten runs", Measured { merged: wrong.merged, ..right.clone() }),
        ("with a large lamp", Measured { covered: [narrow, tiny], ..right.clone() }),
        ("with a tiny lamp", Measured { covered: [large, large_again], ..right.clone() }),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
