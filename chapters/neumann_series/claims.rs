//! The statements of chapter 6, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{Measured, Value};
use fredholm::report::book::Claim;
use fredholm::report::text::number::{plus_minus, significant};

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    let ((r, half), g, (rate, s)) = (m.radius, m.albedo, m.rates[1]);
    let top =
        |values: &[Value], centre: f64| values.iter().map(|(r, s)| (r - centre).abs() + 5.0 * s).fold(0.0, f64::max);
    let furnace = top(&m.furnace, 0.5);
    let early = top(&[m.ratios[0], m.ratios[2]], 0.0) / (r - half);
    let late = ((rate - r).abs() + 5.0 * s + half) / r;
    let over = |bound: &dyn Fn(usize) -> f64| {
        m.remainder[..=12].iter().enumerate().map(|(k, (x, s))| (x + 5.0 * s) / bound(k)).fold(0.0, f64::max)
    };
    let after = over(&|k| g / (1.0 - g) * (m.terms.mean[k] - 5.0 * m.terms.covariance[(k, k)].sqrt()));
    let before = over(&|k| g.powi(k as i32 + 1) / (1.0 - g) * m.terms.mean[0]);
    let ks: Vec<String> = m.enough.iter().map(|k| k.map(or_dash).join(" of ")).collect();
    let third = m.enough.iter().all(|k| matches!(k, [Some(k), Some(bound)] if 3 * k < *bound));
    let [(sum, s1), (again, s2)] = m.scaled;
    let apart = ((sum - again).abs() + 3.0 * s1.hypot(s2)) / again;
    let brighter = m.towards_pole[10].1 / m.towards_pole[9].1;

    let (ratios, rates) = (value(m.ratios[0]) + " and " + &value(m.ratios[2]), value((rate, s)));
    let bounds = format!("at most {} of the bound from term K, {} of that from E", percent(after), percent(before));
    let light = format!("{} from the terms, {} rendered", value((sum, s1)), value((again, s2)));
    vec![
        claim(
            "in the furnace every ratio is 1/2, to 10⁻⁵",
            format!("largest difference {}", significant(furnace, 1)),
            furnace < 1e-5,
        ),
        claim("in the Cornell box γ₀ and γ₂ are at least 5 % below r(T)", ratios, early < 0.95),
        claim("the rate of the late terms is r(T), to 5 %", rates, late < 0.05),
        claim("no remainder after K = 0 to 12 exceeds its bounds", bounds, after < 1.0 && before < 1.0),
        claim("less than a third of the guaranteed bounces are enough", ks.join(", "), third),
        claim("the terms give the light of a room with albedos times 0.8, to 3 %", light, apart < 0.03),
        claim(
            "ten times closer to s = 1/r(T), reflected light is ten times brighter, to 10 %",
            format!("{} times", significant(brighter, 3)),
            (brighter / 10.0 - 1.0).abs() < 0.1,
        ),
    ]
}

pub(super) fn value((x, s): Value) -> String {
    plus_minus(x, s, 1)
}

pub(super) fn or_dash(k: Option<usize>) -> String {
    k.map_or("–".into(), |k| k.to_string())
}

fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}
