//! Explanations in words: what is wrong, the evidence for it, and the next step.
//!
//! | explanation | sentence from |
//! |---|---|
//! | a family with its constant | [`of_family`] |
//! | a simulated mistake | [`of_simulation`] |
//! | something that the file itself shows: its curve, its placement, values that are not finite, a clamp, its error bars | [`finding`] |
//!
//! A constant is reported as its value with its 95 % interval. A cause is mentioned beside it only as an example, because other mistakes
//! can have the same constant.

use super::family::Family;
use super::fit::{Constant, name_of};
use crate::zoo;
use serde::Serialize;

/// Strength of the reason for an explanation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The file itself shows it.
    Found,
    /// A family with a fitted parameter describes every picture and region within its noise.
    Family,
    /// A simulation of the mistake cannot be distinguished from the picture.
    Simulated,
}

/// An explanation.
#[derive(Clone, Debug, Serialize)]
pub struct Suspicion {
    /// Short name, for tables and files.
    pub name: String,
    /// Kind of reason.
    pub basis: Basis,
    /// What is wrong: the part of a sentence after "The picture is wrong:".
    pub what: String,
    /// Description of the evidence.
    pub why: String,
    /// Description of the next step.
    pub next: String,
    /// p-value of the explanation; NaN if it was not tested.
    pub p: f64,
    /// Mean squared deviation, in squared standard errors.
    pub misfit: f64,
    /// Pairs (k, r_k) that the explanation predicts; empty if it predicts none.
    pub curve: Vec<[f64; 2]>,
    /// The fitted constants.
    pub constants: Vec<Constant>,
    /// Members of the zoo that would look the same.
    pub members: Vec<&'static str>,
}

impl Suspicion {
    /// Returns true if it has this name, or could be this member of the zoo.
    pub fn is(&self, name: &str) -> bool {
        self.name == name || self.members.contains(&name)
    }
}

/// An explanation by something that the file itself shows.
pub fn finding(name: &str, what: String, why: String, next: &str) -> Suspicion {
    Suspicion {
        name: name.into(),
        basis: Basis::Found,
        what,
        why,
        next: next.into(),
        p: f64::NAN,
        misfit: f64::NAN,
        curve: vec![],
        constants: vec![],
        members: vec![],
    }
}

/// A number with its 95 % interval, and its name if it is well known.
///
/// ```
/// use fredholm::diagnosis::explain::in_words;
/// use fredholm::diagnosis::fit::Constant;
/// assert_eq!(in_words(Constant { value: 0.97, std_error: 0.002 }), "0.9700 ± 0.0039");
/// assert_eq!(in_words(Constant { value: 3.14, std_error: 0.01 }), "3.140 ± 0.020 (π)");
/// ```
pub fn in_words(c: Constant) -> String {
    let half = 1.96 * c.std_error;
    // two digits of the half width
    let digits = if half > 0.0 { (1.0 - half.log10().floor()).clamp(0.0, 6.0) as usize } else { 4 };
    let known = name_of(c).map_or(String::new(), |n| format!(" ({n})"));
    format!("{:.digits$} ± {half:.digits$}{known}", c.value)
}

