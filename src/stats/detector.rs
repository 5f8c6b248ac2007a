//! Comparison of two results while they are sampled batch by batch: is there a bias, and how small a bias could still be
//! hidden?
//!
//! ```text
//! x_i = φ(first, batch i) − φ(second, batch i)          for every functional φ, quantity and channel
//! Differs    some x has E_n(0) ≥ 1/α_φ at some n         Σ α_φ = α
//! Agrees     x̄ ± r_n lies within ±δ for every image mean
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | E_n, r_n | e-value of one mean, and half width of its confidence interval; valid at any time | [`sequential`](super::sequential) |
//! | α_φ | half of α is shared by the image means, half by regions and projections | [`Detector::push`] |
//! | δ | a fraction of the term plus a fraction of the whole image | [`Criterion`] |
//! | β | probability to miss a bias of the size that is called detectable | [`Finding::min_detectable`] |
//! | a | error of a second side that was finished before and is not sampled in batches | [`Detector::against_finished`] |
//!
//! **Why a union bound.** Each E_n is a martingale only with respect to its own batches (up to their scale), so the average
//! of several E_n need not be one. But the events "E_n ≥ 1/α_φ for some n" do not depend on when or why the comparison
//! stops, and their probabilities add. So for any stopping rule, the probability that some quantity is rejected wrongly is
//! at most α. All intervals hold at once, at every n, with probability 1 − α.
//!
//! In a comparison with a finished result, half of α_φ covers its error: the true value lies within a = t* s of the result,
//! and only a difference beyond a counts. As in [`verdict`](super::verdict), a mean with too little
//! [evidence](super::evidence) for a verdict rejects nothing.

mod track;

use super::evidence::{Evidence, JUDGED, Reason, WIDER, doubt_in_words};
use super::hypothesis::{Measured, ROUNDING, critical};
use super::power::one_sided_normal;
use super::quantity::{Quantity, shared_quantities};
use super::sequential::MeanSequence;
use super::verdict::{Criterion, Outcome};
use crate::math::CHANNELS;
use crate::terms::{Doubt, Estimate, Functional, Series, Variance};
use serde::Serialize;
use track::Track;

/// Comparison of two sides that is updated with every batch.
#[derive(Clone, Debug)]
pub struct Detector {
    criterion: Criterion,
    finished: bool,
    tracks: Vec<Track>,
    /// Mean of the whole image on the first side, for each channel.
    whole: [MeanSequence; 3],
    batches: u64,
    /// Doubts about the sampled sides: label of the side, the doubt, expected events per batch.
    doubts: Vec<(String, Doubt, f64)>,
    /// Whether infinite sums (tail and total) have a finite variance: label of the side, and what is known about it.
    variances: Vec<(String, Variance)>,
}

/// The result for one quantity. It describes the functional and channel that decide about this quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// `T0`, `T1`, …, `tail`, `sum`, `total`.
    pub name: String,
    /// The functional and channel: `image, red`.
    pub functional: String,
    /// Difference first − second, so far.
    pub effect: f64,
    /// Interval that contains the bias. With probability 1 − α this holds for all quantities and at all times.
    pub interval: (f64, f64),
    /// ln E_n(0) now: the evidence against "no bias" in this functional and channel.
    pub log_e: f64,
    /// Adjusted p-value. Without a bias, evidence as strong as this has at most this probability, for any stopping rule and
    /// any number of quantities. The quantity is rejected if p ≤ α.
    pub p: f64,
    /// The smallest bias that would have been detected by now with probability 1 − β.
    pub min_detectable: f64,
    /// Size of the quantity: mean of the values of both sides.
    pub scale: f64,
    /// δ, the margin of equivalence.
    pub delta: f64,
    /// The outcome for this quantity.
    pub outcome: Outcome,
    /// The reason, if the quantity is inconclusive for a reason other than noise.
    pub reason: Option<String>,
}

impl Detector {
    /// Compares two sides that are both sampled batch by batch.
    pub fn new(criterion: Criterion) -> Self {
        Self {
            criterion,
            finished: false,
            tracks: vec![],
            whole: Default::default(),
            batches: 0,
            doubts: vec![],
            variances: vec![],
        }
    }

