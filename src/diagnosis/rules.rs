//! The decision rules: an ordered list of functions, each from evidence to named suspicions (or none).
//!
//! | order | evidence | suspicion |
//! |---|---|---|
//! | 1 | values that are not finite | division by a density of 0 |
//! | 2 | correlation with the mirrored reference | a mirrored or inverted picture |
//! | 3 | scatter compared with the `_se` layers | repeated random numbers |
//! | 4 | mean against samples per pixel | encoding for display, accumulation |
//! | 5 | whole image against the sum of its terms | a nonlinear operation |
//! | 6 | r_k by [`pattern`](super::pattern) | numbering, truncation, connection, bounce, BSDF, roulette |
//! | 7 | r_k the same for all k, but not over the image | the density of light points |
//! | 8 | mirrors and glass against the rest of the image | the rule for counting emission |
//! | 9 | the brightest values | a clamp |
//! | 10 | the scene scaled by 10 against the original | densities in the wrong measure |
//!
//! A rule names a family of mistakes, the evidence for it, and the next experiment. If candidates can be simulated, the
//! simulation decides between the members of the family.

use super::evidence::Evidence;
use super::pattern::{Constant, Pattern, name_of};
use super::picture::Slot;
use super::regions::MIRRORS;
use super::series::BySamples;

/// Strength of the reason for a suspicion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// A simulation of the mistake cannot be distinguished from the suspect.
    Simulated,
    /// A rule for the ratios r_k describes every picture and region within its noise.
    Pattern,
    /// Single observations point to it.
    Points,
}

/// A possible cause.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Suspicion {
    /// Name of the cause; the name of a member of the zoo where there is one.
    pub name: String,
    /// Kind of reason.
    pub basis: Basis,
    /// Description of the evidence.
    pub why: String,
    /// Description of the next experiment.
    pub next: String,
    /// p-value of the explanation; NaN if it was not tested.
    pub p: f64,
    /// Mean squared deviation, in squared standard errors.
    pub misfit: f64,
    /// Pairs (k, r_k) that the explanation predicts; empty if it predicts none.
    pub curve: Vec<[f64; 2]>,
    /// The fitted constant, if it has no well-known value.
    pub fitted: Option<f64>,
}

/// The input of a rule.
pub struct Facts<'a> {
    /// Evidence about the suspect.
    pub evidence: &'a Evidence,
    /// Patterns that describe the suspect, with their constant, p-value and misfit.
    pub patterns: &'a [(Pattern, Option<Constant>, f64, f64)],
    /// Change of its mean with the samples per pixel.
    pub samples: Option<&'a BySamples>,
    /// Scale factor, and evidence from the same scene at that scale.
    pub scaled: Option<(f64, &'a Evidence)>,
    /// True if the suspect differs significantly from the reference.
    pub rejected: bool,
    /// True if the difference is still significant with errors from the scatter of neighbouring pixels instead of the `_se`
    /// layers.
    pub beyond_scatter: bool,
}

/// The rules in the order of the table above.
pub const RULES: [fn(&Facts) -> Vec<Suspicion>; 10] = [
    not_a_number,
    turned,
    same_numbers,
    changes_with_samples,
    no_sum_of_its_terms,
    patterns,
    varies_in_space,
    behind_mirrors,
    cut_at_the_top,
    changes_with_scale,
];

fn points(name: &str, why: String, next: &str) -> Vec<Suspicion> {
    let (why, next) = (why, next.to_owned());
    vec![Suspicion {
        name: name.into(),
        basis: Basis::Points,
        why,
        next,
        p: f64::NAN,
        misfit: f64::NAN,
        curve: vec![],
        fitted: None,
    }]
}

/// Describes several patterns with one fitted constant each. The data cannot decide between them.
pub(super) fn one_constant(fitted: &[Suspicion]) -> String {
    let each = fitted.iter().map(|s| format!("{} {:.4}", s.name, s.fitted.unwrap_or(f64::NAN)));
    let each = each.collect::<Vec<_>>().join(", or ");
    format!("a pattern with one fitted constant, which has no well-known value, fits as well: {each}")
}

fn not_a_number(f: &Facts) -> Vec<Suspicion> {
    let n = f.evidence.counts.non_finite;
    if n == 0 {
        return vec![];
    }
    points(
        "not-a-number",
        format!("{n} values are not finite: probably a value was divided by a density of 0 and added to the image"),
        "find such a pixel, and print the density of the first sample in it that is not finite",
    )
}

fn turned(f: &Facts) -> Vec<Suspicion> {
    let [here, mirrored, down] = f.evidence.likeness;
    let (other, how) = if mirrored > down { (mirrored, "mirrored left to right") } else { (down, "upside down") };
    if !(f.rejected && other > here + 0.05 && other > 0.8) {
        return vec![];
    }
    let why = format!(
        "it is more similar to the reference {how} (correlation {other:.3}) than to the reference itself ({here:.3})"
    );
    points("another-view", why, "flip the picture, or compare the cameras")
}

