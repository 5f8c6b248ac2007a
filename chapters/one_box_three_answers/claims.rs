//! The statements of chapter 1, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::{Answers, Measured, answers, comparisons, on_ceiling, percent};
use fredholm::report::book::Claim;
use fredholm::report::text::number::average;
use fredholm::scene::Scene;
use fredholm::stats::{Comparison, Outcome};

// ANCHOR: claim
/// The claims of the text.
pub fn claims(m: &Measured) -> Option<Vec<Claim>> {
    let (scene, a) = (&m.run.scene, answers(&m.run)?);
    let [(_, path), (_, matrix)] = &comparisons(&a, m.margin);
    let proved = |c: &Comparison| {
        let rows = c.rows.iter().filter(|row| row.outcome == Outcome::Agrees);
        format!("agree: {}", rows.map(|row| row.name.as_str()).collect::<Vec<_>>().join(", "))
    };
    let (same_as_path, same_as_matrix) = (proved(path), proved(matrix));
    let [term, tail] = of_bounds(scene, &a);
    let lit = (1..a.series.terms.len()).find(|&n| on_ceiling(scene, &a.series.terms[n]) > 0.0).unwrap_or(0);
    let left = average(&a.series.series.image().tail).0 / average(&a.series.series.image().total).0;
    let claim = |holds: bool, says, found: String| Claim { says, found, holds };
    Some(vec![
        claim(same_as_path.contains("total"), "terms and tail add up to the path tracer's image", same_as_path),
        // T1 through the camera is read from E, so that T2 is the first term that tests the matrix
        claim(same_as_matrix.contains("T2"), "the term k = 2 agrees with the matrix", same_as_matrix.clone()),
        claim(same_as_matrix.contains("total"), "the whole image agrees with the matrix", same_as_matrix),
        claim(
            matrix.outcome != Outcome::Differs,
            "no term differs significantly from the matrix",
            format!("{:?}", matrix.outcome).to_lowercase(),
        ),
        claim(term < 1.0, "no term exceeds its bound", format!("at most {} of the bound", percent(term))),
        claim(tail < 1.0, "the tail does not exceed its bound", format!("at most {} of the bound", percent(tail))),
        claim(lit == 2, "k = 2 is the first term that lights the ceiling", format!("k = {lit}")),
        claim(left > 0.003 && left < 0.03, "about a hundredth of the light is left after k = 8", percent(left)),
    ])
}
// ANCHOR_END: claim

/// How near the norms come to their bounds, with a margin of five standard errors, in the worst channel: the largest
/// fraction ‖T^k E‖₁/(g^k ‖E‖₁) of all terms, and the fraction of the tail.
pub(super) fn of_bounds(scene: &Scene, a: &Answers<'_>) -> [f64; 2] {
    let k = a.norms.mean.len() - 2; // K, because the last entry is the tail
    let g = scene.max_albedo().as_dvec3();
    let emission = a.matrix.matrix.surface[0]; // without noise
    let seen = |n: usize| a.norms.estimate(n..n + 1).mean + 5.0 * a.norms.estimate(n..n + 1).std_error;
    let of_bound = |n: usize| (seen(n) / (emission * g.powf(n as f64))).max_element();
    let tail = seen(k + 1) / (a.norms.mean[k] * g / (1.0 - g));
    [(1..=k).map(of_bound).fold(0.0, f64::max), tail.max_element()]
}
