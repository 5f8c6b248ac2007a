//! Diagnosis of images from another renderer: finds out whether they are wrong, and which mistakes could be the cause. The
//! method combines evidence, rules and simulations.
//!
//! The *suspect* is the set of images under test. The *reference* is the set of correct terms. A *candidate* is a mistake of
//! the [zoo](crate::zoo) that could explain the suspect.
//!
//! ```text
//! r_k = mean S_k / mean T_k        correct: p(S, T) ≥ α        candidate c stays on the list while p(S, P_c) ≥ α
//! ```
//!
//! | step | what happens | place |
//! |---|---|---|
//! | pictures | terms and whole image, averaged down to at most 96 pixels a side where possible | [`picture`] |
//! | comparison | means of regions, t-tests adjusted by Holm | [`gap`], [`regions`] |
//! | encoding | values with the curve of a display | [`encoding`] |
//! | few pixels | fireflies that are too frequent, and lamps that are missing | `rare` |
//! | evidence | ratios, whether they are constant over the image, counts, noise | [`evidence`], [`series`] |
//! | patterns | rules for r_k with one fitted number | [`pattern`] |
//! | simulations | every member of the zoo on the same scene | [`elimination`], [`candidates`] |
//! | decision | an ordered list of small rules, then a short list of causes | [`rules`], [`diagnose`] |
//!
//! *Correct* means two things: no significant difference from the reference was found, and a uniform bias above a stated
//! size would have been found. Ratios per bounce as a diagnostic follow the practice of rendering the terms one by one (Arvo
//! and Kirk 1990 for the mistakes in roulette; Veach 1997 for those of measure).

pub mod candidates;
pub mod elimination;
pub mod encoding;
pub mod evidence;
pub mod gap;
pub mod pattern;
pub mod picture;
mod rare;
pub mod regions;
pub mod rules;
pub mod series;

pub use elimination::{Effort, Simulate, Tried};
pub use evidence::{Counts, Evidence};
pub use picture::{Code, Layer, Pictures, Slot};
pub use regions::Region;
pub use rules::{Basis, Suspicion};

use crate::math::CHANNELS;
use crate::progress::Progress;
use crate::stats::evidence::JUDGED_PIXELS;
use crate::stats::min_detectable;
use gap::{compare, difference};
use pattern::{Constant, Pattern};
use serde::Serialize;

/// Wider pictures are averaged down to this width before they are compared, because the comparison uses means over regions.
pub const WIDEST: usize = 96;

/// Result of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Conclusion {
    /// No significant difference from the reference.
    Correct,
    /// Significantly different from the reference.
    Wrong,
}

/// A candidate that was simulated, as a row of the table.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Name of the member of the zoo.
    pub name: String,
    /// Smallest p-value of the comparison, adjusted for the number of comparisons.
    pub p: f64,
    /// Mean squared deviation, in squared standard errors.
    pub misfit: f64,
    /// Samples per pixel of its last simulation.
    pub spp: u32,
    /// True if the suspect differs significantly from the simulation.
    pub rejected: bool,
}

/// The result for one suspect.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// The conclusion.
    pub verdict: Conclusion,
    /// Adjusted p-value of the hypothesis that the suspect is correct.
    pub p: f64,
    /// Description of the largest difference; empty if the suspect is correct.
    pub worst: String,
    /// Smallest uniform relative bias that would have been found with probability 0.99; infinite if no bias would have been
    /// found.
    pub visible: f64,
    /// Pictures that are off by more than `visible` and by more than 5 %, but not significantly, for example because too few
    /// pixels carry their noise.
    pub undecided: Vec<Slot>,
    /// Possible causes, the best explanation first.
    pub suspects: Vec<Suspicion>,
    /// The evidence.
    pub evidence: Evidence,
    /// Change of the mean with the number of samples, if several numbers were given.
    pub samples: Option<series::BySamples>,
    /// Candidates that were simulated, best first.
    pub candidates: Vec<Candidate>,
}

/// The input of a diagnosis.
pub struct Case<'a> {
    /// The pictures under test.
    pub suspect: &'a Pictures,
    /// The correct terms, of the same size.
    pub reference: &'a Pictures,
    /// Samples per pixel of the reference; NaN if not known.
    pub reference_spp: f64,
    /// Regions that are defined by what the camera sees, in addition to the grid of regions.
    pub seen: &'a [Region],
    /// Counts of special values in the original pictures.
    pub counts: Counts,
    /// One flag per pixel, true for pixels to leave out; empty if all pixels count.
    pub mask: &'a [bool],
    /// The same render with different numbers of samples per pixel, including the suspect itself.
    pub by_samples: &'a [(u32, Pictures)],
    /// The same scene scaled by a factor, rendered by the renderer under test.
    pub scaled: Option<(f64, &'a Pictures)>,
    /// Candidates for simulation, if the scene is known.
    pub candidates: Option<&'a dyn Simulate>,
    /// Probability of an error: that a correct renderer is called wrong, and that the true cause is removed from the list.
    pub alpha: f64,
    /// Limits on the work of simulation.
    pub effort: Effort,
}

