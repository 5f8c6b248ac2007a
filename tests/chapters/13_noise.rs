//! Every claim of chapter 13 holds, and each of them fails if one ingredient is made wrong. Every exercise judges right
//! answers and known mistakes.

use crate::noise::{CHAPTER, Measured, With, claims, measure};
use fredholm::math::Points;
use fredholm::report::book::{Folder, Number};
use fredholm::report::exercise::{Student, Task};
use fredholm::report::image::picture::mean;
use fredholm::report::text::number::significant;
use fredholm::zoo::Right;

#[test]
fn every_claim_of_chapter_13_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &With::default()).unwrap();
    let refuted = |m: &Measured| claims(m).into_iter().filter(|c| !c.holds).map(|c| c.says).collect::<Vec<_>>();
    assert_eq!(refuted(&right), [""; 0]);

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
    let mutants = [
        ("from 4 to 128 paths", linear),
        ("the variance has slope", curves([free.clone(), no_sobol, repeated.clone(), clamped.clone()])),
        ("numbers that repeat", curves([free.clone(), sobol.clone(), no_repeat, clamped])),
        ("clamped at", curves([free, sobol, repeated, no_clamp])),
        ("a screen shows", not_clipped),
        ("ten runs", Measured { merged: wrong.merged, ..right.clone() }),
        ("with a large lamp", Measured { covered: [narrow, tiny], ..right.clone() }),
        ("with a tiny lamp", Measured { covered: [large, large_again], ..right.clone() }),
    ];
    assert_eq!(mutants.len(), claims(&right).len(), "a claim without a mutation");
    for (words, wrong) in mutants {
        let found = refuted(&wrong);
        assert!(found.len() == 1 && found[0].contains(words), "{words}: {found:?}");
    }
    // the second part of the third claim: pixels that are independent
    let one = Number { value: 1.0, std_error: 0.03 };
    let found = refuted(&Measured { same: [one, one], ..right });
    assert!(found.len() == 1 && found[0].contains("The same numbers"), "{found:?}");
}

#[test]
fn the_exercises_of_chapter_13_have_right_answers() {
    assert_eq!(CHAPTER.exercises.iter().map(|e| e.number).collect::<Vec<_>>(), [1, 2, 3, 4]);
    for i in 0..20 {
        let student = Student::new(&format!("student {i}")).unwrap();
        for exercise in CHAPTER.exercises {
            let Task::Number { truth, mistakes, .. } = exercise.task else { panic!("{} is no number", exercise.title) };
            let says = |answer: &str| exercise.judge(&student, answer).unwrap();
            let answer = significant(truth(&student).unwrap().value, 4);
            let answer = answer.strip_suffix(".000").unwrap_or(&answer);
            assert!(says(answer).right, "{}: {answer}", exercise.title);
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
