//! What is wrong with a picture that somebody else made? Evidence, rules and simulations, and an honest short list.
//!
//! ```text
//! r_k = mean S_k / mean T_k        correct: p(S, T) ≥ α        suspect c stays while p(S, P_c) ≥ α
//! ```
//!
//! | step | what happens | place |
//! |---|---|---|
//! | pictures | terms and whole image, brought to at most 96 pixels a side | [`picture`] |
//! | comparison | means of regions, t-tests adjusted by Holm | [`gap`], [`regions`] |
//! | few pixels | fireflies that nothing pays for, lamps that are not there | `rare` |
//! | evidence | ratios, flatness in space, counts, noise | [`evidence`], [`series`] |
//! | patterns | rules for r_k with one fitted number | [`pattern`] |
//! | simulations | every member of the zoo on the same scene | [`elimination`], [`candidates`] |
//! | decision | an ordered list of small rules, then the short list | [`rules`], [`diagnose`] |
//!
//! *Correct* means: not told apart from the reference, and a uniform bias above a stated size would have been. Ratios per bounce
//! as a diagnostic follow the practice of rendering the terms one by one (Arvo and Kirk 1990 for the roulette rows; Veach 1997
//! for the measures).

pub mod candidates;
pub mod elimination;
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

/// Wider pictures are averaged down before anything is compared: means do not need the pixels.
pub const WIDEST: usize = 96;

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Conclusion {
    /// Not told apart from the reference.
    Correct,
    /// Told apart.
    Wrong,
}

/// A candidate that was simulated, for the table.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// Name in the zoo.
    pub name: String,
    /// Smallest adjusted p-value.
    pub p: f64,
    /// Mean squared deviation in standard errors.
    pub misfit: f64,
    /// Samples per pixel of its last picture.
    pub spp: u32,
    /// Whether the suspect contradicts it.
    pub rejected: bool,
}

/// All that was found out about one suspect.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// The result.
    pub verdict: Conclusion,
    /// p-value of *correct*, adjusted.
    pub p: f64,
    /// Where it differs most, in words; empty if it is correct.
    pub worst: String,
    /// A uniform relative bias of this size would have been seen with probability 0.99; infinite if none would.
    pub visible: f64,
    /// Pictures off by more than that and 5 %, whose mean decides nothing because too few pixels carry its noise.
    pub undecided: Vec<Slot>,
    /// The short list, best first.
    pub suspects: Vec<Suspicion>,
    /// Evidence.
    pub evidence: Evidence,
    /// How the mean changes with samples, if there were several.
    pub samples: Option<series::BySamples>,
    /// Candidates that were simulated, best first.
    pub candidates: Vec<Candidate>,
}

/// What a suspect is judged by.
pub struct Case<'a> {
    /// The pictures.
    pub suspect: &'a Pictures,
    /// The right terms, of the same size.
    pub reference: &'a Pictures,
    /// Samples per pixel of the reference; NaN if not known.
    pub reference_spp: f64,
    /// What the camera sees, in addition to the regions of the image.
    pub seen: &'a [Region],
    /// What was counted in the original pictures.
    pub counts: Counts,
    /// Pixels that tell nothing, by index; empty if all do.
    pub mask: &'a [bool],
    /// The same render with fewer samples, the suspect itself included.
    pub by_samples: &'a [(u32, Pictures)],
    /// The same scene scaled by a factor, rendered by the suspect.
    pub scaled: Option<(f64, &'a Pictures)>,
    /// Candidates, if the scene is known.
    pub candidates: Option<&'a dyn Simulate>,
    /// Chance that a correct renderer is called wrong, and that a true explanation is struck off.
    pub alpha: f64,
    /// How much may be simulated.
    pub effort: Effort,
}

impl Case<'_> {
    /// A prediction at the brightness of the suspect where its exposure is unknown.
    fn brightened(&self, predicted: Pictures, regions: &[Region]) -> Pictures {
        if self.effort.any_gain { elimination::same_brightness(self.suspect, predicted, regions) } else { predicted }
    }
}

/// Finds out what is wrong, if anything.
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
    // numbers that are none, and noise that is shared, leave nothing that a simulation could be compared with
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

/// Whether the means differ by more than neighbouring pixels scatter.
fn beyond_scatter(case: &Case, regions: &[Region]) -> bool {
    let mut plain = case.suspect.clone();
    plain.layers.iter_mut().for_each(|l| l.std_error = None);
    compare(&plain, case.reference, regions).p < case.alpha
}

/// The patterns that describe the suspect within its noise: those without a constant first, then the best fit first.
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
        // a shift has nothing to show for the last slot; all others must explain everything
        let compared = predicted.layers.len() + usize::from(matches!(pattern, Pattern::Shift(_)));
        if fit.p >= case.alpha && compared >= slots.len() && !fit.gaps.is_empty() {
            found.push((pattern, constant, fit.p, fit.misfit));
        }
    }
    found.sort_by(|a, b| a.1.is_some().cmp(&b.1.is_some()).then(a.3.total_cmp(&b.3)));
    found
}

/// Simulations that stayed, then patterns; pieces of evidence only where neither explains it.
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
    // a number that is free and has no name explains less than a simulation, in which there is nothing to fit
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
        // what was simulated without success is not suggested again, but where the simulation had a number of its own
        let has_a_number = |name: &str| ["clamped", "gamma-before-mean"].contains(&name);
        let struck = |s: &Suspicion| tried.iter().any(|t| t.rejected && t.name == s.name) && !has_a_number(&s.name);
        list = named.into_iter().filter(|s| s.basis == Basis::Points && !struck(s)).collect();
    }
    list
}

/// The r_k that a simulation predicts.
fn curve(fit: &gap::Fit, evidence: &Evidence) -> Vec<[f64; 2]> {
    let term = |r: &evidence::Ratio| {
        let Slot::Term(k) = r.slot else { return None };
        let image = fit.gaps.iter().filter(|g| g.slot == r.slot && g.region == 0);
        let predicted = image.map(|g| g.predicted).sum::<f64>() / 3.0;
        Some([k as f64, predicted / r.means[1]]).filter(|p| p[1].is_finite())
    };
    evidence.ratios.iter().filter_map(term).collect()
}

/// The comparison that says most, in words.
fn worst(fit: &gap::Fit, regions: &[Region]) -> String {
    let Some(g) = fit.worst() else { return String::new() };
    let channel = CHANNELS[g.channel];
    format!(
        "{} in {} ({channel}): {:.4} where {:.4} is right, {:.1} standard errors",
        g.slot,
        regions[g.region].name,
        g.suspect,
        g.predicted,
        (g.suspect - g.predicted) / g.std_error
    )
}

/// The pictures that are off by more than a visible bias, though nothing follows from that: too few pixels carry their noise, or
/// they would look suspicious alone (p < 5 %) and are one of many.
fn undecided(fit: &gap::Fit, evidence: &Evidence, visible: f64) -> Vec<Slot> {
    let of = |slot: Slot| fit.gaps.iter().filter(move |g| g.region == 0 && g.slot == slot);
    let doubtful = |slot: Slot| of(slot).all(|g| g.few) || of(slot).any(|g| g.p < 0.05);
    // less than a twentieth is no news
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
