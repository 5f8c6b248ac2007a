//! Diagnosis: every member of the zoo is named or stands on a short list, what is right is called right, and bad input is
//! refused in words.
#![allow(clippy::unwrap_used)]

use fredholm::diagnosis::candidates::{Members, own_seed};
use fredholm::diagnosis::{
    Basis, Case, Diagnosis, Effort, Pictures, Region, Simulate, Slot, Unwatched, Verdict, diagnose, evidence,
    regions,
};
use fredholm::estimator::{Roulette, Technique};
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::stats::ledger;
use fredholm::worlds::sampled::{self, Estimator};
use fredholm::worlds::{Settings, Unobserved};
use fredholm::zoo::{self, Bug, Stage};
use std::fmt::Write;
use std::sync::atomic::AtomicBool;

const SIZE: [u32; 2] = [24, 24];
const K: usize = 6;
static NEVER: AtomicBool = AtomicBool::new(false);

fn settings(spp: u32, seed: u64) -> Settings {
    let usual = Settings::default();
    let roulette = usual.path_roulette.clone().after(K);
    Settings { spp, seed, max_bounces: K, roulette, ..usual }
}

/// A scene with everything a suspect is held against.
struct Bench {
    scene: Scene,
    right: Pictures,
    seen: Vec<Region>,
}

impl Bench {
    fn new(stage: Stage, spp: u32) -> Self {
        let scene = Scene::new(&stage.load(SIZE).unwrap());
        let render = sampled::terms(&scene, Estimator::Prefix, &settings(spp, own_seed(0)), &Unobserved, &NEVER);
        Self { right: Pictures::of(&render, SIZE), seen: regions::seen(&scene), scene }
    }

    fn judge(&self, suspect: &Pictures, candidates: Option<&dyn Simulate>, alpha: f64) -> Diagnosis {
        let case = Case {
            suspect,
            reference: &self.right,
            reference_spp: 1024.0,
            seen: &self.seen,
            counts: evidence::count(suspect, &self.right, 0.0),
            mask: &[],
            by_samples: &[],
            scaled: None,
            candidates,
            alpha,
            effort: Effort { paths: 2_000_000, ..Effort::default() },
        };
        diagnose(&case, &Unwatched)
    }
}

/// What a file without `_se` layers holds.
fn without_errors(mut pictures: Pictures) -> Pictures {
    pictures.layers.iter_mut().for_each(|l| l.std_error = None);
    pictures
}

/// One member handed in: its name, the answer, whether the answer is right, and the words for the table.
struct Answer {
    right: bool,
    line: String,
}

