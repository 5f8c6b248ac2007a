//! Exercises of chapter 14 that the program judges.
//!
//! ```text
//! P(some alarm) = 1 − (1 − α)^m      (z_α + z_β) cv/√n      r_k of a member of the zoo      n = ((z_α + z_β) cv/δ)²
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | α, β, m | level, probability of a miss, number of tests | [`pick_alpha`] |
//! | cv² = (4/3)^k − 1 | of a sample of T^k E in a furnace with uniform directions | [`samples_truth`] |

use super::signatures::{signature_of, words_of};
use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, Student, Task, Unit};
use fredholm::report::text::number::{plus_minus, significant};
use fredholm::stats::{critical, min_detectable, needed_samples};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[
    Exercise {
        number: 1,
        title: "false alarms of many tests",
        question: |s| {
            let (m, a) = family(s);
            format!(
                "A renderer is right. A script compares {m} of its images with references, by independent tests at the level \
                 α = {a}, without a correction. What is the probability that at least one test raises an alarm? Give three \
                 digits."
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.01,
            truth: |s| Ok(exact(some_alarm(s))),
            mistakes: |s| {
                let (m, a) = family(s);
                vec![
                    Mistake { value: 1.0 - some_alarm(s), says: "This is the probability of no alarm at all." },
                    Mistake { value: a, says: "This is the probability of a false alarm of one test." },
                    Mistake {
                        value: f64::from(m) * a,
                        says: "This is m α, the expected number of alarms: a bound of the probability, and not equal to it.",
                    },
                ]
            },
        },
        hint: "Compute first the probability that none of the tests raises an alarm.",
        solution: |s| {
            let (m, a) = family(s);
            format!(
                "One test raises no alarm with probability 1 − α = {}. All {m} raise none with probability (1 − α)^{m} = {}. \
                 So at least one does with probability {}.",
                1.0 - a,
                significant(1.0 - some_alarm(s), 4),
                significant(some_alarm(s), 4)
            )
        },
    },
    Exercise {
        number: 2,
        title: "the smallest bias that a test finds",
        question: |s| {
            let (cv, n, a, b) = plan(s);
            format!(
                "One sample of a renderer has the standard deviation σ = {cv} times the right value μ. A two-sided test at the \
                 level α = {a} uses n = {n} samples; μ is known. How large must a bias be, as a part of μ, so that the test \
                 finds it with probability {}? The quantiles are in the table of chapter 14. Give three digits.",
                1.0 - b
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.02,
            truth: |s| Ok(exact(smallest_bias(s))),
            mistakes: |s| {
                let (cv, n, a, b) = plan(s);
                let (z, miss, root) = (normal(a), normal(2.0 * b), f64::from(n).sqrt());
                vec![
                    Mistake {
                        value: z * cv / root,
                        says: "The term of β is missing. A bias of this size is found with probability 1/2.",
                    },
                    Mistake {
                        value: (z + miss) * cv,
                        says: "This is the bias that one sample would find: divide by √n.",
                    },
                    Mistake { value: (z + miss) * cv / f64::from(n), says: "The error falls as 1/√n, not as 1/n." },
                ]
            },
        },
        hint: "The standard error is σ/√n. The bias must exceed it (z_α + z_β) times.",
        solution: |s| {
            let (cv, n, a, b) = plan(s);
            format!(
                "The standard error is {cv} μ/√{n} = {} μ. The quantiles are z_α = {} and z_β = {}. The bias is their sum times \
                 the standard error: {} μ.",
                significant(cv / f64::from(n).sqrt(), 4),
                significant(normal(a), 4),
                significant(normal(2.0 * b), 4),
                significant(smallest_bias(s), 4)
            )
        },
    },
    Exercise {
        number: 3,
        title: "name the mistake",
        question: |s| match signature_of(suspect(s), s.seed()) {
            Ok(all) => {
                let text = |(k, r): (usize, &(f64, f64))| format!("r_{k} = {}", plus_minus(r.0, r.1, 1));
                let [terms @ .., whole] = all.as_slice() else { return String::new() };
                let terms: Vec<String> = terms.iter().enumerate().map(text).collect();
                format!(
                    "A renderer is compared with the right one in the Cornell box, term by term. The ratios of the image means \
                     are {}; the ratio of the whole images is {}. The errors are standard errors. Which member of the zoo is it?",
                    terms.join(", "),
                    plus_minus(whole.0, whole.1, 1)
                )
            }
            Err(e) => format!("The renderer cannot be measured: {e}"),
        },
        task: Task::Choice { words: &WORDS, truth: |s| Ok(suspect(s)), mistakes: &WHY },
        hint: "Is the ratio constant for k ≥ 1, or does it change by the same factor from each k to the next?",
        solution: |s| {
            let name = suspect(s);
            format!(
                "It is {name}: {}. Its signature is: {}. Compare with `fredholm zoo {name} --scene cornell`.",
                words_of(name)[0],
                words_of(name)[1]
            )
        },
    },
    Exercise {
        number: 4,
        title: "samples that a test needs",
        question: |s| {
            let (k, delta, a, b) = need(s);
            format!(
                "Run `fredholm series furnace --technique scatter --sampling uniform --max-bounces 4 --size 64x64 --spp 64` \
                 and read from its summary.json, for the term k = {k}: `mean`, and `variance`, which is the variance of one \
                 sample. A two-sided test at the level α = {a} shall find a bias of {} % of this term with probability {}. How \
                 many samples does it need? Give three digits.",
                100.0 * delta,
                1.0 - b
            )
        },
        task: Task::Number {
            unit: Unit::Plain,
            margin: 0.02,
            truth: |s| Ok(exact(samples_truth(s))),
            mistakes: |s| {
                let (k, delta, a, b) = need(s);
                let (z, cv) = (normal(a), spread(k));
                vec![
                    Mistake { value: (z * cv / delta).powi(2), says: "The term of β is missing." },
                    Mistake { value: samples_truth(s).sqrt(), says: "This is √n." },
                    Mistake {
                        value: ((z + normal(2.0 * b)) * cv * 0.5f64.powi(k) / delta).powi(2),
                        says: "The standard deviation must be divided by the mean of the term, because the bias is a part of it.",
                    },
                ]
            },
        },
        hint: "cv is the root of `variance`, divided by `mean`. Then solve (z_α + z_β) cv/√n = bias for n.",
        solution: |s| {
            let (k, delta, a, b) = need(s);
            format!(
                "Each reflection brings a factor 2 ρ cos θ, whose mean square is 4/3 of its squared mean. Without noise the file \
                 would thus give cv² = variance/mean² = (4/3)^{k} − 1 = {}. The quantiles are z_α = {} and z_β = {}. So \
                 n = ((z_α + z_β) cv/{delta})² = {:.0}.",
                significant(spread(k).powi(2), 4),
                significant(normal(a), 4),
                significant(normal(2.0 * b), 4),
                samples_truth(s)
            )
        },
    },
];

fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

/// z with P(|Z| ≥ z) = level.
fn normal(level: f64) -> f64 {
    critical(level, f64::INFINITY)
}

/// m and α.
fn family(s: &Student) -> (i32, f64) {
    (s.pick("14.1 tests", &[5, 8, 10, 16, 20, 24, 30, 40]), pick_alpha(s, "14.1 alpha"))
}

fn pick_alpha(s: &Student, key: &str) -> f64 {
    s.pick(key, &[0.02, 0.03, 0.04, 0.05, 0.1])
}

/// 1 − (1 − α)^m.
fn some_alarm(s: &Student) -> f64 {
    let (m, a) = family(s);
    1.0 - (1.0 - a).powi(m)
}

/// σ/μ, n, α, β.
fn plan(s: &Student) -> (f64, u32, f64, f64) {
    let n = s.pick("14.2 samples", &[400, 900, 1600, 2500, 6400, 10_000]);
    let cv = s.pick("14.2 spread", &[0.5, 0.8, 1.2, 1.5, 2.0, 3.0]);
    (cv, n, s.pick("14.2 alpha", &[0.05, 0.01, 0.001]), s.pick("14.2 beta", &[0.2, 0.1, 0.05, 0.01]))
}

fn smallest_bias(s: &Student) -> f64 {
    let (cv, n, a, b) = plan(s);
    min_detectable(cv / f64::from(n).sqrt(), f64::INFINITY, a, b)
}

/// k, δ, α, β.
fn need(s: &Student) -> (i32, f64, f64, f64) {
    let delta = s.pick("14.4 bias", &[0.005, 0.01, 0.02, 0.03, 0.04]);
    let k = s.pick("14.4 term", &[1, 2, 3]);
    (k, delta, s.pick("14.4 alpha", &[0.05, 0.01, 0.001]), s.pick("14.4 beta", &[0.2, 0.1, 0.05, 0.01]))
}

/// cv = √((4/3)^k − 1): a sample is the product of k factors 2 ρ cos θ with cos θ uniform between 0 and 1.
fn spread(k: i32) -> f64 {
    ((4.0f64 / 3.0).powi(k) - 1.0).sqrt()
}

fn samples_truth(s: &Student) -> f64 {
    let (k, delta, a, b) = need(s);
    needed_samples(spread(k), delta, a, b)
}

/// The members among which exercise 3 chooses.
const WORDS: [&str; 9] = [
    "double-emission",
    "missing-pi-connection",
    "missing-pi",
    "half-bounce",
    "roulette-unweighted",
    "roulette-weighted-twice",
    "roulette-before-light",
    "off-by-one",
    "emission-missing",
];

/// The member that a student must name.
fn suspect(s: &Student) -> &'static str {
    s.pick("14.3 member", &WORDS)
}

/// What another answer would look like.
const WHY: [(&str, &str); 9] = [
    ("double-emission", "It would give r_k = 2 for every k ≥ 1."),
    ("missing-pi-connection", "It would give r_k = π for every k ≥ 1."),
    ("missing-pi", "It would give r_k = π^k."),
    ("half-bounce", "It would give r_k = (1/2)^(k−1) for k ≥ 1."),
    ("roulette-unweighted", "It would give r_k = 0.7^(k−1) for k ≥ 1."),
    ("roulette-weighted-twice", "It would give r_k = 1.11^(k−1) for k ≥ 1."),
    ("roulette-before-light", "It would give r_k = 0.7 for every k ≥ 1."),
    ("off-by-one", "It would give r_0 = 0 and a whole image with the right mean."),
    ("emission-missing", "It would give r_0 = 0 and r_k = 1 for every k ≥ 1."),
];
