//! Exercises of chapter 9 that the program judges.
//!
//! ```text
//! 9.1  own/one = (K + 3)/4        9.2  n_k = B (σ_k/√c_k) / Σ_j σ_j √c_j        9.3  Var(X₁ + X₂) = σ₁² + σ₂² + 2 r σ₁ σ₂
//! 9.4  L = e (1 + ρ)/(1 − ρ)      9.5  r_k with the same random numbers, in a room with a mirror and a glass ball
//! ```

use super::{mistake, scene};
use fredholm::engine::Settings;
use fredholm::estimator::{Plan, Roulette, Technique};
use fredholm::progress::Progress;
use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, RADIANCE, Result, Student, Task, Unit};
use fredholm::report::text::number::significant;
use fredholm::zoo::signature::measured;
use fredholm::zoo::{self, Right};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[RAYS, SPLIT, SUM, TWICE, NAME];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

const RAYS: Exercise = Exercise {
    number: 1,
    title: "rays of own paths and of one path",
    question: |s| {
        format!(
            "In a closed room no path is lost. Emission is found by connections only; a connection is one ray. You estimate \
             TE, T²E, …, T^K E for K = {}, one sample of each. How many times as many rays do own paths for every term need as \
             one path for all terms? Give three digits.",
            bounces(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| exact((bounces(s) + 3.0) / 4.0),
        mistakes: |s| {
            let k = bounces(s);
            let own = k * (k + 3.0) / 2.0;
            vec![
                Mistake {
                    value: (k + 1.0) / 4.0,
                    says: "The own paths have connections, too: the term k needs k + 1 rays.",
                },
                Mistake { value: own / k, says: "The one path has a connection at every vertex, too: 2K rays." },
                Mistake {
                    value: own,
                    says: "These are the rays of the own paths. Divide them by those of the one path.",
                },
            ]
        },
    },
    hint: "The term k needs k rays along its path, the first of them from the eye, and one connection.",
    solution: |s| {
        let k = bounces(s);
        format!(
            "Own paths: 2 + 3 + … + {} = {} rays. One path: {k} rays along the path and {k} connections, {} rays. The quotient is \
             (K + 3)/4 = {}.",
            k + 1.0,
            k * (k + 3.0) / 2.0,
            2.0 * k,
            significant((k + 3.0) / 4.0, 4)
        )
    },
};

fn bounces(s: &Student) -> f64 {
    s.pick("9.1 bounces", &[4.0, 5.0, 6.0, 7.0, 9.0, 10.0, 12.0, 16.0])
}

const SPLIT: Exercise = Exercise {
    number: 2,
    title: "the best split of rays",
    question: |s| {
        let [sigma, rays] = pilot(s);
        format!(
            "A pilot run measured three terms. Standard deviations of one sample: {}, {}, {}. Rays of one sample: {}, {}, {}. You \
             may spend 1000 rays per pixel. How many samples does the second term get in the best split? Give three digits; do \
             not round to a whole number.",
            sigma[0], sigma[1], sigma[2], rays[0], rays[1], rays[2]
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| exact(second(s, |sigma, c| sigma / c.sqrt())),
        mistakes: |s| {
            vec![
                Mistake {
                    value: second(s, |sigma, _| sigma),
                    says: "This split is n ∝ σ. It ignores that samples have different costs.",
                },
                Mistake {
                    value: second(s, |sigma, c| sigma * sigma / c),
                    says: "This split is n ∝ σ²/c. The best one is its square root.",
                },
                Mistake { value: second(s, |_, _| 1.0), says: "This is the same number of samples for every term." },
                Mistake { value: second(s, |_, c| 1.0 / c), says: "This is the same number of rays for every term." },
            ]
        },
    },
    hint: "n is proportional to σ/√c, and the rays Σ n c must be 1000.",
    solution: |s| {
        let [sigma, rays] = pilot(s);
        let shares: Vec<String> = (0..3).map(|k| significant(sigma[k] / rays[k].sqrt(), 4)).collect();
        format!(
            "σ/√c is {}. Multiplied with the rays c and added up this is Σ σ √c = {}. So n = 1000 · {} / {} = {}.",
            shares.join(", "),
            significant((0..3).map(|k| sigma[k] * rays[k].sqrt()).sum(), 4),
            shares[1],
            significant((0..3).map(|k| sigma[k] * rays[k].sqrt()).sum(), 4),
            significant(second(s, |sigma, c| sigma / c.sqrt()), 4)
        )
    },
};

/// Standard deviations and rays of three terms. In every pair, the right answer and all mistakes are far apart.
fn pilot(s: &Student) -> [[f64; 3]; 2] {
    const PAIRS: [[[f64; 3]; 2]; 7] = [
        [[1.2, 0.2, 0.3], [1.0, 5.0, 6.0]],
        [[0.5, 0.2, 0.3], [2.0, 3.0, 8.0]],
        [[0.9, 0.9, 0.1], [1.0, 5.0, 6.0]],
        [[1.2, 0.2, 0.1], [2.0, 4.0, 9.0]],
        [[1.2, 0.6, 0.1], [1.0, 5.0, 6.0]],
        [[0.5, 0.9, 0.3], [2.0, 3.0, 8.0]],
        [[0.5, 0.3, 0.1], [1.0, 5.0, 6.0]],
    ];
    s.pick("9.2 pilot", &PAIRS)
}

/// Samples of the second term if n is proportional to `share(σ, c)` and all samples together take 1000 rays.
fn second(s: &Student, share: fn(f64, f64) -> f64) -> f64 {
    let [sigma, rays] = pilot(s);
    let cost: f64 = (0..3).map(|k| share(sigma[k], rays[k]) * rays[k]).sum();
    1000.0 * share(sigma[1], rays[1]) / cost
}

const SUM: Exercise = Exercise {
    number: 3,
    title: "the variance of a sum of correlated terms",
    question: |s| {
        let [a, b, r] = two(s);
        format!(
            "Two terms of one path have the standard deviations {a} and {b}, and the correlation {r}. What is the variance of their \
             sum? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let [a, b, r] = two(s);
            exact(a * a + b * b + 2.0 * r * a * b)
        },
        mistakes: |s| {
            let [a, b, r] = two(s);
            let sum = a * a + b * b;
            vec![
                Mistake { value: sum, says: "This is the variance for independent terms." },
                Mistake {
                    value: sum + r * a * b, says: "The covariance counts twice: Cov(X₁, X₂) and Cov(X₂, X₁)."
                },
                Mistake {
                    value: sum + 2.0 * r,
                    says: "The correlation must be multiplied by both standard deviations.",
                },
                Mistake { value: (sum + 2.0 * r * a * b).sqrt(), says: "This is the standard deviation of the sum." },
            ]
        },
    },
    hint: "Cov(X₁, X₂) = r σ₁ σ₂.",
    solution: |s| {
        let [a, b, r] = two(s);
        format!(
            "The covariance is {r} · {a} · {b} = {}. So the variance is {} + {} + 2 · {} = {}.",
            significant(r * a * b, 4),
            significant(a * a, 4),
            significant(b * b, 4),
            significant(r * a * b, 4),
            significant(a * a + b * b + 2.0 * r * a * b, 4)
        )
    },
};

fn two(s: &Student) -> [f64; 3] {
    let [a, b] = s.pick("9.3 sigma", &[[0.5, 0.3], [2.0, 1.2], [3.0, 2.0], [0.6, 0.4], [2.5, 1.5]]);
    [a, b, s.pick("9.3 correlation", &[0.2, 0.25, 0.3, 0.4, -0.2, -0.3])]
}

const TWICE: Exercise = Exercise {
    number: 4,
    title: "a picture with double emission",
    question: |s| {
        let [rho, e] = furnace(s);
        format!(
            "A renderer counts emission on every hit with weight 1 and through every connection with weight 1. It renders this \
             furnace:\n\n{}\n\nThe command prints the right terms, and the sum `all`, which is noisy. Which radiance \
             does the wrong renderer show, with all reflections? Give three digits.",
            command(rho, e)
        )
    },
    task: Task::Number {
        unit: RADIANCE,
        margin: 0.01,
        truth: |s| {
            let [rho, e] = furnace(s);
            exact(e * (1.0 + rho) / (1.0 - rho))
        },
        mistakes: |s| {
            let [rho, e] = furnace(s);
            let mut all = vec![
                Mistake {
                    value: 2.0 * e / (1.0 - rho),
                    says: "At the eye, emission counts once: the term k = 0 is right.",
                },
                Mistake { value: e / (1.0 - rho), says: "This is the right picture." },
            ];
            if rho < 0.5 {
                let says = "This doubles at every reflection. Every term is doubled only once.";
                all.push(Mistake { value: e / (1.0 - 2.0 * rho), says });
            }
            all
        },
    },
    hint: "Every path with k ≥ 1 is found by a hit and by a connection, and both count fully.",
    solution: |s| {
        let [rho, e] = furnace(s);
        let right = e / (1.0 - rho);
        format!(
            "The right picture is e/(1 − ρ) = {}. Its term k = 0 is {e}, and the other terms are {} together. They count twice: \
             {e} + 2 · {} = e (1 + ρ)/(1 − ρ) = {}.",
            significant(right, 4),
            significant(right - e, 4),
            significant(right - e, 4),
            significant(e * (1.0 + rho) / (1.0 - rho), 4)
        )
    },
};

/// Solves a furnace with these values. Two lines, so that no line is broken in the wrong place.
fn command(rho: f64, e: f64) -> String {
    format!(
        "fredholm series furnace --set shapes.0.emission=[{e},{e},{e}] \\\n--set materials.wall.reflectance=[{rho},{rho},{rho}]"
    )
}

fn furnace(s: &Student) -> [f64; 2] {
    [s.pick("9.4 albedo", &[0.2, 0.3, 0.4, 0.6, 0.7, 0.8]), s.pick("9.4 emission", &[2.0, 3.0, 4.0, 5.0, 6.0])]
}

/// The answers of the last exercise: members of the zoo, and `right`.
const NAMES: [&str; 5] = ["double-emission", "emission-missing", "no-emission-after-mirror", "half-bounce", "right"];

const NAME: Exercise = Exercise {
    number: 5,
    title: "name the mistake",
    question: |s| match table(s) {
        Ok(table) => format!(
            "A renderer made a picture of the room `cornell-spheres`: matt walls, a mirror ball and a glass ball. Here are its terms \
             divided by the right terms. Both pictures have the same random numbers, so a ratio that the mistake does not change is \
             exactly 1:\n\n{table}\n\nWhat is wrong: double-emission (both ways to find \
             the lamp have weight 1), emission-missing (the lamp is black for the eye), no-emission-after-mirror (a hit never \
             counts, not even after a mirror or glass), half-bounce (the throughput is halved at every bounce), or is it right?"
        ),
        Err(e) => format!("The terms could not be rendered: {e}"),
    },
    task: Task::Choice {
        words: &NAMES,
        truth: |s| Ok(wrong(s)),
        mistakes: &[
            ("double-emission", "It would make r₁ almost 2: only paths that end after a mirror or glass count once."),
            ("emission-missing", "It would make r₀ = 0, and all other ratios 1."),
            (
                "no-emission-after-mirror",
                "It would take away caustics and reflected lamps: a tenth to a quarter of each later term.",
            ),
            ("half-bounce", "It would leave r₁ nearly as it is and halve the ratio from term to term: 1, 1/2, 1/4."),
            ("right", "Some ratio is not 1, although both pictures have the same random numbers."),
        ],
    },
    hint: "Look at r₀ first, then at r₁: which ways can find the lamp there?",
    solution: |s| {
        let says = match wrong(s) {
            "double-emission" => {
                "r₀ = 1, and the later ratios are almost 2. They are not exactly 2, because after a mirror or glass only one way can find the lamp."
            }
            "emission-missing" => "Only r₀ is wrong, and it is 0: emission is left out at the eye.",
            "no-emission-after-mirror" => {
                "r₀ = 1, and later ratios are a little below 1 and fall: light whose last step before the lamp is a mirror or glass is lost."
            }
            "half-bounce" => {
                "r₁ is near 1, and the ratio falls by about 1/2 from term to term: a factor is lost at every bounce."
            }
            _ => "All ratios are 1.",
        };
        format!("{says} The answer is {}.", wrong(s))
    },
};

fn wrong(s: &Student) -> &'static str {
    s.pick("9.5 mistake", &NAMES)
}

/// The ratios r_0 to r_3 with the same random numbers, one a line.
fn table(s: &Student) -> Result<String> {
    const TERMS: usize = 3;
    let name = wrong(s);
    let settings = Settings { spp: 32, seed: s.seed(), max_bounces: TERMS, ..Settings::default() };
    let room = scene("cornell-spheres", 24)?;
    let technique = zoo::find(name).map_or(Technique::Mis, |bug| bug.technique);
    let plan = Plan { max_bounces: TERMS, technique, roulette: Roulette::Never };
    let render = |mistake: &dyn zoo::Mistake| {
        zoo::of(&plan, mistake, "paths", &room, &settings, Progress::NONE).series.image().clone()
    };
    let wrong = if name == "right" { &Right } else { mistake(name)? };
    let ratios = measured(&render(wrong), &render(&Right));
    let line = |(k, r): (usize, &zoo::signature::Ratio)| format!("  r{k} = {}", significant(r.value, 3));
    Ok(ratios.iter().enumerate().map(line).collect::<Vec<_>>().join("\n"))
}
