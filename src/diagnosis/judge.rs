//! The decision: correct, wrong or undecided, and which explanations remain.
//!
//! ```text
//! wrong: p(S, T) < α, or the file shows something wrong        undecided: a limit, and nothing wrong        correct: neither
//! ```
//!
//! The steps are in [`prepare`](super::prepare) and [`compared`](super::compared); what cannot be told is in [`limits`](super::limits).

use super::compared::{Compared, SLACK, merge};
use super::elimination::Tried;
use super::evidence;
use super::explain::Suspicion;
use super::family::joined;
use super::gap::{Fit, compare_within};
use super::hints::{hints, with_scale};
use super::limits::{few_pixels, undecided};
use super::prepare::{blurred, prepare};
use super::regions::{self, Region, SIDE};
use super::{Candidate, Case, Conclusion, Diagnosis, MOST, series};
use crate::math::CHANNELS;
use crate::progress::Progress;

/// Tests whether the suspect is correct, and if not, looks for the cause.
pub fn diagnose(case: &Case, progress: Progress<'_>) -> Diagnosis {
    let ready = prepare(case);
    let last = ready.reference.last_term().unwrap_or(0);
    let (suspect, relation) = joined(&ready.pictures, last);
    let mut cells = regions::cells(suspect.size, &regions::either(&ready.mask, &ready.edges));
    cells.extend(ready.regions.iter().filter(|r| r.name == regions::LAMPS).cloned());
    let any_gain = ready.display.fitted;
    // a fitted exposure may be off by its error
    let slack =
        if any_gain { (2.0 * ready.display.half_width / ready.display.exposure + SLACK).min(0.02) } else { 0.0 };
    let correct = compare_within(&suspect, &ready.reference, &ready.regions, slack);
    let c = Compared { case, ready: &ready, suspect, relation, cells, correct };
    let fit = &c.correct;
    let evidence =
        evidence::collect(&ready.pictures, &ready.reference, &ready.regions, ready.counts, case.reference_spp);
    let samples = series::by_samples(case.by_samples, &ready, case).filter(|s| s.means.len() > 1);
    let unseen = ready.regions.first().is_none_or(|r| r.pixels.len() < regions::FEWEST);
    let rejected = fit.p < case.alpha && !unseen;
    let mut findings = ready.findings.clone();
    findings.extend(samples.as_ref().and_then(|s| series::in_words(s, rejected)));
    findings.extend(c.scaled().and_then(|(s, e)| with_scale(&evidence, (s, &e))));

    if !rejected && !ready.empty {
        findings.extend(ready.contrast.and_then(blurred));
    }
    // a shifted reference is not accurate enough to name more than the shift, and an empty picture has nothing to name
    let search = rejected && ready.shift.is_none() && !ready.empty;
    let families = if search { c.families() } else { vec![] };
    let clamped = if search { c.clamped() } else { None };
    let mut suspects: Vec<Suspicion> =
        families.iter().filter(|f| f.kept && c.is_named(f)).map(|f| c.describe(f, &evidence)).collect();
    merge(&mut suspects);
    suspects.extend(clamped);
    let tried = if search && !c.is_decided(&suspects) { c.simulate(progress) } else { vec![] };
    let simulated = c.simulated(&tried, &evidence);
    suspects.extend(simulated.into_iter().filter(|s| suspects.iter().all(|f| !f.is(&s.name))).collect::<Vec<_>>());
    let visible = ready.regions.iter().map(|r| c.visible(r, fit.gaps.len())).fold(f64::INFINITY, f64::min);
    let undecided = undecided(fit, &evidence, visible);
    let mut limits = c.limits(rejected, visible, &suspects);
    limits.extend(few_pixels(&undecided, &evidence).filter(|_| !rejected && limits.is_empty()));
    if suspects.len() > MOST {
        suspects.clear();
    }
    let scale = suspects.iter().any(|s| s.name == "exposure") && suspects.len() == 1;
    let wrong = rejected && ready.display.known && !scale || !findings.is_empty();
    let verdict = match (wrong, limits.is_empty()) {
        (true, _) => Conclusion::Wrong,
        (_, false) => Conclusion::Undecided,
        _ => Conclusion::Correct,
    };
    let hints = if search { hints(&evidence, fit) } else { vec![] };
    Diagnosis {
        verdict,
        p: fit.p,
        worst: if search { worst(fit, &ready.regions) } else { String::new() },
        visible,
        limits,
        undecided,
        suspects: if ready.display.known { suspects } else { vec![] },
        hints,
        display: ready.display.clone(),
        relation,
        audits: ready.audits.clone(),
        contrast: ready.contrast,
        edges: ready.edges.iter().filter(|e| **e).count() as f64 / ready.edges.len().max(1) as f64,
        outliers: ready.outliers.clone(),
        samples,
        findings,
        families: families.iter().map(|f| f.row(&c)).collect(),
        candidates: tried.iter().map(row).collect(),
        evidence,
    }
}

fn row(t: &Tried) -> Candidate {
    Candidate { name: t.name.clone(), p: t.fit.p, misfit: t.fit.misfit, spp: t.spp, rejected: t.rejected }
}

/// Description of the most significant comparison.
fn worst(fit: &Fit, regions: &[Region]) -> String {
    let Some(g) = fit.worst() else { return String::new() };
    let (slot, channel) = (g.slot.in_words(), CHANNELS[g.channel]);
    let place = place(&regions[g.region].name);
    let errors = ((g.suspect - g.predicted) / g.std_error).abs();
    let errors = if errors.is_finite() { format!(", {errors:.0} standard errors") } else { String::new() };
    format!("{slot}{place}, {channel}: mean {:.4}, correct {:.4}{errors}", g.suspect, g.predicted)
}

/// Where a region lies, after the name of a picture.
fn place(region: &str) -> String {
    match region {
        "image" => String::new(),
        regions::LAMPS => " at the lamps".into(),
        "grazing" => " at grazing angles".into(),
        "beside lamps" => " beside the lamps".into(),
        name => match name.strip_prefix("region ").and_then(|n| n.split_once(',')) {
            Some((row, column)) => {
                let from_one = |n: &str| n.parse::<usize>().map_or(0, |n| n + 1);
                format!(" in row {}, column {} of {SIDE} × {SIDE}", from_one(row), from_one(column))
            }
            None => format!(" in {name}"),
        },
    }
}
