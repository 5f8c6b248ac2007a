//! Every claim of chapter 9 holds, and each of them fails if one ingredient is made wrong.

use crate::path_tracing::{BROKEN, CHAPTER, LAST, Measured, Rules, claims, difference, measure, mistake, ratios, rays};
use fredholm::report::book::Folder;
use fredholm::report::exercise::{Student, Task};
use fredholm::zoo::Right;

#[test]
fn every_claim_of_chapter_9_can_fail() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::new(place.path(), "test").unwrap().quick(true);
    let rules = [Rules::CONNECT, Rules::MIS];
    let broken = BROKEN.map(|b| mistake(b.name).unwrap());
    let right = measure(&folder, rules, broken, "furnace").unwrap();
    let refuted = |m: &Measured| claims(m).into_iter().filter(|c| !c.holds).map(|c| c.says).collect::<Vec<_>>();
    assert_eq!(refuted(&right), [""; 0]);

    // hits count after every vertex, although the connections have found the same light
    let twice = [Rules { hit: |_| 1.0, ..Rules::CONNECT }, Rules::MIS];
    let twice = Measured { difference: difference(&folder, twice).unwrap(), ..right.clone() };
    // own paths are one reflection too long
    let mut shifted = right.clone();
    shifted.means[1].rotate_left(1);
    // in an open room some paths leave
    let open = Measured { rays: rays(&folder, "cornell").unwrap(), ..right.clone() };
    // one rule is not broken
    let repaired = |i: usize| {
        let mut m = right.clone();
        m.ratios[i] = ratios(&folder, &BROKEN[i], &Right).unwrap();
        m
    };
    // the terms of one path are treated as independent
    let mut independent = right.clone();
    for noise in &mut independent.noise {
        let diagonal = |(j, row): (usize, &mut Vec<f64>)| (0..LAST).filter(|&k| k != j).for_each(|k| row[k] = 0.0);
        noise.covariance.iter_mut().enumerate().for_each(diagonal);
    }
    // a new path is traced for every term, and called one path
    let mut renewed = right.clone();
    renewed.noise.iter_mut().for_each(|noise| noise.path = noise.rays.iter().sum());
    // the rays to the vertices are not counted for one term alone: all of the path is charged to it
    let mut charged = right.clone();
    for noise in &mut charged.noise {
        noise.rays[..4].iter_mut().for_each(|rays| *rays = noise.path);
    }

    let mutants = [
        ("the loop gives every pixel", twice),
        ("the same means", shifted),
        ("in a closed room", open),
        ("counted twice", repaired(0)),
        ("left out at the eye", repaired(1)),
        ("left out after mirrors", repaired(2)),
        ("along a path", independent),
        ("for the sum", renewed),
        ("for one term alone", charged),
    ];
    assert_eq!(mutants.len(), claims(&right).len(), "a claim without a mutation");
    for (words, wrong) in mutants {
        let found = refuted(&wrong);
        assert!(found.len() == 1 && found[0].contains(words), "{words}: {found:?}");
    }
}

#[test]
fn the_exercises_of_chapter_9_have_right_answers() {
    for (exercise, i) in CHAPTER.exercises.iter().flat_map(|e| (0..20).map(move |i| (e, i))) {
        let student = Student::new(&format!("student {i}")).unwrap();
        let judge = |answer: &str| exercise.judge(&student, answer).unwrap();
        let name = format!("9.{} of student {i}", exercise.number);
        match exercise.task {
            Task::Number { truth, mistakes, .. } => {
                let x = truth(&student).unwrap().value;
                let right = judge(&fredholm::report::text::number::significant(x, 4));
                assert!(right.right, "{name}: {}", right.says);
                for mistake in mistakes(&student) {
                    let wrong = judge(&format!("{:.6}", mistake.value));
                    assert!(
                        !wrong.right && wrong.says.ends_with(mistake.says),
                        "{name}: {}: {}",
                        mistake.says,
                        wrong.says
                    );
                }
            }
            Task::Choice { words, truth, mistakes } => {
                let x = truth(&student).unwrap();
                assert!(judge(x).right, "{name}");
                for (word, says) in mistakes.iter().filter(|m| m.0 != x) {
                    assert!(words.contains(word) && judge(word).says.ends_with(says), "{name}: {word}");
                }
            }
        }
        for text in [(exercise.question)(&student), (exercise.solution)(&student)] {
            assert!(!text.contains("NaN") && !text.contains("could not"), "{name}: {text}");
        }
    }
}
