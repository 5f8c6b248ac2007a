//! Chapter 5: its claims hold, and each of them fails if the result is wrong in the way that it is about.

use crate::naive_recursion::{CHAPTER, CHILDREN, K, Measured, claims, measure, recursion};
use fredholm::report::book::{Claim, Folder};
use fredholm::report::exercise::{Student, Task, Unit};
use fredholm::report::text::number::significant;

/// A change to the result, with words of the one claim that it must refute.
type Mistake = (&'static str, fn(&mut Measured));

fn right() -> Measured {
    let place = tempfile::tempdir().unwrap();
    measure(&Folder::new(place.path(), "test").unwrap().quick(true), |n| 1.0 / n as f32).unwrap()
}

fn refuted(m: &Measured) -> Vec<&'static str> {
    claims(m).into_iter().filter(|c: &Claim| !c.holds).map(|c| c.says).collect()
}

const MISTAKES: [Mistake; 7] = [
    // the camera ray is counted as depth 1
    ("exactly Nᵏ rays", |m| m.counted.iter_mut().for_each(|rays| rays.rotate_right(1))),
    // the sum of the N rays is not divided by N
    ("right mean", |m| {
        let wrong = |n: u32| recursion("sphere", 16_384 / (n * n), 0, n, 1.0).unwrap().1;
        m.sphere = CHILDREN.map(wrong).to_vec();
    }),
    // the reflectance is left out of the bounces, so that no term is darker than direct light
    ("most rays go to k = 4", |m| m.trees.iter_mut().for_each(|t| t.mean[K] = t.mean[1])),
    // all N^K rays of a tree are taken for independent samples of the sum
    ("all terms in one tree", |m| {
        let one = m.trees[0].variance[K + 1];
        m.trees.iter_mut().zip(CHILDREN).for_each(|(t, n)| t.variance[K + 1] = one.map(|v| v / f64::from(n).powi(4)));
    }),
    // the same for each term: its N^k rays are taken for independent samples
    ("k = 2, 3, 4 alone", |m| {
        let one = m.trees[0].variance.clone();
        let wrong = |k: usize, n: u32| one[k].map(|v| v / f64::from(n).powi(k as i32));
        m.trees.iter_mut().zip(CHILDREN).for_each(|(t, n)| (2..=K).for_each(|k| t.variance[k] = wrong(k, n)));
    }),
    // all rays of a hit use the same random numbers, so that more of them do not help
    ("small pixels", |m| {
        let one = m.direct[0][0].variance.clone();
        m.direct[0].iter_mut().for_each(|t| t.variance.clone_from(&one));
    }),
    // every ray of a hit starts at a new point of the pixel, so that all of the variance falls as 1/N
    ("large pixels", |m| {
        let one = m.direct[1][0].variance[1];
        m.direct[1].iter_mut().zip(CHILDREN).for_each(|(t, n)| t.variance[1] = one.map(|v| v / f64::from(n)));
    }),
];

#[test]
fn every_claim_holds_and_can_fail() {
    let right = right();
    assert_eq!(refuted(&right), [""; 0]);
    for (words, mistake) in MISTAKES {
        let mut wrong = right.clone();
        mistake(&mut wrong);
        let refuted = refuted(&wrong);
        assert!(refuted.len() == 1 && refuted[0].contains(words), "`{words}`: {refuted:?}");
    }
    for claim in claims(&right) {
        let named = MISTAKES.iter().filter(|(words, _)| claim.says.contains(words)).count();
        assert_eq!(named, 1, "mistakes for the claim `{}`", claim.says);
    }
}

#[test]
fn the_exercises_of_chapter_5_have_right_answers() {
    let mut seen = std::collections::HashSet::new(); // students with the same numbers have the same truth
    for student in (0..20).map(|i| Student::new(&format!("student {i}")).unwrap()) {
        for e in CHAPTER.exercises {
            let what = format!("5.{} {}", e.number, student.name());
            if !seen.insert((e.question)(&student)) {
                continue;
            }
            let words = (e.question)(&student) + &(e.solution)(&student);
            assert!(!words.contains("NaN") && !words.contains('–'), "{what}: {words}");
            let Task::Number { unit, truth, mistakes, .. } = e.task else { panic!("{what}") };
            let value = truth(&student).unwrap().value;
            let answer = if unit == Unit::Count { value.to_string() } else { significant(value, 4) };
            let judged = e.judge(&student, &answer).unwrap();
            assert!(judged.right, "{what}: {}", judged.says);
            for wrong in mistakes(&student) {
                let judged = e.judge(&student, &wrong.value.to_string()).unwrap();
                assert!(!judged.right && judged.says.ends_with(wrong.says), "{what}: {}", judged.says);
            }
        }
    }
}
