//! Diagnosis: every member of the zoo is named or stands on a short list, what is right is called right, and bad input is
//! refused in words.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::ledger;
use fredholm::diagnosis::candidates::{Members, own_seed};
use fredholm::diagnosis::{
    Basis, Case, Diagnosis, Effort, Pictures, Region, Simulate, Slot, Verdict, diagnose, evidence, regions,
};
use fredholm::engine::Settings;
use fredholm::engine::by_rays::{self, Estimator};
use fredholm::estimator::{Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::scene::Scene;
use fredholm::scene::bsdf::Sampling;
use fredholm::zoo::{self, Bug, Stage};
use std::fmt::Write;

const SIZE: [u32; 2] = [24, 24];
const K: usize = 6;

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
        let render = by_rays::terms(&scene, Estimator::Prefix, &settings(spp, own_seed(0)), Progress::NONE);
        Self { right: Pictures::of(&render, SIZE), seen: regions::seen(&scene), scene }
    }

    fn judge(&self, suspect: &Pictures, candidates: Option<&dyn Simulate>, alpha: f64) -> Diagnosis {
        self.judge_at_length(suspect, candidates, alpha, 4_000_000)
    }

    fn judge_at_length(
        &self,
        suspect: &Pictures,
        candidates: Option<&dyn Simulate>,
        alpha: f64,
        paths: u64,
    ) -> Diagnosis {
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
            effort: Effort { paths, ..Effort::default() },
        };
        diagnose(&case, Progress::NONE)
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

/// Hands in members on their scenes: as terms or as the whole image alone, with or without errors. Of the image alone much less can
/// be seen, so that its nightly test takes more samples, and more paths for the candidates.
fn hand_in(members: &[&'static Bug], terms: bool, errors: bool, more: u32) -> Vec<Answer> {
    let mut stages: Vec<Stage> = members.iter().map(|b| b.exposed_by).collect();
    stages.dedup();
    let mut seen: Vec<Stage> = vec![];
    stages.retain(|s| {
        !seen.contains(s) && {
            seen.push(*s);
            true
        }
    });
    let mut answers = vec![];
    for stage in stages {
        let bench = Bench::new(stage, 4096);
        let candidates = Members::new(&bench.scene, K, 0, Progress::NONE);
        for bug in members.iter().filter(|b| b.exposed_by == stage) {
            let render = zoo::render(bug, &bench.scene, &settings(more * bug.spp.max(64), 77), Progress::NONE);
            let mut suspect = Pictures::of(&render, SIZE);
            if !terms {
                suspect = suspect.only(|s| s == Slot::Whole);
            }
            if !errors {
                suspect = without_errors(suspect);
            }
            let paths = if more > 8 { 24_000_000 } else { 4_000_000 };
            let d = bench.judge_at_length(&suspect, Some(&candidates), 1e-3, paths);
            let names: Vec<&str> = d.suspects.iter().map(|s| s.name.as_str()).collect();
            let points = d.suspects.iter().any(|s| s.basis == Basis::Points);
            // the mean of same-numbers is right, and so is the sum of what has no blind scene: this data cannot show it
            let right = if bug.name == "same-numbers" || (!terms && bug.blind.is_none()) {
                d.verdict == Verdict::Correct
            } else {
                d.verdict == Verdict::Wrong && names.contains(&bug.name) && names.len() <= 3
            };
            let mut line =
                format!("{} {:<26} {:<16} {:?}", if right { ' ' } else { '!' }, bug.name, stage.label, names);
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

/// Every renderer of this program that is right.
fn right_renderers(scene: &Scene, seed: u64) -> Vec<(String, Pictures)> {
    let base = settings(64, seed);
    let with = |technique, sampling| Settings { technique, sampling, ..base.clone() };
    // whoever does not see all light says so, and is no right renderer of the scene
    let terms = |e, s: &Settings| {
        let render = by_rays::terms(scene, e, s, Progress::NONE);
        render.series.unsampled.is_empty().then(|| Pictures::of(&render, SIZE))
    };
    let mut all: Vec<(String, Option<Pictures>)> = vec![];
    for e in [
        Estimator::Prefix,
        Estimator::Single,
        Estimator::Light,
        Estimator::Bidirectional,
        Estimator::Branching { children: 2 },
    ] {
        let s = if e == (Estimator::Branching { children: 2 }) {
            Settings { spp: 8, ..base.clone() }
        } else {
            base.clone()
        };
        all.push((e.to_string(), terms(e, &s)));
    }
    for t in [Technique::Scatter, Technique::Connect, Technique::Power] {
        all.push((format!("prefix, {t}"), terms(Estimator::Prefix, &with(t, Sampling::Bsdf))));
    }
    all.push(("uniform directions".into(), terms(Estimator::Prefix, &with(Technique::Mis, Sampling::Uniform))));
    let albedo = Settings { roulette: Roulette::Albedo { from: 2 }, ..base.clone() };
    all.push(("roulette".into(), terms(Estimator::Prefix, &albedo)));
    let path = by_rays::path(scene, &base, Progress::NONE);
    all.push(("path tracer".into(), Some(Pictures::of(&path, SIZE))));
    all.into_iter().filter_map(|(name, p)| Some((name, p?))).collect()
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
            let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(32, seed), Progress::NONE);
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
    let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(256, account.seed()), Progress::NONE);
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
        let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(256, 6), Progress::NONE);
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
    let render = by_rays::terms(&bench.scene, Estimator::Prefix, &settings(64, 7), Progress::NONE);
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

// The command line.

struct Said {
    code: i32,
    out: String,
    err: String,
}

fn run(desk: &tempfile::TempDir, line: &str) -> Said {
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    let output = command.args(line.split_whitespace()).current_dir(desk.path()).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let said = Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) };
    assert!(!said.err.contains("panicked"), "{line}: {}", said.err);
    assert!(!said.out.contains("\n\n\n"), "{line}: two blank lines in a row\n{}", said.out);
    for l in said.out.lines().filter(|l| !l.starts_with("fredholm ") && !l.trim_start().starts_with('"')) {
        assert!(l.chars().count() <= 100, "{l}");
    }
    said
}

