//! The statements of chapter 15, and what the program found.
//!
//! ```text
//! the value is c to ± δ:   |x − c| + 5 s ≤ δ        x ± s: measured value and its standard error
//! ```

use super::Measured;
use super::solvers::{FROM_TO, rate, steps};
use super::spectrum::TERMS;
use super::walks::{Map, Walked};
use fredholm::report::book::Claim;
use fredholm::report::text::number::significant;

/// The bounce whose picture the modes predict.
const MIDDLE: usize = 10;
/// The bounce at which rates are compared with eigenvalues.
pub(super) const LATE: usize = TERMS - 2;

/// The statements of the text.
pub fn claims(m: &Measured) -> Vec<Claim> {
    let (one, two) = spectrum(m);
    let (three, four) = (rates(m), work(m));
    let [five, six, seven] = walks(m);
    vec![one, two, three, four, five, six, seven, room(m)]
}

fn claim(says: &'static str, found: String, holds: bool) -> Claim {
    Claim { says, found, holds }
}

fn spectrum(m: &Measured) -> (Claim, Claim) {
    let off = m.spectrum.not_orthogonal;
    let [alone, few] = m.spectrum.error[MIDDLE];
    (
        claim("the modes are orthogonal in ⟨·,·⟩_w, to 10⁻¹²", format!("to {off:.0e}"), off < 1e-12),
        claim(
            "six modes predict T¹⁰E, to 2 %",
            format!("to {}; the first mode alone to {}", percent(few), percent(alone)),
            few < 0.02,
        ),
    )
}

fn rates(m: &Measured) -> Claim {
    let ([late, beside], values) = (m.spectrum.ratios[LATE], &m.spectrum.values);
    let off = [late / values[0] - 1.0, beside / values[1].abs() - 1.0].map(f64::abs);
    claim(
        "late terms fall by λ₁ per bounce, to 0.1 %, and their rest beside the first mode by λ₂, to 1 %",
        format!("{late:.4} and {beside:.4}; λ₁ = {:.4}, λ₂ = {:.4}", values[0], values[1]),
        off[0] < 1e-3 && off[1] < 1e-2,
    )
}

/// Steps that an eigenvalue predicts: ln(from/to)/ln(1/factor).
pub(super) fn predicted(factor: f64) -> f64 {
    (FROM_TO[0] / FROM_TO[1]).ln() / (1.0 / factor).ln()
}

/// Measured and predicted steps of Neumann and Chebyshev in every room, the Cornell box first.
fn work(m: &Measured) -> Claim {
    let [a, b] = m.errors.interval;
    let box_steps = [0, 1].map(|i| steps(&m.errors.by_step[i]).map_or(f64::NAN, |n| n as f64));
    let mut pairs: Vec<[f64; 2]> =
        box_steps.into_iter().zip([b, rate([a, b])]).map(|(n, f)| [n, predicted(f)]).collect();
    for room in &m.brighter {
        let factors = [1.0 - room.gap, rate(room.interval)];
        pairs.extend([0, 1].map(|i| [room.steps[i] as f64, predicted(factors[i])]));
    }
    let near = |[n, p]: &[f64; 2]| (n - p).abs() <= 2.0_f64.max(0.03 * p);
    let last = &pairs[pairs.len() - 2..];
    claim(
        "in six rooms λ predicts the steps of Neumann and Chebyshev for six more digits, to 2 steps or 3 %",
        format!("from {} and {} steps to {} and {}", pairs[0][0], pairs[1][0], last[0][0], last[1][0]),
        pairs.iter().all(near),
    )
}

fn walks(m: &Measured) -> [Claim; 3] {
    let found = |map: Map, value: fn(&Walked) -> f64| m.walks.of(map).map_or(f64::NAN, value);
    let largest = found(Map::Exact, |w| w.largest);
    let off = top(m.walks.all.iter().map(|w| w.bias.value.abs() + 5.0 * w.bias.std_error));
    // the fourth moments of these walks are finite, so that their variance has an error
    let judged = |w: &&Walked| matches!(w.map, Map::Flat | Map::Sum(_) | Map::Rough(_));
    let ratios = m.walks.all.iter().filter(judged).map(|w| w.variance.times(1.0 / w.predicted));
    let apart = top(ratios.map(|r| (r.value - 1.0).abs() + 5.0 * r.std_error));
    let [flat, reversed] = [Map::Flat, Map::Reversed].map(|map| found(map, |w| w.predicted));
    [
        claim("with B as the map every walk gives B, to 10⁻⁵", format!("to {largest:.0e}"), largest < 1e-5),
        claim(
            "every map gives the same mean, to 4 %",
            format!("at most {} off, with 5 standard errors", percent(off)),
            off < 0.04,
        ),
        claim(
            "the second moments of the matrix predict the variance of nine maps, to 20 %",
            format!("to {}; flat map {flat:.2}, reversed map {reversed:.2}", percent(apart)),
            apart < 0.2,
        ),
    ]
}

/// The largest of some numbers; NaN if one is.
fn top(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
}

fn room(m: &Measured) -> Claim {
    let [none, own, other] = &m.seen;
    let means = [own, other].map(|seen| seen.mean.over(none.mean));
    let noise = [own, other].map(|seen| seen.variance.over(none.variance));
    let same = means.iter().all(|ratio| ratio.is(1.0, 0.08));
    claim(
        "in a room both maps keep the mean of T²E, to 8 %; the right one halves the variance at least, the wrong one adds to it",
        format!("variance times {} and {}, mean times {} and {}", noise[0], noise[1], means[0], means[1]),
        same && noise[0].value + 5.0 * noise[0].std_error < 0.5 && noise[1].value - 5.0 * noise[1].std_error > 1.0,
    )
}

pub(super) fn percent(x: f64) -> String {
    format!("{} %", significant(100.0 * x, 2))
}
