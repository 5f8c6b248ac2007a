//! Exercises of chapter 10 that the program judges.
//!
//! ```text
//! q < 1 − ρ²      Σ_v P(alive at v) = m + 1/q      Var S = b² q/(1 − q)      r(ρ²F/(1 − q)) = r(ρ²F)/(1 − q)
//! ```
//!
//! | exercise | truth |
//! |---|---|
//! | 10.1, 10.2 | closed form |
//! | 10.3 | enumeration of both ways the roulette can fall |
//! | 10.4 | r(ρ²F) of the same matrix that the command uses |

use super::exact;
use fredholm::engine::by_matrix;
use fredholm::report::exercise::{Exercise, Mistake, Result, Student, Task, Unit};
use fredholm::report::text::number::significant;
use fredholm::scene::{Scene, load};
use fredholm::study::roulette::Radii;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[LARGEST_Q, VERTICES, TWO_TERMS, RADIUS];

const LARGEST_Q: Exercise = Exercise {
    number: 1,
    title: "the largest q with finite variance in a furnace",
    question: |s| {
        format!(
            "A furnace (a closed room of uniform albedo and emission) has the albedo {}. A path tracer ends paths with \
             probability q at every vertex. Below which q is the variance of a path finite? Give three digits.",
            albedo(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| Ok(exact(1.0 - albedo(s).powi(2))),
        mistakes: |s| {
            let rho = albedo(s);
            vec![
                Mistake { value: rho * rho, says: "This is the probability of survival, 1 − q." },
                Mistake {
                    value: 1.0 - rho,
                    says: "This is roulette by albedo. Its variance is finite, but q may be larger.",
                },
                Mistake {
                    value: 1.0 - rho.powf(4.0 / 3.0),
                    says: "This is the condition for a finite fourth moment, ρ⁴ < (1 − q)³.",
                },
            ]
        },
    },
    hint: "From one vertex to the next, the squared weight is multiplied by (ρ/(1 − q))². The path survives with \
           probability 1 − q.",
    solution: |s| {
        let rho = albedo(s);
        format!(
            "The mean squared weight changes by the factor (1 − q)·(ρ/(1 − q))² = ρ²/(1 − q) per bounce. The sum over all \
             bounces is finite if the factor is below 1: q < 1 − ρ² = 1 − {rho}² = {}.",
            significant(1.0 - rho * rho, 4)
        )
    },
};

fn albedo(s: &Student) -> f64 {
    s.pick("10.1 albedo", &[0.4, 0.55, 0.65, 0.75, 0.8, 0.85, 0.9])
}

const VERTICES: Exercise = Exercise {
    number: 2,
    title: "the mean number of vertices",
    question: |s| {
        let (from, q) = length(s);
        format!(
            "In a closed room, paths are ended only by Russian roulette. q = 0 at the vertices 0 to {}, and q = {q} from vertex \
             {from} on. The test comes after a vertex has been scored. How many vertices does a path have on average, vertex 0 \
             included? Give three digits. Check your prediction: `fredholm roulette furnace --technique scatter --schedules \
             constant:{q}@{from} --max-bounces 60` prints rays per path, one ray for each vertex.",
            from - 1
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (from, q) = length(s);
            Ok(exact(f64::from(from) + 1.0 / q))
        },
        mistakes: |s| {
            let (from, q) = length(s);
            let from = f64::from(from);
            vec![
                Mistake { value: 1.0 / q, says: "The vertices before the first test are missing." },
                Mistake { value: from + 1.0 / (1.0 - q), says: "Here q was taken for the probability of survival." },
                Mistake {
                    value: from + (1.0 - q) / q,
                    says: "The vertex with the first test is missing: it is scored before the test.",
                },
            ]
        },
    },
    hint: "The mean number of vertices is the sum over v of the probability of reaching vertex v.",
    solution: |s| {
        let (from, q) = length(s);
        format!(
            "Vertices 0 to {from} are always reached, vertex {from} + j with probability (1 − q)^j. The sum is {from} + Σ (1 − \
             q)^j = {from} + 1/q = {from} + 1/{q} = {}.",
            significant(f64::from(from) + 1.0 / q, 4)
        )
    },
};

/// The first vertex with a test, and q there.
fn length(s: &Student) -> (u32, f64) {
    let q = s.pick("10.2 termination", &[0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.6, 0.7]);
    (s.pick("10.2 first vertex", &[2, 3, 4, 5, 6]), q)
}

const TWO_TERMS: Exercise = Exercise {
    number: 3,
    title: "one path, two ways to end",
    question: |s| {
        let (a, b, q) = two_terms(s);
        format!(
            "A path scores {a} at vertex 0 and would score {b} at vertex 1, where it ends. Roulette ends it after vertex 0 with \
             probability q = {q}; otherwise what vertex 1 scores is divided by the probability of survival. List both ways the \
             roulette can fall, with their probabilities. What is the variance of the sum that the path scores? Give three \
             digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (a, b, q) = two_terms(s);
            let ways = [(q, a), (1.0 - q, a + b / (1.0 - q))];
            let mean = |power| ways.iter().map(|(p, s): &(f64, f64)| p * s.powi(power)).sum::<f64>();
            Ok(exact(mean(2) - mean(1).powi(2)))
        },
        mistakes: |s| {
            let (a, b, q) = two_terms(s);
            vec![
                Mistake { value: b * b * q * (1.0 - q), says: "Here the survivor is not divided by 1 − q." },
                Mistake { value: b * b * (1.0 - q) / q, says: "Here q was taken for the probability of survival." },
                Mistake {
                    value: q * a * a + (1.0 - q) * (a + b / (1.0 - q)).powi(2),
                    says: "This is E[S²]. The variance is E[S²] − (E[S])².",
                },
            ]
        },
    },
    hint: "The two ways: S = a with probability q, and S = a + b/(1 − q) with probability 1 − q. Their mean is a + b.",
    solution: |s| {
        let (a, b, q) = two_terms(s);
        format!(
            "With probability {q} the path scores {a}, with probability {} it scores {a} + {b}/{} = {}. The mean is {a} + {b} = \
             {}. a is in both ways, so only b varies: the variance is b²/(1 − q) − b² = b² q/(1 − q) = {}.",
            significant(1.0 - q, 2),
            significant(1.0 - q, 2),
            significant(a + b / (1.0 - q), 4),
            significant(a + b, 3),
            significant(b * b * q / (1.0 - q), 4)
        )
    },
};

/// What the two vertices score, and q.
fn two_terms(s: &Student) -> (f64, f64, f64) {
    let a = s.pick("10.3 vertex 0", &[0.2, 0.3, 0.5, 0.7, 1.0]);
    let b = s.pick("10.3 vertex 1", &[0.4, 0.6, 0.8, 0.9, 1.2]);
    (a, b, s.pick("10.3 termination", &[0.2, 0.25, 0.3, 0.4, 0.6, 0.7, 0.8]))
}

/// q in the command of exercise 10.4. So large that the radius is above 1 for all walls, because only then it is printed.
pub(super) const COMMAND_Q: f64 = 0.9;

const RADIUS: Exercise = Exercise {
    number: 4,
    title: "the largest q in a Cornell box",
    question: |s| {
        let w = white(s);
        format!(
            "Run `fredholm roulette cornell --set 'materials.white.reflectance=[{w}, {w}, {w}]' --schedules \
             constant:{COMMAND_Q}@0 --spp 4 --size 16x16 --verbose`. Its warning states the spectral radius of ρ²F/(1−q) for q = \
             {COMMAND_Q}. Below which q is the variance finite in this room? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| Ok(exact(1.0 - radius(s)?)),
        mistakes: |s| {
            let (w, radius) = (white(s), radius(s).unwrap_or(f64::NAN));
            vec![
                Mistake { value: radius, says: "This is the least probability of survival, 1 − q." },
                Mistake {
                    value: COMMAND_Q * (1.0 - COMMAND_Q) / radius,
                    says: "The radius is not proportional to q. It is proportional to 1/(1 − q).",
                },
                Mistake {
                    value: 1.0 - w * w,
                    says: "This holds in a furnace whose walls are all white. Here the coloured walls and the open front help.",
                },
            ]
        },
    },
    hint: "The radius of ρ²F/(1 − q) is that of ρ²F, divided by 1 − q. Compute the radius of ρ²F first.",
    solution: |s| {
        let (w, r) = (white(s), radius(s).unwrap_or(f64::NAN));
        format!(
            "With white walls of albedo {w} the command prints {}. So the radius of ρ²F is (1 − {COMMAND_Q}) times that, {}. \
             The variance is finite if r(ρ²F)/(1 − q) < 1: q < 1 − {} = {}.",
            significant(r / (1.0 - COMMAND_Q), 4),
            significant(r, 4),
            significant(r, 4),
            significant(1.0 - r, 4)
        )
    },
};

fn white(s: &Student) -> f64 {
    s.pick("10.4 white walls", &[0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.9, 0.95])
}

/// r(ρ²F) with the student's white walls.
fn radius(s: &Student) -> Result<f64> {
    radius_of(white(s))
}

/// r(ρ²F) with white walls of this albedo, from the mesh that the command uses.
pub(super) fn radius_of(white: f64) -> Result<f64> {
    let set = vec![format!("materials.white.reflectance=[{white}, {white}, {white}]"), "camera.size=[16, 16]".into()];
    let room = load::scene("cornell", &load::Options { set, ..load::Options::default() })?.description;
    let scene = Scene::new(&room);
    let matrix = by_matrix::coarse(&room, &scene).ok_or("this scene has no matrix")?;
    Ok(Radii::new(Some(&matrix.radiosity), &scene, 0.0).second)
}
