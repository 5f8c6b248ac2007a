//! Exercises of chapter 6 that the program judges.
//!
//! ```text
//! plates: r(T) = √(ρ₁ρ₂)      furnace: ρ^(K+1)/(1 − ρ) ≤ 0.01      sphere: r(T) = mean albedo      (s T)^k E = s^k T^k E
//! ```
//!
//! | symbol | meaning | exercise |
//! |---|---|---|
//! | ρ₁, ρ₂ | albedos of two parallel plates | 6.1 |
//! | ρ, K | albedo of a furnace; the last term that is kept | 6.2 |
//! | a, ρ_a, ρ_b | part of the sphere with the albedo ρ_a; the rest has ρ_b | 6.3 |
//! | s | factor of all albedos | 6.5 |

use fredholm::report::exercise::{Exercise, Mistake, RADIANCE, Result, Student, Task, Unit};
use fredholm::report::text::{measured::Number, number::significant};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[PLATES, GUARANTEE, SPHERE, SCALED];

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

const PLATES: Exercise = Exercise {
    number: 1,
    title: "the spectral radius of two plates",
    question: |s| {
        let (a, b) = plates(s);
        format!(
            "Two infinite parallel plates have the albedos {a} and {b}. All light that leaves one plate arrives at the other. \
             What is the spectral radius r(T)? Give three digits."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (a, b) = plates(s);
            exact((a * b).sqrt())
        },
        mistakes: |s| {
            let (a, b) = plates(s);
            vec![
                Mistake { value: a, says: "This is the largest albedo, which is only a bound for r(T)." },
                Mistake { value: a * b, says: "This is the factor of two reflections together." },
                Mistake { value: (a + b) / 2.0, says: "Light meets the plates in turn, so the albedos multiply." },
            ]
        },
    },
    hint: "Two reflections together multiply the light of a plate by the product of the albedos.",
    solution: |s| {
        let (a, b) = plates(s);
        format!(
            "T(x, y) = ({a} y, {b} x), so T²(x, y) = {0} (x, y). The eigenvalues of T are ± √{0}, and r(T) = {1}.",
            significant(a * b, 3),
            significant((a * b).sqrt(), 3)
        )
    },
};

fn plates(s: &Student) -> (f64, f64) {
    s.pick("6.1 plates", &[(0.8, 0.2), (0.8, 0.45), (0.5, 0.32), (0.9, 0.1), (0.98, 0.5)])
}