/// A family with its constants.
// long, because it is a table: one arm for each family
pub fn of_family(family: Family, constants: &[Constant], terms: bool) -> Suspicion {
    let c = constants.first().copied().unwrap_or(Constant { value: 1.0, std_error: 0.0 });
    let (value, number) = (c.value, in_words(c));
    let known = name_of(c).unwrap_or("");
    let apart = "render with next-event estimation only, and with BSDF sampling only: which of the two is wrong?";
    let alone = if terms { "" } else { ", as far as the image alone can tell" };
    let (name, what, why, next, members): (&str, String, String, &str, Vec<&'static str>) = match family {
        Family::Exposure => (
            "exposure",
            format!("all light, emission included, is {number} times the correct one"),
            if terms { "every term and every region has the same ratio" } else { "every region has the same ratio" }
                .into(),
            "compare the exposure, the units of the emission, and the number of samples by which you divide",
            vec![],
        ),
        Family::Colour => (
            "colour-of-the-light",
            format!(
                "red, green and blue are {}, {} and {} times the correct ones",
                in_words(constants[0]),
                in_words(constants[1]),
                in_words(constants[2])
            ),
            "every region has these three ratios".into(),
            "compare the colour of the lamp, the white balance and the colour space",
            vec![],
        ),
        Family::Connection => {
            let cause = match known {
                "2" => "Light that is counted by the connection and again where the path hits the lamp gives 2",
                "π" => "A BSDF without its 1/π in the connection gives π",
                "1/2" => "A lamp that counts half, or an average of two techniques, gives 1/2",
                _ if value < 1.0 => "A test of roulette before the light sample would give its probability of survival",
                _ => "A wrong area or radiance of the lamp gives any constant",
            };
            let members = match known {
                "2" => vec!["double-emission"],
                "π" => vec!["missing-pi-connection"],
                _ if value < 1.0 => vec!["roulette-before-light"],
                _ => vec![],
            };
            (
                "constant-in-the-connection",
                format!("all reflected light is {number} times the correct one, the same at every bounce{alone}"),
                format!(
                    "T0 is correct, and every later term has the same ratio to the correct one, so the mistake occurs once per \
                     path, in the connection to the light. {cause}"
                ),
                apart,
                members,
            )
        }
        Family::Bounce(0) => (
            "constant-in-the-bsdf",
            format!("every reflection, the first included, is {number} times the correct one{alone}"),
            format!(
                "the ratio of T_k to the correct term is c^k: one factor for every reflection, so the BSDF is wrong{}",
                if known == "π" { ". A BSDF without its 1/π gives π" } else { "" }
            ),
            "render a furnace of albedo 1/2: the sum must be 2",
            if known == "π" { vec!["missing-pi"] } else { vec![] },
        ),
        Family::Bounce(from) => {
            let members = if value < 1.0 {
                vec!["roulette-unweighted", "roulette-divides-by-q", "half-bounce"]
            } else {
                vec!["roulette-weighted-twice", "roulette-divides-by-q"]
            };
            let survival = if value < 1.0 { value } else { 1.0 / value };
            let roulette = if value < 1.0 { "roulette without its weight" } else { "roulette that is weighted twice" };
            // a well-known constant is more often one of a density
            let example =
                if known.is_empty() { format!(", as with {roulette} (survival {survival:.3})") } else { String::new() };
            let cause = format!(
                "Examples are {roulette}, with a probability of survival of {survival:.3}, and a density of directions that is \
                 {:.3} times the right one",
                1.0 / value
            );
            let first = if from == 1 { "direct light is correct".to_owned() } else { correct_up_to(from) };
            (
                "constant-in-the-bounce",
                format!("from bounce {} on, every bounce is {number} times the correct one{alone}{example}", from + 1),
                format!(
                    "{first}, and then the ratio of T_k to the correct term is c^(k − {from}): one factor for every bounce. {cause}"
                ),
                "render it without roulette; if nothing changes, divide by the density with which the direction was sampled",
                members,
            )
        }
        Family::Term(k) => (
            "one-term-scaled",
            format!("T{k} is {number} times the correct one, and all other terms are correct{alone}"),
            format!("only T{k} has a ratio to the correct term that differs from 1"),
            "look for a weight or a condition on the number of bounces",
            vec![],
        ),
        Family::Missing(0) => (
            "emission-missing",
            "the emission that the camera sees directly is missing".into(),
            "T0 is black, and all other terms are correct".into(),
            "add the emission of the first surface that the path hits",
            vec!["emission-missing"],
        ),
        Family::Missing(k) => (
            "one-term-missing",
            format!("T{k} is missing, and all other terms are correct{alone}"),
            format!("only T{k} differs from the correct term, and it is black"),
            "look for a condition on the number of bounces",
            vec![],
        ),
        Family::Cut(n) => (
            "truncated",
            format!(
                "light after more than {n} {} is missing{alone}",
                if n == 1 { "reflection" } else { "reflections" }
            ),
            format!("{}, and all longer terms are 0", correct_up_to(n)),
            "increase the number of bounces: the sum must increase",
            vec!["truncated", "one-bounce-short"],
        ),
        Family::Renumbered(by) => (
            "off-by-one",
            format!("the terms are misnumbered: layer k holds T^(k{}1) E", if by > 0 { "+" } else { "−" }),
            "the terms agree with their neighbours, and the sum is correct".into(),
            "number the terms by reflections: T0 is the emission seen directly",
            vec!["off-by-one"],
        ),
        Family::Added(k) => (
            "constant-added",
            format!(
                "a constant of {number} is added to every pixel{}",
                if terms { format!(" of T{k}") } else { String::new() }
            ),
            "the difference is the same everywhere, in bright and in dark places".into(),
            "look for an ambient term, a background, or an offset of the film",
            vec![],
        ),
        Family::InWhole(k) => (
            "sum-of-terms",
            format!("the whole image holds {number} times T{k} in addition to its own layers, which are correct"),
            format!("the whole image minus the sum of the layers is the tail and a multiple of T{k}"),
            "add every term once",
            vec![],
        ),
        Family::WholeOnly => (
            "scale-of-the-whole",
            format!("the whole image is {number} times the correct one, and its layers are correct"),
            "all regions have the same ratio".into(),
            "compare how the sum and the layers are scaled",
            vec![],
        ),
    };
    Suspicion { basis: Basis::Family, constants: constants.to_vec(), members, ..finding(name, what, why, next) }
}

/// The terms up to k, as correct ones.
pub(super) fn correct_up_to(k: usize) -> String {
    match k {
        0 => "T0 is correct".into(),
        1 => "T0 and T1 are correct".into(),
        _ => format!("T0 to T{k} are correct"),
    }
}

/// A mistake whose simulation cannot be distinguished from the picture.
pub fn of_simulation(name: &str, what: String, p: f64, misfit: f64, curve: Vec<[f64; 2]>) -> Suspicion {
    let why = "a simulation of this mistake in the same scene agrees with the picture in all regions".to_owned();
    let next = match zoo::find(name) {
        Some(_) => format!("`fredholm zoo {name}` shows where this mistake is in the code"),
        None => "look at this step of your code, and render again".into(),
    };
    Suspicion { basis: Basis::Simulated, p, misfit, curve, ..finding(name, what, why, &next) }
}
