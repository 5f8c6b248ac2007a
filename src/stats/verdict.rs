//! Verdicts: do two worlds agree, term by term?
//!
//! ```text
//! Differs        some comparison is rejected by Holm at the family level α
//! Agrees         none is, and |effect| + t* s + a ≤ δ for every image mean
//! Inconclusive   neither: the noise hides an effect as large as δ; or the image of the scene is undefined
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | effect | first world − second world | [`Verdict::effect`] |
//! | s, ν | standard error of the effect, its degrees of freedom | [`difference`] |
//! | a | allowance for an error that is not noise: that of the mesh (discretisation) | [`compare`] |
//! | 3 max a | threshold of a rejection: the largest allowance of its kind (image, regions, projections), times Roache's safety factor | [`compare`] |
//! | – | if a exceeds a quarter of a term, the mesh does not resolve the term: it rejects nothing, and sums are judged without it | [`compare`] |
//! | δ | 2 % of the term + 10⁻⁴ of the whole image, per channel | [`Criterion`] |
//! | α | probability that two equal worlds are reported as different anywhere in the whole family | [`Criterion::alpha`] |
//! | t* | critical value at α. Agreement needs *every* interval inside its margin, so α need not be divided among them | [`Verdict::interval`] |
//!
//! The family is every functional (image mean, regions, projections) × every quantity (terms, tail, sum, total) × every
//! channel. Each member can reject. Only image means must also *prove* agreement: a region has more noise, and a test that
//! does not reject proves nothing. If a mean has too little [evidence](super::evidence) for a verdict, it rejects nothing,
//! and agreement needs an interval ten times as narrow. If one side has a [doubt](crate::terms::Doubt) about a quantity, the
//! quantity neither differs nor agrees. References: Schuirmann, *J. Pharmacokinetics and Biopharmaceutics* 15 (1987), for
//! two one-sided tests as one interval; Berger, *Technometrics* 24 (1982), for claims that need no correction because all of
//! their tests must hold.

use super::evidence::{Evidence, JUDGED, Reason, WIDER, doubt_in_words};
use super::hypothesis::{Measured, ROUNDING, critical, difference, holm, two_sided_p};
use super::power;
use super::quantity::{Quantity, shared_quantities};
use crate::math::CHANNELS;
use crate::terms::{Functional, Series, World};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Outcome of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Proved to be equal within δ.
    Agrees,
    /// Proved to be different.
    Differs,
    /// The samples do not decide.
    Inconclusive,
}

/// The thresholds of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Criterion {
    /// δ as a fraction of the term.
    pub of_term: f64,
    /// δ as a fraction of the whole image, added to the fraction of the term.
    pub of_total: f64,
    /// α, the level of the whole family.
    pub alpha: f64,
    /// β of [`Verdict::min_detectable`]: the probability to miss an effect of that size.
    pub beta: f64,
}

impl Default for Criterion {
    fn default() -> Self {
        Self { of_term: 0.02, of_total: 1e-4, alpha: 1e-3, beta: 1e-3 }
    }
}

/// One comparison, or one row that stands for many.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// `T0`, `T1`, …, `tail`, `sum`, `total`.
    pub name: String,
    /// The functional and channel the numbers belong to: `image, red`.
    pub functional: String,
    /// Difference first − second.
    pub effect: f64,
    /// Confidence interval of the effect at level 1 − α, widened by the allowance. NaN if the error is not known.
    pub interval: (f64, f64),
    /// Holm-adjusted p-value: rejected if ≤ α.
    pub p: f64,
    /// Smallest true effect that would have been rejected with probability 1 − β; NaN if nothing could have been rejected.
    pub min_detectable: f64,
    /// The outcome.
    pub outcome: Outcome,
    /// δ, the margin of equivalence.
    pub delta: f64,
    /// The quantity itself: the mean of both image means in this channel, the unit in which a reader measures the effect.
    pub size: f64,
    /// If inconclusive: with this many times the samples one of the other two outcomes is certain, whatever the effect is.
    /// None if no number of samples is enough.
    pub needed_factor: Option<f64>,
    /// The reason, if the comparison is inconclusive for a reason other than noise.
    pub reason: Option<String>,
}

/// The comparison of two results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// One row for each quantity, which describes its worst functional and channel.
    pub rows: Vec<Verdict>,
    /// Number of single comparisons (quantity × image part × channel). They are corrected together, so that α is the chance of any
    /// false alarm among all of them.
    pub family: usize,
    /// Differs if any row does; Agrees if every row does.
    pub outcome: Outcome,
    /// Reason why there is no verdict at all, if the image of the scene is undefined.
    pub undecided: Option<String>,
}

