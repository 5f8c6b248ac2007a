//! Explanations of a difference: families with a fitted parameter, a clamp, and simulations.
//!
//! ```text
//! family f stays while  p(S, P_f) ≥ α  and  χ²_f ≤ χ²_best + Δ          simulation c stays while  p(S, P_c) ≥ α_i
//! ```
//!
//! An explanation that describes a picture only because its own errors are large explains nothing. It counts only if the correct picture
//! is rejected with those errors. Of two families that both stay, the one with fewer parameters is kept unless the other one fits much
//! better.

use super::elimination::{self, Tried};
use super::evidence::{self, Evidence};
use super::explain::{Suspicion, finding, of_family, of_simulation};
use super::family::{Family, Relation};
use super::fit::{Cells, Constant, Fitted};
use super::gap::{Fit, Gap, compare, compare_within, ratio};
use super::picture::{Pictures, Slot};
use super::prepare::Ready;
use super::regions::{self, Region};
use super::{Case, Effort, FamilyTried, plateau};
use crate::progress::Progress;
use crate::stats::two_sided_p;

/// A family is rejected if its χ², in units of the best one per cell, is larger than the best by more than this.
const APART: f64 = 20.0;
/// One more parameter must lower χ² by at least this.
const PARAMETER: f64 = 16.0;
/// Largest factor on one term of an image without terms.
const LARGE: f64 = 5.0;
/// A constant with a smaller relative error needs no simulation beside it.
const PRECISE: f64 = 0.01;
/// Relative error that the prediction of a family may have.
pub(super) const SLACK: f64 = 1e-3;
/// An explanation is named only if its own p-value is at least this.
const NAMED: f64 = 0.02;
/// Largest mean squared deviation of an explanation that is named, in squared standard errors.
const GOOD: f64 = 1.6;
/// The same for a picture for a display, whose errors contain the rounding.
const GOOD_IN_STEPS: f64 = 0.3;
/// Largest χ² per cell of a family that is named. The cells of the fit are smaller than the regions of the comparison.
const CHI2: f64 = 2.5;
/// An image without terms whose mean differs by less than this names no family: too many of them have so small an effect.
const SLIGHT: f64 = 0.02;

/// A suspect that is compared: the terms, and the whole image or the rest.
pub(super) struct Compared<'a> {
    pub(super) case: &'a Case<'a>,
    pub(super) ready: &'a Ready,
    /// The pictures with the rest in place of the whole image.
    pub(super) suspect: Pictures,
    pub(super) relation: Relation,
    /// Regions for fits, smaller than those of the comparison.
    pub(super) cells: Vec<Region>,
    /// The comparison with the correct pictures.
    pub(super) correct: Fit,
}

/// A family after its fit.
pub(super) struct Tested {
    family: Family,
    fitted: Fitted,
    p: f64,
    misfit: f64,
    cells: usize,
    pub(super) kept: bool,
}

impl Tested {
    pub(super) fn row(&self, c: &Compared) -> FamilyTried {
        let what = of_family(self.family, &self.fitted.constants, c.has_terms()).what;
        FamilyTried { what, p: self.p, chi2: self.fitted.chi2 / self.cells.max(1) as f64, rejected: !self.kept }
    }
}

