//! Every claim of chapter 15 holds, and each of them fails if one ingredient is made wrong.

use crate::spectrum_and_guiding::{CHAPTER, Ingredients, Measured, RIGHT, claims, measure};
use fredholm::operator::Transport;
use fredholm::operator::matrix::Weight;
use fredholm::report::book::Folder;
use fredholm::report::exercise::{Student, Task};
use fredholm::report::text::number::significant;

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
    let refuted = |m: &Measured| claims(m).into_iter().filter(|c| !c.holds).map(|c| c.says).collect::<Vec<_>>();
    assert_eq!(refuted(&right), [""; 0]);

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
    assert_eq!(mutants.len(), claims(&right).len(), "a claim without a mutation");
    for (words, wrong) in mutants {
        let found = refuted(&wrong);
        assert!(found.len() == 1 && found[0].contains(words), "{words}: {found:?}");
    }
}

#[test]
fn the_exercises_of_chapter_15_have_right_answers() {
    assert_eq!(CHAPTER.exercises.iter().map(|e| e.number).collect::<Vec<_>>(), [1, 2, 3, 4]);
    for i in 0..20 {
        let student = Student::new(&format!("student {i}")).unwrap();
        for exercise in CHAPTER.exercises {
            let Task::Number { truth, mistakes, .. } = exercise.task else { panic!("{} is no number", exercise.title) };
            let says = |answer: &str| exercise.judge(&student, answer).unwrap();
            let value = truth(&student).unwrap().value;
            let answer = if value.fract() == 0.0 { value.to_string() } else { significant(value, 4) };
            assert!(says(&answer).right, "{}: {answer}", exercise.title);
            assert!(!mistakes(&student).is_empty());
            for mistake in mistakes(&student) {
                let judged = says(&mistake.value.to_string());
                assert!(!judged.right && judged.says.contains(mistake.says), "{}: {}", exercise.title, judged.says);
            }
            for text in [(exercise.question)(&student), (exercise.solution)(&student)] {
                assert!(!text.contains("NaN") && !text.is_empty(), "{text}");
            }
        }
    }
}
