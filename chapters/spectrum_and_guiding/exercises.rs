//! Exercises of chapter 15 that the program judges.
//!
//! ```text
//! Chebyshev: 2 qⁿ/(1 + q²ⁿ) ≤ 10^−d      two modes: a (λ₂/λ₁)^k < 0.01      p₁₃ = T₁₃ B₃/(T₁₂ B₂ + T₁₃ B₃)
//! ```
//!
//! | symbol | meaning | exercise |
//! |---|---|---|
//! | λ, d | all eigenvalues lie in [−λ, λ]; decimal digits to be gained | 15.1 |
//! | a, λ₁, λ₂ | parts of two modes in E, and their eigenvalues | 15.2 |
//! | T_ij, B_j | matrix of three patches, and its solution | 15.3 |
//! | ρ | albedo of the white walls of the Cornell box | 15.4 |

use super::RED;
use fredholm::engine::by_matrix;
use fredholm::operator::matrix::PatchOperator;
use fredholm::operator::modes::Modes;
use fredholm::progress::Progress;
use fredholm::report::exercise::{Exercise, Mistake, Result, Student, Task, Unit};
use fredholm::report::text::{measured::Number, number::significant};
use fredholm::scene::{Scene, load};
use fredholm::solver::{Chebyshev, Neumann};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[CHEBYSHEV, TWO_MODES, STEP, READ];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

