//! Exercises of chapter 2 that the program judges.
//!
//! ```text
//! 2.1  E = π L sin²α = π L R²/(R² + h²)        2.2  L = ρ/(1 − ρ) · E/π,   E = I/r²
//! ```

use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, IRRADIANCE, Mistake, RADIANCE, Student, Task};
use fredholm::report::text::number::significant;
use std::f64::consts::PI;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[DISC, SPHERE];

const DISC: Exercise = Exercise {
    number: 1,
    title: "a disc above the floor",
    question: |s| {
        let [r, h, l] = disc(s);
        format!(
            "A disc of radius {r} m and radiance {l} W/(m² sr) hangs {h} m above the floor and faces it. What is the irradiance of the \
             point below its centre? Give three digits."
        )
    },
    task: Task::Number {
        unit: IRRADIANCE,
        margin: 0.01,
        truth: |s| {
            let [r, h, l] = disc(s);
            Ok(Number { value: PI * l * r * r / (r * r + h * h), std_error: 0.0 })
        },
        mistakes: |s| {
            let [r, h, l] = disc(s);
            let sine = r / r.hypot(h);
            vec![
                Mistake {
                    value: PI * l * r * r / (h * h),
                    says: "This is the irradiance of a point light. The disc is too near for that.",
                },
                Mistake {
                    value: l * sine * sine,
                    says: "The factor π is missing: the integral of the cosine over the cone is π sin²α.",
                },
                Mistake { value: PI * l * sine, says: "The sine counts squared." },
                Mistake {
                    value: 2.0 * PI * l * (1.0 - h / r.hypot(h)),
                    says: "This is L times the solid angle: the cosine at the floor is missing.",
                },
            ]
        },
    },
    hint: "E = π L sin²α, where α is half of the angle that the disc fills, seen from the floor.",
    solution: |s| {
        let [r, h, l] = disc(s);
        let sine2 = r * r / (r * r + h * h);
        format!(
            "sin²α = R²/(R² + h²) = {}. So E = π · {l} · {} = {} W/m².",
            significant(sine2, 4),
            significant(sine2, 4),
            significant(PI * l * sine2, 4)
        )
    },
};

/// Radius, height, radiance. The disc is so large that the cosine at the floor matters.
fn disc(s: &Student) -> [f64; 3] {
    let [r, h] = s.pick("2.1 disc", &[[1.0, 1.5], [1.2, 1.0], [1.5, 2.0], [1.5, 1.0], [2.0, 1.2], [2.0, 2.5]]);
    [r, h, s.pick("2.1 radiance", &[2.0, 4.0, 5.0, 8.0, 20.0])]
}

const SPHERE: Exercise = Exercise {
    number: 2,
    title: "a point light in a hollow sphere",
    question: |s| {
        let [r, rho] = sphere(s);
        format!(
            "A point light of intensity π W/sr stands in the middle of a hollow sphere of radius {r} m and albedo {rho}. Which radiance \
             do the walls have, with all reflections? Give three digits."
        )
    },
    task: Task::Number {
        unit: RADIANCE,
        margin: 0.01,
        truth: |s| {
            let [r, rho] = sphere(s);
            Ok(Number { value: rho / (r * r * (1.0 - rho)), std_error: 0.0 })
        },
        mistakes: |s| {
            let [r, rho] = sphere(s);
            vec![
                Mistake {
                    value: rho / (r * r),
                    says: "This is one reflection. Each further reflection brings a factor of the albedo.",
                },
                Mistake { value: rho / (1.0 - rho), says: "The irradiance falls with the square of the radius." },
                Mistake {
                    value: 1.0 / (r * r * (1.0 - rho)),
                    says: "The walls do not emit: the sum begins with one reflection.",
                },
                Mistake {
                    value: PI * rho / (r * r * (1.0 - rho)),
                    says: "Radiance is the reflected flux density divided by π.",
                },
            ]
        },
    },
    hint: "The light itself gives E = I/r². The first reflection has the radiance ρE/π, the next one ρ times that, and so on.",
    solution: |s| {
        let [r, rho] = sphere(s);
        format!(
            "E = π/{r}² = {} W/m². One reflection gives ρE/π = {}. All reflections give this divided by 1 − {rho}: {} W/(m² sr).",
            significant(PI / (r * r), 4),
            significant(rho / (r * r), 4),
            significant(rho / (r * r * (1.0 - rho)), 4)
        )
    },
};

/// Radius and albedo.
fn sphere(s: &Student) -> [f64; 2] {
    [s.pick("2.2 radius", &[0.5, 0.8, 1.5, 2.0, 3.0]), s.pick("2.2 albedo", &[0.2, 0.3, 0.4, 0.6, 0.7, 0.8])]
}