/// Reason for rows without a verdict, if visible surfaces coincide and differ.
const NO_ANSWER: &str = "two visible surfaces coincide and differ: the image is undefined";
const ALLOWANCE: &str = "the mesh error alone is too large for a verdict within δ: refine the mesh";

/// Safety factor. An allowance from two meshes is itself uncertain, so a rejection must exceed it by this factor. Roache
/// recommends it for comparisons of two grids (*J. Fluids Engineering* 116, 1994).
const SAFETY: f64 = 3.0;

/// A term that changes by more than this fraction of itself from one mesh to the next is not resolved, because two meshes
/// then do not show how far off it is. It rejects nothing, and sums are judged without its difference.
const UNRESOLVED: f64 = 0.25;
const NOT_RESOLVED: &str = "two meshes differ by more than a quarter in this quantity: refine the mesh";

/// For each channel: true if the mesh does not resolve the image mean of this quantity.
fn unresolved(quantity: Quantity, mesh: Option<&Series>, allowance: &[Functional]) -> [bool; 3] {
    let (Some(mesh), Some(gap)) = (mesh.map(Series::image), allowance.first()) else { return [false; 3] };
    let (Some(value), Some(gap)) = (quantity.of(mesh), quantity.of(gap)) else { return [false; 3] };
    [0, 1, 2].map(|c| gap.mean[c].abs() > UNRESOLVED * value.mean[c].abs())
}

/// A sentence about the doubt of either result in a quantity, if too few events are expected; otherwise None.
fn doubt(quantity: Quantity, a: &Series, b: &Series) -> Option<String> {
    let of = |s: &Series| {
        let concerned = s.doubts.iter().filter(|d| quantity.concerned(d) && s.expected(d) < JUDGED);
        let worst = concerned.min_by(|a, b| a.per_path.total_cmp(&b.per_path))?;
        Some(doubt_in_words(&s.label, worst, s.expected(worst)))
    };
    of(a).or_else(|| of(b))
}

/// The largest allowance among the functionals of one kind (image, regions, projections). A single allowance may be small by
/// accident, where the difference of two meshes changes its sign.
fn largest_alike(allowance: &[Functional], name: &str, quantity: Quantity) -> DVec3 {
    let kind = |name: &str| name.split(' ').next().unwrap_or_default().to_string();
    let alike = allowance.iter().filter(|f| kind(&f.name) == kind(name));
    alike.filter_map(|f| quantity.of(f)).fold(DVec3::ZERO, |a, e| a.max(e.mean.abs()))
}

