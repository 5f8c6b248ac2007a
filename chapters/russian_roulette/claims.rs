//! The statements of chapter 10, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x is above c:   x − 5 s > c        x ± s: measured, standard error
//! ```

use super::Measured;
use super::furnace::{IN_FURNACE, variance_in_furnace};
use super::one_pixel::PATHS;
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;
use fredholm::zoo::signature::Ratio;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let e = &m.enumerated;
    let relative: Vec<Number> =
        m.furnace.iter().zip(IN_FURNACE).map(|(v, q)| v.times(1.0 / variance_in_furnace(q))).collect();
    let predicted = m.prices.indirect[0].over(m.prices.indirect[1]);
    let grows = m.weights.growth.times(2.0);
    let [albedo, _, student] = &m.seen;
    let at = |n: usize| PATHS.iter().position(|&p| p == n).unwrap_or(0);
    let [few, many] = [1, 64].map(|n| student.medians[at(n)].over(albedo.mean));
    let settled = albedo.medians[at(64)].over(albedo.mean);
    // k = 0 involves no roulette
    let off = |(r, x): (&Ratio, &f64)| (r.value - x).abs() + 5.0 * r.std_error;
    let wrong = m.wrong.iter().flat_map(|w| w.ratios.iter().zip(&w.expected).skip(1).map(off));
    let wrong = wrong.fold(0.0, f64::max);
    vec![
        claim(
            "over all the ways the roulette can fall, no term of a path changes",
            format!(
                "{} paths, 5 schedules: probabilities sum to 1 to {}, terms are right to {}",
                e.paths,
                significant(e.probability, 1),
                significant(e.term, 1)
            ),
            e.probability < 1e-6 && e.term < 1e-5,
        ),
        claim(
            "in the furnace the variance is ρ²q/((1 − ρ)²(1 − q − ρ²)), to 5 %",
            format!("{} of it for q = 0.1, 0.3, 0.5", list(&relative)),
            relative.iter().all(|r| r.is(1.0, 0.05)),
        ),
        claim(
            "moments without roulette predict the variance with q = 0.2 of indirect light, to 15 %",
            format!("predicted/measured: {predicted}"),
            predicted.is(1.0, 0.15),
        ),
        claim(
            "with q = 0.5 the mean squared weight grows at late vertices, by the factor of the matrix to 5 %",
            format!("{grows} per bounce; matrix: {}", significant(2.0 * m.radius[1].second, 4)),
            grows.value - 5.0 * grows.std_error > 1.0 && m.weights.growth.over(exact(m.radius[1].second)).is(1.0, 0.05),
        ),
        claim(
            "survival with 0.35: the values have a tail with exponent below 2; by albedo above 3",
            format!("{}; by albedo {}", student.exponent, albedo.exponent),
            below(student.exponent, 2.0) && above(albedo.exponent, 3.0),
        ),
        claim(
            "survival with 0.35: with 64 paths, most estimates are over 5 % too dark; by albedo they are not",
            format!("median/mean {many}, with 1 path {few}; by albedo {settled}"),
            below(few, 0.6) && below(many, 0.95) && above(many, 0.6) && above(settled, 0.95),
        ),
        claim(
            "the best schedule for one quantity needs over 1.5 times the rays for the other",
            format!(
                "{} times for the whole image, {} times for indirect light",
                m.prices.crossed[0], m.prices.crossed[1]
            ),
            m.prices.crossed.iter().all(|&x| above(x, 1.5)),
        ),
        claim(
            "four wrong weights of survivors leave the predicted factors in the terms, to ± 0.12",
            format!("largest difference with its error {}", significant(wrong, 2)),
            wrong < 0.12,
        ),
    ]
}

fn above(x: Number, limit: f64) -> bool {
    x.value - 5.0 * x.std_error > limit
}

fn below(x: Number, limit: f64) -> bool {
    x.value + 5.0 * x.std_error < limit
}

pub(super) fn exact(value: f64) -> Number {
    Number { value, std_error: 0.0 }
}

fn list(values: &[Number]) -> String {
    values.iter().map(Number::to_string).collect::<Vec<_>>().join(", ")
}
