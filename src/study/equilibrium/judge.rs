//! The verdict on the equation: at every point, over all points, and of the p-values among each other.
//!
//! ```text
//! Differs    a point is rejected (Holm), or a mean over points, or the p-values are not uniform: α/3 each
//! Agrees     nothing is, and every mean over points lies within ±δ with its whole interval
//! ```
//!
//! A point whose [evidence](crate::stats::evidence) will not carry a verdict is not judged by itself. It still counts in the mean over
//! points, which rests on the events of all.

use super::balance::{Balance, aggregate, evidence};
use crate::stats::{Evidence, Measured, Outcome, Uniformity, critical, holm, two_sided_p, uniformity};
use crate::terms::Estimate;
use glam::DVec3;

/// The mean over some points.
#[derive(Clone, Debug)]
pub struct Group {
    /// `surface`, `camera`.
    pub name: String,
    /// How many points.
    pub points: usize,
    /// Mean of T L = L − E over them: E is exact and the same on both sides.
    pub value: DVec3,
    /// Mean of L − (E + T L).
    pub difference: Estimate,
    /// Half width of its interval at level α; NaN where no error is known.
    pub half: DVec3,
    /// What it rests on.
    pub evidence: Evidence,
    /// The smallest of its channels' p-values, for all groups and channels together.
    pub p: f64,
    /// The margin.
    pub delta: DVec3,
    /// Agrees, Differs or Inconclusive.
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
    /// Means over points.
    pub groups: Vec<Group>,
    /// Points with events enough to be judged one by one.
    pub judged: usize,
    /// Points where it is rejected that both sides agree, by number in the order given.
    pub rejected: Vec<usize>,
    /// The smallest p-value of a point, adjusted by Holm for all points and channels; 1 if no point is judged.
    pub smallest: f64,
    /// Distance of the p-values from uniform ones.
    pub uniformity: Uniformity,
    /// All together.
    pub outcome: Outcome,
}

/// Judges groups of points at level `alpha`; δ is `of_term` of the mean of T L over a group.
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

/// A channel without any noise (black on both sides) says nothing against the equation.
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
