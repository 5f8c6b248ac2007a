//! Exercises of chapter 4 that the program judges.
//!
//! ```text
//! L = E/(1 − ρ)        missing after K: ρ^(K+1)        without the cosine: T^k E = (2ρ)^k        sphere: s = a ρ/(1 − ρ)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | E, ρ | emission and albedo of the walls | [`dim`], [`walls`] |
//! | K | the last term that is kept | [`last`] |
//! | s, a | reflected radiance in the sphere; the part of its area that emits 1 | [`reading`], [`CAP`] |

use fredholm::report::exercise::{Exercise, Mistake, RADIANCE, Student, Task, Unit};
use fredholm::report::text::{measured::Number, number::significant};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[
    Exercise {
        number: 1,
        title: "terms that a furnace needs",
        question: |s| {
            let rho = dim(s);
            format!(
                "All walls of a furnace emit 1 and have the albedo {rho}. What is the least K so that the sum of the \
                 terms k = 0, …, K lacks less than 1 % of all light? Predict K, then check it with\n\
                 `fredholm series furnace --set 'materials.wall.reflectance=[{rho},{rho},{rho}]' --max-bounces K`\n\
                 The share of the row `k > K` must be below 1 %."
            )
        },
        task: Task::Number {
            unit: Unit::Count,
            margin: 0.0,
            truth: |s| Ok(exact(f64::from(last(dim(s))))),
            mistakes: |s| {
                let k = f64::from(last(dim(s)));
                vec![
                    Mistake { value: k + 1.0, says: "This is the number of terms. The first one is k = 0." },
                    Mistake { value: k - 1.0, says: "After this term, 1 % or more is still missing." },
                ]
            },
        },
        hint: "The part that is missing after the term K is Σ ρ^k over k > K, divided by Σ ρ^k over all k.",
        solution: |s| {
            let (rho, k) = (dim(s), last(dim(s)));
            format!(
                "The missing part is ρ^(K+1). It is below 0.01 for K + 1 > ln 0.01/ln {rho} = {}, so K = {k}: {rho}^{} = {}.",
                significant(0.01f64.ln() / rho.ln(), 3),
                k + 1,
                significant(rho.powi(k + 1), 2)
            )
        },
    },
    Exercise {
        number: 2,
        title: "a furnace of two albedos",
        question: |s| {
            let (e, [a, b]) = walls(s);
            format!(
                "In a closed room the walls have the albedo {a}, the floor and the ceiling have the albedo {b}. The \
                 walls emit {e} W/(m² sr). How much must floor and ceiling emit, so that the same radiance leaves \
                 every point in every direction? Give three digits."
            )
        },
        task: Task::Number {
            unit: RADIANCE,
            margin: 0.01,
            truth: |s| {
                let (e, [a, b]) = walls(s);
                Ok(exact(e / (1.0 - a) * (1.0 - b)))
            },
            mistakes: |s| {
                let (e, [a, b]) = walls(s);
                vec![
                    Mistake {
                        value: e / (1.0 - a),
                        says: "This is the radiance that leaves every point. A part of it is reflected.",
                    },
                    Mistake { value: e, says: "With equal emission, the surface with the larger albedo is brighter." },
                    Mistake { value: e * (1.0 - a) / (1.0 - b), says: "The two albedos have changed places." },
                ]
            },
        },
        hint: "If the radiance L leaves every point, L arrives everywhere, and L = E + ρ L holds on each surface.",
        solution: |s| {
            let (e, [a, b]) = walls(s);
            let l = e / (1.0 - a);
            format!(
                "On the walls L = E + ρ L gives L = {e}/(1 − {a}) = {}. On floor and ceiling the same equation gives \
                 E = (1 − {b}) L = {} W/(m² sr).",
                four(l),
                four(l * (1.0 - b))
            )
        },
    },
    Exercise {
        number: 3,
        title: "the cosine is missing",
        question: |s| {
            format!(
                "A renderer samples directions uniformly, with the density 1/(2π), and forgets the cosine in f cos \
                 θ/p. Which radiance does it find in a furnace with E = 1 and the albedo {}? Give three digits.",
                small(s)
            )
        },
        task: Task::Number {
            unit: RADIANCE,
            margin: 0.01,
            truth: |s| Ok(exact(1.0 / (1.0 - 2.0 * small(s)))),
            mistakes: |s| {
                let rho = small(s);
                vec![
                    Mistake { value: 1.0 / (1.0 - rho), says: "This is what a right renderer finds." },
                    Mistake {
                        value: 2.0 / (1.0 - rho),
                        says: "The factor 2 belongs to every step, not to the result.",
                    },
                    Mistake {
                        value: 1.0 / (1.0 - 2.0 * rho / 3.0),
                        says: "This renderer has the cosine once too often, in directions of density cos θ/π.",
                    },
                ]
            },
        },
        hint: "Without the cosine, every step has the weight f/p, and f = ρ/π.",
        solution: |s| {
            let rho = small(s);
            format!(
                "Every step has the weight (ρ/π) · 2π = 2ρ = {}. So T^k E becomes (2ρ)^k, and the sum is 1/(1 − 2ρ) = {}.",
                four(2.0 * rho),
                four(1.0 / (1.0 - 2.0 * rho))
            )
        },
    },
    Exercise {
        number: 4,
        title: "the paint of an integrating sphere",
        question: |s| {
            format!(
                "A tenth of the area of an integrating sphere emits the radiance 1. The whole sphere has the same \
                 albedo, which is not known. The reflected radiance is measured: it is {} at every point. What is \
                 the albedo? Give three digits. Check your answer A with\n\
                 `fredholm series sphere --set 'materials.wall.reflectance=[A,A,A]'`\n\
                 The row `all` minus the row `0` must be the measured value.",
                reading(s)
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.01,
            truth: |s| Ok(exact(reading(s) / (CAP + reading(s)))),
            mistakes: |s| {
                let r = reading(s);
                vec![
                    Mistake { value: r / (1.0 + r), says: "Only a tenth of the sphere emits." },
                    Mistake { value: CAP / (CAP + r), says: "This is 1 − ρ." },
                ]
            },
        },
        hint: "The mean emission over the sphere is 0.1. The reflected light is the sum of 0.1 ρ^k over k ≥ 1.",
        solution: |s| {
            let r = reading(s);
            format!(
                "The reflected radiance is s = 0.1 ρ/(1 − ρ). Solve for ρ: s (1 − ρ) = 0.1 ρ, so ρ = s/(0.1 + s) = \
                 {r}/(0.1 + {r}) = {}.",
                four(r / (CAP + r))
            )
        },
    },
];

/// The part of the area of the sphere that emits.
const CAP: f64 = 0.1;

/// ρ of exercise 1.
fn dim(s: &Student) -> f64 {
    s.pick("4.1 albedo", &[0.35, 0.45, 0.55, 0.6, 0.65, 0.75, 0.8])
}

/// The least K with ρ^(K+1) < 0.01.
fn last(rho: f64) -> i32 {
    (0..).find(|&k| rho.powi(k + 1) < 0.01).unwrap_or_default()
}

/// Emission of the walls, and the albedos of walls and floor, of exercise 2.
fn walls(s: &Student) -> (f64, [f64; 2]) {
    let e = s.pick("4.2 emission", &[0.5, 1.5, 2.0, 3.0, 4.0]);
    (e, s.pick("4.2 albedos", &[[0.2, 0.7], [0.3, 0.8], [0.4, 0.9], [0.8, 0.25], [0.6, 0.35]]))
}

/// ρ of exercise 3, below 1/2.
fn small(s: &Student) -> f64 {
    s.pick("4.3 albedo", &[0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.45])
}

/// s of exercise 4.
fn reading(s: &Student) -> f64 {
    s.pick("4.4 reading", &[0.04, 0.06, 0.12, 0.18, 0.25, 0.4, 0.7])
}

fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

fn four(x: f64) -> String {
    significant(x, 4)
}
