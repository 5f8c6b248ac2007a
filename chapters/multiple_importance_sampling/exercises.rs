//! Exercises of chapter 11 that the program judges.
//!
//! ```text
//! 11.1  part of T E from the lamp with an area      11.2  w = p_ω/(p_ω + p_s),  p_ω = p_A d²/cos θ_y
//! 11.3  a mistake from its factors                  11.4  Var X = (a/(1 + 2q) − b/(3 − 2q))² (¼ + q(1 − q))
//! ```

use super::mistakes::{Factor, Run, factors, from_the_lamp, point_light};
use fredholm::progress::Progress;
use fredholm::report::book::{self, Number};
use fredholm::report::exercise::{Exercise, Mistake, Student, Task, Unit};
use fredholm::report::text::number::significant;
use std::sync::OnceLock;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[POINT, AREA, NAME, LINE];

fn mistake(value: f64, says: &'static str) -> Mistake {
    Mistake { value, says }
}

fn intensity(s: &Student) -> f64 {
    s.pick("11.1 intensity", &[0.2, 0.3, 0.4, 0.6, 0.8])
}

/// Measured once; the same for all students.
fn share(s: &Student) -> book::Result<Number> {
    static POINT_LIGHT: OnceLock<Option<Number>> = OnceLock::new();
    let run = Run { seed: 0, pixels: 64, spp: 64, progress: Progress::NONE };
    let r = POINT_LIGHT.get_or_init(|| point_light(&run).ok()).ok_or("the scene cannot be loaded")?;
    Ok(from_the_lamp(r, intensity(s)))
}

const POINT: Exercise = Exercise {
    number: 1,
    title: "the light that BSDF sampling cannot find",
    question: |s| {
        format!(
            "A point light of the intensity {i} W/sr is added to the Cornell box. Which part of the direct light k = 1 does BSDF \
             sampling alone find? Run this command twice, with mis and with scatter after --technique, and divide the means of \
             the row k = 1:\n\n\
             fredholm series cornell --worlds terms --max-bounces 1 --size 64x64 --spp 1024 --technique mis \
             --set 'lights=[{{ type = \"point\", position = [-0.4, 0.5, 0.5], intensity = [{i}, {i}, {i}] }}]'\n\n\
             Give three digits.",
            i = intensity(s)
        )
    },
    task: Task::Number {
        unit: Unit::Share,
        margin: 0.03,
        truth: share,
        mistakes: |s| {
            let part = share(s).map_or(f64::NAN, |x| x.value);
            vec![
                mistake(1.0 - part, "This is the part that BSDF sampling misses."),
                mistake(1.0, "No direction hits a point. The weight of a connection to it is 1, that of a hit is 0."),
                mistake(0.0, "BSDF sampling still finds the lamp with an area."),
            ]
        },
    },
    hint: "A direction hits a lamp with an area by chance, and a point never. So mis without the point light has the same mean \
           as scatter with it, and less noise.",
    solution: |s| match share(s) {
        Ok(x) => format!(
            "BSDF sampling never finds the point light, so its mean is the direct light of the lamp with an area. MIS finds both: \
             a connection to the point light has the weight 1. With the intensity {} the lamp gives the part {x}.",
            intensity(s)
        ),
        Err(e) => format!("the solution could not be computed: {e}"),
    },
};

/// The area of the lamp, d, cos θ_y, and p_s.
fn pair(s: &Student) -> [f64; 4] {
    [
        s.pick("11.2 area", &[1.0, 1.25, 2.0, 2.5, 4.0]),
        s.pick("11.2 distance", &[1.5, 1.75, 2.0, 2.25, 2.5]),
        s.pick("11.2 cosine", &[0.4, 0.5, 0.6, 0.65, 0.7]),
        s.pick("11.2 density", &[1.0, 2.0, 3.0, 4.0, 5.0]),
    ]
}

