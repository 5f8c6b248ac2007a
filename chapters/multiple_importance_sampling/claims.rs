//! The statements of chapter 11, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        more than c:   x − 5 s > c        x ± s: value and standard error
//! ```

use super::Measured;
use super::mistakes::Factor;
use super::pairs::Pair;
use super::plates::PLATES;
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::{plus_minus, significant};

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let all: Vec<&Pair> = m.pairs.iter().flatten().collect();
    let means: Vec<Number> = all.iter().flat_map(|p| p.means).collect();
    let off = means.iter().map(|m| (m.value - 1.0).abs() + 5.0 * m.std_error).fold(0.0, f64::max);
    let [connect, scatter] = opposite(m);
    let excess = all.iter().map(|p| p.excess.value + 5.0 * p.excess.std_error).fold(f64::NEG_INFINITY, f64::max);
    let below = |x: Number, limit: f64| x.value + 5.0 * x.std_error < limit;
    let above = |x: Number, limit: f64| x.value - 5.0 * x.std_error > limit;

    let of = |name: &str| m.mistakes.iter().find(|f| f.name == name);
    let [double, measures, choice] = ["double-emission", "mixed-measures", "wrong-light-choice"].map(of);
    let twice = double.is_some_and(|f| f.cornell.iter().all(|x| x.is(2.0, 0.25)));
    let scale = |f: &Factor| f.cornell[1].is(1.0, 0.05) && below(f.cornell[2], 0.5);
    let lamps = |f: &Factor| f.cornell.iter().all(|x| x.is(1.0, 0.02)) && above(f.many, 1.1);
    let words = |f: Option<&Factor>, parts: fn(&Factor) -> Vec<Number>| {
        f.map_or("–".into(), |f| parts(f).iter().map(value).collect::<Vec<_>>().join(", "))
    };
    let apart = m.line.measured.iter().flatten().zip(m.line.exact.iter().flatten());
    let apart = apart.map(|(x, e)| ((x.value - e).abs() + 5.0 * x.std_error) / e).fold(0.0, f64::max);
    let [_, balance, ..] = m.line.measured[1];
    let others = [0, 2, 3].map(|k| m.line.measured[1][k].minus(balance));
    vec![
        claim(
            "both weights of a point sum to 1, to 10⁻⁵, one computed per solid angle, the other per area",
            format!("largest difference {} in {} points", significant(m.sums.0, 1), m.sums.1),
            m.sums.0 < 1e-5 && m.sums.1 > 1000,
        ),
        claim(
            "for 4 plates and 4 lamps, both heuristics give the mean of the better strategy, to 15 %",
            format!("at most {} %, with 5 standard errors", significant(100.0 * off, 2)),
            off < 0.15,
        ),
        claim(
            "alpha 0.02, largest lamp: light sampling needs 100 times the rays; alpha 0.2, smallest lamp: BSDF sampling does",
            format!("{} and {} times", value(&connect), value(&scatter)),
            above(connect, 100.0) && above(scatter, 100.0),
        ),
        claim(
            "for every plate and lamp, MIS keeps Veach's bound and needs at most 8 times the rays of the better strategy",
            format!("at most {} μ², {} times", significant(excess, 2), value(&largest(&all, 2))),
            excess < 0.5 && all.iter().all(|p| below(p.rays[2], 8.0)),
        ),
        claim(
            "light that both strategies count with weight 1 is doubled at the scales 0.1, 1 and 10, to 12.5 %",
            words(double, |f| f.cornell.to_vec()),
            twice,
        ),
        claim(
            "weights of mixed measures are right to 5 % at scale 1; at scale 10 more than half of the light is missing",
            words(measures, |f| f.cornell[1..].to_vec()),
            measures.is_some_and(scale),
        ),
        claim(
            "a wrong probability of the lamp changes nothing with one lamp, and more than 10 % with 96 lamps",
            words(choice, |f| vec![f.cornell[1], f.many]),
            choice.is_some_and(lamps),
        ),
        claim(
            "in one dimension the variances agree with the closed forms, to 10 %; one sample has its least with balance",
            format!("at most {} %, with 5 standard errors", significant(100.0 * apart, 2)),
            apart < 0.1 && others.iter().all(|&d| above(d, 0.0)),
        ),
    ]
}

/// Rays of light sampling for the second plate and the largest lamp, of BSDF sampling for the last plate and the smallest lamp.
pub(super) fn opposite(m: &Measured) -> [Number; 2] {
    [m.pairs[1][PLATES - 1].rays[1], m.pairs[PLATES - 1][0].rays[0]]
}

/// The largest number of rays of a technique.
pub(super) fn largest(all: &[&Pair], i: usize) -> Number {
    let first = Number { value: 0.0, std_error: 0.0 };
    all.iter().map(|p| p.rays[i]).fold(first, |a, b| if b.value > a.value { b } else { a })
}

/// `value ± standard error`; of an error above 100, two digits are written.
pub(super) fn value(x: &Number) -> String {
    let unit = 10f64.powf(x.std_error.max(100.0).log10().floor() - 1.0);
    match x.std_error > 100.0 {
        true => format!("{} ± {}", (x.value / unit).round() * unit, (x.std_error / unit).round() * unit),
        false => plus_minus(x.value, x.std_error, 1),
    }
}