fn same_numbers(f: &Facts) -> Vec<Suspicion> {
    let v = f.evidence.noise;
    // a wrong spatial shape also increases the scatter, so that large scatter counts only if the means agree within it
    let repeats = v >= 2.5 && f.rejected && !f.beyond_scatter;
    if !(v < 0.4 || repeats) {
        return vec![];
    }
    let why = if v < 1.0 {
        format!(
            "the scatter of neighbouring pixels is {v:.2} of the variance in the _se layers: pixels share random numbers"
        )
    } else {
        format!("the scatter of neighbouring pixels is {v:.1} times the variance in the _se layers: samples repeat")
    };
    points("same-numbers", why, "render it with two seeds: if the difference is noise, its mean falls as 1/√samples")
}

fn changes_with_samples(f: &Facts) -> Vec<Suspicion> {
    let Some(s) = f.samples else { return vec![] };
    if s.p_constant < 1e-3 && s.largest_change > 5e-3 {
        let why = format!(
            "the mean changes with the samples per pixel, {} (p = {:.1e}): the mean of an unbiased estimator does not change",
            s.means.iter().map(|m| format!("{:.4} at {}", m[1], m[0])).collect::<Vec<_>>().join(", "),
            s.p_constant
        );
        return points(
            "gamma-before-mean",
            why,
            "average linear radiance, and apply gamma, tone map and clamp afterwards",
        );
    }
    if s.renewed < 0.3 && !f.rejected {
        let why = format!(
            "further samples replace {:.1} % of the error of the first ones; independent samples would replace nearly all of it",
            100.0 * s.renewed
        );
        return points("same-numbers", why, "give every sample its own random numbers");
    }
    vec![]
}

fn no_sum_of_its_terms(f: &Facts) -> Vec<Suspicion> {
    let Some([sum, half, right]) = f.evidence.sum else { return vec![] };
    let off = (sum / right - 1.0).abs();
    if off.is_nan() || off <= (2.5 * half).max(5e-3) {
        return vec![];
    }
    let why = format!("the whole image is {sum:.4} ± {half:.4} times the sum of its own layers; correct is {right:.4}");
    let name = if sum < right { "gamma-before-mean" } else { "emission-missing" };
    let next = "look for a nonlinear step (clamp, gamma, 8 bits), or for a term that the layers do not contain";
    points(name, why, next)
}

fn patterns(f: &Facts) -> Vec<Suspicion> {
    let curve = |pattern: Pattern, c: Option<Constant>| -> Vec<[f64; 2]> {
        let terms = f.evidence.ratios.iter().filter_map(|r| if let Slot::Term(k) = r.slot { Some(k) } else { None });
        let shifted = matches!(pattern, Pattern::Shift(_));
        let known = terms.filter(|_| !shifted);
        known.map(|k| [k as f64, pattern.factor(k, c.map_or(1.0, |c| c.value))]).collect()
    };
    let all = f.patterns.iter().map(|&(pattern, c, p, misfit)| (named(pattern, c, p, misfit), curve(pattern, c)));
    all.flat_map(|(list, curve)| list.into_iter().map(move |s| Suspicion { curve: curve.clone(), ..s })).collect()
}

/// Names of a pattern with its constant. There are several if the pattern fits several mistakes.
// long, because it is a table: one line for each pattern and constant
fn named(pattern: Pattern, c: Option<Constant>, p: f64, misfit: f64) -> Vec<Suspicion> {
    let value = c.map_or(1.0, |c| c.value);
    let number = c.map_or(String::new(), |c| {
        let known = name_of(c).map_or(String::new(), |n| format!(" = {n}"));
        format!("{:.4} ± {:.4}{known}", c.value, 1.96 * c.value * c.relative_error)
    });
    let known = c.and_then(name_of).unwrap_or("");
    let make = |name: &str, why: String, next: &str| Suspicion {
        name: name.into(),
        basis: Basis::Pattern,
        why,
        next: next.into(),
        p,
        misfit,
        curve: vec![],
        fitted: c.filter(|c| name_of(*c).is_none()).map(|c| c.value),
    };
    let apart = "render with next-event estimation only, and with BSDF sampling only, to see which of the two is wrong";
    match pattern {
        Pattern::Everything => {
            let why = format!("every term, including emission, is {number} times the correct one");
            vec![make("exposure", why, "compare the units of the emission and the exposure")]
        }
        Pattern::Connection => {
            let why = format!(
                "r_k = {number} for every k ≥ 1, everywhere: the mistake occurs once per path, in the connection to the light"
            );
            match known {
                "2" => vec![make("double-emission", why, apart)],
                "π" => vec![make("missing-pi-connection", why, apart)],
                _ if value < 1.0 && known.is_empty() => {
                    let why = format!("{why}; if it is roulette, paths survive with {value:.3}");
                    vec![make("roulette-before-light", why, "render it without roulette")]
                }
                _ => vec![make("constant-in-the-connection", why, apart)],
            }
        }
        Pattern::Bounce(0) => {
            let why =
                format!("r_k = c^k with c = {number}: one factor for every application of T, so the BSDF is wrong");
            let name = if known == "π" { "missing-pi" } else { "constant-in-the-bsdf" };
            vec![make(name, why, "render a furnace of albedo 1/2: the sum must be 2")]
        }
        Pattern::Bounce(from) => {
            let why = format!(
                "r_k = c^(k−{from}) for k ≥ {from} with c = {number}: direct light is correct, but every later bounce has a wrong factor"
            );
            match known {
                "1/2" => vec![
                    make("half-bounce", why.clone(), "render it without roulette"),
                    make(
                        "roulette-unweighted",
                        format!("{why}; if it is roulette, paths survive with 1/2 and get no weight"),
                        "render it without roulette",
                    ),
                ],
                "" | "1/4" | "1/3" if value < 1.0 => {
                    let why = format!("{why}; if it is roulette, paths survive with {value:.3} and get no weight");
                    vec![make("roulette-unweighted", why, "render it without roulette")]
                }
                _ if value > 1.0 => {
                    let s = 1.0 / value;
                    let why = format!("{why}; if it is roulette, paths survive with {s:.3} and get the weight twice");
                    vec![make("roulette-weighted-twice", why, "render it without roulette")]
                }
                _ => {
                    vec![make(
                        "constant-in-the-bounce",
                        why,
                        "divide by the density with which the direction was sampled",
                    )]
                }
            }
        }
        Pattern::Cut(n) => {
            let why = format!("T0 to T{n} are correct, and all longer terms are missing");
            vec![make("truncated", why, "increase the number of bounces: the sum must increase")]
        }
        Pattern::Shift(by) => {
            let why = if by > 0 { "slot k shows T^(k+1) E" } else { "slot k shows T^(k−1) E" };
            let next = "count applications of T: k = 0 is emission seen directly";
            vec![make("off-by-one", why.into(), next)]
        }
    }
}

