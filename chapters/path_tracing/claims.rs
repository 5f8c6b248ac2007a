//! The statements of chapter 9, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x is below c:   x + 5 s < c        x ± s: measured value and its error
//! ```

use super::reuse::{Noise, value};
use super::{LAST, Measured};
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    vec![loops(m), same_means(m), rays(m), double(m), missing(m), mirror(m), correlated(m), reuse_wins(m), own_wins(m)]
}

fn claim(says: &'static str, found: String, holds: bool) -> Claim {
    Claim { says, found, holds }
}

/// x + 5 s and x − 5 s.
fn upper(x: Number) -> f64 {
    x.value + 5.0 * x.std_error
}

fn lower(x: Number) -> f64 {
    x.value - 5.0 * x.std_error
}

pub(super) fn listed(numbers: &[Number]) -> String {
    numbers.iter().map(Number::to_string).collect::<Vec<_>>().join(", ")
}

fn loops(m: &Measured) -> Claim {
    let most = m.difference[0].max(m.difference[1]);
    claim(
        "with the same random numbers, the loop gives every pixel of the library's path tracer, to 10⁻⁵ of the mean",
        format!("largest difference {} of the mean", significant(most, 1)),
        most < 1e-5,
    )
}

fn same_means(m: &Measured) -> Claim {
    let [one, own] = &m.means;
    let ratio = |i: usize| one[i].over(own[i]);
    let (terms, sum) = ([0, 1, 2].map(ratio), ratio(LAST));
    claim(
        "one path and own paths have the same means of TE, T²E, T³E (ratio 1 to ± 0.06) and of the sum up to T⁸E (to ± 0.04)",
        format!("ratios {}; of the sum {sum}", listed(&terms)),
        terms.iter().all(|r| r.is(1.0, 0.06)) && sum.is(1.0, 0.04),
    )
}

fn rays(m: &Measured) -> Claim {
    let [one, own] = m.rays;
    claim(
        "in a closed room, 8 terms need 2·8 = 16 rays from one path and 2 + 3 + … + 9 = 44 rays from own paths",
        format!("{one} and {own}"),
        [one, own] == [16.0, 44.0],
    )
}

fn double(m: &Measured) -> Claim {
    let [r0, later @ ..] = &m.ratios[0][..] else { return claim("double emission", String::new(), false) };
    claim(
        "counted twice, emission gives r₀ = 1 and rₖ = 2 for k = 1 to 4, to ± 0.15",
        listed(&m.ratios[0]),
        r0.is(1.0, 0.15) && later.iter().all(|r| r.is(2.0, 0.15)),
    )
}

fn missing(m: &Measured) -> Claim {
    let [r0, later @ ..] = &m.ratios[1][..] else { return claim("emission is missing", String::new(), false) };
    claim(
        "left out at the eye, emission gives r₀ = 0 and rₖ = 1 for k = 1 to 4, to ± 0.15",
        listed(&m.ratios[1]),
        r0.value == 0.0 && later.iter().all(|r| r.is(1.0, 0.15)),
    )
}

fn mirror(m: &Measured) -> Claim {
    let r = &m.ratios[2];
    claim(
        "left out after mirrors and glass, emission gives r₀ = 1 to ± 0.15, and r₁, r₂, r₃ below 1",
        listed(&r[..4]),
        r[0].is(1.0, 0.15) && r[1..4].iter().all(|&r| upper(r) < 1.0),
    )
}

fn correlated(m: &Measured) -> Claim {
    let of = |j, k| value(&m.noise, move |x| x.correlation(j, k));
    let first: Vec<Number> = (2..=LAST).map(|k| of(1, k)).collect();
    let most = first.iter().map(|r| r.value.abs() + 5.0 * r.std_error).fold(0.0, f64::max);
    let apart: Vec<Number> = (2..=LAST - 2).map(|k| of(k, k + 2)).collect();
    claim(
        "along a path, X₁ has a correlation of less than 0.1 with each later term; Xₖ and Xₖ₊₂ have one above 0.12, for k = 2 to 6",
        format!("at most {} (with 5 standard errors); {}", significant(most, 2), listed(&apart)),
        most < 0.1 && apart.iter().all(|&r| lower(r) > 0.12),
    )
}

fn reuse_wins(m: &Measured) -> Claim {
    let [equal, best] = [Noise::equal, Noise::best].map(|way| value(&m.noise, move |x| way(x) / x.one_path()));
    claim(
        "for the sum, variance × rays of own paths is more than 2 times that of one path, and more than 1.2 times with the best split",
        format!("{equal} and {best} times"),
        lower(equal) > 2.0 && lower(best) > 1.2,
    )
}

fn own_wins(m: &Measured) -> Claim {
    let alone: Vec<Number> = (1..=4).map(|k| value(&m.noise, move |x| x.alone(k))).collect();
    claim(
        "for one term alone, k = 1 to 4, variance × rays of own paths is less than 0.7 times that of one path for all",
        format!("{} times", listed(&alone)),
        alone.iter().all(|&r| upper(r) < 0.7),
    )
}
