//! The statements of chapter 3, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::Measured;
use super::situations::{ALPHA, RHO};
use fredholm::report::book::{Claim, Number};
use fredholm::report::text::number::significant;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, holds: bool, found: String| Claim { says, found, holds };
    let [[uniform, cosine, _], [_, lamp, _], .., [_, glossy, lobe]] = m.spreads[..] else { return vec![] };
    let ratios = m.spreads.iter().flat_map(|[u, c, b]| [u.mean.over(b.mean), c.mean.over(b.mean)]);
    let ratios: Vec<Number> = ratios.collect();
    let weights = m.weights[0].iter().map(|w| w / RHO);
    let (n, above) = (weights.len() as f64, weights.clone().filter(|w| *w > 1.0).count() as f64);
    let above = Number { value: above / n, std_error: (0.25 / n).sqrt() };
    let (largest, mean) = (weights.clone().fold(0.0, f64::max), weights.sum::<f64>() / n);
    let gain = glossy.variance.over(lobe.variance);
    let (sin, cos) = ALPHA.to_radians().sin_cos();
    let hit_or_miss = 1.0 / (sin * sin) - 1.0;
    let [narrow, wide, seen] = m.wrong;
    vec![
        claim(
            "the three densities give the same mean in every situation, to ± 5 %",
            ratios.iter().all(|ratio| ratio.is(1.0, 0.05)),
            ratios.iter().map(Number::to_string).collect::<Vec<_>>().join("; "),
        ),
        claim(
            "matt surface under a constant sky: directions by the cosine have no variance",
            cosine.variance.value < 1e-9,
            format!("V = {}, which is rounding", significant(cosine.variance.value, 1)),
        ),
        claim(
            "matt surface under a constant sky: uniform directions have V = 1/3, to ± 0.01",
            uniform.variance.is(1.0 / 3.0, 0.01),
            format!("V = {}", uniform.variance),
        ),
        claim(
            "half of the weights of uniform directions exceed ρ, to ± 2 %, and none exceeds 2ρ",
            above.is(0.5, 0.02) && (1.9..=2.0).contains(&largest),
            format!("{above} of the weights; the largest is {largest:.3} ρ, the mean {mean:.3} ρ"),
        ),
        claim(
            "glossy surface: directions by f need less than 1/100 of the rays of directions by the cosine",
            gain.value - 5.0 * gain.std_error > 100.0,
            format!("1/{gain} of the rays"),
        ),
        claim(
            "small lamp on a matt surface: directions by the cosine have V = 1/sin²α − 1, to ± 5 %",
            lamp.variance.is(hit_or_miss, 0.05 * hit_or_miss),
            format!("V = {}, and 1/sin²α − 1 = {hit_or_miss:.3}", lamp.variance),
        ),
        claim(
            "cosine directions weighted as uniform ones give 4/3 of the light of a sky, to ± 1 %",
            narrow.is(4.0 / 3.0, 0.0133),
            narrow.to_string(),
        ),
        claim(
            "uniform directions weighted as cosine ones are right under a sky; under the small lamp they give \
             1/(1 + cos α), to ± 0.05",
            wide.is(1.0, 0.001) && seen.is(1.0 / (1.0 + cos), 0.05),
            format!("{wide} under the sky; {seen} under the lamp, and 1/(1 + cos α) = {:.3}", 1.0 / (1.0 + cos)),
        ),
    ]
}
