//! Every claim of chapter 6 holds, and each of them fails if one ingredient is made wrong. Every exercise judges right
//! answers and known mistakes.

use crate::neumann_series::{CHAPTER, Measured, claims, measure};
use fredholm::report::book::Folder;
use fredholm::report::exercise::{Student, Task};
use fredholm::report::text::number::significant;
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
    let refuted = |m: &Measured| claims(m).into_iter().filter(|c| !c.holds).map(|c| c.says).collect::<Vec<_>>();
    assert_eq!(refuted(&right), [""; 0]);

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
    assert_eq!(mutants.len(), claims(&right).len(), "a claim without a mutation");
    for (words, wrong) in mutants {
        let found = refuted(&wrong);
        assert!(found.len() == 1 && found[0].contains(words), "{words}: {found:?}");
    }
}

#[test]
fn the_exercises_of_chapter_6_have_right_answers() {
    assert_eq!(CHAPTER.exercises.iter().map(|e| e.number).collect::<Vec<_>>(), [1, 2, 3, 5]);
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