impl Case<'_> {
    /// Scales a prediction to the brightness of the suspect, if the exposure of the suspect is unknown.
    fn brightened(&self, predicted: Pictures, regions: &[Region]) -> Pictures {
        if self.effort.any_gain { elimination::same_brightness(self.suspect, predicted, regions) } else { predicted }
    }
}

/// Tests whether the suspect is correct, and if not, looks for the cause.
pub fn diagnose(case: &Case, progress: Progress<'_>) -> Diagnosis {
    let grid = regions::lit(regions::without(regions::grid(case.suspect.size), case.mask), case.reference);
    let all = grid.iter().chain(case.seen).cloned().collect();
    let all = regions::lit(regions::without(all, case.mask), case.reference);
    let reference = case.brightened(case.reference.clone(), &grid);
    let case = &Case { reference: &reference, ..*case };
    let fit = compare(case.suspect, case.reference, &all);
    let evidence = evidence::collect(case.suspect, case.reference, &all, case.counts, case.reference_spp);
    let samples = series::by_samples(case.by_samples, case.reference, &grid[0]).filter(|s| s.means.len() > 1);
    let scaled = case.scaled.map(|(s, p)| (s, evidence::collect(p, case.reference, &all, Counts::default(), f64::NAN)));
    let broken = case.counts.non_finite > 0;
    let rejected = fit.p < case.alpha;

    let patterns = if rejected && !broken { patterns(case, &grid, &all) } else { vec![] };
    let facts = rules::Facts {
        evidence: &evidence,
        patterns: &patterns,
        samples: samples.as_ref(),
        scaled: scaled.as_ref().map(|(s, e)| (*s, e)),
        rejected,
        beyond_scatter: rejected && beyond_scatter(case, &all),
    };
    let named: Vec<Suspicion> = rules::RULES.iter().flat_map(|rule| rule(&facts)).collect();
    let alone = named.iter().any(|s| s.name == "same-numbers" && s.basis == Basis::Points);
    // with non-finite values or shared noise there is nothing with which a simulation could be compared
    let tried = match case.candidates {
        Some(candidates) if rejected && !broken && !alone => {
            elimination::eliminate(case.suspect, candidates, &all, case.alpha, case.effort, progress)
        }
        _ => vec![],
    };
    let suspects = short_list(named, &tried, &evidence, broken || alone);
    let wrong = rejected || !suspects.is_empty();
    let candidates = tried.iter().map(|t| Candidate {
        name: t.name.clone(),
        p: t.fit.p,
        misfit: t.fit.misfit,
        spp: t.spp,
        rejected: t.rejected,
    });
    let visible = grid.iter().map(|r| visible(case, r, fit.gaps.len())).fold(f64::INFINITY, f64::min);
    Diagnosis {
        verdict: if wrong { Conclusion::Wrong } else { Conclusion::Correct },
        p: fit.p,
        worst: if rejected { worst(&fit, &all) } else { String::new() },
        visible,
        undecided: undecided(&fit, &evidence, visible),
        suspects,
        candidates: candidates.collect(),
        samples,
        evidence,
    }
}

/// Returns true if the means differ by more than the scatter of neighbouring pixels allows.
fn beyond_scatter(case: &Case, regions: &[Region]) -> bool {
    let mut plain = case.suspect.clone();
    plain.layers.iter_mut().for_each(|l| l.std_error = None);
    compare(&plain, case.reference, regions).p < case.alpha
}

/// The patterns that describe the suspect within its noise. Patterns without a fitted constant come first, then the better
/// fits.
fn patterns(case: &Case, grid: &[Region], all: &[Region]) -> Vec<(Pattern, Option<Constant>, f64, f64)> {
    let slots: Vec<Slot> = case.suspect.layers.iter().map(|l| l.slot).filter(|s| *s != Slot::Tail).collect();
    let suspect = case.suspect.only(|s| s != Slot::Tail);
    let last = case.reference.last_term().unwrap_or(0);
    let mut found = vec![];
    for pattern in Pattern::all(last) {
        if case.effort.any_gain && pattern == Pattern::Everything {
            continue;
        }
        let constant = if pattern.has_constant() {
            match pattern.fit(&suspect, case.reference, grid) {
                Some(c) => Some(c),
                None => continue,
            }
        } else {
            None
        };
        let predicted = pattern.predict(case.reference, &slots, constant.map_or(1.0, |c| c.value));
        let predicted = case.brightened(predicted, grid);
        let fit = compare(&suspect, &predicted, all);
        // a shift cannot predict the last slot; all other patterns must explain every slot
        let compared = predicted.layers.len() + usize::from(matches!(pattern, Pattern::Shift(_)));
        if fit.p >= case.alpha && compared >= slots.len() && !fit.gaps.is_empty() {
            found.push((pattern, constant, fit.p, fit.misfit));
        }
    }
    found.sort_by(|a, b| a.1.is_some().cmp(&b.1.is_some()).then(a.3.total_cmp(&b.3)));
    found
}

