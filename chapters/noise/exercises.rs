//! Exercises of chapter 13 that the program judges.
//!
//! ```text
//! h(N₂) = h(N₁) √(N₁/N₂)      N = (1 − p)/(p r²)      E[min(L_N, 1)] = 1 − (1 − p)^N      m = (n₁ m₁ + n₂ m₂)/(n₁ + n₂)
//! ```
//!
//! | symbol | meaning | exercise |
//! |---|---|---|
//! | h | half width of a 95 % interval | 13.1 |
//! | p, r | probability that a path finds the lamp; relative error of a pixel | 13.2 |
//! | L_N | pixel of N paths, each v with probability p, else 0; v ≥ N, and 1 is white | 13.3 |
//! | n, m | paths and mean of a run | 13.4 |

use fredholm::report::exercise::{Exercise, Mistake, RADIANCE, Result, Student, Task, Unit};
use fredholm::report::text::measured::Number;
use fredholm::report::text::number::significant;
use fredholm::stats::half_width_95;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[MORE_PATHS, ENOUGH_PATHS, SHOWN, TWO_RUNS];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

const MORE_PATHS: Exercise = Exercise {
    number: 1,
    title: "the error with more paths",
    question: |s| {
        let (few, many) = paths(s);
        format!(
            "The command\n  {}\nprints the mean of the term k = 1 with its ± 95 %. With {few} paths per pixel this half \
             width is {} W/(m² sr) on average. Which half width do you expect with {many} paths per pixel? Give three \
             digits, in W/(m² sr). Then check with --spp {many} and several seeds, --seed 1, 2, 3: what is printed comes \
             from 16 replicates, so it has an error of about 20 % of its own.",
            command(few),
            significant(half_width(few), 3)
        )
    },
    task: Task::Number {
        unit: RADIANCE,
        margin: 0.02,
        truth: |s| exact(half_width(paths(s).1)),
        mistakes: |s| {
            let (few, many) = paths(s);
            let (h, times) = (half_width(few), f64::from(many) / f64::from(few));
            vec![
                Mistake { value: h / times, says: "The variance falls like 1/N. The error is its square root." },
                Mistake { value: h, says: "This is the error with the smaller number of paths." },
                Mistake { value: h * times.sqrt(), says: "More paths give a smaller error, not a larger one." },
            ]
        },
    },
    hint: "The variance of a mean of N independent paths is σ²/N. Take the square root.",
    solution: |s| {
        let (few, many) = paths(s);
        format!(
            "The error falls like 1/√N. So {} · √({few}/{many}) = {}.",
            significant(half_width(few), 3),
            significant(half_width(many), 3)
        )
    },
};

fn paths(s: &Student) -> (u32, u32) {
    let few = s.pick("13.1 paths", &[16, 32, 48, 64, 80]);
    (few, few * s.pick("13.1 times", &[3, 5, 6, 8, 10]))
}

fn command(spp: u32) -> String {
    format!("fredholm series sphere --worlds terms --technique scatter --max-bounces 1 --size 32x32 --spp {spp}")
}

/// Half width for the mean of 32 × 32 pixels: X is ρ = 0.6 with the probability p = 0.1, else 0.
fn half_width(spp: u32) -> f64 {
    let (rho, p) = (0.6, 0.1f64);
    half_width_95(rho * (p * (1.0 - p) / (1024.0 * f64::from(spp))).sqrt(), 16)
}

