//! Exercises of chapter 1 that the program judges.
//!
//! ```text
//! 1.3  largest k of a picture with depth D: D − 1 in Mitsuba, D in pbrt and fredholm        1.5  E → a E, T → b T:  T^k E → a b^k T^k E
//! ```

use fredholm::report::book::Number;
use fredholm::report::exercise::{Exercise, Mistake, Student, Task, Unit};
use fredholm::report::text::number::significant;

/// All of them.
pub(super) const EXERCISES: &[Exercise] = &[DEPTH, SCALED];

const DEPTH: Exercise = Exercise {
    number: 3,
    title: "what other programs call k",
    question: |s| {
        let (program, option, depth, _) = picture(s);
        format!(
            "A picture was rendered by {program} with {option} = {depth}. Which is the largest k in this picture? (k is the \
             number of reflections; k = 0 is the lamp seen directly.)"
        )
    },
    task: Task::Number {
        unit: Unit::Count,
        margin: 0.0,
        truth: |s| {
            let (.., depth, less) = picture(s);
            Ok(Number { value: f64::from(depth - less), std_error: 0.0 })
        },
        mistakes: |s| {
            let (.., depth, less) = picture(s);
            let other = f64::from(depth + less - 1);
            let says = match less {
                1 => "This would be the largest k in pbrt. Mitsuba counts the segments of the path: k ≤ D − 1.",
                _ => "This would be the largest k in Mitsuba. Here the depth counts reflections.",
            };
            vec![Mistake { value: other, says }]
        },
    },
    hint: "The table `What other programs call k` lists which terms a depth D contains.",
    solution: |s| {
        let (program, _, depth, less) = picture(s);
        let rule = if less == 1 { "k ≤ D − 1" } else { "k ≤ D" };
        format!("In {program} a depth of D shows {rule}. With D = {depth} the largest k is {}.", depth - less)
    },
};

/// A program, its option, the depth, and by how much the largest k is less than the depth.
fn picture(s: &Student) -> (&'static str, &'static str, u32, u32) {
    let (program, option, less) = s.pick(
        "1.3 program",
        &[
            ("Mitsuba", "max_depth", 1),
            ("pbrt", "maxdepth", 0),
            ("Mitsuba", "max_depth", 1),
            ("fredholm", "max-bounces", 0),
        ],
    );
    (program, option, s.pick("1.3 depth", &[3, 4, 5, 6, 7, 8, 9]), less)
}

const SCALED: Exercise = Exercise {
    number: 5,
    title: "a brighter lamp and darker walls",
    question: |s| {
        let (a, b, k) = factors(s);
        format!(
            "The radiance of all lamps is multiplied by {a}, and all reflectances are multiplied by {b}. By which factor does the term \
             T^k E with k = {k} change? Predict it. Then check it in a furnace with the reflectance 0.5 and the emission 1, and in \
             one with the new values:\n\nfredholm series furnace\nfredholm series furnace --set shapes.0.emission=[{a},{a},{a}] \\\n--set \
             materials.wall.reflectance=[{r},{r},{r}]\n\nGive three digits.",
            r = 0.5 * b
        )
    },
    task: Task::Number {
        unit: Unit::Plain,
        margin: 0.01,
        truth: |s| {
            let (a, b, k) = factors(s);
            Ok(Number { value: a * b.powi(k), std_error: 0.0 })
        },
        mistakes: |s| {
            let (a, b, k) = factors(s);
            vec![
                Mistake {
                    value: a * b,
                    says: "Every reflection brings the factor of the reflectance, not only one of them.",
                },
                Mistake {
                    value: (a * b).powi(k),
                    says: "The light leaves the lamp only once: its factor counts once.",
                },
                Mistake { value: a * b.powi(k + 1), says: "The term k has k reflections, not k + 1." },
                Mistake { value: b.powi(k), says: "The radiance of the lamps has changed, too." },
            ]
        },
    },
    hint: "T is proportional to the reflectances, and T^k applies it k times.",
    solution: |s| {
        let (a, b, k) = factors(s);
        format!(
            "T becomes {b} T, and E becomes {a} E. So T^{k} E is multiplied by {b}^{k} · {a} = {}.",
            significant(a * b.powi(k), 4)
        )
    },
};

/// Factor of the lamps, factor of the reflectances, and k.
fn factors(s: &Student) -> (f64, f64, i32) {
    (
        s.pick("1.5 lamps", &[2.0, 3.0, 4.0, 5.0, 6.0]),
        s.pick("1.5 walls", &[0.4, 0.6, 0.7, 0.8, 0.9]),
        s.pick("1.5 term", &[2, 3, 4]),
    )
}
