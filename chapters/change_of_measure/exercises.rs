//! Exercises of chapter 8 that the program judges.
//!
//! ```text
//! 8.1  T E = ρ E R²/(R² + h²)        8.4  Var = D₁²/P₁ + D₂²/P₂ − (D₁ + D₂)²        8.5  s² if 1/m² is missing, else 1
//! ```

use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, RADIANCE, Result, Student, Task, Unit};
use fredholm::report::text::number::significant;
use std::f64::consts::PI;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[DISC, LAMPS, SCALE];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

fn mistake(value: f64, says: &'static str) -> Mistake {
    Mistake { value, says }
}

/// ρ, R and h.
fn disc(s: &Student) -> [f64; 3] {
    [
        s.pick("8.1 reflectance", &[0.2, 0.3, 0.4, 0.6, 0.8]),
        s.pick("8.1 radius", &[0.5, 0.75, 1.25, 1.8, 2.0]),
        s.pick("8.1 height", &[0.8, 1.0, 1.2, 1.6, 2.0]),
    ]
}

fn below_disc([rho, r, h]: [f64; 3]) -> f64 {
    rho * r * r / (r * r + h * h)
}

const DISC: Exercise = Exercise {
    number: 1,
    title: "direct light below a disc",
    question: |s| {
        let [rho, r, h] = disc(s);
        format!(
            "A black disc of radius {r} m emits the radiance 1 W/(m² sr). It hangs horizontally {h} m above a matt floor of \
             reflectance {rho}. Which radiance does the floor reflect below the centre of the disc? Predict it, then check it \
             with the row k = 1 of\n\n\
             fredholm series cornell --worlds terms --technique connect --max-bounces 1 --size 64x64 --spp 64 \
             --set 'materials.white.reflectance=[{rho}, {rho}, {rho}]' --set 'materials.red.reflectance=[0, 0, 0]' \
             --set 'shapes=[{{ type = \"quad\", origin = [-1, -1, 1], edge_u = [2, 0, 0], edge_v = [0, 0, -2], material = \"white\" }}, \
             {{ type = \"disk\", center = [0, {}, 0], normal = [0, -1, 0], radius = {r}, material = \"red\", emission = [1, 1, 1] }}]' \
             --set 'camera.origin=[0.6, -0.8, 0]' --set 'camera.target=[0, -1, 0]' --set camera.fov=0.1\n\n\
             Give three digits.",
            significant(h - 1.0, 2)
        )
    },
    task: Task::Number {
        unit: RADIANCE,
        margin: 0.01,
        truth: |s| exact(below_disc(disc(s))),
        mistakes: |s| {
            let [rho, r, h] = disc(s);
            let right = below_disc([rho, r, h]);
            vec![
                mistake(rho * (r / h).powi(2), "This takes every point of the disc at the distance h, without a tilt."),
                mistake(right * PI, "A factor 1/π is missing: f = ρ/π."),
                mistake(right / PI, "The factor 1/π of f cancels with the π of the integral over the disc."),
            ]
        },
    },
    hint: "Both cosines are h/d with d² = h² + r², so G = h²/d⁴. Integrate over rings dA = 2πr dr.",
    solution: |s| {
        let [rho, r, h] = disc(s);
        format!(
            "T E = ρ/π · E ∫₀ᴿ h²/(h² + r²)² 2πr dr = ρ E R²/(R² + h²) = {rho} · {} = {} W/(m² sr).",
            significant(r * r / (r * r + h * h), 4),
            significant(below_disc([rho, r, h]), 4)
        )
    },
};

/// D₁, D₂ and P₁.
fn lamps(s: &Student) -> [f64; 3] {
    [
        s.pick("8.4 strong lamp", &[7.0, 8.0, 10.0, 12.0, 15.0]),
        s.pick("8.4 weak lamp", &[1.0, 1.5, 2.0, 2.5, 3.0]),
        s.pick("8.4 probability", &[0.2, 0.3, 0.35, 0.45, 0.55]),
    ]
}

