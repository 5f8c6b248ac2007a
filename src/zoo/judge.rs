//! Tests whether a render is correct. Compares the image means of every term, of the tail and of the whole with a reference,
//! and tests that the variance falls as 1/n.
//!
//! ```text
//! p_i = P(|T_ν| ≥ |t_i|),   t_i = (T_k − T_k^ref)/√(s² + s_ref²)         slope of ln V(n) against ln n:  −1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p_i | p-value of one comparison per term and channel, by Welch's test | [`crate::stats::difference`] |
//! | p | the smallest p-value, adjusted by Holm: rejecting if p ≤ α gives a false alarm with probability ≤ α | [`Judgement::p`] |
//! | V(n) | variance of the mean of n samples, per pixel | [`crate::terms::variance`] |
//!
//! A term with too little [evidence](crate::stats::evidence) is not tested. A term that is completely black has no evidence
//! itself; it is tested if the reference, with as many paths, would have found enough light. A render with non-finite
//! samples is rejected at once.

use crate::engine::by_rays::Sampled;
use crate::stats::hypothesis::ROUNDING;
use crate::stats::{Evidence, Measured, difference, holm, two_sided_p, variance_slope};
use crate::terms::{Estimate, Events};

/// Rounding error of a path of a few dozen vertices in `f32`, as a multiple of [`ROUNDING`].
const LONG_WALKS: f64 = 50.0;

/// Result of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The smallest p-value, adjusted by Holm; 0 if samples were not finite.
    pub p: f64,
    /// The comparison that gave this p-value: `k = 2`, `tail`, `whole`, `variance against samples`, ….
    pub what: String,
}

/// Compares a render with a reference of the same terms and the same K.
pub fn judge(suspect: &Sampled, reference: &Sampled) -> Judgement {
    if suspect.series.cost.non_finite > 0 {
        return Judgement { p: 0.0, what: format!("{} samples that are not finite", suspect.series.cost.non_finite) };
    }
    let share = suspect.series.cost.paths as f64 / reference.series.cost.paths as f64;
    let (image, reference) = (suspect.series.image(), reference.series.image());
    let mut names = vec![];
    let mut p = vec![];
    let mut compare = |name: String, a: &Estimate, b: &Estimate| {
        let black = a.events.is_some_and(|e| e.mean == 0.0);
        let expected = b.events.map(|e| Events::equal(e.mean * share));
        if (if black { expected } else { a.events }).is_some_and(|e| Evidence::of_events(e).no_verdict.is_some()) {
            return;
        }
        for c in 0..3 {
            names.push(name.clone());
            p.push(p_value(Measured::of(a, c), Measured::of(b, c)));
        }
    };
    for (k, (a, b)) in image.terms.iter().zip(&reference.terms).enumerate() {
        compare(format!("k = {k}"), a, b);
    }
    if image.tail.is_none() || reference.tail.is_none() {
        // one of the two ends its paths at K: compare the light up to K. If the suspect has no tail, its own total counts,
        // because after `finish` it is not the sum of its terms
        let whole = if image.tail.is_none() { &image.total } else { &image.sum };
        compare("whole".into(), whole, &reference.sum);
    } else {
        compare("tail".into(), &image.tail, &reference.tail);
        compare("whole".into(), &image.total, &reference.total);
    }
    if let Some(law) = law_of_the_variance(suspect) {
        names.push("variance against samples".into());
        p.push(law);
    }
    let adjusted = holm(&p);
    let least = adjusted.iter().enumerate().filter(|a| !a.1.is_nan()).min_by(|a, b| a.1.total_cmp(b.1));
    least.map_or(Judgement { p: 1.0, what: "nothing".into() }, |(i, &p)| Judgement { p, what: names.swap_remove(i) })
}

fn p_value(a: Measured, b: Measured) -> f64 {
    let d = difference(a, b);
    if d.mean.abs() <= LONG_WALKS * ROUNDING * a.mean.abs().max(b.mean.abs()) {
        1.0
    } else {
        two_sided_p(d.mean / d.std_error, d.dof)
    }
}

/// p-value of the hypothesis that the slope of the variance is −1. None with fewer than three points, or without variance.
fn law_of_the_variance(suspect: &Sampled) -> Option<f64> {
    let points: Vec<(f64, f64)> = suspect.snapshots.iter().map(|s| (f64::from(s.spp), s.total.value)).collect();
    let replicates = suspect.series.image().total.replicates;
    if points.len() < 3 || replicates < 2 {
        return None;
    }
    let dof = (replicates - 1) as f64;
    let slope = variance_slope(&points, dof)?;
    Some(two_sided_p((slope.slope + 1.0) / slope.std_error, f64::INFINITY))
}