/// The short list: simulations that were not rejected, then patterns. Single pieces of evidence are listed only if neither
/// explains the suspect.
fn short_list(named: Vec<Suspicion>, tried: &[Tried], evidence: &Evidence, certain: bool) -> Vec<Suspicion> {
    if certain {
        return named.into_iter().filter(|s| s.basis == Basis::Points).take(1).collect();
    }
    let mut list: Vec<Suspicion> = vec![];
    for t in tried.iter().filter(|t| !t.rejected) {
        let hint = named.iter().find(|s| s.name == t.name);
        list.push(Suspicion {
            name: t.name.clone(),
            basis: Basis::Simulated,
            why: hint.map_or(String::new(), |s| s.why.clone()),
            next: hint.map_or(String::new(), |s| s.next.clone()),
            p: t.fit.p,
            misfit: t.fit.misfit,
            curve: curve(&t.fit, evidence),
            fitted: None,
        });
    }
    let simulated = !list.is_empty();
    let patterns = named.iter().filter(|s| s.basis == Basis::Pattern && list.iter().all(|l| l.name != s.name));
    let patterns: Vec<Suspicion> = patterns.cloned().collect();
    let (fitted, exact): (Vec<Suspicion>, Vec<Suspicion>) = patterns.into_iter().partition(|s| s.fitted.is_some());
    list.extend(exact);
    // a fitted constant without a known value explains less than a simulation, which has nothing to fit
    if simulated && fitted.len() > 1 {
        let why = &mut list[0].why;
        *why = [why.as_str(), &rules::one_constant(&fitted)]
            .into_iter()
            .filter(|w| !w.is_empty())
            .collect::<Vec<_>>()
            .join("; ");
    } else {
        list.extend(fitted);
    }
    if list.is_empty() {
        // do not suggest again what was simulated and rejected, unless the simulation depends on a constant of its own
        let has_a_number = |name: &str| ["clamped", "gamma-before-mean"].contains(&name);
        let struck = |s: &Suspicion| tried.iter().any(|t| t.rejected && t.name == s.name) && !has_a_number(&s.name);
        list = named.into_iter().filter(|s| s.basis == Basis::Points && !struck(s)).collect();
    }
    list
}

/// The r_k that a simulation predicts, as pairs (k, r_k).
fn curve(fit: &gap::Fit, evidence: &Evidence) -> Vec<[f64; 2]> {
    let term = |r: &evidence::Ratio| {
        let Slot::Term(k) = r.slot else { return None };
        let image = fit.gaps.iter().filter(|g| g.slot == r.slot && g.region == 0);
        let predicted = image.map(|g| g.predicted).sum::<f64>() / 3.0;
        Some([k as f64, predicted / r.means[1]]).filter(|p| p[1].is_finite())
    };
    evidence.ratios.iter().filter_map(term).collect()
}

/// Description of the most significant comparison.
fn worst(fit: &gap::Fit, regions: &[Region]) -> String {
    let Some(g) = fit.worst() else { return String::new() };
    let channel = CHANNELS[g.channel];
    format!(
        "{} in {} ({channel}): {:.4} instead of {:.4}, {:.1} standard errors",
        g.slot,
        regions[g.region].name,
        g.suspect,
        g.predicted,
        (g.suspect - g.predicted) / g.std_error
    )
}

/// The pictures that are off by more than a visible bias without a significant result. Either too few pixels carry their
/// noise, or the p-value of this comparison alone is below 5 % but not small enough among so many comparisons.
fn undecided(fit: &gap::Fit, evidence: &Evidence, visible: f64) -> Vec<Slot> {
    let of = |slot: Slot| fit.gaps.iter().filter(move |g| g.region == 0 && g.slot == slot);
    let doubtful = |slot: Slot| of(slot).all(|g| g.few) || of(slot).any(|g| g.p < 0.05);
    // differences below a twentieth are not reported
    let least = if visible.is_finite() { visible.max(0.05) } else { 0.05 };
    let off = evidence.ratios.iter().filter(|r| r.slot != Slot::Tail && (r.value - 1.0).abs() > least);
    off.map(|r| r.slot).filter(|slot| doubtful(*slot)).collect()
}

/// The smallest uniform relative bias that the means of a region would have shown with probability 0.99.
fn visible(case: &Case, image: &Region, comparisons: usize) -> f64 {
    let one = |l: &Layer| {
        let right = case.reference.layer(l.slot)?;
        let n = image.pixels.len() as f64;
        let channel = |c: usize| {
            let (m, carried) = difference((l, right, 1.0), case.suspect.size[0], &image.pixels, c, true);
            if carried < JUDGED_PIXELS {
                return f64::NAN;
            }
            let mean = image.pixels.iter().map(|&p| f64::from(right.mean[p][c])).sum::<f64>() / n;
            min_detectable(m.std_error, m.dof, case.alpha / comparisons.max(1) as f64, 0.01) / mean
        };
        Some((0..3).map(channel).filter(|v| v.is_finite()).fold(f64::INFINITY, f64::min))
    };
    let rounding = case.suspect.code.rounding();
    let best = case.suspect.layers.iter().filter(|l| l.slot != Slot::Term(0)).filter_map(one);
    best.fold(f64::INFINITY, f64::min).max(rounding)
}