    /// Compares one sampled side with a finished result, whose error is allowed for.
    pub fn against_finished(criterion: Criterion) -> Self {
        Self { finished: true, ..Self::new(criterion) }
    }

    /// Adds the doubts of a sampled side, and what is known about its variance. The cost of `side` is that of one batch.
    #[must_use]
    pub fn doubting(mut self, side: &Series) -> Self {
        self.doubts.extend(side.doubts.iter().map(|d| (side.label.clone(), d.clone(), side.expected(d))));
        self.variances.push((side.label.clone(), side.variance));
        self
    }

    /// Reason why a quantity can neither agree nor differ yet.
    fn doubt(&self, quantity: Quantity) -> Option<String> {
        if matches!(quantity, Quantity::Tail | Quantity::Total) {
            // a mean over batches is nearly normal only if its variance is finite
            let endless = |(label, variance): &(String, Variance)| {
                Evidence::of_variance(*variance).no_verdict.map(|reason| format!("{label}: {reason}"))
            };
            if let Some(reason) = self.variances.iter().find_map(endless) {
                return Some(reason);
            }
        }
        let of = |(label, doubt, each): &(String, Doubt, f64)| {
            let few = quantity.concerned(doubt) && each * (self.batches as f64) < JUDGED;
            few.then(|| doubt_in_words(label, doubt, each * self.batches as f64))
        };
        self.doubts.iter().find_map(of)
    }

    /// Number of batches so far.
    pub fn batches(&self) -> u64 {
        self.batches
    }

    /// Number of scalars that share α.
    pub fn family(&self) -> usize {
        self.tracks.len()
    }

    /// Adds one batch of samples of both sides, as image means and other functionals (weighted sums over pixels). The first
    /// functional is the image mean; the others are matched by name. If the second side is a finished result, every call passes
    /// the same value for it. The first call fixes the quantities to compare: those that both sides have.
    pub fn push(&mut self, first: &[Functional], second: &[Functional]) {
        if self.batches == 0 {
            self.open(first, second);
        }
        self.batches += 1;
        if let Some(image) = first.first() {
            (0..3).for_each(|c| self.whole[c].push(image.total.mean[c]));
        }
        let (finished, whole) = (self.finished, self.whole);
        let doubts: Vec<bool> = self.tracks.iter().map(|t| self.doubt(t.quantity).is_some()).collect();
        for (track, doubt) in self.tracks.iter_mut().zip(doubts) {
            track.push([first, second], finished);
            if track.weak().is_none() && !doubt {
                let log_e = track.difference.log_e(0.0, track.allowance + rounding(&whole, track.channel));
                track.evidence = track.evidence.max(log_e); // NaN is no evidence
            }
        }
    }

    fn open(&mut self, first: &[Functional], second: &[Functional]) {
        for (i, a) in first.iter().enumerate() {
            let Some(j) = second.iter().position(|b| b.name == a.name) else { continue };
            for quantity in shared_quantities(a, &second[j]) {
                for (channel, colour) in CHANNELS.iter().enumerate() {
                    self.tracks.push(Track {
                        quantity,
                        at: [i, j],
                        name: format!("{}, {colour}", a.name),
                        channel,
                        level: 0.0,
                        difference: MeanSequence::default(),
                        values: Default::default(),
                        events: Default::default(),
                        allowance: 0.0,
                        evidence: f64::NEG_INFINITY,
                    });
                }
            }
        }
        let images = self.tracks.iter().filter(|t| t.is_image()).count();
        let others = self.tracks.len() - images;
        let part = if others == 0 { 1.0 } else { 0.5 };
        let (alpha, finished) = (self.criterion.alpha, self.finished);
        for track in &mut self.tracks {
            track.level = alpha * part / if track.is_image() { images } else { others } as f64;
            if finished {
                track.level *= 0.5;
                let e = track.quantity.of(&second[track.at[1]]).unwrap_or(Estimate::NONE);
                let m = Measured::of(&e, track.channel);
                track.allowance = if m.std_error == 0.0 { 0.0 } else { critical(track.level, m.dof) * m.std_error };
            }
        }
    }

