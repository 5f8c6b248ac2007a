//! Diagnosis: every member of the zoo is named or stands on a short list, what is right is called right, and bad input is
//! refused in words.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "diagnosis/command.rs"]
mod command;
mod common;
#[path = "diagnosis/files.rs"]
mod files;
#[path = "diagnosis/levels.rs"]
mod levels;
#[path = "diagnosis/members.rs"]
mod members;
#[path = "diagnosis/strangers.rs"]
mod strangers;
#[allow(dead_code, unreachable_pub)]
#[path = "diagnosis/tracer/mod.rs"]
mod tracer;

use common::ledger;
use fredholm::diagnosis::candidates::{Members, own_seed};
use fredholm::diagnosis::{
    Case, Code, Conclusion, Diagnosis, Effort, Layer, Pictures, Seen, Simulate, Slot, diagnose, regions,
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
    seen: Seen,
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
            factor: 1,
            reference: &self.right,
            reference_spp: 1024.0,
            seen: &self.seen,
            by_samples: &[],
            scaled: None,
            candidates,
            alpha,
            gain: if suspect.code.for_display() { None } else { Some(1.0) },
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
            let names: Vec<&str> = d.named().map(|s| s.name.as_str()).collect();
            // the mean of same-numbers is right, and so is the sum of what has no blind scene: this data cannot show it
            let right = if bug.name == "same-numbers" || (!terms && bug.blind.is_none()) {
                d.verdict == Conclusion::Correct
            } else {
                d.verdict == Conclusion::Wrong && d.named().any(|s| s.is(bug.name)) && names.len() <= 3
            };
            let mut line =
                format!("{} {:<26} {:<16} {:?}", if right { ' ' } else { '!' }, bug.name, stage.label, names);
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
