//! Every exercise that the program judges, with the numbers of many students: the truth is right, every known mistake is wrong
//! for its own reason, and the solution states a right answer.

use crate::programs::CHAPTERS;
use fredholm::report::exercise::{Exercise, Student, Task, Unit};
use fredholm::report::text::number::significant;
use std::collections::HashSet;

/// Checks one exercise with the numbers of one student.
fn check(exercise: &Exercise, student: &Student, what: &str) {
    let judge = |answer: &str| exercise.judge(student, answer).unwrap();
    let refuses = |answer: &str, why: &str| {
        let judged = judge(answer);
        assert!(!judged.right && judged.says.ends_with(why), "{what}: {answer}, `{why}`: {}", judged.says);
    };
    match exercise.task {
        Task::Number { unit, truth, mistakes, .. } => {
            let x = truth(student).unwrap().value;
            let right = judge(&if unit == Unit::Count { x.to_string() } else { significant(x, 4) });
            assert!(right.right, "{what}: {}", right.says);
            assert!(!mistakes(student).is_empty(), "{what}: no known mistake");
            mistakes(student).iter().for_each(|m| refuses(&m.value.to_string(), m.says));
        }
        Task::Choice { words, truth, mistakes } => {
            let right = truth(student).unwrap();
            assert!(judge(right).right, "{what}: {right}");
            for word in words.iter().filter(|w| **w != right) {
                let why = mistakes.iter().find(|m| m.0 == *word).unwrap_or_else(|| panic!("{what}: why not {word}?"));
                refuses(word, why.1);
            }
        }
    }
    let solution = (exercise.solution)(student);
    let joined = solution.replace(" %", "%");
    let tokens = joined.split(|c: char| c.is_whitespace() || "=≈:,;()`".contains(c)).map(|t| t.trim_end_matches('.'));
    let states = |token: &str| exercise.judge(student, token).is_ok_and(|judged| judged.right);
    assert!({ tokens }.any(states), "{what}: no right answer in the solution: {solution}");
    for text in [(exercise.question)(student), solution.clone()] {
        assert!(!text.is_empty() && !text.contains("NaN") && !text.contains("could not"), "{what}: {text}");
    }
}

#[test]
fn every_exercise_judges_right_answers_and_known_mistakes() {
    for chapter in CHAPTERS {
        // students with the same numbers have the same truth
        let mut seen = HashSet::new();
        for (exercise, i) in chapter.exercises.iter().flat_map(|e| (0..20).map(move |i| (e, i))) {
            let student = Student::new(&format!("student {i}")).unwrap();
            if seen.insert((exercise.question)(&student)) {
                let what = format!("{}.{} for {}", chapter.number, exercise.number, student.name());
                check(exercise, &student, &what);
            }
        }
    }
}
