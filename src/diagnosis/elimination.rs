//! Elimination of candidates by simulation: every candidate renders the same scene. Those that differ significantly from the
//! suspect are rejected.
//!
//! ```text
//! candidate c stays while  p(S, P_c) ≥ α_i        Σ α_i = α        stages i: more samples for fewer candidates
//! ```
//!
//! The true cause is rejected with probability at most α, however many candidates there are, because each candidate has its
//! own test. Its level α is divided among the stages. The first stage gets a thousandth of α: it has few samples, so that a
//! t-test is not quite valid there. The remaining candidates are all explanations that the data cannot distinguish.

use super::gap::{Fit, compare, ratio};
use super::picture::{Pictures, Slot};
use super::regions::Region;
use crate::progress::Progress;

/// Renders candidates.
pub trait Simulate {
    /// Names of all candidates.
    fn names(&self) -> Vec<String>;
    /// The mistake of one candidate, in one line.
    fn what(&self, name: &str) -> String;
    /// The pictures of one candidate with `spp` samples per pixel. None if interrupted.
    fn pictures(&self, name: &str, spp: u32) -> Option<Pictures>;
}

/// A candidate after its last test.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Name of the candidate.
    pub name: String,
    /// Result of its last test.
    pub fit: Fit,
    /// Samples per pixel of that test.
    pub spp: u32,
    /// True if it was rejected.
    pub rejected: bool,
}

/// Limits on the work of elimination. They are counted in paths rather than seconds, so that the same command always gives
/// the same result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Samples per pixel of the first stage; each stage takes four times as many.
    pub first: u32,
    /// Largest number of paths of one stage, for all candidates together.
    pub paths: u64,
    /// Number of stages.
    pub stages: u32,
    /// True if the exposure of the suspect is unknown. Every candidate is then first scaled to the brightness of the
    /// suspect. Set by [`diagnose`](super::diagnose).
    pub any_gain: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { first: 4, paths: 3_000_000, stages: 5, any_gain: false }
    }
}

/// Fraction of the level α that the first stage gets.
const FIRST: f64 = 1e-3;

/// Samples per pixel from which on the errors of single pixels are used.
const KNOWN: u32 = 16;

/// Scales the prediction to the brightness of the suspect, by the mean of the whole image, or of the last picture that both
/// have.
pub(super) fn same_brightness(suspect: &Pictures, predicted: Pictures, regions: &[Region]) -> Pictures {
    let pair = suspect.layers.iter().rev().find_map(|a| Some((a, predicted.layer(a.slot)?)));
    let gain = pair.map_or(1.0, |(a, b)| ratio(a, b, suspect.size[0], &regions[0].pixels).mean);
    if gain.is_finite() && gain > 0.0 { predicted.times(gain) } else { predicted }
}

/// Rejects candidates stage by stage. Returns those that were not rejected first, and within each group the better fit
/// first.
pub fn eliminate(
    suspect: &Pictures,
    candidates: &dyn Simulate,
    regions: &[Region],
    alpha: f64,
    effort: Effort,
    progress: Progress<'_>,
) -> Vec<Tried> {
    // leave out the tail: renderers differ in how long their paths are, and so in what the tail contains
    let suspect = suspect.only(|s| s != Slot::Tail);
    let pixels = (suspect.size[0] * suspect.size[1]) as u64;
    let later = f64::from(effort.stages.max(2) - 1);
    let level = |stage: u32| alpha * if stage == 0 { FIRST } else { (1.0 - FIRST) / later };
    let (mut alive, mut tried) = (candidates.names(), Vec::<Tried>::new());
    for stage in 0..effort.stages {
        let spp = effort.first * 4u32.pow(stage);
        if alive.is_empty() || (stage > 0 && pixels * u64::from(spp) * alive.len() as u64 > effort.paths) {
            break;
        }
        progress.begin(&format!("{} candidates, {spp} spp", alive.len()), alive.len() as u64);
        tried.retain(|t| t.rejected);
        for name in std::mem::take(&mut alive) {
            let Some(mut predicted) = candidates.pictures(&name, spp) else { continue };
            if spp < KNOWN {
                // a pixel whose few samples agree by chance has no error; the scatter of pixels has
                predicted.layers.iter_mut().for_each(|l| l.std_error = None);
            }
            let predicted = if effort.any_gain { same_brightness(&suspect, predicted, regions) } else { predicted };
            // a simulation that ends after K bounces has no tail, and its whole image lacks it
            let endless = suspect.last_term().is_some() && predicted.layer(Slot::Tail).is_none();
            let fit = compare(&suspect.only(|s| !(endless && s == Slot::Whole)), &predicted, regions);
            let rejected = fit.p < level(stage);
            if !rejected {
                alive.push(name.clone());
            }
            tried.push(Tried { name, fit, spp, rejected });
            progress.advance(1);
        }
    }
    tried.sort_by(|a, b| a.rejected.cmp(&b.rejected).then(a.fit.misfit.total_cmp(&b.fit.misfit)));
    tried
}
