//! Which of several settings needs the fewest rays for the same error, said in one sentence that admits what the noise hides.
//!
//! ```text
//! work = V · rays        rays for the same error ∝ work        ratio = work / work of the best
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | V | variance of one sample | part of [`Candidate::work`] |
//! | work | V times the rays of one sample: the rays that an error of 1 costs | [`Candidate::work`] |
//!
//! The error of a ratio is the jackknife's: replicate i is left out of both settings. This is right whether or not the settings
//! share random numbers. Where the values without each replicate are not given, the relative errors are added as for
//! independent values. For settings that share random numbers this error is usually too large, and the sentence too cautious.

use super::number::{plus_minus, significant};
use super::prose::listed;
use crate::report::half_width_95;
use crate::stats::critical;

/// Level of the family of comparisons with the best: 5 %, shared equally.
const LEVEL: f64 = 0.05;

/// A setting with the rays that it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The name of the setting.
    pub name: String,
    /// V · rays.
    pub work: f64,
    /// Standard error of `work` divided by `work`; NaN where it is not known.
    pub relative_error: f64,
    /// Independent replicates behind the error.
    pub replicates: u64,
    /// `work` without each replicate; empty where it is not known.
    pub without: Vec<f64>,
}

/// The ratio of two works with its standard error.
pub(crate) fn ratio(a: &Candidate, b: &Candidate) -> (f64, f64) {
    let ratio = a.work / b.work;
    let r = a.without.len() as f64;
    if r < 3.0 || a.without.len() != b.without.len() {
        return (ratio, ratio * a.relative_error.hypot(b.relative_error));
    }
    let each: Vec<f64> = a.without.iter().zip(&b.without).map(|(a, b)| a / b).collect();
    let mean = each.iter().sum::<f64>() / r;
    let spread: f64 = each.iter().map(|x| (x - mean).powi(2)).sum();
    (ratio, (spread * (r - 1.0) / r).sqrt())
}

/// Settings in rising order of work.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    order: Vec<Candidate>,
    /// The best, and those that cannot be told from it.
    tied: Vec<Candidate>,
    /// Those that need more rays than the best beyond the noise.
    told: Vec<Candidate>,
}

impl Ranking {
    /// Sorts the settings. Those without noise, or without a known variance, must not be among them.
    pub fn new(mut candidates: Vec<Candidate>) -> Self {
        candidates.retain(|c| c.work > 0.0 && c.work.is_finite());
        candidates.sort_by(|a, b| a.work.total_cmp(&b.work));
        let rivals = candidates.len().saturating_sub(1).max(1) as f64;
        // an error that is not known proves nothing: the comparison with NaN is false
        let told = |c: &Candidate| {
            let t = critical(LEVEL / rivals, c.replicates as f64 - 1.0);
            let (ratio, error) = ratio(c, &candidates[0]);
            ratio - 1.0 > t * error
        };
        let (told, tied) = candidates.iter().cloned().partition(told);
        Self { tied, told, order: candidates }
    }

    /// The work of a setting divided by that of the best, `2.96 ± 0.52` with the half width of the 95 % interval.
    fn times(&self, c: &Candidate) -> String {
        let (ratio, error) = ratio(c, &self.order[0]);
        let half = half_width_95(error, c.replicates);
        if half < 5e-3 * ratio { significant(ratio, 3) } else { plus_minus(ratio, half, 2) }
    }

    /// The sentence: which setting is best, and by how much. `among` names the settings in the plural ("techniques"), `what`
    /// the quantity whose error is meant, and `noise` the number of samples behind the variances.
    ///
    /// ```
    /// use fredholm::report::text::ranking::{Candidate, Ranking};
    /// let of = |name: &str, work| Candidate { name: name.into(), work, relative_error: 0.02, replicates: 16, without: vec![] };
    /// let told = Ranking::new(vec![of("a", 3.0), of("b", 1.0)]).sentence("settings", "T1", "64 samples");
    /// assert!(told.starts_with("Among the settings, `b` needs the fewest rays for the same error of T1: `a` needs 3.0"));
    /// let hidden = Ranking::new(vec![of("a", 1.02), of("b", 1.0)]).sentence("settings", "T1", "64 samples");
    /// assert!(hidden.starts_with("The noise of 64 samples does not tell the settings `b` and `a` apart"));
    /// ```
    pub fn sentence(&self, among: &str, what: &str, noise: &str) -> String {
        let quoted = |of: &[Candidate]| listed(&of.iter().map(|c| format!("`{}`", c.name)).collect::<Vec<_>>());
        let (tied, told) = (&self.tied[..], &self.told[..]);
        let (Some(best), Some(last)) = (self.order.first(), self.order.last()) else {
            return format!("There is nothing to compare among the {among}: no {what} has a variance that is known.");
        };
        if self.order.len() == 1 {
            let work = significant(best.work, 3);
            return format!("`{}` stands alone: for {what} its variance times its rays is {work}.", best.name);
        }
        if told.is_empty() {
            return format!(
                "The noise of {noise} does not tell the {among} {} apart by the rays that they need for the same error of \
                 {what}: the largest ratio is {} (95 %).",
                quoted(tied),
                self.times(last)
            );
        }
        let others = match told {
            [one] => format!("`{}` needs {} times as many", one.name, self.times(one)),
            [next, .., last] => format!(
                "`{}`, the next, needs {} times as many and `{}`, the last, {} times",
                next.name,
                self.times(next),
                last.name,
                self.times(last)
            ),
            [] => String::new(),
        };
        match tied {
            [_, _, ..] => format!(
                "Among the {among}, {} need the fewest rays for the same error of {what}, and the noise of {noise} does not \
                 tell them apart; {others} (95 %).",
                quoted(tied)
            ),
            _ => format!(
                "Among the {among}, `{}` needs the fewest rays for the same error of {what}: {others} (95 %).",
                best.name
            ),
        }
    }

