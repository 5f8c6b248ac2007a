//! How a combination is compared with the reference of its scene, scalar by scalar.
//!
//! ```text
//! effect = mean − reference        half = t* √(s² + s_ref²)        t* at the level of the account, Welch's degrees of freedom
//! ```
//!
//! | verdict | when |
//! |---|---|
//! | equivalent | \|effect\| + half ≤ δ, and both sides are judged |
//! | consistent | \|effect\| ≤ half, and both sides are judged |
//! | not above | effect ≤ half, and only the upper side is judged |
//! | differs | anything else |
//!
//! δ is 5 % of the term in the image plus 0.1 % of the image.
//!
//! **Which sides.** Samples are never negative. Where bright ones are rare, a mean is too low with too small an error, and the lower
//! side of a t-test means nothing; too high it cannot seem, since one bright sample raises the error as much as the mean. So
//! the upper side, which is where anything counted twice shows, is always judged. The lower side is judged where
//!
//! 1. no path is hidden that this combination finds by luck only ([`Case::steady`]), and it finds all paths
//!    ([`unsampled`](fredholm::engine::known::unsampled::unsampled)); and
//! 2. an independent pilot run of the same size found 2 t* s ≤ the term, both as it and as the reference have it. Of equal rare
//!    events that asks for (2t*)² ≈ 350, whose Poisson tail at t* is about as thin as the level. A pilot run that found nothing
//!    at all says that a walk without connections had no luck, and of any other that something is wrong: that is judged.
//!
//! Neither looks at the run that is judged. Projections have no sign, so they are judged from both sides or not at all.

use super::array::Combination;
use super::measure::{K, Measurement};
use super::scenes::Case;
use fredholm::engine::by_rays::Estimator;
use fredholm::estimator::Technique;
use fredholm::stats::{Measured, critical, difference, hypothesis::ROUNDING};
use fredholm::terms::{Estimate, Functional};

/// δ as a share of the term, and of the image.
const OF_TERM: f64 = 0.05;
const OF_IMAGE: f64 = 1e-3;
/// A part of the image that cannot be missed in it.
const SLIGHT: f64 = 5e-3;

/// The slots of a functional: k = 0..=K, the tail, and `None` for the whole.
fn quantities(f: &Functional) -> Vec<(Option<usize>, Estimate)> {
    let slots = f.terms.iter().chain([&f.tail]).enumerate().map(|(k, e)| (Some(k), *e));
    let slots: Vec<_> = if f.terms.is_empty() { vec![] } else { slots.collect() };
    slots.into_iter().chain([(None, f.total)]).collect()
}

/// What the comparison of one combination in one scene found, in numbers of scalars.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    pub equivalent: u32,
    pub consistent: u32,
    /// Of only the upper side: by luck only, too noisy in the pilot run, or not supported.
    pub rare_paths: u32,
    pub noisy: u32,
    pub unsampled: u32,
    /// Image means from k = 1 on: judged from both sides, and proved.
    pub image: (u32, u32, u32),
    /// Least and largest effect in standard errors, of what was judged from both sides; and largest of all.
    pub z: (f64, f64),
    pub highest: f64,
    /// What differs from both sides by more than five standard errors, but not by t*.
    pub extreme: Vec<String>,
    /// What differs.
    pub wrong: Vec<String>,
}

impl Findings {
    pub fn scalars(&self) -> u32 {
        self.equivalent + self.consistent + self.rare_paths + self.noisy + self.unsampled
    }
    pub fn both_sides(&self) -> u32 {
        self.equivalent + self.consistent
    }
    /// In one word: by the image means from k = 1 on.
    pub fn verdict(&self) -> &'static str {
        let (all, judged, proved) = self.image;
        match () {
            () if self.scalars() == 0 => "–",
            () if !self.wrong.is_empty() => "DIFFERS",
            () if self.unsampled > 0 => "not supported",
            () if proved == all => "agrees",
            () if judged > 0 => "consistent",
            () => "too noisy",
        }
    }
}

/// What the combination sees of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Sees {
    /// All paths.
    pub all: bool,
    /// Mirrors or glass, behind which no connection finds anything.
    pub delta: bool,
}