impl Compared<'_> {
    pub(super) fn has_terms(&self) -> bool {
        self.suspect.last_term().is_some()
    }

    /// All families that have a best parameter, the best fit first.
    pub(super) fn families(&self) -> Vec<Tested> {
        let reference = &self.ready.reference;
        let cells = Cells::new(&self.suspect, reference, &self.cells, self.ready.display.fitted);
        let slots: Vec<Slot> = self.suspect.layers.iter().map(|l| l.slot).collect();
        let last = reference.last_term().unwrap_or(0);
        let test = |family: Family| {
            let fitted = cells.fit(family)?;
            let first = self.tested(family, fitted, &slots, cells.count());
            if family != Family::Exposure || first.kept {
                return Some(first);
            }
            // in a file with coarse values, the mean of the image is less biased than the cells
            let mean = self.mean_ratio()?;
            let chi2 = first.fitted.chi2;
            let second = self.tested(family, Fitted { constants: vec![mean], chi2 }, &slots, cells.count());
            Some(if second.kept { second } else { first })
        };
        let mut all: Vec<Tested> =
            Family::all(&slots, last, self.ready.display.fitted).into_iter().filter_map(test).collect();
        all.sort_by(|a, b| b.kept.cmp(&a.kept).then(a.fitted.chi2.total_cmp(&b.fitted.chi2)));
        select(&mut all);
        all
    }

    /// The ratio of the suspect to the correct picture over the regions of the grid.
    fn mean_ratio(&self) -> Option<Constant> {
        let layer = self.suspect.layers.last()?;
        let right = self.ready.reference.layer(layer.slot)?;
        let grid = self.ready.regions.iter().filter(|r| r.in_grid());
        let pixels: Vec<usize> = grid.flat_map(|r| r.pixels.clone()).collect();
        let r = ratio(layer, right, self.suspect.size[0], &pixels);
        (r.mean.is_finite() && r.std_error > 0.0).then_some(Constant { value: r.mean, std_error: r.std_error })
    }

    /// A family with its constants, after the comparison with its prediction.
    fn tested(&self, family: Family, fitted: Fitted, slots: &[Slot], cells: usize) -> Tested {
        let predicted = self.brightened(family.predict(&self.ready.reference, slots, fitted.by_channel()));
        let slack = |c: &Constant| 4.0 * c.std_error / c.value.abs().max(0.5);
        let slack = fitted.constants.iter().map(slack).fold(SLACK, f64::max).min(0.05);
        let fit = compare_within(&self.suspect, &predicted, &self.ready.regions, slack);
        let whole = |slot: &&Slot| predicted.layer(**slot).is_some() || family.leaves_out(**slot);
        let explained = slots.iter().filter(whole).count() == slots.len();
        // without terms, a factor that makes one term many times brighter stands for something else
        let one_term = matches!(family, Family::Term(_)) && !self.has_terms();
        let likely = !one_term || fitted.constants.iter().all(|c| c.value < LARGE);
        let positive = family.is_addition() || fitted.constants.iter().all(|c| c.value >= -2.0 * c.std_error);
        // a factor of 1, and nothing added, is no mistake
        let none = if family.is_addition() { 0.0 } else { 1.0 };
        let differs = |c: &Constant| (c.value - none).abs() > 4.0 * c.std_error;
        let differs = fitted.constants.is_empty() || fitted.constants.iter().any(differs);
        let fits = fit.p >= self.case.alpha && !fit.gaps.is_empty() && self.tells(&fit);
        let kept = fits && explained && positive && differs && likely;
        Tested { family, fitted, p: fit.p, misfit: fit.misfit, cells, kept }
    }

    /// Scales a prediction to the brightness of the suspect, if the exposure of the suspect is unknown.
    fn brightened(&self, predicted: Pictures) -> Pictures {
        if self.ready.display.fitted {
            elimination::same_brightness(&self.suspect, predicted, &self.ready.regions)
        } else {
            predicted
        }
    }

    /// Returns true if an explanation fits well enough to be named.
    fn fits(&self, p: f64, misfit: f64) -> bool {
        let good = if self.suspect.code.for_display() { GOOD_IN_STEPS } else { GOOD };
        p >= NAMED && misfit <= good
    }

    /// Returns true if a family fits well enough to be named, and its effect is large enough.
    pub(super) fn is_named(&self, t: &Tested) -> bool {
        let grid = || self.correct.gaps.iter().filter(|g| self.ready.regions[g.region].in_grid());
        let (seen, right) = grid().fold((0.0, 0.0), |a, g| (a.0 + g.suspect, a.1 + g.predicted));
        let lamps = || {
            self.correct
                .gaps
                .iter()
                .any(|g| self.ready.regions[g.region].name == regions::LAMPS && g.adjusted < self.case.alpha)
        };
        let slight = !self.has_terms() && !self.ready.display.fitted && (seen / right - 1.0).abs() < SLIGHT && !lamps();
        self.fits(t.p, t.misfit) && t.fitted.chi2 <= CHI2 * t.cells as f64 && !slight
    }

    pub(super) fn describe(&self, t: &Tested, evidence: &Evidence) -> Suspicion {
        let s = of_family(t.family, &t.fitted.constants, self.has_terms());
        let c = t.fitted.by_channel()[0];
        let known = evidence.ratios.iter().filter_map(|r| if let Slot::Term(k) = r.slot { Some(k) } else { None });
        let known = known.filter(|_| !matches!(t.family, Family::Renumbered(_) | Family::Added(_)));
        Suspicion { p: t.p, misfit: t.misfit, curve: known.map(|k| [k as f64, t.family.factor(k, c)]).collect(), ..s }
    }

    /// The clamp of finished pixels, if it explains the suspect.
    pub(super) fn clamped(&self) -> Option<Suspicion> {
        let level = self.ready.counts.plateau? as f32;
        let suspect = self.ready.pictures.only(|s| s != Slot::Tail);
        let predicted = self.brightened(plateau::clamped(&self.ready.reference, level));
        let fit = compare(&suspect, &predicted, &self.ready.regions);
        let found = finding(
            "clamped",
            format!("finished pixels are clamped at {level:.4}"),
            "its brightest pixels all have this value, and the correct ones are brighter".into(),
            "write the file before the clamp; only pictures for a display need it",
        );
        (self.fits(fit.p, fit.misfit) && self.tells(&fit)).then_some(Suspicion {
            p: fit.p,
            misfit: fit.misfit,
            ..found
        })
    }

    /// Returns true if the terms and a precise constant, or a rule without one, exclude other mistakes. An image alone does not.
    pub(super) fn is_decided(&self, suspects: &[Suspicion]) -> bool {
        let precise = |c: &Constant| c.std_error < PRECISE * c.value.abs().max(0.1);
        !suspects.is_empty() && self.has_terms() && suspects.iter().all(|s| s.constants.iter().all(precise))
    }

    /// Simulates the known mistakes.
    pub(super) fn simulate(&self, progress: Progress<'_>) -> Vec<Tried> {
        let Some(candidates) = self.case.candidates else { return vec![] };
        let effort = Effort { any_gain: self.ready.display.fitted, ..self.case.effort };
        let sum = self.relation == Relation::Sum;
        let suspect = self.ready.pictures.only(|s| !(sum && s == Slot::Whole));
        elimination::eliminate(&suspect, candidates, &self.ready.regions, self.case.alpha, effort, progress)
    }

    /// The simulations that explain the suspect although the correct picture does not, with the same errors.
    pub(super) fn simulated(&self, tried: &[Tried], evidence: &Evidence) -> Vec<Suspicion> {
        let explains = |t: &&Tried| !t.rejected && self.fits(t.fit.p, t.fit.misfit) && self.tells(&t.fit);
        let what = |name: &str| self.case.candidates.map_or(String::new(), |c| c.what(name));
        let one = |t: &Tried| of_simulation(&t.name, what(&t.name), t.fit.p, t.fit.misfit, curve(&t.fit, evidence));
        tried.iter().filter(explains).map(one).collect()
    }

    /// Returns true if the correct picture is rejected where an explanation predicts something, also with the errors of the comparison
    /// with that explanation. An explanation with large errors explains nothing.
    fn tells(&self, fit: &Fit) -> bool {
        let tells = |g: &Gap| {
            let same = |h: &&Gap| (h.slot, h.region, h.channel) == (g.slot, g.region, g.channel);
            let Some(right) = self.correct.gaps.iter().find(same) else { return false };
            let off = if g.suspect == right.predicted { 0.0 } else { (g.suspect - right.predicted) / g.std_error };
            right.adjusted < self.case.alpha && two_sided_p(off, g.dof) * (fit.gaps.len() as f64) < self.case.alpha
        };
        fit.gaps.iter().any(tells)
    }

    /// Evidence from the scene scaled by a factor.
    pub(super) fn scaled(&self) -> Option<(f64, Evidence)> {
        let (s, pictures) = self.case.scaled?;
        let small = pictures.shrunk(self.case.factor).times(1.0 / self.case.gain.unwrap_or(1.0));
        Some((
            s,
            evidence::collect(
                &small,
                &self.ready.reference,
                &self.ready.regions,
                evidence::Counts::default(),
                f64::NAN,
            ),
        ))
    }
}

