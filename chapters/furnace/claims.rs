//! The statements of chapter 4, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::exact::largest;
use super::figures::{gap, percent, pm};
use super::{Furnace, Measured, Value};
use fredholm::report::book::Claim;
use fredholm::report::text::number::significant;
use fredholm::stats::Outcome;
use fredholm::zoo::signature::Ratio;

// ANCHOR: claims
/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let off = |[mean, error]: Value, truth: f64| ((mean - truth) / error).abs();
    // largest deviation in standard errors, and largest relative standard error
    let test = |all: &[(Value, f64)]| {
        let (z, noise) = (largest(all.iter().map(|&(v, x)| off(v, x))), largest(all.iter().map(|(v, x)| v[1] / x)));
        let found =
            format!("off by at most {} standard errors; these are at most {}", significant(z, 2), percent(noise));
        (z < 5.0 && noise < 0.01, found)
    };
    let whole: Vec<_> = m.furnaces.iter().map(|f| (f.whole, 1.0 / (1.0 - f.rho))).collect();
    let term = |f: &Furnace| (1..=8).map(|k| (f.terms[k as usize], f.rho.powi(k))).collect::<Vec<_>>();
    let terms = test(&m.furnaces.iter().flat_map(term).collect::<Vec<_>>());
    let sphere = test(&m.sphere.map(|v| (v, 0.06 / (1.0 - 0.6))));
    let [furnace, cornell] = &m.compared;
    let r = |r: &Ratio| [r.value, r.std_error];
    let passes = largest(furnace.wrong[0].0[1..=4].iter().map(|r| (r.value - 1.0).abs()));
    let r_2 = r(&cornell.wrong[0].0[2]);
    let fails = off(r_2, 1.0) > 5.0 && (r_2[0] - 1.0).abs() > 0.03;
    let seen = test(&(1..=4).map(|k| (r(&furnace.wrong[1].0[k]), (2.0f64 / 3.0).powi(k as i32))).collect::<Vec<_>>());
    let spread = largest(m.glass[3].as_flattened().iter().map(|&l| f64::from(l - 1.0).abs()));
    let [(_, right), (_, broken)] = &m.balance;
    let holds = right.outcome == Outcome::Agrees && broken.outcome == Outcome::Differs;
    let found = format!("{} of T L; with 1.02: {}", gap(right), gap(broken));
    let claim = |holds, says, found| Claim { says, found, holds };
    vec![
        claim(test(&whole).0, "furnace: L = 1/(1 − ρ) for ρ = 0.5, 0.8, 0.9", list(m.furnaces.iter().map(|f| f.whole))),
        claim(terms.0, "furnace: TᵏE = ρᵏ for k = 1 to 8", terms.1),
        claim(
            spread < 1e-5,
            "a glass ball in a sky of radiance 1 has radiance 1",
            format!("largest difference of a pixel: {}", significant(spread, 2)),
        ),
        claim(sphere.0, "integrating sphere: lit cap and wall reflect the same 0.15", list(m.sphere)),
        claim(
            passes < 1e-5,
            "`uniform-as-cosine` passes the furnace: r_k = 1",
            format!("largest difference: {}", significant(passes, 1)),
        ),
        claim(fails, "`uniform-as-cosine` fails in the Cornell box: r₂ is not 1", pm(r_2)),
        claim(seen.0, "`cosine-twice` fails in the furnace: r_k = (2/3)ᵏ", seen.1),
        claim(holds, "cube: L = E + T L to ± 2 % of T L; 1.02 T is found", found),
    ]
}
// ANCHOR_END: claims

pub(super) fn list(values: impl IntoIterator<Item = Value>) -> String {
    values.into_iter().map(pm).collect::<Vec<_>>().join(", ")
}
