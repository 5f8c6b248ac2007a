//! Exercises of chapter 16 that the program judges.
//!
//! ```text
//! m^(2k)          ρ^(K+1) ≤ 0.01          (1 − p)^N ≤ 0.01          ½ (R_s² + R_p²),  R_s R_p
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | m, k | points of a grid for each number; the term T^k E | [`grid`] |
//! | ρ, K | albedo of a furnace; the last term | [`last_term`] |
//! | p, N | probability of an event in one sample; samples | [`samples`] |
//! | R_s, R_p | reflectance of the two polarisations | [`polarised`] |
//!
//! Reference: the text of the chapter.

use super::polarisation;
use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, Student, Task, Unit};
use fredholm::report::text::number::{count, significant};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[
    Exercise {
        number: 1,
        title: "a grid for T^k E",
        question: |s| {
            let Grid { m, most, .. } = grid(s);
            format!(
                "Each reflection of a path takes two numbers. A grid has m = {m} values for each number, so that T E takes {} points. \
                 You can afford {} points. What is the largest k for which the grid of T^k E is affordable?",
                m * m,
                count(most)
            )
        },
        task: Task::Number {
            unit: Unit::Count,
            margin: 0.0,
            truth: |s| Ok(exact(f64::from(grid(s).k))),
            mistakes: |s| {
                let k = f64::from(grid(s).k);
                vec![
                    Mistake { value: 2.0 * k, says: "This counts the numbers. Each reflection takes two of them." },
                    Mistake { value: k + 1.0, says: "For this k the grid has more points than you can afford." },
                ]
            },
        },
        hint: "A grid in D dimensions has m^D points, and T^k E has D = 2k dimensions.",
        solution: |s| {
            let Grid { m, k, most } = grid(s);
            format!(
                "T^k E is an integral over 2k numbers, so the grid has {m}^(2k) points. For k = {k} these are {}, which is at most {}. For \
                 k = {} they are {}, which is more. The answer is {k}.",
                count(m.pow(2 * k)),
                count(most),
                k + 1,
                count(m.pow(2 * k + 2))
            )
        },
    },
    Exercise {
        number: 2,
        title: "bounces for 1 %",
        question: |s| {
            let rho = albedo(s);
            format!(
                "Run `fredholm series furnace --set 'materials.wall.reflectance=[{rho}, {rho}, {rho}]' --max-bounces 8 --spp 4` and read \
                 the ratio of the terms in the column `norm of the matrix`. All later terms have the same ratio. What is the smallest K \
                 for which the terms k = 0, …, K together miss at most 1 % of all light?"
            )
        },
        task: Task::Number {
            unit: Unit::Count,
            margin: 0.0,
            truth: |s| Ok(exact(last_term(albedo(s)))),
            mistakes: |s| {
                let rho = albedo(s);
                vec![
                    Mistake {
                        value: last_term(rho) + 1.0,
                        says: "This is the number of terms. The first of them has k = 0.",
                    },
                    Mistake {
                        value: (0.01f64.ln() / rho.ln() + (1.0 - rho).ln() / rho.ln()).ceil() - 1.0,
                        says: "This K makes the remainder 1 % of E. All light is 1/(1 − ρ) times E.",
                    },
                ]
            },
        },
        hint: "The remainder after the term K is ρ^(K+1) times all light.",
        solution: |s| {
            let rho = albedo(s);
            let k = last_term(rho);
            format!(
                "The ratio is ρ = {rho}. The remainder after K is ρ^(K+1)/(1 − ρ), all light is 1/(1 − ρ), so the missing part is ρ^(K+1). \
                 From {rho}^(K+1) ≤ 0.01 follows K + 1 ≥ ln 0.01/ln {rho} = {:.2}, so K = {k}.",
                0.01f64.ln() / rho.ln()
            )
        },
    },
    Exercise {
        number: 3,
        title: "samples that miss an event",
        question: |s| {
            let (p, n) = (event(s), length(s));
            format!(
                "A random direction hits a lamp with the probability p = {p}. What is the probability that {n} independent directions \
                 all miss it? Give three digits."
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.02,
            truth: |s| Ok(exact(missed(s))),
            mistakes: |s| {
                let (p, n) = (event(s), length(s));
                vec![
                    Mistake { value: 1.0 - missed(s), says: "This is the probability of at least one hit." },
                    Mistake { value: p * n, says: "This is the expected number of hits." },
                ]
            },
        },
        hint: "One direction misses with the probability 1 − p, and all of them are independent.",
        solution: |s| {
            let (p, n) = (event(s), length(s));
            format!(
                "(1 − {p})^{n} = {}. About e^(−pN) = e^(−{}). To see the lamp at least once with a probability of 99 %, {} samples are needed.",
                significant(missed(s), 4),
                significant(p * n, 3),
                samples(p)
            )
        },
    },
    Exercise {
        number: 4,
        title: "two reflections with polarisation",
        question: |s| {
            format!(
                "Unpolarised light is reflected twice at glass of index n = {}, both times at Brewster's angle θ_B = arctan n and in the \
                 same plane of incidence. Which part of the radiance remains, if the renderer keeps track of polarisation? Give three \
                 digits. At Brewster's angle R_p = 0 and R_s = ((n² − 1)/(n² + 1))².",
                index(s)
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.02,
            truth: |s| {
                let n = index(s);
                Ok(exact(polarisation::twice(n, polarisation::brewster(n), polarisation::reflection).same))
            },
            mistakes: |s| {
                let r = polarised(index(s));
                vec![
                    Mistake {
                        value: 0.25 * r * r,
                        says: "This is F²: the second reflection was computed as if its light were unpolarised.",
                    },
                    Mistake {
                        value: r * r,
                        says: "This is the part that remains of light polarised perpendicular to the plane from the start.",
                    },
                    Mistake { value: 0.5 * r, says: "This is the part after one reflection." },
                ]
            },
        },
        hint: "Half of the light has each polarisation. Follow the two halves separately.",
        solution: |s| {
            let n = index(s);
            let r = polarised(n);
            format!(
                "R_s = {}. Half of the light is polarised perpendicular to the plane; R_s² of it remains. The other half is lost at \
                 the first reflection. So ½ R_s² = {} remains, twice as much as F² = (R_s/2)² = {}.",
                significant(r, 4),
                significant(0.5 * r * r, 4),
                significant(0.25 * r * r, 4)
            )
        },
    },
];

fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

/// The grid of a student.
struct Grid {
    m: u64,
    /// The largest k with m^(2k) ≤ `most`.
    k: u32,
    most: u64,
}

fn grid(s: &Student) -> Grid {
    let m: u64 = s.pick("16.1 points", &[4, 5, 6, 8, 10, 12, 16]);
    let most = s.pick("16.1 paths", &[1_000_000, 2_000_000, 5_000_000, 100_000_000, 200_000_000, 1_000_000_000]);
    let k = (0..).take_while(|&k| m.pow(2 * k + 2) <= most).count() as u32;
    Grid { m, k, most }
}

fn albedo(s: &Student) -> f64 {
    s.pick("16.2 albedo", &[0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95])
}

/// The smallest K with ρ^(K+1) ≤ 0.01.
fn last_term(rho: f64) -> f64 {
    (0.01f64.ln() / rho.ln()).ceil() - 1.0
}

fn event(s: &Student) -> f64 {
    s.pick("16.3 probability", &[0.001, 0.002, 0.003, 0.004, 0.005])
}

fn length(s: &Student) -> f64 {
    s.pick("16.3 samples", &[64.0, 100.0, 128.0, 200.0, 256.0])
}

/// (1 − p)^N.
fn missed(s: &Student) -> f64 {
    (1.0 - event(s)).powf(length(s))
}

/// The smallest N with (1 − p)^N ≤ 0.01.
fn samples(p: f64) -> f64 {
    (0.01f64.ln() / (1.0 - p).ln()).ceil()
}

fn index(s: &Student) -> f64 {
    s.pick("16.4 index", &[1.33, 1.4, 1.6, 1.7, 1.8, 1.9, 2.0])
}

/// R_s at Brewster's angle.
fn polarised(n: f64) -> f64 {
    ((n * n - 1.0) / (n * n + 1.0)).powi(2)
}
