//! Each claim of chapter 11 fails if one ingredient of its measurement is wrong, and the exercises have right answers.

use crate::multiple_importance_sampling::mistakes::{Run, factors};
use crate::multiple_importance_sampling::pairs::{Pair, pairs};
use crate::multiple_importance_sampling::{CHAPTER, Measured, claims, line, measure, sums, weight};
use fredholm::estimator::Technique;
use fredholm::report::book::Folder;
use fredholm::report::exercise::{Student, Task};
use fredholm::report::text::number::significant;

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
    let found = claims(&right);
    assert!(found.iter().all(|c| c.holds), "{found:#?}");

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
    assert_eq!(mutants.len(), found.len(), "a claim without a mutation");
    for (words, wrong) in mutants {
        let failed: Vec<&str> = claims(&wrong).iter().filter(|c| !c.holds).map(|c| c.says).collect();
        assert!(matches!(failed[..], [says] if says.contains(words)), "`{words}` refutes {failed:?}");
    }
}

#[test]
fn the_exercises_of_chapter_11_have_right_answers() {
    for (exercise, i) in CHAPTER.exercises.iter().flat_map(|e| (0..20).map(move |i| (e, i))) {
        let student = Student::new(&format!("student {i}")).unwrap();
        let judge = |answer: &str| exercise.judge(&student, answer).unwrap();
        let name = format!("11.{} of student {i}", exercise.number);
        match exercise.task {
            Task::Number { truth, mistakes, .. } => {
                let x = truth(&student).unwrap().value;
                let right = judge(&significant(x, 4));
                assert!(right.right, "{name}: {}", right.says);
                for mistake in mistakes(&student) {
                    let wrong = judge(&format!("{:.8}", mistake.value));
                    let known = !wrong.right && wrong.says.ends_with(mistake.says);
                    assert!(known, "{name}: {}: {}", mistake.says, wrong.says);
                }
            }
            Task::Choice { words, truth, mistakes } => {
                let x = truth(&student).unwrap();
                assert!(judge(x).right, "{name}");
                for word in words.iter().filter(|word| **word != x) {
                    let (_, says) = mistakes.iter().find(|m| m.0 == *word).unwrap();
                    assert!(!judge(word).right && judge(word).says.ends_with(says), "{name}: {word}");
                }
            }
        }
        for text in [(exercise.question)(&student), (exercise.solution)(&student)] {
            assert!(!text.contains("NaN") && !text.contains("could not"), "{name}: {text}");
        }
    }
}
