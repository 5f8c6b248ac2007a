//! The statements of chapter 8, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{Measured, wall::Place};
use fredholm::engine::by_rays::Sampled;
use fredholm::report::book::Claim;
use fredholm::report::text::number::{plus_minus, significant};
use std::f64::consts::PI;

/// The claims of the text. "Equal" means: at most five standard errors apart, and these are below the number behind it.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let off = |[estimate, error]: [f64; 2], exact: f64| [estimate / exact - 1.0, error / exact]; // relative to `exact`
    let equal = |[d, error]: [f64; 2], most: f64| d.abs() <= 5.0 * error && 5.0 * error <= most;
    let by_place = |p: &Place| p.by.each_ref().map(|x| off([x.mean()[0], x.std_error(0)], p.exact));
    let lambert: Vec<_> = m.wall.iter().flat_map(by_place).collect();
    let worst = lambert.iter().map(|[d, error]| d.abs() / error).fold(0.0, f64::max);
    let square = |p: &Place| off([p.by[0].mean()[1], p.by[0].std_error(1)], 1.0 / (24.0 * PI * p.h * p.h));
    let edge = m.wall.last().map_or([f64::NAN; 2], square);
    let same = |[a, b]: [&Sampled; 2]| {
        let ([a, ea], [b, eb]) = (mean(a), mean(b));
        off([a, ea.hypot(eb)], b)
    };
    let (techniques, choices) = (same([&m.room[0], &m.room[1]]), same([&m.lamps[0], &m.lamps[1]]));
    let (noise, power) = (variance_ratio(&m.room[0], &m.room[1]), variance_ratio(&m.lamps[0], &m.lamps[1]));
    // every scale has the same random numbers: ratios differ by rounding only
    let scale = |which: usize| [0, 2].map(|s| mean(&m.scales[s][which])[0] / mean(&m.scales[1][which])[0]);
    let ([small, large], [dark, bright]) = (scale(0), scale(1));
    let near = |ratio: f64, exact: f64| (ratio / exact - 1.0).abs() < 1e-3;
    let percent = |[d, error]: [f64; 2]| format!("difference {} %", plus_minus(100.0 * d, 100.0 * error, 1));
    let times = |[r, error]: [f64; 2]| format!("{} times", plus_minus(r, error, 1));
    let claim = |holds: bool, says, found: String| Claim { says, found, holds };
    vec![
        claim(
            lambert.iter().all(|&d| equal(d, 0.1)),
            "on the wall, points on the lamp and directions give Lambert's closed form",
            format!("{} means, at most {} standard errors away", lambert.len(), significant(worst, 2)),
        ),
        claim(equal(edge, 0.3), "next to the lamp, the mean square of X is ρ²E²A/(24π h²)", percent(edge)),
        claim(equal(techniques, 0.1), "directions and connections give the same direct light", percent(techniques)),
        claim(noise[0] - 5.0 * noise[1] > 500.0, "directions have at least 500 times the variance", times(noise)),
        claim(
            near(small, 1.0) && near(large, 1.0),
            "at the scales 0.1 and 10 the radiance is the same",
            format!("{small:.6} and {large:.6} times that at scale 1"),
        ),
        claim(
            near(dark, 0.01) && near(bright, 100.0),
            "with p_A in place of p_ω, radiance grows as the square of the scale",
            format!("{dark:.6} and {bright:.3} times that at scale 1"),
        ),
        claim(equal(choices, 0.1), "lamps chosen by power give the same light as uniform ones", percent(choices)),
        claim(power[0] - 5.0 * power[1] > 1.5, "a uniform choice has at least 1.5 times the variance", times(power)),
    ]
}

/// Mean of T E over pixels and channels, and its standard error (at most the mean of the errors of the channels).
pub(super) fn mean(s: &Sampled) -> [f64; 2] {
    let e = s.series.image().terms[1];
    [e.mean, e.std_error].map(|v| v.element_sum() / 3.0)
}

/// How many times larger the variance of a pixel is in `a` than in `b`, and the standard error of this number.
pub(super) fn variance_ratio(a: &Sampled, b: &Sampled) -> [f64; 2] {
    let [a, b] = [a, b].map(|s| s.snapshots.last().map(|last| last.slots[1]).unwrap_or_default());
    let ratio = a.value / b.value;
    [ratio, ratio * (a.std_error / a.value).hypot(b.std_error / b.value)]
}