/// Compares every quantity that both results have. `allowance` holds, as the means of functionals, an absolute error that is
/// not noise, such as [`discretisation`](super::discretisation::discretisation). A functional that is not named there gets
/// the allowance of the first one. If the list is empty, there is no allowance.
///
/// K may differ. The common terms are then compared, but `tail` and `sum` have different meanings and are left out. The path
/// tracer has no terms, so only its `total` is compared. If there is nothing in common, the outcome is Inconclusive. A
/// series cut at K has no tail: `tail` is left out, and `total` too unless both are cut.
///
/// If neither side has an error, the values agree if they are equal to [`ROUNDING`] of the whole image and differ otherwise,
/// whatever δ is, because there is no noise to explain a difference.
pub fn compare(a: &Series, b: &Series, criterion: &Criterion, allowance: &[Functional]) -> Comparison {
    let mut family = Vec::new();
    let (Some(image_a), Some(image_b)) = (a.functionals.first(), b.functionals.first()) else {
        return Comparison { rows: Vec::new(), family: 0, outcome: Outcome::Inconclusive, undecided: None };
    };
    let delta_of = |q: Quantity| margin(criterion, q, image_a, image_b);
    let size_of = |q: Quantity| {
        let of = |f| q.of(f).map_or(DVec3::ZERO, |e| e.mean.abs());
        0.5 * (of(image_a) + of(image_b))
    };
    let mesh = [b, a].into_iter().find(|s| s.world == World::Radiosity);
    for (i, fa) in a.functionals.iter().enumerate() {
        let Some(fb) = b.functionals.iter().find(|f| f.name == fa.name) else { continue };
        let allowed = allowance.iter().find(|f| f.name == fa.name).or(allowance.first());
        for quantity in shared_quantities(fa, fb) {
            let (Some(x), Some(y)) = (quantity.of(fa), quantity.of(fb)) else { continue };
            let extra = allowed.and_then(|f| quantity.of(f)).map_or(DVec3::ZERO, |e| e.mean.abs());
            let excused = SAFETY * largest_alike(allowance, &fa.name, quantity);
            let whole = 0.5 * (image_a.total.mean.abs() + image_b.total.mean.abs());
            let evidence = Evidence::of(&x).and(Evidence::of(&y));
            let doubt = doubt(quantity, a, b);
            let unresolved = |q: Quantity| unresolved(q, mesh, allowance);
            let own = unresolved(quantity);
            // the differences of those terms of a sum that the mesh does not resolve
            let parts = shared_quantities(fa, fb).into_iter().filter(|q| quantity.contains(*q));
            let unknown = parts.fold(DVec3::ZERO, |sum, q| match (q.of(fa), q.of(fb)) {
                (Some(x), Some(y)) => sum + DVec3::from(unresolved(q).map(f64::from)) * (x.mean - y.mean).abs(),
                _ => sum,
            });
            for (c, channel) in CHANNELS.iter().enumerate() {
                family.push(Item {
                    quantity,
                    functional: format!("{}, {channel}", fa.name),
                    is_image: i == 0,
                    effect: difference(Measured::of(&x, c), Measured::of(&y, c)),
                    allowance: extra[c],
                    excuse: if own[c] { f64::INFINITY } else { excused[c].max(extra[c]) + unknown[c] },
                    rounding: ROUNDING * whole[c],
                    delta: delta_of(quantity)[c].max(ROUNDING * whole[c]),
                    size: size_of(quantity)[c],
                    weak: evidence.no_verdict,
                    doubt: doubt.clone(),
                });
            }
        }
    }
    let mut found = judge(&family, criterion);
    if let Some(why) = a.undecided.as_ref().or(b.undecided.as_ref()) {
        (found.outcome, found.undecided) = (Outcome::Inconclusive, Some(why.clone()));
        for row in &mut found.rows {
            (row.outcome, row.needed_factor, row.reason) = (Outcome::Inconclusive, None, Some(NO_ANSWER.to_owned()));
        }
    }
    found
}

/// δ always follows from the image means, so that a projection, whose value is near zero, has the margin of its term.
fn margin(criterion: &Criterion, quantity: Quantity, a: &Functional, b: &Functional) -> DVec3 {
    let size = |q: Quantity| {
        let abs = |f| q.of(f).map_or(DVec3::ZERO, |e| e.mean.abs());
        0.5 * (abs(a) + abs(b))
    };
    criterion.of_term * size(quantity) + criterion.of_total * size(Quantity::Total)
}

/// One member of the family of comparisons.
struct Item {
    quantity: Quantity,
    functional: String,
    is_image: bool,
    effect: Measured,
    /// Allowance for an error that is neither noise nor a difference: discretisation.
    allowance: f64,
    /// The size that a rejection must exceed: the allowance with its own uncertainty.
    excuse: f64,
    /// Rounding error of `f32`; it never counts as a difference.
    rounding: f64,
    delta: f64,
    /// The mean of both image means.
    size: f64,
    /// Reason why nothing may be rejected.
    weak: Option<Reason>,
    /// Reason why there can be no verdict at all.
    doubt: Option<String>,
}

impl Item {
    /// Probability of an effect at least this large if the true effect is within excuse and rounding. Without noise it is 0
    /// or 1.
    fn p(&self) -> f64 {
        let excess = self.effect.mean.abs() - self.excuse - self.rounding;
        let s = self.effect.std_error;
        if excess.is_nan() || s.is_nan() {
            f64::NAN
        } else if excess <= 0.0 || self.weak.is_some() || self.doubt.is_some() {
            1.0
        } else {
            two_sided_p(excess / s, self.effect.dof) // s = 0: t = ∞
        }
    }

    /// |t|, which orders comparisons whose p-values underflow.
    fn t(&self) -> f64 {
        self.effect.mean.abs() / self.effect.std_error
    }

    /// t* s: half the width of the interval, before the allowance is added.
    fn noise(&self, level: f64) -> f64 {
        if self.effect.std_error == 0.0 { 0.0 } else { critical(level, self.effect.dof) * self.effect.std_error }
    }
}