fn varies_in_space(f: &Facts) -> Vec<Suspicion> {
    let Some(direct) = f.evidence.ratio(Slot::Term(1)) else { return vec![] };
    let off = (direct.value - 1.0).abs() > 2.0 * direct.half_width;
    if !(f.rejected && off && direct.flat < 1e-6) {
        return vec![];
    }
    let known: Vec<f64> = direct.regions.iter().copied().filter(|r| r.is_finite()).collect();
    let (lo, hi) = known.iter().fold((f64::INFINITY, 0.0f64), |a, &r| (a.0.min(r), a.1.max(r)));
    let why = format!(
        "direct light is wrong, and not by a constant factor: r_1 varies from {lo:.2} to {hi:.2} between regions"
    );
    points(
        "area-density",
        why,
        "scale the scene by 10: direct light from area lights must not change (--scale 10=FILE)",
    )
}

fn behind_mirrors(f: &Facts) -> Vec<Suspicion> {
    let Some(at) = f.evidence.regions.iter().position(|r| r == MIRRORS) else { return vec![] };
    let Some(r) = f.evidence.ratios.iter().find(|r| r.slot == Slot::Term(1)).or(f.evidence.ratio(Slot::Whole)) else {
        return vec![];
    };
    if !(f.rejected && r.regions[at] < 0.7 && (r.value > 0.9 || r.regions[at] == 0.0)) {
        return vec![];
    }
    let why = format!(
        "{} is {:.3} times the correct one in mirrors and glass, {:.3} times over the whole image",
        r.slot, r.regions[at], r.value
    );
    points(
        "no-emission-after-mirror",
        why,
        "count emission that a path hits after a mirror, because no connection can find it",
    )
}

fn cut_at_the_top(f: &Facts) -> Vec<Suspicion> {
    let e = f.evidence;
    let low = e.ratios.iter().all(|r| r.value < 1.0 + 2.0 * r.half_width || r.value.is_nan());
    if !(f.rejected && e.brightest < 0.8 && low && e.ratios.iter().any(|r| r.flat < 1e-3)) {
        return vec![];
    }
    let why = format!(
        "the brightest value is {:.3} times the correct one, and dimmer values are closer to correct",
        e.brightest
    );
    points("clamped", why, "remove the clamp: the noise and the mean will increase")
}

fn changes_with_scale(f: &Facts) -> Vec<Suspicion> {
    let Some((scale, other)) = f.scaled else { return vec![] };
    let moved = f.evidence.ratios.iter().find_map(|r| {
        let there = other.ratio(r.slot)?;
        let gap = (r.value - there.value).abs();
        (gap > 2.5 * r.half_width.hypot(there.half_width) && gap > 5e-3).then_some((r, there))
    });
    let Some((here, there)) = moved else { return vec![] };
    let why = format!(
        "{} is {:.4} ± {:.4} times the correct one, and {:.4} ± {:.4} times in the scene scaled by {scale}: lengths do not cancel as they must",
        here.slot, here.value, here.half_width, there.value, there.half_width
    );
    let name = if (here.value - 1.0).abs() < 0.05 { "mixed-measures" } else { "area-density" };
    points(name, why, "convert the density of a light point: p_ω = p_A r²/cos θ_y")
}
