//! Members of the zoo handed in as renderers: each is named, and what has no name gets none.

use super::*;

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_its_terms() {
    let answers = hand_in(&zoo::all(), true, true, 8);
    println!("{}", table(&answers));
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_plain_terms() {
    let answers = hand_in(&zoo::all(), true, false, 8);
    println!("{}", table(&answers));
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_its_image_alone() {
    let answers = hand_in(&zoo::all(), false, false, 32);
    println!("{}", table(&answers));
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

/// Four members that each need another step of the procedure, from files without errors.
#[test]
fn members_are_named() {
    let names = ["double-emission", "half-bounce", "truncated", "off-by-one", "area-density", "not-a-number"];
    let members: Vec<&Bug> = names.iter().map(|n| zoo::find(n).unwrap()).collect();
    let answers = hand_in(&members, true, false, 1);
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

/// A mistake that nobody put in the zoo is not given a name of the zoo.
#[test]
fn an_unknown_mistake_has_no_name() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(256, 5), Progress::NONE);
    let mut suspect = Pictures::of(&render, SIZE);
    // a gradient of brightness from left to right: a vignette, say
    for layer in &mut suspect.layers {
        let width = SIZE[0] as usize;
        layer
            .mean
            .iter_mut()
            .enumerate()
            .for_each(|(p, v)| *v = v.map(|x| x * (0.5 + (p % width) as f32 / width as f32)));
    }
    let candidates = Members::new(&bench.scene, K, 0, Progress::NONE);
    let d = bench.judge(&suspect, Some(&candidates), 1e-3);
    assert_eq!(d.verdict, Conclusion::Wrong);
    assert!(d.named().next().is_none(), "{:?} {:?}", d.findings, d.suspects);
    assert!(d.candidates.iter().all(|c| c.rejected));
}

/// The procedure without any candidates: patterns name what is a rule for r_k, with its number.
#[test]
fn rules_name_the_number() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    use std::f64::consts::PI;
    for (factor, name, constant) in [
        ((|k| 0.7f64.powi(k - 1)) as fn(i32) -> f64, "roulette-unweighted", Some(0.7)),
        (|_| 0.97, "constant-in-the-connection", Some(0.97)),
        (|_| 2.0, "double-emission", Some(2.0)),
        (|_| PI, "missing-pi-connection", Some(PI)),
        (|k| PI.powi(k), "missing-pi", Some(PI)),
        (|k| 0.5f64.powi(k - 1), "half-bounce", Some(0.5)),
        (|k| if k > 3 { 0.6f64.powi(k - 3) } else { 1.0 }, "roulette-unweighted", Some(0.6)),
        (|k| if k == 2 { 1.2 } else { 1.0 }, "one-term-scaled", Some(1.2)),
        (|k| f64::from(k != 3), "one-term-missing", None),
        (|k| if k > 2 { 0.0 } else { 1.0 }, "truncated", None),
    ] {
        let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(256, 6), Progress::NONE);
        let mut suspect = without_errors(Pictures::of(&render, SIZE)).only(|s| matches!(s, Slot::Term(_)));
        for layer in &mut suspect.layers {
            let Slot::Term(k) = layer.slot else { continue };
            let f = if k == 0 { 1.0 } else { factor(k as i32) } as f32;
            layer.mean.iter_mut().for_each(|v| *v = v.map(|x| f * x));
        }
        let d = bench.judge(&suspect, None, 1e-6);
        let Some(first) = d.suspects.iter().find(|s| s.is(name)) else { panic!("{name}: {:?}", d.suspects) };
        assert_eq!(d.suspects.len(), 1, "{name}: {:?}", d.suspects);
        if let Some(constant) = constant {
            let c = first.constants[0];
            assert!((c.value - constant).abs() < 5.0 * c.std_error && c.std_error < 0.01 * constant, "{name}: {c:?}");
        }
    }
}

#[test]
fn turned_broken_and_repeated_pictures_are_noticed() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(64, 7), Progress::NONE);
    let right = Pictures::of(&render, SIZE);
    let names = |p: &Pictures| {
        let d = bench.judge(p, None, 1e-6);
        assert_eq!(d.verdict, Conclusion::Wrong);
        d.named().map(|s| s.name.clone()).collect::<Vec<_>>()
    };
    let mut turned = without_errors(right.clone());
    turned.layers.iter_mut().for_each(|l| l.mean.reverse());
    let mut rows = turned.clone();
    rows.layers.iter_mut().for_each(|l| l.mean.chunks_mut(SIZE[0] as usize).for_each(<[_]>::reverse));
    assert!(names(&rows).contains(&"another-view".into()));
    let mut broken = right.clone();
    broken.layers[2].mean[40] = [f32::NAN; 3];
    assert_eq!(names(&broken), ["not-a-number"]);
    // errors four times too small: the samples were not independent
    let mut sure = right;
    sure.layers.iter_mut().for_each(|l| l.std_error.iter_mut().flatten().for_each(|e| *e = e.map(|x| 0.25 * x)));
    assert_eq!(names(&sure), ["error-bars"]);
}

/// Black and 8 bits: without a linear scale the terms and the brightness are gone, and still the shape speaks.
#[test]
fn members_are_named_from_their_image_alone() {
    let names = ["area-density", "no-shadow-test"];
    let members: Vec<&Bug> = names.iter().map(|n| zoo::find(n).unwrap()).collect();
    let answers = hand_in(&members, false, false, 4);
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}
