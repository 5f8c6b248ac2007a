//! Each claim of chapter 2 fails if one ingredient of its measurement is wrong.

use crate::reflection_equation::{
    CHAPTER, Measured, claims, cones, distance, limit, measure, mirror_ball::capture, sphere,
};
use fredholm::report::book::Folder;
use fredholm::report::exercise::{Student, Task, Unit};
use fredholm::report::text::number::significant;
use fredholm::zoo::{self, Mistake, Right};

fn mistake(name: &str) -> &'static dyn Mistake {
    zoo::find(name).unwrap().mistake
}

#[test]
fn every_claim_fails_if_its_measurement_is_wrong() {
    let out = tempfile::tempdir().unwrap();
    let folder = Folder::new(out.path(), "test").unwrap().quick(true);
    let right = measure(&folder, &Right, f32::INFINITY).unwrap();
    let found = claims(&right);
    assert!(found.iter().all(|c| c.holds), "{found:#?}");

    let clipped = capture(&folder, 1.0).unwrap();
    let (mut by_distance, mut same_size, mut never_cut) = (right.clone(), right.clone(), right.clone());
    // a renderer that applies the inverse-square law to radiance
    by_distance.distance.iter_mut().for_each(|(d, l, _)| l.value /= *d * *d);
    // a large object that is lit as if all its points were where the mirror ball was
    same_size.captured.in_room[2].1 = right.captured.in_room[0].1.clone();
    never_cut.captured.under_clipped = right.captured.under.clone();

    let wrong: [(&str, Measured); 8] = [
        ("E = π L sin²α", Measured { cones: cones(&folder, mistake("no-receiver-cosine")).unwrap(), ..right.clone() }),
        (
            "E_point/E_disc",
            Measured { limit: limit(&folder, mistake("disk-light-without-root")).unwrap(), ..right.clone() },
        ),
        ("radiance of the lamp", by_distance),
        (
            "irradiance falls",
            Measured { distance: distance(&folder, mistake("no-inverse-square")).unwrap(), ..right.clone() },
        ),
        ("Pharr's sphere", Measured { sphere: sphere(&folder, mistake("half-bounce")).unwrap(), ..right.clone() }),
        ("radius 5 cm", Measured { captured: clipped, ..right.clone() }),
        ("radius 30 cm", same_size),
        ("cuts radiance", never_cut),
    ];
    for (words, measured) in &wrong {
        let failed: Vec<&str> = claims(measured).iter().filter(|c| !c.holds).map(|c| c.says).collect();
        assert!(matches!(failed[..], [says] if says.contains(words)), "`{words}` refutes {failed:?}");
    }
    for claim in &found {
        assert!(wrong.iter().any(|(words, _)| claim.says.contains(words)), "no mistake refutes `{}`", claim.says);
    }
}

#[test]
fn the_exercises_of_chapter_2_have_right_answers() {
    for (exercise, i) in CHAPTER.exercises.iter().flat_map(|e| (0..20).map(move |i| (e, i))) {
        let student = Student::new(&format!("student {i}")).unwrap();
        let judge = |answer: &str| exercise.judge(&student, answer).unwrap();
        let name = format!("2.{} of student {i}", exercise.number);
        let Task::Number { truth, mistakes, unit, .. } = exercise.task else { panic!("{name} is no number") };
        let x = truth(&student).unwrap().value;
        let right = judge(&if unit == Unit::Count { x.to_string() } else { significant(x, 4) });
        assert!(right.right, "{name}: {}", right.says);
        for mistake in mistakes(&student) {
            let wrong = judge(&mistake.value.to_string());
            assert!(!wrong.right && wrong.says.ends_with(mistake.says), "{name}: {}: {}", mistake.says, wrong.says);
        }
        for text in [(exercise.question)(&student), (exercise.solution)(&student)] {
            assert!(!text.contains("NaN"), "{name}: {text}");
        }
    }
}
