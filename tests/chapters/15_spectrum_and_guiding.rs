//! Every claim of chapter 15 holds, and each of them fails if one ingredient is made wrong.

use crate::each_claim_fails_alone;
use crate::spectrum_and_guiding::{Ingredients, RIGHT, claims, measure};
use fredholm::operator::Transport;
use fredholm::operator::matrix::Weight;
use fredholm::report::book::Folder;

/// λ_min and λ_2: the largest eigenvalue is forgotten.
fn without_the_first(values: &[f64]) -> [f64; 2] {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    [values[0], values[values.len() - 2]]
}

#[test]
fn every_claim_of_chapter_15_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &RIGHT).unwrap();

    let some = Ingredients {
        // the area alone, without 1/ρ
        weight: |t| Weight::new(&t.factors.area, &vec![1.0; t.rho.len()]),
        interval: without_the_first,
        // reflected light alone
        map: |b, e| b.iter().zip(e).map(|(b, e)| b - e).collect(),
        ..RIGHT
    };
    let others = Ingredients {
        // the term k has k + 1 reflections
        power: |lambda, k| lambda.powi(k as i32 + 1),
        // the weight of a walk that follows no map
        step: |t, at, _| f64::from(t.albedo(at).x),
        ..RIGHT
    };
    let (some, others) = (measure(&folder, &some).unwrap(), measure(&folder, &others).unwrap());

    let mut by_area = right.clone();
    by_area.spectrum.not_orthogonal = some.spectrum.not_orthogonal;
    let mut shifted = right.clone();
    shifted.spectrum.error = others.spectrum.error;
    // the rate of the first bounce in place of a late one
    let mut early = right.clone();
    early.spectrum.ratios.reverse();
    let mut underestimated = right.clone();
    underestimated.errors.by_step = some.errors.by_step;
    let mut without_emission = right.clone();
    let largest = some.walks.all.iter().map(|w| w.largest);
    without_emission.walks.all.iter_mut().zip(largest).for_each(|(w, largest)| w.largest = largest);
    let mut unweighted = right.clone();
    let biases = others.walks.all.iter().map(|w| w.bias);
    unweighted.walks.all.iter_mut().zip(biases).for_each(|(w, bias)| w.bias = bias);
    // a standard deviation in place of a variance
    let mut deviation = right.clone();
    deviation.walks.all.iter_mut().for_each(|w| w.variance.value = w.variance.value.sqrt());
    // directions by the map with the weight of the cosine: bright directions count too often
    let mut too_bright = right.clone();
    too_bright.seen[1].mean = too_bright.seen[1].mean.times(1.3);

    let mutants = [
        ("the modes are orthogonal", by_area),
        ("six modes predict", shifted),
        ("late terms fall", early),
        ("in six rooms", underestimated),
        ("with B as the map", without_emission),
        ("every map gives the same mean", unweighted),
        ("the second moments", deviation),
        ("in a room both maps", too_bright),
    ];
    each_claim_fails_alone(&right, claims, mutants);
}