/// The mean square of Dᵢ/Pᵢ, and the squared mean.
fn of_lamps([a, b, p]: [f64; 3]) -> [f64; 2] {
    [a * a / p + b * b / (1.0 - p), (a + b).powi(2)]
}

const LAMPS: Exercise = Exercise {
    number: 4,
    title: "the variance of a choice between two lamps",
    question: |s| {
        let [a, b, p] = lamps(s);
        format!(
            "At a point two lamps give the direct light D₁ = {a} and D₂ = {b}, in W/(m² sr), and the estimate of each alone has \
             no noise. The estimator chooses the first lamp with probability {p}, otherwise the second, and divides by the \
             probability. What is the variance of one sample, in (W/(m² sr))²? Give three digits, without unit."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let [square, mean] = of_lamps(lamps(s));
            exact(square - mean)
        },
        mistakes: |s| {
            let [a, b, p] = lamps(s);
            let [square, _] = of_lamps([a, b, p]);
            vec![
                mistake(square, "This is the mean square. Subtract the squared mean."),
                mistake(
                    p * (1.0 - p) * (a - b).powi(2),
                    "This is the variance without the division by the probability; that estimator is biased.",
                ),
            ]
        },
    },
    hint: "The sample is D₁/P₁ with probability P₁ and D₂/P₂ with probability P₂.",
    solution: |s| {
        let [square, mean] = of_lamps(lamps(s));
        format!(
            "E[X²] = D₁²/P₁ + D₂²/P₂ = {} and E[X] = D₁ + D₂ = {}. The variance is {} − {} = {}.",
            significant(square, 5),
            mean.sqrt(),
            significant(square, 5),
            mean,
            significant(square - mean, 4)
        )
    },
};

/// A member of the zoo, the power of the scale by which its light grows, and the scale.
fn scaled(s: &Student) -> (&'static str, i32, f64) {
    let all = [("area-density", 2), ("no-inverse-square", 2), ("no-light-cosine", 0), ("no-receiver-cosine", 0)];
    let (name, power) = s.pick("8.5 mistake", &all);
    (name, power, s.pick("8.5 scale", &[2.0, 3.0, 5.0, 20.0, 100.0]))
}

const SCALE: Exercise = Exercise {
    number: 5,
    title: "a mistake and the scale of the scene",
    question: |s| {
        let (name, _, scale) = scaled(s);
        format!(
            "All lengths of the Cornell box are multiplied by {scale}; the radiance of its lamp stays the same. A renderer has the \
             mistake `{name}` (read what it does: fredholm zoo {name}). By which factor does its mean of T E change?"
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (_, power, scale) = scaled(s);
            exact(scale.powi(power))
        },
        mistakes: |s| {
            let (_, power, scale) = scaled(s);
            let other = match power {
                0 => "The missing factor has no unit, so the picture is wrong by the same factor at every scale.",
                _ => "The missing factor has the unit 1/m², so the picture depends on the unit of length.",
            };
            vec![
                mistake(scale.powi(2 - power), other),
                mistake(scale, "No mistake of this kind lacks a factor with the unit 1/m."),
                mistake(
                    1.0 / (scale * scale),
                    "Look at the right estimator: dividing by d² makes distant lamps weaker.",
                ),
            ]
        },
    },
    hint: "The right estimator gives the same radiance at every scale. Which unit has the factor that is missing?",
    solution: |s| {
        let (name, power, scale) = scaled(s);
        let (missing, unit) = match name {
            "area-density" => ("cos θ_y/d²", "1/m²"),
            "no-inverse-square" => ("1/d²", "1/m²"),
            "no-light-cosine" => ("cos θ_y", "no unit"),
            _ => ("cos θ_x", "no unit"),
        };
        format!(
            "`{name}` lacks {missing}, which has {}. The right estimator does not change with the scale, so T E of the mistake \
             changes by the factor {}.",
            if power == 0 { unit.to_owned() } else { format!("the unit {unit}") },
            scale.powi(power)
        )
    },
};