    /// A shorter sentence: which settings are best for `what`, and what the next one needs.
    pub fn short_sentence(&self, what: &str) -> String {
        let quoted = |of: &[Candidate]| listed(&of.iter().map(|c| format!("`{}`", c.name)).collect::<Vec<_>>());
        let next = self.told.first().map_or(".".into(), |c| {
            format!(": `{}`, the next, needs {} times the rays for the same error.", c.name, self.times(c))
        });
        match self.tied.len() {
            0 => format!("There is nothing to compare for {what}: no variance is known."),
            1 => format!("For {what}, {} is best{next}", quoted(&self.tied)),
            2 | 3 => format!("For {what}, {} are best as far as the noise tells{next}", quoted(&self.tied)),
            n => format!("For {what}, the noise does not tell the best {n} apart{next}"),
        }
    }

    /// Cell of a table: the work of the setting of that name divided by that of the best; a dash where it is not ranked.
    pub fn cell(&self, name: &str) -> String {
        let found = self.order.iter().find(|c| c.name == name);
        found.map_or("–".into(), |c| significant(c.work / self.order[0].work, 3))
    }

    /// The same with the half width of its 95 % interval; the best has none.
    pub fn cell_with_error(&self, name: &str) -> String {
        match self.order.iter().position(|c| c.name == name) {
            None => "–".into(),
            Some(0) => "1".into(),
            Some(i) => self.times(&self.order[i]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, work: f64, relative_error: f64) -> Candidate {
        Candidate { name: name.into(), work, relative_error, replicates: 16, without: vec![] }
    }

    #[test]
    fn what_the_noise_hides_is_tied() {
        let r = Ranking::new(vec![of("scatter", 3.0, 0.05), of("mis", 1.0, 0.05), of("connect", 1.05, 0.05)]);
        let text = r.sentence("techniques", "the whole image", "256 samples per pixel");
        assert!(text.starts_with("Among the techniques, `mis` and `connect` need the fewest rays"), "{text}");
        assert!(text.contains("`scatter` needs 3.00 ± 0.45 times as many"), "{text}");
        assert_eq!((r.cell("connect").as_str(), r.cell("nobody").as_str()), ("1.05", "–"));
        assert_eq!((r.cell_with_error("mis").as_str(), r.cell_with_error("nobody").as_str()), ("1", "–"));
    }

    /// Two settings whose noise is the same, one of which needs 50 % more rays: the ratio has no error, although each work has.
    #[test]
    fn shared_noise_does_not_hide_a_ratio() {
        let noise = [0.8, 1.3, 0.9, 1.1, 0.7, 1.2];
        let of = |name: &str, rays: f64| Candidate {
            without: noise.iter().map(|v| v * rays).collect(),
            ..of(name, rays, 0.3)
        };
        let text = Ranking::new(vec![of("none", 1.5), of("albedo", 1.0)]).sentence("ways", "T0", "64 samples");
        assert!(text.starts_with("Among the ways, `albedo` needs the fewest rays"), "{text}");
        assert!(text.contains("`none` needs 1.50 times as many"), "{text}");
    }

    /// Errors that are not known prove nothing, however large the ratio.
    #[test]
    fn without_an_error_nothing_is_told_apart() {
        let text = Ranking::new(vec![of("a", 9.0, f64::NAN), of("b", 1.0, 0.01)]).sentence("ways", "T2", "2 samples");
        assert!(text.starts_with("The noise of 2 samples does not tell"), "{text}");
    }

    /// A setting whose variance is zero, infinite or unknown is no candidate.
    #[test]
    fn what_has_no_variance_is_left_out() {
        let r = Ranking::new(vec![of("zero", 0.0, 0.0), of("infinite", f64::INFINITY, 0.1), of("a", 2.0, 0.1)]);
        assert!(r.sentence("ways", "T2", "4 samples").starts_with("`a` stands alone"));
        assert!(Ranking::new(vec![]).sentence("ways", "T2", "4 samples").starts_with("There is nothing to compare"));
    }
}