/// Writes layers as an EXR.
fn write_exr(desk: &tempfile::TempDir, name: &str, [w, h]: [usize; 2], layers: &[(&str, &[[f32; 3]])]) {
    use fredholm::report::image::exr;
    let layers: Vec<exr::Layer> = layers.iter().map(|&(name, pixels)| exr::Layer { name, pixels }).collect();
    exr::write(&desk.path().join(name), w, h, &layers, &[]).unwrap();
}

const QUICK: &str = "--spp 256 --paths 400000 -q";

#[test]
fn the_command_says_correct_or_names_the_mistake() {
    let desk = tempfile::TempDir::new().unwrap();
    let scene = Scene::new(&Stage::CORNELL.load([16, 16]).unwrap());
    let s = Settings { spp: 256, seed: 9, max_bounces: 3, ..Settings::default() };
    let s = Settings { roulette: Roulette::Albedo { from: 2 }.after(3), ..s };
    let good = by_rays::terms(&scene, Estimator::Prefix, &s, Progress::NONE);
    let bad = zoo::render(zoo::find("missing-pi-connection").unwrap(), &scene, &s, Progress::NONE);
    for (file, render) in [("good.exr", &good), ("bad.exr", &bad)] {
        let names: Vec<String> = (0..4).map(|k| format!("T{k:02}")).collect();
        let mut layers: Vec<(&str, &[[f32; 3]])> = vec![("", &render.total.mean)];
        layers.extend(names.iter().zip(&render.terms).map(|(n, t)| (n.as_str(), t.mean.as_slice())));
        write_exr(&desk, file, [16, 16], &layers);
    }
    let said = run(&desk, &format!("diagnose good.exr --against cornell -o a {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("good.exr: correct, as far as this data can tell"), "{}", said.out);
    assert!(
        said.out.contains("A uniform bias") && said.out.contains("cannot show samples that repeat"),
        "{}",
        said.out
    );

    let said = run(&desk, &format!("diagnose bad.exr --against cornell -o b {QUICK}"));
    assert_eq!(said.code, 1, "{}{}", said.out, said.err);
    assert!(said.out.starts_with("bad.exr: wrong: missing-pi-connection"), "{}", said.out);
    for file in ["diagnosis.png", "diagnosis.svg", "diagnosis.json", "summary.json"] {
        assert!(desk.path().join("b").join(file).is_file(), "{file}");
    }
    let svg = std::fs::read_to_string(desk.path().join("b/diagnosis.svg")).unwrap();
    assert!(svg.contains("missing-pi-connection") && svg.contains("scene cornell"));

    // several files: a table, and the same numbers for any number of threads
    let line = format!("diagnose good.exr bad.exr --against cornell {QUICK}");
    let said = run(&desk, &format!("{line} -o c -t 1"));
    assert_eq!(said.code, 1);
    assert!(said.out.contains("1 of 2 are wrong") && said.out.contains("data can tell: bias < "), "{}", said.out);
    let json = run(&desk, &format!("{line} --json -o c -t 2"));
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    assert_eq!(json[1]["diagnosis"]["suspects"][0]["name"], "missing-pi-connection");
    assert_eq!(json[0]["diagnosis"]["verdict"], "correct");
    let stored = std::fs::read_to_string(desk.path().join("c/diagnosis.json")).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&stored).unwrap(), json);

    // terms in files of their own, and 8 bits of unknown exposure
    for (k, t) in good.terms.iter().enumerate() {
        write_exr(&desk, &format!("T{k:02}.exr"), [16, 16], &[("", t.mean.as_slice())]);
    }
    let said = run(&desk, &format!("diagnose T00.exr T01.exr T02.exr T03.exr --against cornell -o d {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("the terms of one render"), "{}", said.out);
    let developed = fredholm::report::image::picture::develop(16, 16, &good.total.mean, 2.0);
    developed.picture.write(&desk.path().join("good.png")).unwrap();
    let said = run(&desk, &format!("diagnose good.png --against cornell -o e {QUICK}"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("exposure unknown") && said.out.contains("end of 8 bits"), "{}", said.out);
}

#[test]
fn growing_samples_show_what_one_picture_cannot() {
    let desk = tempfile::TempDir::new().unwrap();
    let scene = Scene::new(&Stage::CORNELL.load(SIZE).unwrap());
    for (name, bug) in [("same", Some("same-numbers")), ("gamma", Some("gamma-before-mean")), ("right", None)] {
        for spp in [16, 64, 256] {
            let s = settings(spp, 40 + u64::from(spp) * u64::from(bug != Some("same-numbers")));
            let render = match bug {
                Some(bug) => zoo::render(zoo::find(bug).unwrap(), &scene, &s, Progress::NONE),
                None => by_rays::path(&scene, &s, Progress::NONE),
            };
            write_exr(&desk, &format!("{name}_{spp}.exr"), [24, 24], &[("", render.total.mean.as_slice())]);
        }
        let files = [16, 64, 256].map(|n| format!("{name}_{n}.exr")).join(" ");
        let said = run(&desk, &format!("diagnose {files} --against cornell -o {name} {QUICK}"));
        assert!(said.out.contains("growing samples per pixel"), "{}", said.out);
        match bug {
            Some(bug) => {
                assert_eq!(said.code, 1, "{}", said.out);
                assert!(said.out.lines().next().unwrap().contains(bug), "{}", said.out);
            }
            None => assert_eq!(said.code, 0, "{}", said.out),
        }
    }
}

/// Inside a sphere nothing depends on its radius: only what is wrong in its measures does.
#[test]
fn a_larger_scene_shows_mixed_measures() {
    let desk = tempfile::TempDir::new().unwrap();
    let mixed = zoo::find("mixed-measures").unwrap();
    for (radius, stage) in [(1, Stage::SPHERE), (10, Stage::LARGE_SPHERE)] {
        let scene = Scene::new(&stage.load([16, 16]).unwrap());
        let s = Settings { max_bounces: 3, ..settings(256, 20 + radius) };
        let wrong = zoo::render(mixed, &scene, &s, Progress::NONE);
        let right = zoo::render_right(mixed, &scene, &s, Progress::NONE);
        for (name, render) in [("wrong", &wrong), ("right", &right)] {
            write_exr(&desk, &format!("{name}{radius}.exr"), [16, 16], &[("T01", render.terms[1].mean.as_slice())]);
        }
    }
    let lengths = "lengths enter where they must cancel";
    // no candidates: what the two scales say by themselves
    let few = "--spp 256 --paths 1 -q --json";
    let names = |said: &Said| {
        let json: serde_json::Value = serde_json::from_str(&said.out).unwrap();
        let list = json[0]["diagnosis"]["suspects"].as_array().unwrap().clone();
        list.iter().map(|s| s["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let said = run(&desk, &format!("diagnose wrong1.exr --scale 10=wrong10.exr --against sphere -o a {few}"));
    assert_eq!(said.code, 1, "{}", said.err);
    assert!(said.out.contains(lengths) && names(&said).contains(&"mixed-measures".into()), "{}", said.out);
    let said = run(&desk, &format!("diagnose right1.exr --scale 10=right10.exr --against sphere -o b {few}"));
    assert_eq!(said.code, 0, "{}", said.out);
    assert!(!said.out.contains(lengths) && names(&said).is_empty(), "{}", said.out);
    // the right picture, beside a large one that is not
    let said = run(&desk, &format!("diagnose right1.exr --scale 10=wrong10.exr --against sphere -o c {few}"));
    assert_eq!(said.code, 1, "{}", said.err);
    assert_eq!(names(&said), ["mixed-measures"], "{}", said.out);
    assert!(said.out.contains(lengths), "{}", said.out);
}

/// A lamp close below the ceiling that shines upwards, too: its light lies in few pixels, and is in no other renderer.
#[test]
fn too_few_pixels_are_said_to_be_too_few() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let behind = zoo::find("light-from-behind").unwrap();
    let render = |mistake: bool| {
        let s = settings(512, 31);
        let make = if mistake { zoo::render } else { zoo::render_right };
        without_errors(Pictures::of(&make(behind, &bench.scene, &s, Progress::NONE), SIZE))
    };
    // this light comes through few pixels: if that is too few to decide, it is said
    let d = bench.judge(&render(true), None, 1e-6);
    assert!(d.verdict == Verdict::Wrong || !d.undecided.is_empty(), "{:?}", d.evidence.ratios);
    let d = bench.judge(&render(false), None, 1e-6);
    assert_eq!(d.verdict, Verdict::Correct, "{}", d.worst);
    // one firefly, as bright as half of all pixels together, decides nothing, and that is said
    let mut one = render(false).only(|s| s == Slot::Term(1));
    one.layers[0].mean[40] = [10.0; 3];
    let d = bench.judge(&one, None, 1e-6);
    assert_eq!((d.verdict, d.undecided.as_slice()), (Verdict::Correct, &[Slot::Term(1)][..]), "{}", d.p);
}

/// A lamp of few pixels: it is seen that it is missing, with its term and in the whole image.
#[test]
fn a_small_lamp_is_missed() {
    let bench = Bench::new(Stage::CORNELL, 1024);
    let missing = zoo::find("emission-missing").unwrap();
    let render = zoo::render(missing, &bench.scene, &settings(64, 32), Progress::NONE);
    let all = without_errors(Pictures::of(&render, SIZE));
    for part in [all.clone(), all.only(|s| s == Slot::Whole)] {
        let d = bench.judge(&part, None, 1e-6);
        assert_eq!(d.verdict, Verdict::Wrong, "{:?} {}", d.evidence.ratios, d.p);
    }
    // black alone does not tell how many samples saw nothing
    let d = bench.judge(&all.only(|s| s == Slot::Term(0)), None, 1e-6);
    assert_eq!((d.verdict, d.undecided.as_slice()), (Verdict::Correct, &[Slot::Term(0)][..]));
}

#[test]
fn bad_input_is_refused_in_words() {
    let desk = tempfile::TempDir::new().unwrap();
    let grey = vec![[0.5f32; 3]; 64];
    write_exr(&desk, "small.exr", [8, 8], &[("", &grey)]);
    write_exr(&desk, "wide.exr", [16, 4], &[("", &grey)]);
    write_exr(&desk, "tiny.exr", [2, 2], &[("", &grey[..4])]);
    write_exr(&desk, "albedo.exr", [8, 8], &[("albedo", &grey), ("normal", &grey)]);
    std::fs::write(desk.path().join("text.png"), "not an image").unwrap();
    std::fs::write(desk.path().join("cut.exr"), [0x76, 0x2f, 0x31, 0x01, 2, 0]).unwrap();
    std::fs::create_dir(desk.path().join("empty")).unwrap();
    for (line, code, said) in [
        ("diagnose --against cornell", 2, "required arguments were not provided"),
        ("diagnose small.exr", 2, "--against"),
        ("diagnose small.exr --against cornell --alpha 2", 2, "`2` is not between 0 and 1"),
        ("diagnose small.exr --against cornell --gain -1", 2, "unexpected argument '-1'"),
        ("diagnose small.exr --against cornell --gain=-1", 2, "`-1` is not a number from 0 on"),
        ("diagnose small.exr --against cornell --scale 10", 2, "`10` is not SCALE=FILE"),
        ("diagnose small.exr wide.exr --as bounces --against cornell", 2, "do not end in numbers"),
        ("diagnose nowhere.exr --against cornell", 3, "check the name, or render it first"),
        ("diagnose text.png --against cornell", 3, "not a readable image"),
        ("diagnose cut.exr --against cornell", 3, "not a readable OpenEXR file"),
        ("diagnose albedo.exr --against cornell", 3, "no layer is a term or a whole image: albedo, normal"),
        ("diagnose tiny.exr --against cornell", 3, "too few to tell a bias from noise"),
        ("diagnose wide.exr --against cornell", 3, "has not the shape of the scene's"),
        ("diagnose small.exr --scale 10=wide.exr --against cornell", 3, "different sizes, 16×4 and 8×8"),
        ("diagnose small.exr --against corneII", 3, "corneII"),
        ("diagnose small.exr --against empty", 3, "summary.json"),
    ] {
        let answer = run(&desk, line);
        assert_eq!(answer.code, code, "{line}: {}", answer.err);
        assert!(answer.err.contains(said), "{line}: {}", answer.err);
        assert!(answer.out.is_empty() && !desk.path().join("fredholm-out").exists(), "{line}");
        assert!(code == 2 || answer.err.contains("help: "), "{line}: {}", answer.err);
    }
}
