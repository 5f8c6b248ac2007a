//! Exercises of chapter 7 that the program judges.
//!
//! ```text
//! cube: c = 1 + ρ (F_o f + 4 F_a w),  f = ρ (F_o c + 4 F_a w),  w = ρ (F_a (c + f) + (F_o + 2 F_a) w)
//! sweeps for a factor 10^−d: d ln 10/ln(1/r)        A_i F_ij = A_j F_ji
//! ```
//!
//! | symbol | meaning | exercise |
//! |---|---|---|
//! | ρ; c, f, w | albedo of the cube; radiance of ceiling, floor and side walls | 7.1 |
//! | r, d | spectral radius; decimal digits to be gained | 7.2, 7.5 |
//! | A | areas of lamp and floor | 7.4 |
//!
//! Exercise 7.3 has no numbers to choose.

use super::RED;
use fredholm::engine::by_matrix;
use fredholm::progress::Progress;
use fredholm::report::exercise::{Exercise, Mistake, Result, Student, Task, Unit};
use fredholm::report::text::{measured::Number, number::significant};
use fredholm::scene::{Scene, load};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[CUBE, SWEEPS, LAMP, READ];

/// Form factors of opposite and of neighbouring walls of a cube.
const OPPOSITE: f64 = 0.199_825;
const NEIGHBOUR: f64 = 0.200_044;

fn exact(value: f64) -> Result<Number> {
    Ok(Number { value, std_error: 0.0 })
}