const CHEBYSHEV: Exercise = Exercise {
    number: 1,
    title: "steps of Chebyshev's iteration",
    question: |s| {
        let (lambda, digits) = interval(s);
        format!(
            "All eigenvalues of T lie between −{lambda} and {lambda}. Which is the least number n of steps after which \
             Chebyshev's iteration guarantees an error 10^{digits} times smaller than at the start?"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| exact(chebyshev(s) as f64),
        mistakes: |s| {
            let (lambda, digits) = interval(s);
            vec![Mistake {
                value: (10f64.ln() * f64::from(digits) / (1.0 / lambda).ln()).ceil(),
                says: "These are the steps of Neumann's iteration, whose error falls like λⁿ. Chebyshev has q in place of λ.",
            }]
        },
    },
    hint: "c = (1 + λ)/(1 − λ) and q = (√c − 1)/(√c + 1). The error falls by 2 qⁿ/(1 + q²ⁿ), which is nearly 2 qⁿ.",
    solution: |s| {
        let (lambda, digits) = interval(s);
        let q = super::solvers::rate([-lambda, lambda]);
        format!(
            "c = {}, q = {}. 2 qⁿ ≤ 10^−{digits} gives n ≥ {}, so n = {}.",
            significant((1.0 + lambda) / (1.0 - lambda), 4),
            significant(q, 4),
            significant((2.0 * 10f64.powi(digits)).ln() / (1.0 / q).ln(), 4),
            chebyshev(s)
        )
    },
};

fn interval(s: &Student) -> (f64, i32) {
    s.pick("15.1 interval", &[(0.8, 3), (0.85, 4), (0.9, 4), (0.95, 3), (0.95, 6), (0.98, 4)])
}

/// The least n with a guaranteed error of at most 10^−d.
fn chebyshev(s: &Student) -> usize {
    let (lambda, digits) = interval(s);
    let bound = |n: &usize| Chebyshev::<PatchOperator<'_>>::bound([-lambda, lambda], *n) <= 10f64.powi(-digits);
    (1..10_000).find(bound).unwrap_or_default()
}

const TWO_MODES: Exercise = Exercise {
    number: 2,
    title: "when only the first mode is left",
    question: |s| {
        let (first, second, part) = modes(s);
        format!(
            "E = u₁ + {part} u₂ consists of two modes with ‖u₁‖ = ‖u₂‖ = 1 and the eigenvalues λ₁ = {first} and \
             λ₂ = {second}. Which is the least k for which the second mode in T^k E is smaller than 1 % of the first?"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| {
            let (first, second, part) = modes(s);
            exact(below(part, second / first))
        },
        mistakes: |s| {
            let (_, second, part) = modes(s);
            vec![Mistake {
                value: below(part, second),
                says: "You compared the second mode with the first mode in E. The first mode gets smaller, too.",
            }]
        },
    },
    hint: "In T^k E the first mode has the factor λ₁^k, the second one the factor λ₂^k. Divide.",
    solution: |s| {
        let (first, second, part) = modes(s);
        format!(
            "{part} · ({second}/{first})^k < 0.01 gives k > ln({}) / ln({}) = {}, so k = {}.",
            significant(0.01 / part, 3),
            significant(second / first, 4),
            significant((0.01 / part).ln() / (second / first).ln(), 4),
            below(part, second / first)
        )
    },
};

fn modes(s: &Student) -> (f64, f64, f64) {
    s.pick(
        "15.2 modes",
        &[(0.7, 0.5, 2.0), (0.8, 0.6, 3.0), (0.9, 0.7, 2.0), (0.66, 0.52, 1.5), (0.75, 0.45, 4.0), (0.85, 0.6, 0.5)],
    )
}

/// The least k with part · ratio^k < 0.01.
fn below(part: f64, ratio: f64) -> f64 {
    ((0.01 / part).ln() / ratio.ln()).floor() + 1.0
}

const STEP: Exercise = Exercise {
    number: 3,
    title: "the step of a walk without variance",
    question: |s| {
        let [t12, t13, t32] = matrix(s);
        format!(
            "A matrix of three patches has the entries T₁₂ = {t12}, T₁₃ = {t13} and T₃₂ = {t32}; all others are 0. Only \
             patch 2 emits, E₂ = 1. A walk starts on patch 1 and follows the exact map. With which probability is its \
             next patch 3? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Share,
        margin: 0.01,
        truth: |s| {
            let [t12, t13, t32] = matrix(s);
            exact(t13 * t32 / (t12 + t13 * t32))
        },
        mistakes: |s| {
            let [t12, t13, t32] = matrix(s);
            vec![
                Mistake {
                    value: t13 / (t12 + t13), says: "This follows T alone. The exact map multiplies T₁ⱼ by Bⱼ."
                },
                Mistake { value: t32 / (1.0 + t32), says: "This follows B alone. The step needs T₁ⱼ times Bⱼ." },
                Mistake { value: t13 * t32, says: "This is T₁₃ B₃. Divide by the sum over both patches." },
            ]
        },
    },
    hint: "First solve B = E + T B, from patch 2 backwards. Then p is proportional to T₁ⱼ Bⱼ.",
    solution: |s| {
        let [t12, t13, t32] = matrix(s);
        format!(
            "B₂ = 1, B₃ = {t32} and B₁ = {t12} + {t13} · {t32} = {}. The part of B₁ that comes through patch 3 is {}, so \
             p₁₃ = {}. The walk by way of patch 3 has the weight B₁/B₃ · B₃/B₂, the direct one B₁/B₂. Both are B₁: \
             every walk gives B₁.",
            significant(t12 + t13 * t32, 4),
            significant(t13 * t32, 3),
            significant(t13 * t32 / (t12 + t13 * t32), 4)
        )
    },
};

fn matrix(s: &Student) -> [f64; 3] {
    s.pick(
        "15.3 matrix",
        &[[0.2, 0.5, 0.6], [0.1, 0.6, 0.5], [0.3, 0.4, 0.8], [0.1, 0.7, 0.3], [0.2, 0.6, 0.4], [0.05, 0.5, 0.2]],
    )
}

const READ: Exercise = Exercise {
    number: 4,
    title: "the second mode after more bounces",
    question: |s| {
        let rho = white(s);
        format!(
            "Run\n  fredholm radiosity cornell --patches 60 --modes 2 --channel red \
             --set 'materials.white.reflectance=[{rho},{rho},{rho}]'\n\
             The table lists two modes, with their eigenvalues λ and their sizes at the bounce k = 4. Predict the size of \
             mode 2 divided by that of mode 1 at k = 12. Give two digits."
        )
    },
    task: Task::Number {
        unit: Unit::Share,
        margin: 0.02,
        truth: |s| {
            let [four, ratio, _] = read(white(s))?;
            exact(four * ratio.powi(8))
        },
        mistakes: |s| {
            let Ok([four, ratio, second]) = read(white(s)) else { return vec![] };
            vec![
                Mistake { value: four, says: "This is the ratio at k = 4. Eight more bounces follow." },
                Mistake { value: ratio.powi(8), says: "The two modes are not of the same size at k = 4." },
                Mistake { value: four * second.powi(8), says: "The first mode gets smaller, too." },
            ]
        },
    },
    hint: "From k = 4 to k = 12 each mode gets the factor λ⁸.",
    solution: |s| match read(white(s)) {
        Ok([four, ratio, _]) => format!(
            "At k = 4 the ratio is {}. Each bounce multiplies it by λ₂/λ₁ = {}. Eight bounces later it is {}.",
            significant(four, 3),
            significant(ratio, 4),
            significant(four * ratio.powi(8), 3)
        ),
        Err(error) => error.to_string(),
    },
};

fn white(s: &Student) -> f64 {
    s.pick("15.4 white", &[0.5, 0.6, 0.7, 0.8, 0.95])
}

/// Mode 2 over mode 1 at k = 4, |λ₂|/λ₁ and |λ₂|, of the Cornell box with white walls of this albedo.
fn read(rho: f64) -> Result<[f64; 3]> {
    let set = vec![format!("materials.white.reflectance=[{rho},{rho},{rho}]")];
    let room = load::scene("cornell", &load::Options { set, ..Default::default() })?.description;
    let matrix = by_matrix::dense_matrix(&room, &Scene::new(&room), 60, 1.0, 0, Progress::NONE)?;
    let (t, e) = (matrix.radiosity.operator(RED), matrix.radiosity.emission(RED));
    let leading = Modes::of(&t, 2).leading;
    let term: Vec<f64> = Neumann::new(&t, e).nth(4).ok_or("no term")?;
    let [first, second] = [0, 1].map(|j| t.weighted_inner(&leading[j].vector, &term).abs());
    let [a, b] = [0, 1].map(|j| leading[j].value.abs());
    Ok([second / first, b / a, b])
}