/// Hands in members on their scenes: as terms or as the whole image alone, with or without errors.
fn hand_in(members: &[&'static Bug], terms: bool, errors: bool, more: u32) -> Vec<Answer> {
    let mut stages: Vec<Stage> = members.iter().map(|b| b.exposed_by).collect();
    stages.dedup();
    let mut seen: Vec<Stage> = vec![];
    stages.retain(|s| !seen.contains(s) && { seen.push(*s); true });
    let mut answers = vec![];
    for stage in stages {
        let bench = Bench::new(stage, 2048);
        let candidates = Members::new(&bench.scene, K, 0, &NEVER);
        for bug in members.iter().filter(|b| b.exposed_by == stage) {
            let render = zoo::render(bug, &bench.scene, &settings(more * bug.spp.max(64), 77), &Unobserved, &NEVER);
            let mut suspect = Pictures::of(&render, SIZE);
            if !terms {
                suspect = suspect.only(|s| s == Slot::Whole);
            }
            if !errors {
                suspect = without_errors(suspect);
            }
            let d = bench.judge(&suspect, Some(&candidates), 1e-3);
            let names: Vec<&str> = d.suspects.iter().map(|s| s.name.as_str()).collect();
            let points = d.suspects.iter().any(|s| s.basis == Basis::Points);
            // the mean of same-numbers is right: a single picture cannot show it
            let right = if bug.name == "same-numbers" {
                d.verdict == Verdict::Correct
            } else {
                d.verdict == Verdict::Wrong && names.contains(&bug.name) && names.len() <= 3
            };
            let mut line = format!("{} {:<26} {:<16} {:?}", if right { ' ' } else { '!' }, bug.name, stage.label, names);
            if points {
                line += " (points)";
            }
            let first = d.candidates.iter().find(|c| c.name == bug.name);
            write!(line, "  own p {:.1e}, p correct {:.1e}", first.map_or(f64::NAN, |c| c.p), d.p).unwrap();
            answers.push(Answer { right, line });
        }
    }
    answers
}

fn table(answers: &[Answer]) -> String {
    answers.iter().map(|a| a.line.as_str()).collect::<Vec<_>>().join("\n")
}

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_its_terms() {
    let answers = hand_in(&zoo::all(), true, true, 4);
    println!("{}", table(&answers));
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_plain_terms() {
    let answers = hand_in(&zoo::all(), true, false, 4);
    println!("{}", table(&answers));
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}

#[test]
#[ignore = "nightly"]
fn every_member_is_named_from_its_image_alone() {
    let answers = hand_in(&zoo::all(), false, false, 8);
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

/// Every renderer of this program that is right.
fn right_renderers(scene: &Scene, seed: u64) -> Vec<(String, Pictures)> {
    let base = settings(64, seed);
    let with = |technique, sampling| Settings { technique, sampling, ..base.clone() };
    let terms = |e, s: &Settings| Pictures::of(&sampled::terms(scene, e, s, &Unobserved, &NEVER), SIZE);
    let mut all = vec![];
    for e in [Estimator::Prefix, Estimator::Single, Estimator::Light, Estimator::Bidirectional, Estimator::Branching { children: 2 }]
    {
        let s = if e == (Estimator::Branching { children: 2 }) { Settings { spp: 8, ..base.clone() } } else { base.clone() };
        all.push((e.to_string(), terms(e, &s)));
    }
    for t in [Technique::Scatter, Technique::Connect, Technique::Power] {
        all.push((format!("prefix, {t}"), terms(Estimator::Prefix, &with(t, Sampling::Bsdf))));
    }
    all.push(("uniform directions".into(), terms(Estimator::Prefix, &with(Technique::Mis, Sampling::Uniform))));
    let albedo = Settings { roulette: Roulette::Albedo { from: 2 }, ..base.clone() };
    all.push(("roulette".into(), terms(Estimator::Prefix, &albedo)));
    all.push(("path tracer".into(), Pictures::of(&sampled::path(scene, &base, &Unobserved, &NEVER), SIZE)));
    all
}

#[test]
fn right_renderers_are_called_correct() {
    let mut account = ledger::open("right_renderers_are_called_correct", 0);
    for stage in [Stage::CORNELL, Stage::GLASS_BALL] {
        let bench = Bench::new(stage, 1024);
        for (name, pictures) in right_renderers(&bench.scene, account.seed()) {
            for suspect in [pictures.clone(), without_errors(pictures)] {
                let d = bench.judge(&suspect, None, account.spend(1));
                assert_eq!(d.verdict, Verdict::Correct, "{} by {name}: {} {:?}", stage.label, d.worst, d.suspects);
                assert!(d.visible < 0.5, "{}: {}", name, d.visible);
            }
        }
    }
}

/// P(B(n, p) ≥ k).
fn upper_tail(n: u64, p: f64, k: u64) -> f64 {
    use statrs::distribution::{Binomial, DiscreteCDF};
    if k == 0 { 1.0 } else { Binomial::new(p, n).unwrap().sf(k - 1) }
}

#[test]
fn false_alarms_keep_their_level() {
    let mut account = ledger::open("false_alarms_keep_their_level", 0);
    let bench = Bench::new(Stage::CORNELL, 1024);
    let (runs, alpha) = (150u64, 0.05);
    for errors in [true, false] {
        let wrong = (0..runs).filter(|i| {
            let seed = account.seed().wrapping_add(*i);
            let render = sampled::terms(&bench.scene, Estimator::Prefix, &settings(32, seed), &Unobserved, &NEVER);
            let suspect = Pictures::of(&render, SIZE);
            let suspect = if errors { suspect } else { without_errors(suspect) };
            bench.judge(&suspect, None, alpha).p < alpha
        });
        let wrong = wrong.count() as u64;
        let p = upper_tail(runs, alpha, wrong);
        assert!(p > account.spend(1), "{wrong} false alarms in {runs} runs at {alpha} (errors {errors})");
    }
}

#[test]
fn a_bias_of_the_size_that_is_promised_is_seen() {
    let mut account = ledger::open("a_bias_of_the_size_that_is_promised_is_seen", 0);
    let bench = Bench::new(Stage::CORNELL, 1024);
    let alpha = account.spend(1);
    let render = sampled::terms(&bench.scene, Estimator::Prefix, &settings(256, account.seed()), &Unobserved, &NEVER);
    let suspect = Pictures::of(&render, SIZE);
    let d = bench.judge(&suspect, None, alpha);
    assert_eq!(d.verdict, Verdict::Correct, "{}", d.worst);
    // twice the size that is seen with probability 0.99 lies far enough beyond for any run
    let d = bench.judge(&suspect.times(1.0 + 2.0 * d.visible), None, alpha);
    assert_eq!(d.verdict, Verdict::Wrong);
    assert!(d.suspects.iter().any(|s| s.name == "exposure"), "{:?}", d.suspects);
}

/// A mistake that nobody put in the zoo is not given a name of the zoo.
#[test]
fn an_unknown_mistake_has_no_name() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let render = sampled::terms(&bench.scene, Estimator::Prefix, &settings(256, 5), &Unobserved, &NEVER);
    let mut suspect = Pictures::of(&render, SIZE);
    // a gradient of brightness from left to right: a vignette, say
    for layer in &mut suspect.layers {
        let width = SIZE[0] as usize;
        layer.mean.iter_mut().enumerate().for_each(|(p, v)| *v = v.map(|x| x * (0.5 + (p % width) as f32 / width as f32)));
    }
    let candidates = Members::new(&bench.scene, K, 0, &NEVER);
    let d = bench.judge(&suspect, Some(&candidates), 1e-3);
    assert_eq!(d.verdict, Verdict::Wrong);
    assert!(d.suspects.iter().all(|s| s.basis == Basis::Points), "{:?}", d.suspects);
    assert!(d.candidates.iter().all(|c| c.rejected));
}

/// The procedure without any candidates: patterns name what is a rule for r_k, with its number.
#[test]
fn rules_name_the_number() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    for (factor, name, number) in [
        ((|k| 0.7f64.powi(k - 1)) as fn(i32) -> f64, "roulette-unweighted", "0.70"),
        (|_| 2.0, "double-emission", "2"),
        (|_| std::f64::consts::PI, "missing-pi-connection", "π"),
        (|k| std::f64::consts::PI.powi(k), "missing-pi", "π"),
        (|k| 0.5f64.powi(k - 1), "half-bounce", "1/2"),
        (|k| if k > 2 { 0.0 } else { 1.0 }, "truncated", "T2"),
    ] {
        let render = sampled::terms(&bench.scene, Estimator::Prefix, &settings(256, 6), &Unobserved, &NEVER);
        let mut suspect = without_errors(Pictures::of(&render, SIZE)).only(|s| matches!(s, Slot::Term(_)));
        for layer in &mut suspect.layers {
            let Slot::Term(k) = layer.slot else { continue };
            let f = if k == 0 { 1.0 } else { factor(k as i32) } as f32;
            layer.mean.iter_mut().for_each(|v| *v = v.map(|x| f * x));
        }
        let d = bench.judge(&suspect, None, 1e-6);
        let first = d.suspects.iter().find(|s| s.name == name);
        assert!(first.is_some_and(|s| s.why.contains(number)), "{name}: {:?}", d.suspects);
    }
}

#[test]
fn turned_broken_and_repeated_pictures_are_noticed() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let render = sampled::terms(&bench.scene, Estimator::Prefix, &settings(64, 7), &Unobserved, &NEVER);
    let right = Pictures::of(&render, SIZE);
    let names = |p: &Pictures| {
        let d = bench.judge(p, None, 1e-6);
        assert_eq!(d.verdict, Verdict::Wrong);
        d.suspects.iter().map(|s| s.name.clone()).collect::<Vec<_>>()
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
    assert_eq!(names(&sure), ["same-numbers"]);
}

/// Black and 8 bits: without a linear scale the terms and the brightness are gone, and still the shape speaks.
#[test]
fn members_are_named_from_their_image_alone() {
    let names = ["area-density", "no-shadow-test"];
    let members: Vec<&Bug> = names.iter().map(|n| zoo::find(n).unwrap()).collect();
    let answers = hand_in(&members, false, false, 4);
    assert!(answers.iter().all(|a| a.right), "\n{}", table(&answers));
}