fn judge(family: &[Item], criterion: &Criterion) -> Comparison {
    let adjusted = holm(&family.iter().map(Item::p).collect::<Vec<_>>());
    // a rejection anywhere is a claim, so α is divided among the family; agreement claims that all margins hold, which is
    // wrong only if it is wrong where it is worst, so every interval may use the whole α
    let levels = (criterion.alpha, criterion.alpha / family.len() as f64);

    let mut quantities: Vec<Quantity> = family.iter().filter(|i| i.is_image).map(|i| i.quantity).collect();
    quantities.dedup(); // three channels each
    let row = |quantity: &Quantity| {
        let all: Vec<(&Item, f64)> =
            family.iter().zip(adjusted.iter().copied()).filter(|(i, _)| i.quantity == *quantity).collect();
        // the row shows the clearest rejection if there is one; then a comparison that could not be judged; else the image
        // mean with the widest interval
        let clearest = |a: &&(&Item, f64), b: &&(&Item, f64)| a.1.total_cmp(&b.1).then(b.0.t().total_cmp(&a.0.t()));
        let rejected = all.iter().filter(|(_, p)| *p <= criterion.alpha).min_by(clearest);
        let speaker = rejected.or_else(|| all.iter().find(|(_, p)| p.is_nan()));
        match speaker {
            Some((item, p)) => Some(verdict(item, *p, criterion, levels)),
            None => {
                let reach = |v: &Verdict| v.interval.0.abs().max(v.interval.1.abs()) / v.delta;
                let images = all.iter().filter(|(i, _)| i.is_image).map(|(i, p)| verdict(i, *p, criterion, levels));
                images.max_by(|a, b| reach(a).total_cmp(&reach(b)))
            }
        }
    };
    let rows: Vec<Verdict> = quantities.iter().filter_map(row).collect();
    Comparison { outcome: overall(&rows), rows, family: family.len(), undecided: None }
}

/// Verdict of one comparison. `levels` holds the level of the interval and that of a rejection.
fn verdict(item: &Item, p: f64, criterion: &Criterion, levels: (f64, f64)) -> Verdict {
    let (effect, s, delta) = (item.effect.mean, item.effect.std_error, item.delta);
    let (noise, reject) = (item.noise(levels.0), item.noise(levels.1));
    // if the error is not reliable, agreement must not depend on it
    let half = item.allowance + if item.weak.is_some() { (1.0 + WIDER) * noise } else { noise };
    let outcome = if p <= criterion.alpha {
        Outcome::Differs
    } else if effect.abs() + half <= delta && item.doubt.is_none() {
        Outcome::Agrees
    } else {
        Outcome::Inconclusive
    };
    // inconclusive means δ − noise − a < |effect| ≤ reject + excuse + rounding. That range is empty once
    // noise + reject ≤ room, and both fall as 1/√n
    let room = delta - item.allowance - item.excuse - item.rounding;
    let reason = match outcome {
        Outcome::Agrees | Outcome::Differs => None,
        Outcome::Inconclusive if item.excuse.is_infinite() && item.weak.is_none() && item.doubt.is_none() => {
            Some(NOT_RESOLVED.to_owned())
        }
        Outcome::Inconclusive if room <= 0.0 && item.weak.is_none() && item.doubt.is_none() => {
            Some(ALLOWANCE.to_owned())
        }
        Outcome::Inconclusive => item.doubt.clone().or(item.weak.map(|w| w.to_string())),
    };
    // an error that is not reliable is not shown
    let known = outcome != Outcome::Inconclusive || (item.weak.is_none() && item.doubt.is_none());
    let or_unknown = |x: f64| if known { x } else { f64::NAN };
    let noise_decides = outcome == Outcome::Inconclusive && reason.is_none();
    Verdict {
        name: item.quantity.name(),
        functional: item.functional.clone(),
        effect,
        interval: (or_unknown(effect - half), or_unknown(effect + half)),
        p,
        min_detectable: if item.weak.is_some() || item.doubt.is_some() || item.excuse.is_infinite() {
            f64::NAN
        } else {
            item.excuse + item.rounding + power::min_detectable(s, item.effect.dof, levels.1, criterion.beta)
        },
        outcome,
        delta,
        size: item.size,
        needed_factor: noise_decides.then(|| ((noise + reject) / room).powi(2)),
        reason,
    }
}

fn overall(rows: &[Verdict]) -> Outcome {
    let any = |o| rows.iter().any(|r| r.outcome == o);
    if any(Outcome::Differs) {
        Outcome::Differs
    } else if rows.is_empty() || any(Outcome::Inconclusive) {
        Outcome::Inconclusive
    } else {
        Outcome::Agrees
    }
}
