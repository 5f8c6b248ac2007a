//! Observations about a wrong picture that name no cause, but tell where to look.
//!
//! | observation | sentence |
//! |---|---|
//! | r_k by term | the first term that differs, and by how much |
//! | the same in the three channels | the difference is in one channel only |
//! | r_1 over regions | direct light is wrong by a factor that varies |
//! | mirrors and glass | they differ more than the rest of the image |
//! | the scene scaled | lengths do not cancel; this is a finding |

use super::evidence::{Evidence, Ratio};
use super::explain::{Suspicion, correct_up_to, finding};
use super::gap::Fit;
use super::picture::Slot;
use super::regions::MIRRORS;
use crate::math::CHANNELS;

/// The observations in the order of the table.
pub fn hints(e: &Evidence, fit: &Fit) -> Vec<String> {
    let all = [first_difference(e), one_channel(fit), varies_in_space(e), behind_mirrors(e)];
    all.into_iter().flatten().collect()
}

/// Returns true if a ratio is certainly not 1 over the whole image, or not the same everywhere.
fn differs(r: &Ratio) -> bool {
    (r.value - 1.0).abs() > 2.0 * r.half_width.max(1e-4) || r.flat < 1e-6
}

/// The first term that differs, as an index into the terms of the picture.
pub fn first_wrong_term(e: &Evidence) -> Option<usize> {
    let mut terms = e.ratios.iter().filter(|r| matches!(r.slot, Slot::Term(_)) && !r.value.is_nan());
    terms.position(differs)
}

fn first_difference(e: &Evidence) -> Option<String> {
    let terms: Vec<&Ratio> = e.ratios.iter().filter(|r| matches!(r.slot, Slot::Term(_)) && !r.value.is_nan()).collect();
    let first = first_wrong_term(e)?;
    let r = terms[first];
    let right = match first {
        0 => String::new(),
        k => format!("{}; ", correct_up_to(k - 1)),
    };
    let how = if r.flat < 1e-6 { ", and not the same everywhere" } else { "" };
    Some(format!(
        "{right}{} is the first term that differs: {:.3} ± {:.3} times the correct one{how}",
        r.slot, r.value, r.half_width
    ))
}

/// The only channel with significant differences, if there is one.
fn one_channel(fit: &Fit) -> Option<String> {
    let worst = |c: usize| fit.gaps.iter().filter(|g| g.channel == c).map(|g| g.adjusted).fold(1.0, f64::min);
    let p = [0, 1, 2].map(worst);
    let wrong: Vec<usize> = (0..3).filter(|c| p[*c] < 1e-6).collect();
    let right = p.iter().filter(|p| **p > 0.05).count();
    (wrong.len() == 1 && right == 2).then(|| format!("only {} differs", CHANNELS[wrong[0]]))
}

fn varies_in_space(e: &Evidence) -> Option<String> {
    let direct = e.ratio(Slot::Term(1))?;
    let off = (direct.value - 1.0).abs() > 2.0 * direct.half_width;
    if !(off && direct.flat < 1e-6) {
        return None;
    }
    let known = direct.regions.iter().copied().filter(|r| r.is_finite());
    let (lo, hi) = known.fold((f64::INFINITY, 0.0f64), |a, r| (a.0.min(r), a.1.max(r)));
    Some(format!(
        "direct light is wrong by a factor that varies from {lo:.2} to {hi:.2} over the image; a render of the scene ten times larger \
         tells whether lengths cancel (--scale 10=FILE)"
    ))
}

fn behind_mirrors(e: &Evidence) -> Option<String> {
    let at = e.regions.iter().position(|r| r == MIRRORS)?;
    let r = e.ratio(Slot::Term(1)).or(e.ratio(Slot::Whole))?;
    let there = *r.regions.get(at)?;
    (there < 0.7 && (r.value > 0.9 || there == 0.0)).then(|| {
        format!(
            "{} is {there:.3} times the correct one in mirrors and glass, {:.3} times over the whole image",
            r.slot, r.value
        )
    })
}

/// The finding that a term changes with the scale of the scene, if one does.
pub(super) fn with_scale(e: &Evidence, (scale, other): (f64, &Evidence)) -> Option<Suspicion> {
    let moved = |r: &&Ratio| {
        let there = other.ratio(r.slot)?;
        let gap = (r.value - there.value).abs();
        (gap > 2.5 * r.half_width.hypot(there.half_width) && gap > 5e-3).then_some(there)
    };
    let (here, there) = e.ratios.iter().find_map(|r| Some((r, moved(&r)?)))?;
    let found = finding(
        "changes-with-scale",
        "it changes with the unit of length".into(),
        format!(
            "{} is {:.4} ± {:.4} times the correct one, and {:.4} ± {:.4} times in the scene scaled by {scale}: lengths do not cancel \
             as they must",
            here.slot, here.value, here.half_width, there.value, there.half_width
        ),
        "convert the density of a light point: p_ω = p_A r²/cos θ_y",
    );
    let member = if (here.value - 1.0).abs() < 0.05 { "mixed-measures" } else { "area-density" };
    Some(Suspicion { members: vec![member], ..found })
}