    /// The present findings, one for each quantity. If any functional and channel of a quantity is rejected, the one with
    /// the strongest evidence is reported. Otherwise it is the image mean with the widest interval relative to δ.
    pub fn findings(&self) -> Vec<Finding> {
        let mut quantities: Vec<Quantity> = self.tracks.iter().filter(|t| t.is_image()).map(|t| t.quantity).collect();
        quantities.dedup(); // three channels each
        let row = |quantity: &Quantity| {
            let all = || self.tracks.iter().filter(|t| t.quantity == *quantity);
            let rejected = all().filter(|t| self.rejects(t));
            let strongest = rejected.max_by(|a, b| (a.evidence + a.level.ln()).total_cmp(&(b.evidence + b.level.ln())));
            if let Some(track) = strongest {
                return Some(self.finding(track));
            }
            let reach = |f: &Finding| f.interval.0.abs().max(f.interval.1.abs()) / f.delta;
            let images = all().filter(|t| t.is_image()).map(|t| self.finding(t));
            images.max_by(|a, b| reach(a).total_cmp(&reach(b)))
        };
        quantities.iter().filter_map(row).collect()
    }

    /// The findings for the image mean of the total (or of the last quantity, if there is no total), one for each channel.
    /// Progress lines and curves show them.
    pub fn image(&self) -> Vec<Finding> {
        let last = self.tracks.iter().filter(|t| t.is_image()).map(|t| t.quantity).next_back();
        self.tracks.iter().filter(|t| t.is_image() && Some(t.quantity) == last).map(|t| self.finding(t)).collect()
    }

    /// Differs if anything is rejected; Agrees if every image mean is bounded within its δ.
    pub fn outcome(&self) -> Outcome {
        if self.tracks.iter().any(|t| self.rejects(t)) {
            return Outcome::Differs;
        }
        let mut images = self.tracks.iter().filter(|t| t.is_image()).peekable();
        let agree = images.peek().is_some() && images.all(|t| self.finding(t).outcome == Outcome::Agrees);
        if agree { Outcome::Agrees } else { Outcome::Inconclusive }
    }

    /// The largest ln E_n so far, over all scalars, minus the threshold that its share of α demands. A value ≥ 0 is a
    /// rejection.
    pub fn excess(&self) -> f64 {
        self.tracks.iter().map(|t| t.evidence + t.level.ln()).fold(f64::NEG_INFINITY, f64::max)
    }

    fn rejects(&self, track: &Track) -> bool {
        track.evidence >= -track.level.ln()
    }

    fn finding(&self, track: &Track) -> Finding {
        let (d, c) = (&track.difference, track.channel);
        let allowance = track.allowance + rounding(&self.whole, c);
        let half = d.radius(track.level) + allowance;
        let scale = 0.5 * (track.values[0].mean() + track.values[1].mean());
        let delta = self.criterion.of_term * scale.abs() + self.criterion.of_total * self.whole[c].mean().abs();
        let (weak, doubt) = (track.weak(), self.doubt(track.quantity));
        let known = weak.is_none() && doubt.is_none();
        let outcome = if self.rejects(track) {
            Outcome::Differs
        } else if d.mean().abs() + half * if weak.is_some() { 1.0 + WIDER } else { 1.0 } <= delta && doubt.is_none() {
            Outcome::Agrees
        } else {
            Outcome::Inconclusive
        };
        let reason = match outcome {
            Outcome::Inconclusive if !d.mean().is_finite() => Some(Reason::NotFinite.to_string()),
            Outcome::Inconclusive => doubt.or(weak.map(|w| w.to_string())),
            _ => None,
        };
        let or_unknown = |x: f64| if known || outcome != Outcome::Inconclusive { x } else { f64::NAN };
        // α divided by the level of this scalar
        let shared = self.criterion.alpha / track.level;
        Finding {
            name: track.quantity.name(),
            functional: track.name.clone(),
            effect: d.mean(),
            interval: (or_unknown(d.mean() - half), or_unknown(d.mean() + half)),
            log_e: d.log_e(0.0, allowance),
            p: if d.mean().is_nan() { f64::NAN } else { (shared * (-track.evidence).exp()).min(1.0) },
            min_detectable: or_unknown(half + one_sided_normal(self.criterion.beta) * d.std_error()),
            scale,
            delta,
            outcome,
            reason,
        }
    }
}