const ENOUGH_PATHS: Exercise = Exercise {
    number: 2,
    title: "paths for a given relative error",
    question: |s| {
        let (odds, r) = lamp(s);
        format!(
            "A path finds the lamp with probability p = 1/{}; its value is then v, else 0. How many independent paths per \
             pixel are needed until the standard error of the pixel is {} % of its mean? Give a whole number.",
            odds + 1,
            100.0 * r
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| {
            let (odds, r) = lamp(s);
            exact((f64::from(odds) / (r * r)).round())
        },
        mistakes: |s| {
            let (odds, r) = lamp(s);
            let odds = f64::from(odds);
            vec![
                Mistake {
                    value: (odds / r).round(),
                    says: "The error falls like 1/√N: the relative error is squared.",
                },
                Mistake {
                    value: ((odds + 1.0) / (r * r)).round(),
                    says: "This uses E[X²] = p v² for the variance. Subtract the square of the mean, (p v)².",
                },
                Mistake {
                    value: (1.0 / (r * r)).round(),
                    says: "This holds for σ equal to the mean. Here σ²/mean² is (1 − p)/p.",
                },
            ]
        },
    },
    hint: "The variance of one path is p(1 − p)v², its mean is p v.",
    solution: |s| {
        let (odds, r) = lamp(s);
        format!(
            "σ²/mean² = p(1 − p)v²/(p v)² = (1 − p)/p = {odds}. The relative error of N paths is √({odds}/N). It is {r} for \
             N = {odds}/{r}² = {}.",
            (f64::from(odds) / (r * r)).round()
        )
    },
};

/// (1 − p)/p, and the relative error.
fn lamp(s: &Student) -> (u32, f64) {
    (s.pick("13.2 lamp", &[4, 9, 19, 49, 99]), s.pick("13.2 error", &[0.01, 0.02, 0.05, 0.1, 0.2]))
}

const SHOWN: Exercise = Exercise {
    number: 3,
    title: "the mean that a screen shows",
    question: |s| {
        let (p, v, n) = pixel(s);
        format!(
            "Every pixel of an image is the mean of {n} paths. A path has the value {v} with probability {p}, else 0. The \
             screen shows values up to 1 and clips the rest to 1. What is the expected value of a pixel as it is shown? Give \
             three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (p, _, n) = pixel(s);
            exact(1.0 - (1.0 - p).powi(n))
        },
        mistakes: |s| {
            let (p, v, _) = pixel(s);
            let mean = p * f64::from(v);
            let mut all = vec![
                Mistake { value: mean, says: "This is the mean of the pixel before it is clipped." },
                Mistake { value: p, says: "This is the mean shown with one path per pixel." },
            ];
            if mean > 1.0 {
                all.push(Mistake {
                    value: 1.0,
                    says: "This is the clipped mean. Clip the pixel first, then take its mean.",
                });
            }
            all
        },
    },
    hint: "One path that finds the light already makes the pixel at least 1. What is the probability that none does?",
    solution: |s| {
        let (p, v, n) = pixel(s);
        format!(
            "One path with the value {v} makes the pixel {v}/{n} = {}, which is above 1 and is shown as 1. Without such a path \
             it is 0. So the mean shown is the probability of at least one: 1 − (1 − {p})^{n} = {}. The true mean is {}.",
            significant(f64::from(v) / f64::from(n), 3),
            significant(1.0 - (1.0 - p).powi(n), 3),
            significant(p * f64::from(v), 3)
        )
    },
};

/// p, v, and N ≤ v.
fn pixel(s: &Student) -> (f64, u32, i32) {
    let p = s.pick("13.3 probability", &[0.05, 0.08, 0.12, 0.15, 0.2]);
    (p, s.pick("13.3 value", &[11, 14, 18, 24, 30]), s.pick("13.3 paths", &[2, 3, 4, 6, 8]))
}

const TWO_RUNS: Exercise = Exercise {
    number: 4,
    title: "two runs of different length",
    question: |s| {
        let ([n, l], [a, b]) = runs(s);
        format!(
            "Two computers rendered the same pixel from independent random numbers. {n} paths gave the mean {a}, {l} paths \
             gave the mean {b}. What is the mean of all {} paths together? Give three digits.",
            n + l
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.005,
        truth: |s| exact(weighted(s, |n| n)),
        mistakes: |s| {
            let ([n, l], [a, b]) = runs(s);
            let (n, l) = (f64::from(n), f64::from(l));
            vec![
                Mistake {
                    value: (a + b) / 2.0,
                    says: "The plain average gives a path of the short run more weight than one of the long run.",
                },
                Mistake { value: (l * a + n * b) / (n + l), says: "The weights are exchanged." },
                Mistake {
                    value: weighted(s, f64::sqrt),
                    says: "The weights are 1/variance, which grows like n, not like √n.",
                },
            ]
        },
    },
    hint: "Add all light and divide by all paths.",
    solution: |s| {
        let ([n, l], [a, b]) = runs(s);
        let mean = significant(weighted(s, |n| n), 3);
        format!(
            "All light is {n} · {a} + {l} · {b}. Divided by all {} paths it is {mean}. The weights are proportional to the \
             numbers of paths.",
            n + l
        )
    },
};

fn runs(s: &Student) -> ([u32; 2], [f64; 2]) {
    let n = s.pick("13.4 paths", &[[4, 64], [16, 48], [10, 90], [8, 120], [25, 100]]);
    (n, s.pick("13.4 means", &[[0.5, 0.3], [0.2, 0.28], [0.9, 0.6], [0.44, 0.3], [0.1, 0.16]]))
}

/// Σ w(n) m/Σ w(n).
fn weighted(s: &Student, weight: fn(f64) -> f64) -> f64 {
    let (n, [a, b]) = runs(s);
    let [v, w] = n.map(|n| weight(f64::from(n)));
    (v * a + w * b) / (v + w)
}
