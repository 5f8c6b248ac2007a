//! Exercises that the program judges: every student gets other numbers, and the truth is computed again for each of them.
//!
//! ```text
//! name → numbers of the question → truth x ± s            an answer a is right if |a − x| ≤ m |x| + 5 s
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | x, s | the truth and its standard error (0 for a closed form) | [`Task::Number`], [`Number`] |
//! | m | the relative margin: room for rounding | [`Task::Number`] |
//! | a | the answer, with its unit | [`Unit::read`] |
//! | name | chooses the numbers | [`Student::pick`] |
//!
//! A measured truth is computed with a fixed seed. A right answer lies outside ± 5 s with a probability of 6·10⁻⁷.

use super::text::measured::Number;
use crate::math::{Key, Purpose, Rng, fnv1a};
use std::error::Error;

/// Result of a computed truth.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// A person who answers. The name chooses the numbers of the questions, so that two students get different ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Student(String);

impl Student {
    /// A student by name. Capital letters and spaces around the name make no difference.
    ///
    /// # Errors
    /// If the name is empty, or cannot be the name of a file.
    pub fn new(name: &str) -> std::result::Result<Self, Unreadable> {
        let name = name.trim().to_lowercase();
        if name.is_empty() {
            return Err(Unreadable::new("the name of the student is empty", "any name will do: --student ada"));
        }
        if name.starts_with('.') || name.chars().any(|c| c.is_control() || "/\\:*?\"<>|".contains(c)) {
            let what = format!("the name `{}` cannot be the name of a file", name.escape_debug());
            return Err(Unreadable::new(&what, "use letters, digits, spaces, - and _"));
        }
        Ok(Self(name))
    }

    /// The name in small letters.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// One of the values. The same student gets the same value for the same key.
    ///
    /// ```
    /// use fredholm::report::exercise::Student;
    /// let albedo = |name| Student::new(name).unwrap().pick("furnace albedo", &[0.3, 0.4, 0.5, 0.6]);
    /// assert_eq!(albedo("Ada"), albedo(" ada"));
    /// ```
    ///
    /// # Panics
    /// If there are no values.
    pub fn pick<T: Copy>(&self, key: &str, values: &[T]) -> T {
        let u = Rng::at(Key::new(0, &format!("{key}: {}", self.0)), 0, 0, 0, Purpose::Start).one();
        values[((f64::from(u) * values.len() as f64) as usize).min(values.len() - 1)]
    }

    /// Seed for a truth that is measured.
    pub fn seed(&self) -> u64 {
        fnv1a(self.0.bytes())
    }
}

/// An exercise with one answer.
#[derive(Clone, Copy, Debug)]
pub struct Exercise {
    /// Its number in the chapter: exercise 10.1 has number 1.
    pub number: u32,
    /// What it is about, in a few words.
    pub title: &'static str,
    /// The question, with the student's numbers.
    pub question: fn(&Student) -> String,
    /// What is asked for, and the truth.
    pub task: Task,
    /// A step towards the answer.
    pub hint: &'static str,
    /// The way to the answer, with the student's numbers.
    pub solution: fn(&Student) -> String,
}

/// What an exercise asks for.
#[derive(Clone, Copy, Debug)]
pub enum Task {
    /// A number.
    Number {
        /// Its unit.
        unit: Unit,
        /// m, the relative margin.
        margin: f64,
        /// Computes the truth.
        truth: fn(&Student) -> Result<Number>,
        /// Wrong answers that have a known reason.
        mistakes: fn(&Student) -> Vec<Mistake>,
    },
    /// One of several words.
    Choice {
        /// All of them.
        words: &'static [&'static str],
        /// The right one.
        truth: fn(&Student) -> Result<&'static str>,
        /// What is wrong with another one.
        mistakes: &'static [(&'static str, &'static str)],
    },
}

/// A wrong answer with a known reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mistake {
    /// The wrong answer.
    pub value: f64,
    /// What led to it: `this is the probability of survival`.
    pub says: &'static str,
}

/// Unit of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A number without a unit.
    Plain,
    /// A part of a whole: 0.25 or 25 %.
    Share,
    /// A whole number.
    Count,
    /// A unit by its spellings; the first one is printed. An answer without a unit is taken to be in this unit.
    Of(&'static [&'static str]),
}

/// Radiance in W·sr⁻¹·m⁻².
pub const RADIANCE: Unit = Unit::Of(&["W/(m² sr)", "W/(m2 sr)", "W/m2/sr", "W/m^2/sr", "W m-2 sr-1", "W·sr⁻¹·m⁻²"]);
/// Irradiance in W·m⁻².
pub const IRRADIANCE: Unit = Unit::Of(&["W/m²", "W/m2", "W/m^2", "W m-2", "W·m⁻²"]);