/// Rounding error of `f32` for the whole image; it never counts as a bias.
fn rounding(whole: &[MeanSequence; 3], channel: usize) -> f64 {
    ROUNDING * whole[channel].mean().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terms::Events;
    use glam::DVec3;

    /// An image with two terms of these values, and a region.
    fn batch(values: [f64; 2], events: f64) -> Vec<Functional> {
        let events = Some(Events::equal(events));
        let e = |x: f64| Estimate { mean: DVec3::splat(x), std_error: DVec3::NAN, replicates: 1, events };
        let one = |name: &str| Functional {
            name: name.into(),
            terms: values.map(e).to_vec(),
            tail: Estimate::NONE,
            sum: e(values[0] + values[1]),
            total: e(values[0] + values[1]),
        };
        vec![one("image"), one("region 0,0")]
    }

    /// Numbers without a pattern, with mean 0.
    fn noise(i: u32) -> f64 {
        f64::from((i * i * 7 + i * 13) % 101) / 50.5 - 0.98
    }

    fn watch(bias: f64, events: f64, batches: u32) -> Detector {
        let mut d = Detector::new(Criterion { of_term: 0.01, ..Criterion::default() });
        for i in 0..batches {
            d.push(
                &batch([1.0, 0.5 + bias + 0.01 * noise(i)], events),
                &batch([1.0, 0.5 - 0.01 * noise(i + 37)], events),
            );
        }
        d
    }

    #[test]
    fn a_bias_is_found_and_named() {
        let d = watch(0.01, 1000.0, 300);
        assert_eq!(d.family(), 2 * 3 * 4); // two functionals; T0, T1, sum, total; three channels
        let found = d.findings();
        let outcomes: Vec<_> = found.iter().map(|f| (f.name.as_str(), f.outcome)).collect();
        assert_eq!(outcomes[0], ("T0", Outcome::Agrees));
        assert_eq!(outcomes[1], ("T1", Outcome::Differs));
        assert_eq!(d.outcome(), Outcome::Differs);
        assert!(found[1].p <= 1e-3 && found[1].interval.0 > 0.0 && d.excess() >= 0.0, "{:?}", found[1]);
    }

    #[test]
    fn equality_is_proved_within_delta() {
        let d = watch(0.0, 1000.0, 300);
        assert_eq!(d.outcome(), Outcome::Agrees, "{:?}", d.findings());
        let t1 = &d.findings()[1];
        assert!(t1.interval.0 < 0.0 && t1.interval.1 > 0.0 && t1.min_detectable < t1.delta, "{t1:?}");
        assert_eq!(watch(0.0, 1000.0, 5).outcome(), Outcome::Inconclusive);
    }

    #[test]
    fn few_events_decide_nothing() {
        let d = watch(0.01, 1.0, 300);
        assert_eq!(d.outcome(), Outcome::Inconclusive);
        assert!(d.findings()[1].reason.as_deref().is_some_and(|why| why.contains("rests on")));
    }

    /// A finished result that is off by less than its own error does not prove a bias; one that is off by much more does.
    #[test]
    fn the_error_of_a_finished_result_is_allowed_for() {
        for (std_error, outcome) in [(2e-3, Outcome::Inconclusive), (1e-5, Outcome::Differs)] {
            let mut finished = batch([1.0, 0.5], 1e6);
            for f in &mut finished {
                for e in f.terms.iter_mut().chain([&mut f.sum, &mut f.total]) {
                    (e.std_error, e.replicates) = (DVec3::splat(std_error), 16);
                }
            }
            let mut d = Detector::against_finished(Criterion::default());
            (0..300).for_each(|i| d.push(&batch([1.0, 0.505 + 0.01 * noise(i)], 1000.0), &finished));
            assert_eq!(d.findings()[1].outcome, outcome, "{std_error}: {:?}", d.findings()[1]);
        }
    }

    #[test]
    fn what_is_not_finite_is_never_judged() {
        let mut d = watch(0.0, 1000.0, 300);
        d.push(&batch([f64::NAN, 0.5], 1000.0), &batch([1.0, 0.5], 1000.0));
        let t0 = &d.findings()[0];
        assert_eq!((t0.outcome, t0.reason.clone()), (Outcome::Inconclusive, Some(Reason::NotFinite.to_string())));
        assert!(t0.p.is_nan());
    }
}
