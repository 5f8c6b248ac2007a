//! Exercises of chapter 3 that the program judges.
//!
//! ```text
//! 3.1  V = 4/((n + 1)(3 − n)) − 1        3.3  V_cos/V_uni = (1/b² − 1)/(4/(3b) − 1),  b = sin δ
//! 3.5  V_uni = 4(1 − cos³α)/(3 sin⁴α) − 1,  V_cos = 1/sin²α − 1
//! ```

use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, Result, Student, Task, Unit};
use fredholm::report::text::number::significant;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[POWER, BAND, DISC];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

fn mistake(value: f64, says: &'static str) -> Mistake {
    Mistake { value, says }
}

fn exponent(s: &Student) -> f64 {
    s.pick("3.1 exponent", &[0.25, 0.5, 0.75, 1.5, 1.75, 2.25, 2.5])
}

/// V of the density (n + 1)/2π · cosⁿθ under constant light.
fn of_power(n: f64) -> f64 {
    4.0 / ((n + 1.0) * (3.0 - n)) - 1.0
}

const POWER: Exercise = Exercise {
    number: 1,
    title: "a density with another power of the cosine",
    question: |s| {
        format!(
            "Directions have the density p = (n + 1)/2π · cosⁿθ with n = {}. A matt surface lies under a sky of constant \
             radiance. Compute V, the variance of one sample divided by its squared mean. Give three digits.",
            exponent(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| exact(of_power(exponent(s))),
        mistakes: |s| {
            let v = of_power(exponent(s));
            vec![
                mistake(v + 1.0, "This is E[X²]/E[X]². Subtract 1 to get the variance."),
                mistake(v.sqrt(), "This is √V, the relative standard deviation."),
            ]
        },
    },
    hint: "E[X²] = ∫ (ρ L cos θ/π)²/p dω, and ∫ cosᵐθ dω = 2π/(m + 1) over the hemisphere.",
    solution: |s| {
        let n = exponent(s);
        format!(
            "E[X²]/E[X]² = 4/(n + 1) · ∫₀¹ c^(2 − n) dc = 4/((n + 1)(3 − n)) = {}, with c = cos θ. So V = {}.",
            significant(of_power(n) + 1.0, 4),
            significant(of_power(n), 4)
        )
    },
};

fn angle(s: &Student) -> f64 {
    s.pick("3.3 angle", &[4.0, 6.0, 8.0, 12.0, 15.0, 20.0])
}

/// V by the cosine and by uniform directions, for light up to this angle above the horizon.
fn of_band(degrees: f64) -> [f64; 2] {
    let b = degrees.to_radians().sin();
    [1.0 / (b * b) - 1.0, 4.0 / (3.0 * b) - 1.0]
}

const BAND: Exercise = Exercise {
    number: 3,
    title: "light from a band above the horizon",
    question: |s| {
        format!(
            "Constant light comes only from the directions up to {}° above the horizon. For the same relative error of a matt \
             surface, how many times as many rays do directions by the cosine need as uniform ones? Give three digits.",
            angle(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let [cosine, uniform] = of_band(angle(s));
            exact(cosine / uniform)
        },
        mistakes: |s| {
            let [cosine, uniform] = of_band(angle(s));
            let b = angle(s).to_radians().sin();
            vec![
                mistake(uniform / cosine, "This is the inverse: the rays of uniform directions per ray by the cosine."),
                mistake(1.0 / b, "This compares only how often the light is hit. The values of the hits differ, too."),
                mistake(0.75 / b, "This is the ratio of the mean squares. Subtract 1 from each to get V."),
            ]
        },
    },
    hint: "By the cosine, light is hit with probability b², b = sin of the angle, and all hits are equal. Uniform directions \
           hit it with probability b, and X is proportional to cos θ.",
    solution: |s| {
        let [cosine, uniform] = of_band(angle(s));
        format!(
            "b = sin {}° = {}. By the cosine V = 1/b² − 1 = {}; uniform V = 4/(3b) − 1 = {}. The number of rays for the same \
             error is proportional to V, so the ratio is {}.",
            angle(s),
            significant(angle(s).to_radians().sin(), 4),
            significant(cosine, 4),
            significant(uniform, 4),
            significant(cosine / uniform, 4)
        )
    },
};

fn radius(s: &Student) -> f64 {
    s.pick("3.5 radius", &[0.8, 1.0, 1.2, 1.4, 1.6])
}

/// V by uniform directions and by the cosine, on the axis of a disc of this radius, 2 m away.
fn of_disc(radius: f64) -> [f64; 2] {
    let sin2 = radius * radius / (radius * radius + 4.0);
    let cos = (1.0 - sin2).sqrt();
    [4.0 * (1.0 - cos.powi(3)) / (3.0 * sin2 * sin2) - 1.0, 1.0 / sin2 - 1.0]
}

const DISC: Exercise = Exercise {
    number: 5,
    title: "the variance under a disc",
    question: |s| {
        format!(
            "A matt floor lies 2 m below the centre of a black disc that emits constant light; the radius of the disc is {r} m. \
             How many times as large is the variance of one sample with uniform directions as with directions by the cosine, \
             at the point below the centre? Predict it, then check it with\n\n\
             fredholm sweep cornell --over sampling --technique scatter --max-bounces 1 --size 64x64 --spp 64 \
             --set 'materials.red.reflectance=[0, 0, 0]' --set 'shapes=[{{ type = \"quad\", origin = [-1, -1, 1], edge_u = [2, 0, 0], \
             edge_v = [0, 0, -2], material = \"white\" }}, {{ type = \"disk\", center = [0, 1, 0], normal = [0, -1, 0], radius = {r}, \
             material = \"red\", emission = [1, 1, 1] }}]' --set 'camera.origin=[1, 0, 0]' --set 'camera.target=[0, -1, 0]' \
             --set camera.fov=0.1\n\n\
             The file sweep.csv has a column `variance`; use the rows k = 1. Give three digits.",
            r = radius(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.03,
        truth: |s| {
            let [uniform, cosine] = of_disc(radius(s));
            exact(uniform / cosine)
        },
        mistakes: |s| {
            let [uniform, cosine] = of_disc(radius(s));
            vec![
                mistake(cosine / uniform, "This is the inverse: the variance by the cosine divided by the other one."),
                mistake(uniform, "This is V of uniform directions. Divide it by V of directions by the cosine."),
                mistake(cosine, "This is V of directions by the cosine. The question asks for a ratio."),
            ]
        },
    },
    hint: "X = 2ρL cos θ for a uniform direction that hits the disc, and X = ρL for one by the cosine. E[X] = ρL sin²α.",
    solution: |s| {
        let [uniform, cosine] = of_disc(radius(s));
        format!(
            "sin²α = R²/(R² + 4) = {}. Uniform: E[X²] = 4ρ²L² (1 − cos³α)/3, so V = {}. By the cosine: E[X²] = ρ²L² sin²α, so \
             V = 1/sin²α − 1 = {}. The means are equal, so the variances have the ratio {}.",
            significant(radius(s).powi(2) / (radius(s).powi(2) + 4.0), 4),
            significant(uniform, 4),
            significant(cosine, 4),
            significant(uniform / cosine, 4)
        )
    },
};