/// Explanations that differ only in the bounce where a factor starts are one explanation: the best one.
pub(super) fn merge(suspects: &mut Vec<Suspicion>) {
    let name = suspects.first().map(|s| s.name.clone()).filter(|name| name == "constant-in-the-bounce");
    let Some(name) = name.filter(|name| suspects.len() > 1 && suspects.iter().all(|s| s.name == *name)) else { return };
    let others: Vec<String> =
        suspects[1..].iter().map(|s| s.what.split(", as").next().unwrap_or_default().to_owned()).collect();
    suspects.truncate(1);
    suspects[0].name = name;
    suspects[0].why +=
        &format!(". This data cannot tell where the factor starts; it fits as well that {}", others.join(", or that "));
}

/// Keeps the families that are as good as the best one, and drops those that another one with fewer parameters explains as well.
fn select(all: &mut [Tested]) {
    let Some(best) = all.iter().filter(|t| t.kept).map(|t| t.fitted.chi2).min_by(f64::total_cmp) else { return };
    let scale = all.first().map_or(1.0, |t| (best / t.cells.max(1) as f64).max(1.0));
    let kept: Vec<(Family, f64)> = all.iter().filter(|t| t.kept).map(|t| (t.family, t.fitted.chi2)).collect();
    for t in all.iter_mut().filter(|t| t.kept) {
        let simpler = |(other, chi2): &(Family, f64)| {
            let fewer = t.family.parameters().saturating_sub(other.parameters());
            fewer > 0 && *chi2 - t.fitted.chi2 < PARAMETER * scale * fewer as f64
        };
        t.kept = t.fitted.chi2 - best <= APART * scale && !kept.iter().any(simpler);
    }
}

/// The r_k that a simulation predicts, as pairs (k, r_k).
fn curve(fit: &Fit, evidence: &Evidence) -> Vec<[f64; 2]> {
    let term = |r: &evidence::Ratio| {
        let Slot::Term(k) = r.slot else { return None };
        let image = fit.gaps.iter().filter(|g| g.slot == r.slot && g.region == 0);
        let predicted = image.map(|g| g.predicted).sum::<f64>() / 3.0;
        Some([k as f64, predicted / r.means[1]]).filter(|p| p[1].is_finite())
    };
    evidence.ratios.iter().filter_map(term).collect()
}
