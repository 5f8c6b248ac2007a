//! The statements of chapter 14, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! p-values are uniform to ± δ:   D + d ≤ δ          D: distance of the measured law, d: its band with probability 1 − 10⁻⁶
//! ```

use super::Measured;
use super::decisions::power;
use super::experiments::{ALPHA, BATCHES, SAMPLES, SHORT, TESTS};
use super::signatures::Signature;
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;
use fredholm::stats::{uniformity, uniformity::band};
use fredholm::zoo::signature::Ratio;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let uniform = uniformity(&m.p).distance;
    let room = band(m.p.len(), 1e-6);
    let [uncorrected, corrected] = m.families;
    let once = 1.0 - (1.0 - ALPHA).powi(TESTS as i32);
    let families = uncorrected.is(once, 0.1) && below(corrected, 0.09);
    let [watched, anytime] = [&m.watched[0], &m.watched[1]].map(|rates| rates[BATCHES - 1]);
    let watching = watched.value - 5.0 * watched.std_error >= 4.0 * ALPHA && below(anytime, ALPHA);
    let [few, all] = [SHORT, BATCHES].map(|n| rejected(m, n));
    let missed = Number { value: 1.0 - few.value, ..few };
    let laws = laws(&m.zoo);
    let hidden = m.zoo.iter().find(|s| s.bug.name == "off-by-one");
    let [first, whole] = [hidden.map(|s| s.ratios[0]), hidden.map(|s| s.whole)].map(|r| r.map_or(UNKNOWN, number));
    let [right, wrong] = m.scales.each_ref().map(|[small, large]| factors(small, large));

    let claim = |says, found: String, holds: bool| Claim { says, found, holds };
    vec![
        claim(
            "the p-values of the right renderer are uniform, to ± 0.08",
            format!("distance {} ± {}", significant(uniform, 2), significant(room, 2)),
            uniform + room <= 0.08,
        ),
        claim(
            "of 20 tests of the right renderer at least one raises an alarm in 64 % ± 10 % of all cases; with Holm in at most 9 %",
            format!("{} and {}", share(uncorrected), share(corrected)),
            families,
        ),
        claim(
            "a test for one look, used after every batch, raises at least 20 % false alarms; the test for any time at most 5 %",
            format!("{} and {}", share(watched), share(anytime)),
            watching,
        ),
        claim(
            "the darker renderer is found in 90 % of the experiments, as planned, to ± 4 %",
            format!("{}, predicted {}", share(all), percent(power(SAMPLES as f64))),
            all.is(power(SAMPLES as f64), 0.04),
        ),
        claim(
            "with a sixteenth of the samples no difference is found in at least 80 %; the test of equality accepts it in 5 % ± 3 %",
            format!("{} and {}", share(missed), share(m.equal[1])),
            missed.value - 5.0 * missed.std_error >= 0.8 && m.equal[1].is(ALPHA, 0.03),
        ),
        claim(
            "five members of the zoo have the ratios r₁ and r₂ of their laws, to ± 20 %",
            format!("off by at most {}, with 5 standard errors", percent(laws)),
            laws <= 0.2,
        ),
        claim(
            "off-by-one: r₀ = 0, and the mean of the whole image is right, to ± 10 %",
            format!("r₀ = {first}, whole {whole}"),
            first.value == 0.0 && whole.is(1.0, 0.1),
        ),
        claim(
            "in a sphere 8 times as large the right renderer gives the same bits, and area-density 64 times the light",
            format!("{} to {} times, and {} to {} times", right[0], right[1], wrong[0], wrong[1]),
            right == [1.0; 2] && wrong.iter().all(|x| (x / 64.0 - 1.0).abs() < 1e-5),
        ),
    ]
}

const UNKNOWN: Number = Number { value: f64::NAN, std_error: f64::NAN };

/// The rate is at most `limit`, also with 5 standard errors.
fn below(rate: Number, limit: f64) -> bool {
    rate.value + 5.0 * rate.std_error <= limit
}

/// Rate at which the darker renderer is rejected after n batches.
fn rejected(m: &Measured, n: usize) -> Number {
    m.power.iter().find(|p| p.0 == n).map_or(UNKNOWN, |p| p.1)
}

pub(super) fn number(r: Ratio) -> Number {
    Number { value: r.value, std_error: r.std_error }
}

/// Largest distance of r_1 and r_2 from their laws, with 5 standard errors, as a part of the law. Members without a law
/// are left out.
fn laws(zoo: &[Signature]) -> f64 {
    let off = |s: &Signature, k: usize| {
        (s.bug.ratio)(k).map(|law| ((s.ratios[k].value - law).abs() + 5.0 * s.ratios[k].std_error) / law)
    };
    zoo.iter().flat_map(|s| (1..=2).filter_map(|k| off(s, k))).fold(0.0, f64::max)
}

/// Smallest and largest factor between the pixels of two images.
fn factors(small: &[[f32; 3]], large: &[[f32; 3]]) -> [f64; 2] {
    let factor = |(a, b): (&f32, &f32)| f64::from(b / a);
    let all = || small.as_flattened().iter().zip(large.as_flattened()).map(factor);
    [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
}

pub(super) fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}

/// A rate in percent.
pub(super) fn share(rate: Number) -> String {
    format!("{} %", rate.times(100.0))
}
