//! Explanations by simulation: every candidate renders the same scene, and those that the suspect contradicts are struck off.
//!
//! ```text
//! candidate c stays while  p(S, P_c) ≥ α_i        Σ α_i = α        stages i: ever more samples for ever fewer candidates
//! ```
//!
//! A true explanation is struck off with probability α at most, however many candidates there are: each is tested by itself, and
//! its level is shared by the stages, of which the first, where samples are few and no t-test is quite right, gets a thousandth. What stays is a list of all explanations that the data cannot tell apart.

use super::gap::{Fit, compare, ratio};
use super::picture::{Pictures, Slot};
use super::regions::Region;
use crate::progress::Progress;

/// Who can render candidates.
pub trait Simulate {
    /// All candidates.
    fn names(&self) -> Vec<String>;
    /// The pictures of one of them with so many samples per pixel; nothing if it was interrupted.
    fn pictures(&self, name: &str, spp: u32) -> Option<Pictures>;
}

/// A candidate after its last test.
#[derive(Clone, Debug)]
pub struct Tried {
    /// Its name.
    pub name: String,
    /// Its last test.
    pub fit: Fit,
    /// Samples per pixel of that test.
    pub spp: u32,
    /// Whether it was struck off.
    pub rejected: bool,
}

/// How much work elimination may do. Counted in paths and not in seconds, so that equal commands have equal results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Samples per pixel of the first stage; each stage takes four times as many.
    pub first: u32,
    /// Paths that one stage may take, all candidates together.
    pub paths: u64,
    /// Stages.
    pub stages: u32,
    /// Whether the exposure of the suspect is unknown: then every candidate is brought to its brightness first.
    pub any_gain: bool,
}

impl Default for Effort {
    fn default() -> Self {
        Self { first: 16, paths: 6_000_000, stages: 4, any_gain: false }
    }
}

/// Share of the level that the first stage has.
const FIRST: f64 = 1e-3;

/// The prediction at the brightness of the suspect, by the mean of its whole image, or of its first picture.
pub(super) fn same_brightness(suspect: &Pictures, predicted: Pictures, regions: &[Region]) -> Pictures {
    let pair = suspect.layers.iter().rev().find_map(|a| Some((a, predicted.layer(a.slot)?)));
    let gain = pair.map_or(1.0, |(a, b)| ratio(a, b, suspect.size[0], &regions[0].pixels).mean);
    if gain.is_finite() && gain > 0.0 { predicted.times(gain) } else { predicted }
}

/// Strikes off candidates; the best fit first, those that stayed before those that did not.
pub fn eliminate(
    suspect: &Pictures,
    candidates: &dyn Simulate,
    regions: &[Region],
    alpha: f64,
    effort: Effort,
    progress: Progress<'_>,
) -> Vec<Tried> {
    // a tail is what each renderer takes for it: its length depends on where paths end
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
            let Some(predicted) = candidates.pictures(&name, spp) else { continue };
            let predicted = if effort.any_gain { same_brightness(&suspect, predicted, regions) } else { predicted };
            let fit = compare(&suspect, &predicted, regions);
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
