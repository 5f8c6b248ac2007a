//! Exercises of chapter 12 that the program judges.
//!
//! ```text
//! F₀ = ((n − 1)/(n + 1))²        sin θ_c = 1/n        (1 − F)² (1 + F² + F⁴ + …) = (1 − F)/(1 + F)
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | index of refraction | [`index`], [`clear`], [`dense`] |
//! | F₀ | reflectance along the normal | [`normal`] |
//! | θ_c | critical angle | [`critical`] |

use fredholm::report::exercise::{Exercise, Mistake, Student, Task, Unit};
use fredholm::report::text::{measured::Number, number::significant};

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[
    Exercise {
        number: 1,
        title: "reflection along the normal",
        question: |s| {
            format!(
                "A ray in air meets a transparent material of index n = {} along its normal. Which part of the light \
                 is reflected? Give three digits.",
                index(s)
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.01,
            truth: |s| Ok(exact(normal(index(s)))),
            mistakes: |s| {
                let f = normal(index(s));
                vec![
                    Mistake { value: f.sqrt(), says: "This is the ratio of the amplitudes. Light is their square." },
                    Mistake { value: 1.0 - f, says: "This is the part that is refracted." },
                ]
            },
        },
        hint: "Along the normal, both polarisations have the same amplitude, (n − 1)/(n + 1) of the arriving one.",
        solution: |s| {
            let n = index(s);
            format!(
                "The amplitude is (n − 1)/(n + 1) = ({n} − 1)/({n} + 1) = {}. The reflected part of the light is its \
                 square, {}.",
                four(normal(n).sqrt()),
                four(normal(n))
            )
        },
    },
    Exercise {
        number: 2,
        title: "the critical angle",
        question: |s| {
            format!(
                "A lamp is inside a transparent material of index n = {}, with air above its flat surface. Beyond \
                 which angle with the normal does none of its light leave? Give the angle in degrees, with three \
                 digits.",
                clear(s)
            )
        },
        task: Task::Number {
            unit: Unit::Of(&["°", "deg", "degrees"]),
            margin: 0.01,
            truth: |s| Ok(exact(critical(clear(s)).to_degrees())),
            mistakes: |s| {
                let n = clear(s);
                vec![
                    Mistake { value: critical(n), says: "This is the angle in radians." },
                    Mistake {
                        value: 90.0 - critical(n).to_degrees(),
                        says: "This is the angle with the surface, not with the normal.",
                    },
                    Mistake {
                        value: n.atan().to_degrees(),
                        says: "This is Brewster's angle in air, where light of one polarisation is not reflected.",
                    },
                ]
            },
        },
        hint: "At the critical angle the refracted ray runs along the surface: its angle is 90°.",
        solution: |s| {
            let n = clear(s);
            format!(
                "Snell's law is n sin θ = 1 · sin θ'. With θ' = 90° this gives sin θ = 1/{n} = {}, so θ = {}°.",
                four(1.0 / n),
                four(critical(n).to_degrees())
            )
        },
    },
    Exercise {
        number: 3,
        title: "the kind of path that is missing",
        question: |s| {
            format!(
                "The letters of a path are those of its vertices, from the lamp L to the eye E: S is a mirror or \
                 glass, D is any other surface. Which of the kinds LDE, LDSE, LSDE, LDSDE is missing in the pictures \
                 of {}?",
                renderer(s).0
            )
        },
        task: Task::Choice {
            words: &KINDS,
            truth: |s| missing(renderer(s).1).ok_or_else(|| "no kind of path is missing".into()),
            mistakes: &[
                ("LDE", "A single diffuse reflection is found from both ends."),
                ("LDSE", FOUND),
                ("LSDE", FOUND),
                ("LDSDE", "Both ends of this path are next to a D, so it can be connected from either end."),
            ],
        },
        hint: "A connection needs a D next to the point to which it leads, because a mirror does not reflect light \
               towards a given point.",
        solution: |s| {
            let (words, from_eye) = renderer(s);
            let (end, letter) = if from_eye { ("the lamp", "L") } else { ("the eye", "E") };
            format!(
                "In {words}, {end} is found only through a connection from the vertex next to it. So the letter next \
                 to {letter} must be D. Of the four kinds, only {} has an S there.",
                missing(from_eye).unwrap_or_default()
            )
        },
    },
    Exercise {
        number: 4,
        title: "a plate of glass",
        question: |s| {
            let n = dense(s);
            format!(
                "A plate has two parallel surfaces and the index n = {n}. Light arrives along the normal and is \
                 reflected inside again and again. Which part of it leaves on the other side? Give three digits. In \
                 a sky of radiance 1, a path leaves a plate on the other side after 2, 4, 6, … reflections and \
                 refractions. So you can check your answer with the sum of T²E, T⁴E, T⁶E and T⁸E in the output of\n\
                 `{}`",
                command(n)
            )
        },
        task: Task::Number {
            unit: Unit::Share,
            margin: 0.01,
            truth: |s| Ok(exact(through(normal(dense(s))))),
            mistakes: |s| {
                let f = normal(dense(s));
                vec![
                    Mistake { value: (1.0 - f).powi(2), says: "This light is never reflected inside. There is more." },
                    Mistake { value: 1.0 - f, says: "This is the part that enters through the first surface." },
                    Mistake { value: 1.0 - through(f), says: "This is the part that the plate reflects." },
                ]
            },
        },
        hint: "Each passage to and fro inside the plate multiplies the light by F². Sum the geometric series.",
        solution: |s| {
            let n = dense(s);
            let f = normal(n);
            format!(
                "One surface reflects F = ((n − 1)/(n + 1))² = {}. Light enters and leaves with (1 − F)². Before it \
                 leaves, it is reflected 0, 2, 4, … times inside. The sum is (1 − F)² (1 + F² + F⁴ + …) = (1 − \
                 F)²/(1 − F²) = (1 − F)/(1 + F) = {}.",
                four(f),
                four(through(f))
            )
        },
    },
];

/// Why a kind of path with one S is not the missing one.
const FOUND: &str = "This kind is found: the letter next to the end that needs a connection is D.";

/// The kinds of path of exercise 3.
const KINDS: [&str; 4] = ["LDE", "LDSE", "LSDE", "LDSDE"];

/// n of exercise 1, from ice to diamond.
fn index(s: &Student) -> f64 {
    s.pick("12.1 index", &[1.31, 1.36, 1.47, 1.6, 1.77, 2.0, 2.42])
}

/// n of exercise 2. None is near √2, where the critical angle is 45° from both sides.
fn clear(s: &Student) -> f64 {
    s.pick("12.2 index", &[1.31, 1.33, 1.49, 1.52, 1.66, 1.77, 2.42])
}

/// n of exercise 4. F is so large that reflections inside the plate matter.
fn dense(s: &Student) -> f64 {
    s.pick("12.4 index", &[2.3, 2.42, 2.6, 2.9, 3.4, 4.0])
}

/// A renderer of exercise 3, and whether its walks begin at the eye.
fn renderer(s: &Student) -> (&'static str, bool) {
    let all = [
        (
            "a path tracer that connects every vertex to a lamp with area and never counts emission on a hit after vertex 0",
            true,
        ),
        ("a path tracer with connections in a scene whose only lamp is a point", true),
        ("a path tracer with connections in a scene whose only light comes from the sun, taken as one direction", true),
        ("a light tracer in a scene with an area lamp, seen through a pinhole", false),
        ("a light tracer in a scene whose only lamp is a point, seen through a pinhole", false),
        ("a light tracer in a scene whose only light comes from the sun, seen through a pinhole", false),
    ];
    s.pick("12.3 renderer", &all)
}

/// The kind of path with an S next to the end that is only found through connections.
fn missing(from_eye: bool) -> Option<&'static str> {
    let next = |kind: &str| if from_eye { kind.chars().nth(1) } else { kind.chars().rev().nth(1) };
    KINDS.into_iter().find(|kind| next(kind) == Some('S'))
}

/// A plate in the white sky, seen along its normal.
fn command(n: f64) -> String {
    let plate = "shapes=[{ type = \"box\", min = [-1,-1,-0.1], max = [1,1,0.1], material = \"glass\" }]";
    format!(
        "fredholm series glass-furnace --set materials.glass.ior={n} --set '{plate}' --set camera.fov=1 --size 32x32"
    )
}

fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

/// F₀ = ((n − 1)/(n + 1))².
fn normal(n: f64) -> f64 {
    ((n - 1.0) / (n + 1.0)).powi(2)
}

/// θ_c = asin(1/n), in radians.
fn critical(n: f64) -> f64 {
    (1.0 / n).asin()
}

/// (1 − F)/(1 + F).
fn through(f: f64) -> f64 {
    (1.0 - f) / (1.0 + f)
}

fn four(x: f64) -> String {
    significant(x, 4)
}