const CUBE: Exercise = Exercise {
    number: 1,
    title: "the floor of a cube with six patches",
    question: |s| {
        format!(
            "In a unit cube, opposite walls have the form factor 0.199825 and neighbouring walls 0.200044. All walls have the \
             albedo {}, and the ceiling emits 1. With one patch for each wall, what is the radiance of the floor? Give three \
             digits.",
            albedo(s)
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.003,
        truth: |s| exact(cube(albedo(s))[1]),
        mistakes: |s| {
            let rho = albedo(s);
            vec![
                Mistake { value: rho * OPPOSITE, says: "This is direct light alone, the first term of the series." },
                Mistake { value: cube(rho)[0], says: "This is the radiance of the ceiling." },
                Mistake { value: 1.0 / (6.0 * (1.0 - rho)), says: "This is the mean over all six walls." },
            ]
        },
    },
    hint: "By symmetry there are three unknowns: ceiling c, floor f and side walls w. The difference c − f is simple.",
    solution: |s| {
        let rho = albedo(s);
        let [c, f, w] = cube(rho).map(|x| significant(x, 4));
        format!(
            "c = 1 + {rho} (F_o f + 4 F_a w), f = {rho} (F_o c + 4 F_a w), w = {rho} (F_a c + F_a f + (F_o + 2 F_a) w). \
             The difference is c − f = 1/(1 + {rho} F_o). The solution is c = {c}, f = {f}, w = {w}."
        )
    },
};

fn albedo(s: &Student) -> f64 {
    s.pick("7.1 albedo", &[0.3, 0.4, 0.6, 0.7, 0.8, 0.9])
}

/// Radiance of ceiling, floor and side walls.
fn cube(rho: f64) -> [f64; 3] {
    let difference = 1.0 / (1.0 + rho * OPPOSITE);
    // w = share · (c + f), and c + f = 1 + ρ F_o (c + f) + 8 ρ F_a w
    let share = rho * NEIGHBOUR / (1.0 - rho * (OPPOSITE + 2.0 * NEIGHBOUR));
    let sum = 1.0 / (1.0 - rho * OPPOSITE - 8.0 * rho * NEIGHBOUR * share);
    [0.5 * (sum + difference), 0.5 * (sum - difference), share * sum]
}

const SWEEPS: Exercise = Exercise {
    number: 2,
    title: "sweeps of Jacobi",
    question: |s| {
        let (r, digits) = radius(s);
        format!(
            "The spectral radius of a mesh is {r}. In late sweeps Jacobi's error falls by this factor. Which is the least \
             number of late sweeps that make the error 10^{digits} times smaller?"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| {
            let (r, digits) = radius(s);
            exact(sweeps(r, digits).ceil())
        },
        mistakes: |s| {
            let (r, digits) = radius(s);
            let c = 1.43 / (1.0 - r);
            let q = (c.sqrt() - 1.0) / (c.sqrt() + 1.0);
            let gradients = ((2.0 * 10f64.powi(digits)).ln() / (1.0 / q).ln()).ceil();
            vec![
                Mistake { value: gradients, says: "This is the bound of conjugate gradients for λ_min = −0.43." },
                Mistake {
                    value: (f64::from(digits) / (1.0 / r).ln()).ceil(),
                    says: "You divided a decimal logarithm by a natural one.",
                },
            ]
        },
    },
    hint: "Solve rⁿ ≤ 10^−d for n.",
    solution: |s| {
        let (r, digits) = radius(s);
        let n = sweeps(r, digits);
        format!("n ≥ {digits} ln 10/ln(1/{r}) = {}, so {} sweeps.", significant(n, 4), n.ceil())
    },
};

fn radius(s: &Student) -> (f64, i32) {
    s.pick("7.2 radius", &[(0.4, 6), (0.6, 4), (0.7, 6), (0.8, 3), (0.85, 5), (0.95, 4)])
}

/// Sweeps for d digits.
fn sweeps(r: f64, digits: i32) -> f64 {
    f64::from(digits) * 10f64.ln() / (1.0 / r).ln()
}

const LAMP: Exercise = Exercise {
    number: 4,
    title: "from the floor to the lamp",
    question: |s| {
        let (lamp, floor, part) = areas(s);
        format!(
            "A lamp of {lamp} m² hangs above a floor of {floor} m². {} % of the light that leaves the lamp arrives at the \
             floor. What part of the light that leaves the floor arrives at the lamp? Give three digits.",
            significant(100.0 * part, 2)
        )
    },
    task: Task::Number {
        unit: Unit::Share,
        margin: 0.01,
        truth: |s| {
            let (lamp, floor, part) = areas(s);
            exact(part * lamp / floor)
        },
        mistakes: |s| {
            let (lamp, floor, part) = areas(s);
            vec![
                Mistake { value: part, says: "Form factors are symmetric only after multiplication by the area." },
                Mistake { value: part * floor / lamp, says: "You divided by the wrong area: a part cannot exceed 1." },
                Mistake { value: lamp / floor, says: "This is the ratio of the areas. The form factor is missing." },
            ]
        },
    },
    hint: "Reciprocity: the area of the lamp times its form factor is the area of the floor times the other one.",
    solution: |s| {
        let (lamp, floor, part) = areas(s);
        format!("F = {part} · {lamp}/{floor} = {}.", significant(part * lamp / floor, 4))
    },
};

fn areas(s: &Student) -> (f64, f64, f64) {
    s.pick(
        "7.4 areas",
        &[(0.1, 4.0, 0.5), (0.25, 6.0, 0.45), (0.5, 12.0, 0.7), (0.3, 9.0, 0.4), (0.2, 5.0, 0.65), (0.15, 8.0, 0.55)],
    )
}

const READ: Exercise = Exercise {
    number: 5,
    title: "the sweeps of a room",
    question: |s| {
        let rho = white(s);
        format!(
            "Run\n  fredholm radiosity cornell --patches 60 --solver jacobi --channel red \
             --set 'materials.white.reflectance=[{rho},{rho},{rho}]'\n\
             and read the spectral radius. How many late sweeps does it predict for an error 10⁴ times smaller? Give the \
             result with one decimal, without rounding up, and compare it with the columns 1e-6 and 1e-10."
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| exact(sweeps(room(white(s))?, 4)),
        mistakes: |s| {
            let Ok(r) = room(white(s)) else { return vec![] };
            vec![
                Mistake {
                    value: sweeps(white(s), 4),
                    says: "You used the albedo of the white walls. It is only a bound for the spectral radius.",
                },
                Mistake { value: 4.0 / (1.0 / r).ln(), says: "You divided a decimal logarithm by a natural one." },
            ]
        },
    },
    hint: "Each late sweep multiplies the error by the spectral radius.",
    solution: |s| match room(white(s)) {
        Ok(r) => format!("r = {}, and 4 ln 10/ln(1/r) = {}.", significant(r, 4), significant(sweeps(r, 4), 3)),
        Err(error) => error.to_string(),
    },
};

fn white(s: &Student) -> f64 {
    s.pick("7.5 white", &[0.6, 0.65, 0.7, 0.75, 0.8, 0.95])
}

/// The spectral radius of the Cornell box with white walls of this albedo, in red.
fn room(rho: f64) -> Result<f64> {
    let set = vec![format!("materials.white.reflectance=[{rho},{rho},{rho}]")];
    let room = load::scene("cornell", &load::Options { set, ..Default::default() })?.description;
    Ok(by_matrix::dense_matrix(&room, &Scene::new(&room), 60, 1.0, 0, Progress::NONE)?.spectral[RED].radius)
}
