//! Each claim of chapter 11 fails if one ingredient of its measurement is wrong, and the exercises have right answers.

use crate::each_claim_fails_alone;
use crate::multiple_importance_sampling::mistakes::{Run, factors};
use crate::multiple_importance_sampling::pairs::{Pair, pairs};
use crate::multiple_importance_sampling::{Measured, claims, line, measure, sums, weight};
use fredholm::estimator::Technique;
use fredholm::report::book::Folder;

/// The measurements with one mistake replaced by another member of the zoo.
fn replaced(run: &Run<'_>, right: &Measured, name: &str, other: &'static str) -> Measured {
    let mut wrong = right.clone();
    let mut found = factors(run, &[other]).unwrap().remove(0);
    let at = wrong.mistakes.iter().position(|f| f.name == name).unwrap();
    found.name = wrong.mistakes[at].name;
    wrong.mistakes[at] = found;
    wrong
}

#[test]
fn every_claim_of_chapter_11_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, weight).unwrap();

    let with = |change: fn(&mut Pair, &Pair), others: &[[Pair; 4]]| {
        let mut wrong = right.clone();
        for (row, others) in wrong.pairs.iter_mut().zip(others) {
            row.iter_mut().zip(others).for_each(|(pair, other)| change(pair, other));
        }
        wrong
    };
    // balance: the mean of both strategies, unbiased, but with the noise of the worse one; power: both count all light
    let pairs = pairs(&folder, |t, i, p| match t {
        Technique::Mis => 0.5,
        Technique::Power => 1.0,
        _ => weight(t, i, p),
    });
    let pairs = pairs.unwrap();
    let swapped = with(|pair, _| pair.rays.swap(0, 1), &right.pairs.clone());
    // the density of light sampling is that of a uniform choice on the lamp, but points are chosen in the cone that it fills
    let area = sums::sums(&folder, |t, _, y| t.scene.light_density(y.side)).unwrap();
    let run = Run::of(&folder);
    // the exponent of the weights is always 2
    let power = line::variances(&folder, |_, i, half| line::weight(2.0, i, half));

    let mutants = [
        ("sum to 1", Measured { sums: area, ..right.clone() }),
        ("mean of the better strategy", with(|pair, other| pair.means = other.means, &pairs)),
        ("smallest lamp", swapped),
        ("Veach's bound", with(|pair, other| (pair.rays[2], pair.excess) = (other.rays[2], other.excess), &pairs)),
        ("doubled", replaced(&run, &right, "double-emission", "right")),
        ("mixed measures", replaced(&run, &right, "mixed-measures", "mixed-heuristics")),
        ("probability of the lamp", replaced(&run, &right, "wrong-light-choice", "right")),
        ("one dimension", Measured { line: power, ..right.clone() }),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