const AREA: Exercise = Exercise {
    number: 2,
    title: "a weight from two densities",
    question: |s| {
        let [area, d, cos, p] = pair(s);
        format!(
            "The only lamp has the area {area} m²; its points are chosen uniformly. A connection from a glossy surface finds a point \
             y of it at the distance {d} m, with cos θ_y = {cos}. BSDF sampling would choose the direction to y with the density \
             {p} per steradian. Which weight does the connection get by the balance heuristic? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let [area, d, cos, p] = pair(s);
            Ok(Number { value: balance(d * d / (area * cos), p), std_error: 0.0 })
        },
        mistakes: |s| {
            let [area, d, cos, p] = pair(s);
            vec![
                mistake(
                    balance(1.0 / area, p),
                    "A density per area is added to one per solid angle. Convert it: d²/cos θ_y.",
                ),
                mistake(balance(d * d / area, p), "The factor 1/cos θ_y of the conversion is missing."),
                mistake(
                    balance(cos / (d * d * area), p),
                    "The conversion is upside down: p_ω = p_A dA/dω, dA/dω = d²/cos θ_y.",
                ),
            ]
        },
    },
    hint: "Bring both densities to the same measure first: p_ω = p_A d²/cos θ_y.",
    solution: |s| {
        let [area, d, cos, p] = pair(s);
        let light = d * d / (area * cos);
        format!(
            "p_ω = (1/{area}) · {d}²/{cos} = {} per steradian. The weight is {} / ({} + {p}) = {}.",
            significant(light, 4),
            significant(light, 4),
            significant(light, 4),
            significant(balance(light, p), 4)
        )
    },
};

fn balance(p: f64, other: f64) -> f64 {
    p / (p + other)
}

/// The mistakes of exercise 11.3.
const SUSPECTS: &[&str] =
    &["double-emission", "mixed-heuristics", "mixed-measures", "wrong-light-choice", "area-density"];

fn suspect(s: &Student) -> &'static str {
    s.pick("11.3 mistake", SUSPECTS)
}

/// The factors of the student's mistake, from a short render, which is the same for all students.
fn row(s: &Student) -> book::Result<&'static Factor> {
    static ROWS: OnceLock<Vec<Factor>> = OnceLock::new();
    let run = Run { seed: 0, pixels: 32, spp: 16, progress: Progress::NONE };
    let rows = ROWS.get_or_init(|| factors(&run, SUSPECTS).unwrap_or_default());
    Ok(rows.iter().find(|f| f.name == suspect(s)).ok_or("a scene cannot be loaded")?)
}

const NAME: Exercise = Exercise {
    number: 3,
    title: "name the mistake",
    question: |s| match row(s) {
        Ok(f) => format!(
            "A renderer with MIS has one mistake. Its direct light, divided by the right one, is (± one standard error)\n\n\
             Cornell box, lengths × 0.1: {}\nCornell box: {}\nCornell box, lengths × 10: {}\nscene many-lights (96 lamps): {}\n\n\
             Which mistake is it?",
            f.cornell[0], f.cornell[1], f.cornell[2], f.many
        ),
        Err(e) => format!("the question could not be computed: {e}"),
    },
    task: Task::Choice {
        words: SUSPECTS,
        truth: |s| Ok(suspect(s)),
        mistakes: &[
            ("double-emission", "It would give 2 everywhere, within the error."),
            ("mixed-heuristics", "It would change the light by at most 15 %, by the same factor at every scale."),
            (
                "mixed-measures",
                "It would depend on the scale: close to 1 for a small room, far below 1 for a large one.",
            ),
            ("wrong-light-choice", "With one lamp it would change nothing. Only the last number could differ from 1."),
            ("area-density", "It would make a room that is ten times larger about a hundred times brighter."),
        ],
    },
    hint: "Ask first: does the factor depend on the scale? Then: does it differ from 1 with a single lamp?",
    solution: |s| {
        let why = match suspect(s) {
            "double-emission" => "all factors are 2: both strategies count the whole light",
            "mixed-heuristics" => {
                "the Cornell box has the same factor close to 1 at every scale: the weights do not sum to 1, but have no unit"
            }
            "mixed-measures" => {
                "the factor falls with the scale: a density per area is compared with one per solid angle"
            }
            "wrong-light-choice" => "one lamp gives 1, and 96 lamps do not: the probability of the lamp is wrong",
            _ => {
                "the light grows a hundredfold with each step of the scale: samples are divided by a density per area, so that \
                 a factor of the unit 1/m² is missing"
            }
        };
        format!("It is {}: {why}.", suspect(s))
    },
};

