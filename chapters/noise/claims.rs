//! The statements of chapter 13, and what the program found.
//!
//! ```text
//! x ± s is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s is above c:   x − 5 s > c
//! ```

use super::display::PATHS;
use super::intervals::{self, TRUTH};
use super::{Curve, Measured};
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    [convergence(m), display(m), covered(m)].concat()
}

fn claim(says: &'static str, found: String, holds: bool) -> Claim {
    Claim { says, found, holds }
}

/// RMSE(128)/RMSE(4) = √(4/128).
pub(super) fn expected() -> f64 {
    (f64::from(PATHS[0]) / f64::from(PATHS[5])).sqrt()
}

/// P(a path finds the tiny lamp) = 1 − (1 − p)^N.
pub(super) fn any(lamp: f64) -> f64 {
    1.0 - (1.0 - lamp).powi(intervals::PATHS as i32)
}

/// The RMSE at the largest N over that at the smallest.
fn fall(curve: &Curve) -> Number {
    curve.rmse[curve.rmse.len() - 1].1.over(curve.rmse[0].1)
}

fn below(x: Number, limit: f64) -> bool {
    x.value + 5.0 * x.std_error < limit
}

fn above(x: Number, limit: f64) -> bool {
    x.value - 5.0 * x.std_error > limit
}

fn convergence(m: &Measured) -> Vec<Claim> {
    let [free, sobol, repeated, clamped] = &m.curves;
    let slope = |c: &Curve| c.slope.map_or("none".into(), |s| s.to_string());
    let independent = free.slope.is_some_and(|s| s.is(-1.0, 0.15));
    let steeper = sobol.slope.is_some_and(|s| below(s, -1.1));
    let [pixel, image] = m.same;
    let (same, less) = (fall(repeated), fall(free));
    let change = (same.value - 1.0).abs();
    vec![
        claim(
            "from 4 to 128 paths, the RMSE falls to 1/√32 = 0.177 of it, to 35 %",
            m.display.ratio.to_string(),
            m.display.ratio.is(expected(), 0.35 * expected()),
        ),
        claim(
            "the variance has slope −1 to ± 0.15 with independent paths, and less than −1.1 with Sobol points",
            format!("{} and {}", slope(free), slope(sobol)),
            independent && steeper,
        ),
        claim(
            "numbers that repeat after 16 paths: later paths leave the RMSE as it is, to 10⁻⁶. The same numbers in all \
             pixels: a pixel is as noisy to 25 %, the mean of the image at least twice as uncertain",
            format!("change {}, with new numbers factor {less}; {pixel} and {image} times", significant(change, 1)),
            change < 1e-6 && below(less, 0.5) && pixel.is(1.0, 0.25) && above(image, 2.0),
        ),
        claim(
            "clamped at 0.25, the mean of the image is at least 3 % too small; without clamping it is right to 2 %",
            format!("{} and {}", clamped.bias, free.bias),
            below(clamped.bias, -0.03) && free.bias.is(0.0, 0.02),
        ),
    ]
}

fn display(m: &Measured) -> Vec<Claim> {
    let (d, merged) = (&m.display, &m.merged);
    let few = d.images[0].mean.over(d.reference);
    let means = merged.means[0].over(merged.means[1]);
    vec![
        claim(
            "a screen shows images of 4 paths at least 8 % darker than images of 128; their mean is right to 5 %",
            format!("shown {}, mean {}", d.darker, few),
            below(d.darker, 0.92) && few.is(1.0, 0.05),
        ),
        claim(
            "ten runs of 48 paths have the variance of one run of 480, to 20 %, and its mean, to 3 %; \
             the average of the ten images is all light divided by all paths, to 10⁻¹²",
            format!("{} and {means}; rounding {}", merged.variance, significant(merged.rounding, 1)),
            merged.variance.is(1.0, 0.2) && means.is(1.0, 0.03) && merged.rounding < 1e-12,
        ),
    ]
}

fn covered(m: &Measured) -> Vec<Claim> {
    let [large, tiny] = &m.covered;
    vec![
        claim(
            "with a large lamp, the 95 % intervals cover the truth in 95 % of the pixels, to ± 3 %",
            large.covered.to_string(),
            large.covered.is(0.95, 0.03) && large.mean.is(TRUTH, 0.02),
        ),
        claim(
            "with a tiny lamp they cover it in fewer than half, where a path finds the lamp: 1 − (1 − p)ᴺ to ± 0.05; \
             the median is 0, the mean of all pixels is right to 10 %",
            format!(
                "{}, expected {}; mean {}, median {}",
                tiny.covered,
                significant(any(tiny.lamp), 3),
                tiny.mean,
                significant(tiny.median, 2)
            ),
            tiny.covered.is(any(tiny.lamp), 0.05)
                && below(tiny.covered, 0.5)
                && tiny.median == 0.0
                && tiny.mean.is(TRUTH, 0.1 * TRUTH),
        ),
    ]
}