/// Compares.
pub fn compare(
    case: &Case,
    c: &Combination,
    (run, pilot, reference): (&Measurement, &Measurement, &Measurement),
    sees: Sees,
    level: f64,
) -> Findings {
    let mut found =
        Findings { z: (f64::INFINITY, f64::NEG_INFINITY), highest: f64::NEG_INFINITY, ..Findings::default() };
    if run.non_finite > 0 {
        found.wrong.push(format!("{} samples are not finite", run.non_finite));
    }
    let image = quantities(&reference.functionals[0]);
    let whole = reference.functionals[0].total.mean;
    let supported = sees.all;
    let from_light = matches!(c.estimator, Some(Estimator::Light | Estimator::Bidirectional));
    let seeks = !sees.delta && (c.technique != Technique::Scatter || from_light);
    let expect: &[f64] = case.description.expect.as_ref().map_or(&[], |e| &e.terms);
    for ((f, p), r) in run.functionals.iter().zip(&pilot.functionals).zip(&reference.functionals) {
        let truth = quantities(r);
        // the whole is heard only if each of its parts is that has a part in it
        let mut parts = [true; 3];
        for ((slot, e), (_, trial)) in quantities(f).into_iter().zip(quantities(p)) {
            let at = truth.iter().position(|(s, _)| *s == slot).unwrap();
            let exact = slot.filter(|_| f.name == "image").filter(|&k| k <= K).and_then(|k| expect.get(k));
            // a projection has the size of what it moves about
            let size = if f.name.starts_with("projection") { image[at].1.mean } else { truth[at].1.mean };
            let signed = f.name.starts_with("projection");
            let loud = |mean: f64| if signed { f64::INFINITY } else { mean };
            let steady = case.steady(c, slot);
            for channel in 0..3 {
                let known = match exact {
                    Some(&x) => Measured::exact(x),
                    None => Measured::of(&truth[at].1, channel),
                };
                let d = difference(Measured::of(&e, channel), known);
                let t = if d.std_error == 0.0 { 0.0 } else { critical(level, d.dof) };
                let (half, rounding) = (t * d.std_error, ROUNDING * whole[channel]);
                let z = if d.mean.abs() <= rounding { 0.0 } else { d.mean / d.std_error };
                let pilot = Measured::of(&trial, channel);
                let reach = 2.0 * critical(level, pilot.dof) * pilot.std_error;
                let dark = pilot.mean == 0.0 && pilot.std_error == 0.0;
                let empty = seeks && slot != Some(0) || size[channel] == 0.0;
                let fits = if dark { empty } else { reach <= size[channel].min(loud(pilot.mean)) };
                parts[channel] &= fits || size[channel] <= SLIGHT * whole[channel];
                let heard = fits && (slot.is_some() || parts[channel]);
                let delta = OF_TERM * image[at].1.mean[channel] + OF_IMAGE * whole[channel];
                let (above, below) = (d.mean > half + rounding, -d.mean > half + rounding);
                let both = supported && steady && heard;
                let is_image = f.name == "image" && slot != Some(0);
                found.image.0 += u32::from(is_image);
                found.highest = found.highest.max(if signed && !both { 0.0 } else { z });
                match () {
                    () if !supported => found.unsampled += 1,
                    () if !steady => found.rare_paths += 1,
                    () if !heard => found.noisy += 1,
                    () => {
                        let proved = d.mean.abs() + half <= delta;
                        *(if proved { &mut found.equivalent } else { &mut found.consistent }) += 1;
                        found.image.1 += u32::from(is_image);
                        found.image.2 += u32::from(is_image && proved);
                        found.z = (found.z.0.min(z), found.z.1.max(z));
                    }
                }
                let wrong = if both { above || below } else { above && !signed };
                if !d.mean.is_finite() || wrong || both && z.abs() > 5.0 {
                    let slot = slot.map_or("whole".into(), |k| if k > K { "tail".into() } else { format!("T{k}") });
                    let colour = ["red", "green", "blue"][channel];
                    let differs = !d.mean.is_finite() || wrong;
                    (if differs { &mut found.wrong } else { &mut found.extreme }).push(format!(
                        "{}, {c}, {slot}, {}, {colour}: {:.5e} ± {:.1e}, reference {:.5e} ± {:.1e}, z = {z:.1}",
                        case.name, f.name, e.mean[channel], e.std_error[channel], known.mean, known.std_error
                    ));
                }
            }
        }
    }
    found
}