/// a and q; b is 1.
fn line(s: &Student) -> [f64; 2] {
    [s.pick("11.4 value", &[2.0, 4.0, 5.0, 6.0, 8.0]), s.pick("11.4 probability", &[0.6, 0.65, 0.7, 0.75, 0.8])]
}

/// Var X for f = a on the left and b = 1 on the right, with the weights (w₀, w₁) of each half.
fn variance([a, q]: [f64; 2], weights: [[f64; 2]; 2]) -> f64 {
    let [left, right] = weights;
    let uniform = left[0] * a - right[0];
    let second = left[1] * a / (2.0 * q) - right[1] / (2.0 * (1.0 - q));
    0.25 * uniform * uniform + q * (1.0 - q) * second * second
}

/// Weights of the balance heuristic, on the left and on the right half.
fn balanced(q: f64) -> [[f64; 2]; 2] {
    [2.0 * q, 2.0 * (1.0 - q)].map(|p| [balance(1.0, p), balance(p, 1.0)])
}

const LINE: Exercise = Exercise {
    number: 4,
    title: "the variance of an estimate with two samples",
    question: |s| {
        let [a, q] = line(s);
        format!(
            "f is {a} on the left half of the line from 0 to 1, and 1 on the right half. Strategy 0 is uniform. Strategy 1 lies on \
             the left half with probability {q}, and is uniform within each half. Take one sample of each, and add both with the \
             weights of the balance heuristic. What is the variance of this estimate of ∫ f? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let [a, q] = line(s);
            Ok(Number { value: variance([a, q], balanced(q)), std_error: 0.0 })
        },
        mistakes: |s| {
            let [a, q] = line(s);
            vec![
                mistake(variance([a, q], [[0.5; 2]; 2]), "This is the variance with the weights ½ and ½."),
                mistake(variance([a, q], [[1.0, 0.0]; 2]), "This is the variance of strategy 0 alone."),
                mistake(
                    mean_square([a, q]),
                    "This is the sum of both mean squares. Subtract the squared mean of each sample.",
                ),
            ]
        },
    },
    hint: "With the balance heuristic each sample gives f/(p₀ + p₁), whichever strategy found it: one value on the left, one \
           on the right.",
    solution: |s| {
        let [a, q] = line(s);
        let [left, right] = [a / (1.0 + 2.0 * q), 1.0 / (3.0 - 2.0 * q)];
        format!(
            "The densities of strategy 1 are {} and {}. A sample gives {} on the left and {} on the right. A number with two values \
             at the distance D, the first with probability P, has the variance D² P(1 − P). The samples have P = ½ and P = {q}, so \
             the variance is {}² (¼ + {}) = {}.",
            significant(2.0 * q, 3),
            significant(2.0 - 2.0 * q, 3),
            significant(left, 4),
            significant(right, 4),
            significant((left - right).abs(), 4),
            significant(q * (1.0 - q), 4),
            significant(variance([a, q], balanced(q)), 4)
        )
    },
};

/// Σᵢ E[(wᵢ f/pᵢ)²] with the balance heuristic.
fn mean_square([a, q]: [f64; 2]) -> f64 {
    let [left, right] = [a / (1.0 + 2.0 * q), 1.0 / (3.0 - 2.0 * q)];
    (0.5 + q) * left * left + (1.5 - q) * right * right
}