const GUARANTEE: Exercise = Exercise {
    number: 2,
    title: "the guaranteed number of bounces",
    question: |s| {
        let rho = furnace(s);
        format!(
            "All walls of a furnace have the albedo {rho}. Which least K does the a priori bound guarantee, so that all terms \
             after K together are at most 1 % of ‖E‖₁? Predict K, then check it: the number is in the second line of\n  \
             fredholm info furnace --set 'materials.wall.reflectance=[{rho},{rho},{rho}]'"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| exact(guaranteed(furnace(s))),
        mistakes: |s| {
            let rho = furnace(s);
            let of_all_light = (0.01f64.ln() / rho.ln()).ceil() - 1.0;
            vec![
                Mistake {
                    value: of_all_light,
                    says: "After this K, 1 % of all light is missing. The guarantee compares with ‖E‖₁, which is less.",
                },
                Mistake {
                    value: guaranteed(rho) + 1.0,
                    says: "This is K + 1, the number of terms. The first one is k = 0.",
                },
            ]
        },
    },
    hint: "Solve ρ^(K+1)/(1 − ρ) ≤ 0.01 for K.",
    solution: |s| {
        let (rho, k) = (furnace(s), guaranteed(furnace(s)));
        format!(
            "K + 1 ≥ ln(0.01 · (1 − {rho}))/ln {rho} = {}, so K = {k}.",
            significant((0.01 * (1.0 - rho)).ln() / rho.ln(), 3)
        )
    },
};

fn furnace(s: &Student) -> f64 {
    s.pick("6.2 albedo", &[0.65, 0.7, 0.75, 0.8, 0.85])
}

/// The least K with ρ^(K+1)/(1 − ρ) ≤ 0.01.
fn guaranteed(rho: f64) -> f64 {
    ((0.01 * (1.0 - rho)).ln() / rho.ln()).ceil() - 1.0
}

const SPHERE: Exercise = Exercise {
    number: 3,
    title: "the spectral radius of a sphere",
    question: |s| {
        let (part, [a, b]) = sphere(s);
        format!(
            "Inside a hollow sphere, {} % of the area has the albedo {a}, the rest {b}. Each point sees every other point \
             equally well. What is the spectral radius r(T)? Give three digits.",
            100.0 * part
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| exact(mean_albedo(s)),
        mistakes: |s| {
            let (part, [a, b]) = sphere(s);
            vec![
                Mistake { value: a, says: "This is the largest albedo, which is only a bound for r(T)." },
                Mistake {
                    value: (a + b) / 2.0,
                    says: "The two parts have different areas: weight the albedos with them.",
                },
                Mistake { value: part * b + (1.0 - part) * a, says: "The areas are exchanged." },
            ]
        },
    },
    hint: "T x = ρ times the mean of x over the sphere. What is the mean of T x?",
    solution: |s| {
        let (part, [a, b]) = sphere(s);
        format!(
            "T x = ρ x̄, so every term after the first is a multiple of ρ, and each step multiplies the mean by the mean albedo: \
             {part} · {a} + {} · {b} = {}.",
            significant(1.0 - part, 2),
            significant(mean_albedo(s), 3)
        )
    },
};

fn sphere(s: &Student) -> (f64, [f64; 2]) {
    let albedos = s.pick("6.3 albedos", &[[0.9, 0.3], [0.8, 0.2], [0.95, 0.45], [0.85, 0.25], [0.9, 0.4]]);
    (s.pick("6.3 area", &[0.1, 0.2, 0.25, 0.3, 0.7]), albedos)
}

fn mean_albedo(s: &Student) -> f64 {
    let (part, [a, b]) = sphere(s);
    part * a + (1.0 - part) * b
}

const SCALED: Exercise = Exercise {
    number: 5,
    title: "a term for other albedos",
    question: |s| {
        let (scale, k) = scaled(s);
        let rho = significant(0.6 * scale, 3);
        format!(
            "The command\n  fredholm series sphere --worlds terms --max-bounces 4\nprints the means of the terms T^k E of a \
             sphere with the albedo 0.6. Read the mean for k = {k}. What is it if the albedo is {rho}, {scale} times as \
             large? Give three digits, in W/(m² sr), without rendering again. Then check it: add\n  \
             --set 'materials.wall.reflectance=[{rho},{rho},{rho}]'"
        )
    },
    task: Task::Number {
        unit: RADIANCE,
        margin: 0.02,
        truth: |s| {
            let (scale, k) = scaled(s);
            exact(term(k) * scale.powi(k))
        },
        mistakes: |s| {
            let (scale, k) = scaled(s);
            vec![
                Mistake { value: term(k) * scale, says: "Each of the k reflections brings a factor s." },
                Mistake { value: term(k), says: "This is the term for the albedo 0.6." },
                Mistake { value: term(k) * scale.powi(k + 1), says: "The term k has k reflections, not k + 1." },
            ]
        },
    },
    hint: "(s T)^k E = s^k T^k E.",
    solution: |s| {
        let (scale, k) = scaled(s);
        format!(
            "The mean for the albedo 0.6 is {}. The term k = {k} has {k} reflections, so it gets the factor {scale}^{k} = {}: \
             {}.",
            significant(term(k), 3),
            significant(scale.powi(k), 4),
            significant(term(k) * scale.powi(k), 3)
        )
    },
};

fn scaled(s: &Student) -> (f64, i32) {
    (s.pick("6.5 factor", &[0.5, 0.75, 0.8, 1.25, 1.5]), s.pick("6.5 term", &[2, 3, 4]))
}

/// T^k E in the scene `sphere`, for k ≥ 1.
fn term(k: i32) -> f64 {
    0.06 * 0.6f64.powi(k - 1)
}
