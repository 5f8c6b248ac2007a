//! The statements of chapter 2, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::Measured;
use fredholm::report::book::Claim;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let claim = |says, holds: bool, found: String| Claim { says, found, holds };
    let cones = m.cones.iter().map(|(name, e)| format!("{name}: {e} of it")).collect::<Vec<_>>().join("; ");
    let limit = m.limit.iter().map(|(r, e)| format!("R/h = {r}: {e}")).collect::<Vec<_>>().join("; ");
    let seen = m.distance.iter().map(|(d, l, _)| format!("{d} m: {l}")).collect::<Vec<_>>().join("; ");
    let quarter: Vec<_> = m.distance.windows(2).map(|w| w[0].2.over(w[1].2)).collect();
    let quarters = quarter.iter().map(|q| format!("by a factor of {q}")).collect::<Vec<_>>().join("; ");
    let (captured, clipped) = (m.captured.differences(), m.captured.clipped());
    let [(_, small), .., (_, large)] = captured[..] else { return vec![] };
    vec![
        claim(
            "E = π L sin²α under a disc, a sphere and the sky, to ± 2 %",
            m.cones.iter().all(|(_, e)| e.is(1.0, 0.02)),
            cones,
        ),
        claim(
            "E_point/E_disc − 1 = (R/h)² at the same intensity on the axis, to ± 10 % of (R/h)²",
            m.limit.iter().all(|(r, e)| e.is(r * r, 0.1 * r * r)),
            limit,
        ),
        claim(
            "the radiance of the lamp is the same from 1, 2 and 4 m, to ± 0.1 %",
            m.distance.iter().all(|(_, l, _)| l.is(1.0, 0.001)),
            seen,
        ),
        claim(
            "the irradiance falls to a quarter when the distance doubles, to ± 2 %",
            quarter.iter().all(|q| q.is(4.0, 0.08)),
            quarters,
        ),
        claim(
            "in Pharr's sphere, one reflection gives 0.5 and all reflections give 1, to ± 1 %",
            m.sphere[0].is(0.5, 0.005) && m.sphere[1].is(1.0, 0.01),
            format!("{} and {}", m.sphere[0], m.sphere[1]),
        ),
        claim(
            "a photograph of a mirror ball lights an object of radius 5 cm as the room does, to ± 5 %",
            small.is(0.0, 0.05),
            format!("difference {small}"),
        ),
        claim(
            "for an object of radius 30 cm the photograph is off by more than 10 %",
            large.value.abs() - 5.0 * large.std_error > 0.1,
            format!("difference {large}"),
        ),
        claim(
            "a photograph that cuts radiance at 1 loses more than a fifth of the light",
            clipped.value + 5.0 * clipped.std_error < -0.2,
            format!("difference {clipped}"),
        ),
    ]
}