/// An answer or a name that cannot be read: what is wrong, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("error: {what}\nhelp: {help}")]
pub struct Unreadable {
    /// What is wrong.
    pub what: String,
    /// What to do.
    pub help: String,
}

impl Unreadable {
    fn new(what: &str, help: &str) -> Self {
        Self { what: what.into(), help: help.into() }
    }
}

impl Unit {
    /// What an answer looks like: `a number, such as 0.25`.
    pub fn asks_for(self) -> String {
        match self {
            Self::Plain => "a number without unit, such as 0.25 or 1/4".into(),
            Self::Share => "a part of the whole, such as 0.25, 1/4 or 25%".into(),
            Self::Count => "a whole number, such as 12".into(),
            Self::Of(all) => format!("a number in {}", all[0]),
        }
    }

    /// Reads an answer: a decimal number or a fraction, and its unit.
    ///
    /// ```
    /// use fredholm::report::exercise::{RADIANCE, Unit};
    /// assert_eq!(Unit::Share.read("25 %").unwrap(), 0.25);
    /// assert_eq!(Unit::Plain.read("1/4").unwrap(), 0.25);
    /// assert_eq!(RADIANCE.read("0.5 W/m2/sr").unwrap(), 0.5);
    /// assert!(Unit::Plain.read("25 %").is_err() && Unit::Count.read("1.5").is_err() && RADIANCE.read("2 m").is_err());
    /// ```
    ///
    /// # Errors
    /// If the text is no number, or has another unit.
    pub fn read(self, text: &str) -> std::result::Result<f64, Unreadable> {
        let wanted = format!("this exercise asks for {}", self.asks_for());
        let text = text.trim().replace('−', "-");
        if text.is_empty() {
            return Err(Unreadable::new("the answer is empty", &wanted));
        }
        let part = |c: char| c.is_ascii_digit() || "+-./".contains(c);
        let exponent = |at: usize| {
            let rest = &text[at + 1..];
            rest.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c)) && at > 0
        };
        let end = text.char_indices().find(|&(at, c)| !(part(c) || "eE".contains(c) && exponent(at)));
        let (number, unit) = text.split_at(end.map_or(text.len(), |(at, _)| at));
        if unit.starts_with(',') {
            let help = format!("write a point in decimal numbers; {wanted}");
            return Err(Unreadable::new(&format!("`{text}` has a comma"), &help));
        }
        let Some(value) = fraction(number).filter(|x| x.is_finite()) else {
            return Err(Unreadable::new(&format!("`{text}` is not a number"), &wanted));
        };
        let unit = unit.trim();
        let wrong = || Err(Unreadable::new(&format!("`{unit}` is not the unit of this answer"), &wanted));
        match self {
            Self::Share if unit == "%" => Ok(value / 100.0),
            Self::Count if unit.is_empty() && value.fract() != 0.0 => {
                Err(Unreadable::new(&format!("`{text}` is not a whole number"), &wanted))
            }
            Self::Plain | Self::Share | Self::Count if unit.is_empty() => Ok(value),
            Self::Of(all) => {
                let bare = |s: &str| s.to_lowercase().replace([' ', '·'], "");
                let known = unit.is_empty() || all.iter().any(|u| bare(u) == bare(unit));
                if known { Ok(value) } else { wrong() }
            }
            _ => wrong(),
        }
    }

    /// The value with its unit.
    fn shown(self, value: f64) -> String {
        let number = super::text::number::significant(value, 4);
        match self {
            Self::Of(all) => format!("{number} {}", all[0]),
            Self::Count => format!("{value}"),
            _ => number,
        }
    }
}

/// A decimal number, or the quotient of two.
fn fraction(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((a, b)) => Some(a.parse::<f64>().ok()? / b.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}

/// The judgement of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// True if the answer is right.
    pub right: bool,
    /// The truth for a right answer. For a wrong one what is wrong with it, without the truth.
    pub says: String,
}

impl Exercise {
    /// What the answer must look like.
    pub fn asks_for(&self) -> String {
        match self.task {
            Task::Number { unit, .. } => unit.asks_for(),
            Task::Choice { words, .. } => format!("one of {}", words.join(", ")),
        }
    }

