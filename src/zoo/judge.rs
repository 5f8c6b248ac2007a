//! Is this render the right one? The image means of every term, the tail and the whole against a reference, and the law of the variance.
//!
//! ```text
//! p_i = P(|T_ν| ≥ |t_i|),   t_i = (T_k − T_k^ref)/√(s² + s_ref²)         slope of ln V(n) over ln n:  −1
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | p_i | one comparison per term and channel, by Welch's test | [`crate::stats::difference`] |
//! | p | Holm's smallest: rejecting where it is ≤ α is a false alarm with probability ≤ α | [`Judgement::p`] |
//! | V(n) | variance of the mean of n samples, per pixel | [`crate::terms::variance`] |
//!
//! What is carried by fewer than 400 equal events is not judged: its error is not known. Samples that are not finite settle the matter.

use crate::stats::hypothesis::ROUNDING;
use crate::stats::{Measured, difference, holm, two_sided_p, variance_slope};
use crate::terms::{Estimate, Functional};
use crate::worlds::sampled::Sampled;

/// Below this many equal events nothing is judged.
const FEW: f64 = 400.0;
/// Rounding of a walk of a few dozen vertices in `f32`, as a multiple of [`ROUNDING`].
const LONG_WALKS: f64 = 50.0;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Holm's smallest p value; 0 where samples were not finite.
    pub p: f64,
    /// What it belongs to: `T²E`, `whole`, `variance`, ….
    pub what: String,
}

/// Judges a render by a reference of the same terms, made with the same K.
pub fn judge(suspect: &Sampled, reference: &Functional) -> Judgement {
    if suspect.series.cost.non_finite > 0 {
        return Judgement { p: 0.0, what: format!("{} samples that are no number", suspect.series.cost.non_finite) };
    }
    let image = suspect.series.image();
    let last = image.terms.len();
    let mut names = vec![];
    let mut p = vec![];
    let mut compare = |name: String, slot: usize, a: &Estimate, b: &Estimate| {
        if image.events.get(slot).is_some_and(|&n| n < FEW) {
            return;
        }
        for c in 0..3 {
            names.push(name.clone());
            p.push(p_value(Measured::of(a, c), Measured::of(b, c)));
        }
    };
    for (k, (a, b)) in image.terms.iter().zip(&reference.terms).enumerate() {
        compare(format!("k = {k}"), k, a, b);
    }
    if image.tail.is_none() {
        compare("whole".into(), last + 2, &image.total, &reference.sum);
    } else {
        compare("tail".into(), last, &image.tail, &reference.tail);
        compare("whole".into(), last + 2, &image.total, &reference.total);
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

/// P of a slope that far from −1; nothing with fewer than three points, or without variance.
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
