//! What a diagnosis cannot tell, and why.
//!
//! | limit | reason |
//! |---|---|
//! | [`limits`] | an unknown curve, clipped pixels, too few noisy pixels, an outlier, many explanations, a factor on all light |
//! | [`visible`] | the smallest uniform bias that would have been found with probability 0.99 |
//! | [`undecided`] | pictures that are off by more than that, but not significantly |

use super::compared::Compared;
use super::evidence::Evidence;
use super::explain::Suspicion;
use super::gap::{Fit, difference};
use super::picture::{Layer, Slot};
use super::regions::Region;
use super::{Limit, MOST};
use crate::stats::evidence::JUDGED_PIXELS;
use crate::stats::min_detectable;

/// A picture is undecided if more than this share of it is clipped and nothing is found in the rest.
const HIDDEN: f64 = 0.3;

/// A picture is undecided if a bias of this size could hide in it.
const VAGUE: f64 = 0.5;
/// A fitted exposure must have a smaller relative error.
const UNKNOWN: f64 = 0.2;

impl Compared<'_> {
    /// Reasons why nothing, or not everything, can be told.
    pub(super) fn limits(&self, rejected: bool, visible: f64, suspects: &[Suspicion]) -> Vec<Limit> {
        let (ready, mut limits) = (self.ready, vec![]);
        let percent = |x: f64| format!("{:.0} %", 100.0 * x);
        let mut add = |why: String, next: &str| limits.push(Limit { why, next: next.into() });
        if !ready.display.known {
            let why = "no known tone curve fits its brightness, and a mistake could hide in an unknown one";
            add(why.into(), "send linear radiance as EXR");
        }
        if !rejected && ready.display.hidden > HIDDEN {
            let share = percent(ready.display.hidden);
            add(
                format!("{share} of its pixels are clipped, or beside such pixels"),
                "send an EXR, or a darker picture",
            );
        } else if !rejected && visible.is_infinite() {
            add("too few pixels carry its noise".into(), "render it with more samples per pixel");
        }
        if !rejected && visible.is_finite() && visible > VAGUE {
            let share = percent(visible);
            add(format!("its noise would hide a bias of {share}"), "render it with more samples per pixel");
        }
        if !rejected && ready.display.fitted && ready.display.half_width > UNKNOWN * ready.display.exposure {
            add("its noise is too large to find its exposure".into(), "render it with more samples per pixel");
        }
        if let Some(o) = ready.outliers.first() {
            let image = o.slot.in_words();
            let why = format!(
                "the pixel in column {}, row {} is {:.0} times as bright as it should be and holds {} of the light of {image}",
                o.pixel[0],
                o.pixel[1],
                o.times,
                percent(o.share)
            );
            add(why, "render it with another seed, to see whether it is a rare sample or a mistake");
        }
        if rejected && suspects.len() > MOST {
            let why = format!("{} explanations fit its difference from the correct picture", suspects.len());
            add(why, "send the terms as layers, or more samples per pixel");
        }
        if let [only] = suspects
            && only.name == "exposure"
        {
            let c = only.constants[0].value;
            let why = format!("{}: that is its exposure, or a mistake in the scale of all light", only.what);
            add(why, &format!("if it is the exposure, repeat with --gain {c:.4}; if not, {}", only.next));
        }
        limits
    }

    /// The smallest uniform relative bias that the means of a region would have shown with probability 0.99.
    pub(super) fn visible(&self, image: &Region, comparisons: usize) -> f64 {
        let suspect = &self.ready.pictures;
        let one = |l: &Layer| {
            let right = self.ready.reference.layer(l.slot)?;
            let n = image.pixels.len() as f64;
            let channel = |c: usize| {
                let (m, carried) = difference((l, right, 1.0), suspect.size[0], &image.pixels, c, true);
                if carried < JUDGED_PIXELS {
                    return f64::NAN;
                }
                let mean = image.pixels.iter().map(|&p| f64::from(right.mean[p][c])).sum::<f64>() / n;
                min_detectable(m.std_error, m.dof, self.case.alpha / comparisons.max(1) as f64, 0.01) / mean
            };
            Some((0..3).map(channel).filter(|v| v.is_finite()).fold(f64::INFINITY, f64::min))
        };
        let best = suspect.layers.iter().filter(|l| l.slot != Slot::Term(0)).filter_map(one);
        best.fold(f64::INFINITY, f64::min).max(suspect.code.rounding())
    }
}

/// The pictures that are off by more than a visible bias without a significant result. Either too few pixels carry their
/// noise, or the p-value of this comparison alone is below 5 % but not small enough among so many comparisons.
pub(super) fn undecided(fit: &Fit, evidence: &Evidence, visible: f64) -> Vec<Slot> {
    let of = |slot: Slot| fit.gaps.iter().filter(move |g| g.region == 0 && g.slot == slot);
    let doubtful = |slot: Slot| of(slot).all(|g| g.few) || of(slot).any(|g| g.p < 0.05);
    // differences below a twentieth are not reported
    let least = if visible.is_finite() { visible.max(0.05) } else { 0.05 };
    let off = evidence.ratios.iter().filter(|r| r.slot != Slot::Tail && (r.value - 1.0).abs() > least);
    off.map(|r| r.slot).filter(|slot| doubtful(*slot)).collect()
}

/// The limit that some pictures are off, but not significantly.
pub(super) fn few_pixels(undecided: &[Slot], evidence: &Evidence) -> Option<Limit> {
    let of = |slot: &Slot| {
        let ratio = evidence.ratio(*slot).map_or(f64::NAN, |r| r.value);
        let name = slot.in_words();
        format!("{name} is {ratio:.3} times the correct one")
    };
    let all: Vec<String> = undecided.iter().map(of).collect();
    (!all.is_empty()).then(|| Limit {
        why: format!("{}, and its noise is too large for a decision", all.join(", ")),
        next: "render it with more samples per pixel".into(),
    })
}