    /// Judges an answer.
    ///
    /// # Errors
    /// If the answer cannot be read, or the truth cannot be computed.
    pub fn judge(&self, student: &Student, answer: &str) -> Result<Judgement> {
        match self.task {
            Task::Number { unit, margin, truth, mistakes } => {
                let a = unit.read(answer)?;
                Ok(number(a, unit, margin, truth(student)?, &mistakes(student)))
            }
            Task::Choice { words, truth, mistakes } => {
                let lower = answer.trim().to_lowercase();
                let Some(&word) = words.iter().find(|w| w.to_lowercase() == lower) else {
                    let what = match lower.is_empty() {
                        true => "the answer is empty".into(),
                        false => format!("`{}` is none of the answers", answer.trim()),
                    };
                    return Err(Unreadable { what, help: crate::math::names::suggest(&lower, "answers", words) }.into());
                };
                if word == truth(student)? {
                    return Ok(Judgement { right: true, says: format!("Right: {word}.") });
                }
                let why = mistakes.iter().find(|m| m.0 == word).map_or(String::new(), |m| format!(" {}", m.1));
                Ok(Judgement { right: false, says: format!("Not right: {word}.{why}") })
            }
        }
    }
}

/// Judges a number against the truth.
fn number(a: f64, unit: Unit, margin: f64, truth: Number, mistakes: &[Mistake]) -> Judgement {
    let Number { value: x, std_error: s } = truth;
    let room = margin * x.abs() + 5.0 * s;
    // rounding of the truth itself
    let near = |b: f64, room: f64| (a - b).abs() <= room + 1e-9 * b.abs();
    if near(x, room) {
        let known = if s > 0.0 { format!("measured: {truth}") } else { format!("exactly {}", unit.shown(x)) };
        let says = format!(
            "Right: {}. The truth is {known}. Answers from {} to {} are accepted.",
            unit.shown(a),
            unit.shown(x - room),
            unit.shown(x + room)
        );
        return Judgement { right: true, says };
    }
    let known = mistakes.iter().find(|m| near(m.value, margin.max(0.005) * m.value.abs()));
    let why = match known {
        Some(m) => m.says.to_owned(),
        None if a < x => "It is too small.".into(),
        None => "It is too large.".into(),
    };
    Judgement { right: false, says: format!("Not right: {}. {why}", unit.shown(a)) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn answers_that_cannot_be_read_say_what_is_asked_for() {
        let why = |unit: Unit, text: &str| unit.read(text).unwrap_err().what;
        assert_eq!(why(Unit::Plain, " "), "the answer is empty");
        assert_eq!(why(Unit::Plain, "0,64"), "`0,64` has a comma");
        assert_eq!(why(Unit::Plain, "64 %"), "`%` is not the unit of this answer");
        assert_eq!(why(Unit::Plain, "1/0"), "`1/0` is not a number");
        assert_eq!(why(Unit::Plain, "inf"), "`inf` is not a number");
        assert_eq!(why(Unit::Count, "2.5"), "`2.5` is not a whole number");
        assert_eq!(why(RADIANCE, "2 W/m2"), "`W/m2` is not the unit of this answer");
        for (unit, text, value) in [
            (Unit::Plain, "-1.5e-3", -0.0015),
            (Unit::Plain, ".5", 0.5),
            (Unit::Plain, "−2", -2.0),
            (Unit::Share, "0.64", 0.64),
            (Unit::Share, "64%", 0.64),
            (IRRADIANCE, "3 W/m^2", 3.0),
            (RADIANCE, "3", 3.0),
        ] {
            assert!((unit.read(text).unwrap() - value).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn a_truth_is_accepted_with_its_error_and_a_known_mistake_is_named() {
        let truth = Number { value: 2.0, std_error: 0.01 };
        let mistakes = [Mistake { value: 0.5, says: "This is 1/x." }];
        let judge = |a| number(a, Unit::Plain, 0.01, truth, &mistakes);
        assert!(judge(2.069).right && judge(1.931).right);
        assert!(!judge(2.071).right && !judge(1.929).right);
        assert_eq!(judge(0.5).says, "Not right: 0.5000. This is 1/x.");
        assert_eq!(judge(3.0).says, "Not right: 3.000. It is too large.");
        // a wrong answer does not give the truth away
        assert!(!judge(3.0).says.contains("2.0"));
    }

    #[test]
    fn a_name_chooses_the_numbers_and_all_of_them_occur() {
        let values = [1, 2, 3, 4, 5];
        let picked = |i: usize| Student::new(&format!("student {i}")).unwrap().pick("n", &values);
        let count = |v| (0..200).filter(|&i| picked(i) == v).count();
        assert!(values.iter().all(|&v| count(v) > 15), "{:?}", values.map(count));
        for bad in ["", "  ", "../ada", "a/b", ".x"] {
            assert!(Student::new(bad).is_err(), "{bad}");
        }
    }
}
