//! The verdict on the rendering equation, from three tests: every point, the means over all points, and the distribution of
//! the p-values.
//!
//! ```text
//! Differs    a point is rejected (Holm), or a mean over points is, or the p-values are not uniform: level α/3 each
//! Agrees     none of these, and the whole interval of every mean over points lies within ±δ
//! ```
//!
//! A point with too little [evidence](crate::stats::evidence) is not tested separately. It still counts in the mean over all
//! points.

use super::balance::{Balance, aggregate, evidence};
use crate::stats::{Evidence, Measured, Outcome, Uniformity, critical, holm, two_sided_p, uniformity};
use crate::terms::Estimate;
use glam::DVec3;

/// The mean over a group of points.
#[derive(Clone, Debug)]
pub struct Group {
    /// Name of the group: `surface` or `camera`.
    pub name: String,
    /// Number of points.
    pub points: usize,
    /// Mean of T L = L − E over the points. E is left out because it is exact and the same on both sides.
    pub value: DVec3,
    /// Mean of the difference L − (E + T L).
    pub difference: Estimate,
    /// Half width of the interval of the difference at level α; NaN if its error is not known.
    pub half: DVec3,
    /// The evidence behind the difference.
    pub evidence: Evidence,
    /// The smallest p-value of the three channels, adjusted for all groups and channels.
    pub p: f64,
    /// The margin δ of agreement.
    pub delta: DVec3,
    /// Verdict on this group: agrees, differs or inconclusive.
    pub outcome: Outcome,
}

impl Group {
    /// The channel in which the difference has the widest bound relative to T L.
    pub fn worst_channel(&self) -> usize {
        let reach = (self.difference.mean.abs() + self.half) / self.value;
        (0..3).filter(|&c| reach[c].is_finite()).max_by(|&a, &b| reach[a].total_cmp(&reach[b])).unwrap_or(0)
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// The groups of points with their means.
    pub groups: Vec<Group>,
    /// Number of points with enough evidence to be tested separately.
    pub judged: usize,
    /// Indices of the points at which equality of the two sides is rejected, in the order given.
    pub rejected: Vec<usize>,
    /// The smallest p-value of a point, adjusted by Holm for all points and channels; 1 if no point is tested.
    pub smallest: f64,
    /// Test of the p-values against the uniform distribution.
    pub uniformity: Uniformity,
    /// The overall verdict.
    pub outcome: Outcome,
}

/// Tests groups of points at level `alpha`. The margin δ of a group is `of_term` times the mean of T L over it.
pub fn judge(groups: &[(&str, &[Balance])], alpha: f64, of_term: f64) -> Judgement {
    let third = alpha / 3.0;
    let all: Vec<&Balance> = groups.iter().flat_map(|g| g.1).collect();
    let judged: Vec<usize> = (0..all.len()).filter(|&i| all[i].judged()).collect();
    let adjusted = holm(&judged.iter().flat_map(|&i| all[i].channels).map(quiet).collect::<Vec<f64>>());
    let least = |j: usize| adjusted[3 * j..3 * j + 3].iter().copied().fold(1.0, f64::min);
    let rejected: Vec<usize> = judged.iter().enumerate().filter(|(j, _)| least(*j) <= third).map(|(_, &i)| i).collect();
    let uniform = uniformity(&judged.iter().map(|&i| all[i].p).collect::<Vec<f64>>());

    let scalars = 3 * groups.iter().filter(|g| !g.1.is_empty()).count();
    let groups: Vec<Group> = groups
        .iter()
        .filter(|g| !g.1.is_empty())
        .map(|(name, balances)| group(name, &balances.iter().collect::<Vec<_>>(), (alpha, third, scalars), of_term))
        .collect();
    let differs = !rejected.is_empty() || uniform.p <= third || groups.iter().any(|g| g.outcome == Outcome::Differs);
    let agrees = !groups.is_empty() && groups.iter().all(|g| g.outcome == Outcome::Agrees);
    Judgement {
        smallest: (0..judged.len()).map(least).fold(1.0, f64::min),
        judged: judged.len(),
        rejected,
        uniformity: uniform,
        outcome: match (differs, agrees) {
            (true, _) => Outcome::Differs,
            (_, true) => Outcome::Agrees,
            _ => Outcome::Inconclusive,
        },
        groups,
    }
}

/// A channel without noise (black on both sides) gives no evidence against the equation, so that its p-value is 1.
fn quiet(p: f64) -> f64 {
    if p.is_nan() { 1.0 } else { p }
}

fn group(name: &str, balances: &[&Balance], (alpha, third, scalars): (f64, f64, usize), of_term: f64) -> Group {
    let difference = aggregate(balances);
    let value = balances.iter().map(|b| b.left.mean - b.emission).sum::<DVec3>() / balances.len() as f64;
    let delta = of_term * value.abs();
    let measured = [0, 1, 2].map(|c| Measured::of(&difference, c));
    let half =
        DVec3::from(measured.map(|m| if m.std_error == 0.0 { 0.0 } else { critical(alpha, m.dof) * m.std_error }));
    let p = measured.map(|m| quiet(two_sided_p(m.mean / m.std_error, m.dof))).into_iter().fold(1.0, f64::min);
    let p = (p * scalars as f64).min(1.0);
    let evidence = evidence(balances);
    let judged = evidence.no_verdict.is_none();
    let (p, half) = (if judged { p } else { 1.0 }, if evidence.no_error.is_none() { half } else { DVec3::NAN });
    let inside = judged && (difference.mean.abs() + half).cmple(delta).all();
    Group {
        name: name.to_owned(),
        points: balances.len(),
        value,
        half,
        evidence,
        p,
        delta,
        outcome: match (p <= third, inside) {
            (true, _) => Outcome::Differs,
            (_, true) => Outcome::Agrees,
            _ => Outcome::Inconclusive,
        },
        difference,
    }
}
