//! The decision procedure as data: an ordered list of small rules, each from evidence to a named suspicion or to nothing.
//!
//! | order | looks at | names |
//! |---|---|---|
//! | 1 | values that are no numbers | division by a density of 0 |
//! | 2 | likeness with the mirrored reference | a picture that is turned |
//! | 3 | scatter against the `_se` layers | the same random numbers |
//! | 4 | the mean against samples per pixel | display, accumulator |
//! | 5 | the whole against the sum of its terms | something that is not linear |
//! | 6 | r_k by [`pattern`](super::pattern) | numbering, truncation, connection, bounce, BSDF, roulette |
//! | 7 | r_k flat in k, not in space | the density of light points |
//! | 8 | mirrors and glass against the rest | the emission rule |
//! | 9 | brightest values | a clamp |
//! | 10 | scale × 10 against scale × 1 | measures |
//!
//! A rule names a family, with its evidence and the next experiment. Where candidates can be simulated, they decide
//! between its members.

use super::evidence::Evidence;
use super::pattern::{Constant, Pattern, name_of};
use super::picture::Slot;
use super::regions::MIRRORS;
use super::series::BySamples;

/// How much a suspicion rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// A simulation of it cannot be told from the suspect.
    Simulated,
    /// A rule for the ratios r_k describes every picture and region within its noise.
    Pattern,
    /// Single pieces of evidence point to it.
    Points,
}

/// A named suspect.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Suspicion {
    /// The name, as in the zoo where it has a member.
    pub name: String,
    /// What it rests on.
    pub basis: Basis,
    /// What was seen, in words.
    pub why: String,
    /// What would decide.
    pub next: String,
    /// p-value of the explanation; NaN where there is no test.
    pub p: f64,
    /// Mean squared deviation in standard errors.
    pub misfit: f64,
    /// k and the r_k that it predicts, where it predicts any.
    pub curve: Vec<[f64; 2]>,
    /// A number that was fitted and is no known one.
    pub fitted: Option<f64>,
}

/// What a rule may look at.
pub struct Facts<'a> {
    /// Evidence of the suspect.
    pub evidence: &'a Evidence,
    /// Patterns that describe it, with their constants.
    pub patterns: &'a [(Pattern, Option<Constant>, f64, f64)],
    /// How its mean changes with the samples per pixel.
    pub samples: Option<&'a BySamples>,
    /// Evidence of the same scene at another scale, with the scale.
    pub scaled: Option<(f64, &'a Evidence)>,
    /// Whether it is certain that something is wrong.
    pub rejected: bool,
    /// Whether that is still so if errors are those that neighbouring pixels show, and not those that are claimed.
    pub beyond_scatter: bool,
}

/// The rules in their order.
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

/// Several rules with a free number each, in words: where the number belongs the data does not say.
pub(super) fn one_constant(fitted: &[Suspicion]) -> String {
    let each = fitted.iter().map(|s| format!("{} {:.4}", s.name, s.fitted.unwrap_or(f64::NAN)));
    let each = each.collect::<Vec<_>>().join(", or ");
    format!("one number that is no known one fits as well, but it was free to fit: {each}")
}

fn not_a_number(f: &Facts) -> Vec<Suspicion> {
    let n = f.evidence.counts.non_finite;
    if n == 0 {
        return vec![];
    }
    points(
        "not-a-number",
        format!("{n} values are not finite: somewhere a density of 0 was divided by, and the sum kept it"),
        "find the pixel, and print the density of the sample that first gives no number",
    )
}

fn turned(f: &Facts) -> Vec<Suspicion> {
    let [here, mirrored, down] = f.evidence.likeness;
    let (other, how) = if mirrored > down { (mirrored, "mirrored left to right") } else { (down, "upside down") };
    if !(f.rejected && other > here + 0.05 && other > 0.8) {
        return vec![];
    }
    let why = format!("it is more like the reference {how} (correlation {other:.3}) than as it stands ({here:.3})");
    points("another-view", why, "turn the picture, or compare the cameras")
}

fn same_numbers(f: &Facts) -> Vec<Suspicion> {
    let v = f.evidence.noise;
    // a wrong shape scatters, too: too much of it counts only where the means agree but for the errors that are claimed
    let repeats = v >= 2.5 && f.rejected && !f.beyond_scatter;
    if !(v < 0.4 || repeats) {
        return vec![];
    }
    let why = if v < 1.0 {
        format!(
            "neighbouring pixels scatter with {v:.2} of the variance that their errors claim: they share random numbers"
        )
    } else {
        format!("neighbouring pixels scatter with {v:.1} times the variance that their errors claim: samples repeat")
    };
    points("same-numbers", why, "render it with two seeds: the mean of the difference must fall as 1/√samples")
}

fn changes_with_samples(f: &Facts) -> Vec<Suspicion> {
    let Some(s) = f.samples else { return vec![] };
    if s.p_constant < 1e-3 && s.largest_change > 5e-3 {
        let why = format!(
            "the mean changes with the samples per pixel, {} (p = {:.1e}): no estimator of a mean does that",
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
            "further samples replace {:.1} % of the error that the first ones leave, where new ones would replace nearly all",
            100.0 * s.renewed
        );
        return points("same-numbers", why, "give every sample numbers of its own");
    }
    vec![]
}

fn no_sum_of_its_terms(f: &Facts) -> Vec<Suspicion> {
    let Some([sum, half, right]) = f.evidence.sum else { return vec![] };
    let off = (sum / right - 1.0).abs();
    if off.is_nan() || off <= (2.5 * half).max(5e-3) {
        return vec![];
    }
    let why =
        format!("the whole image is {sum:.4} ± {half:.4} of the sum of its own layers, where {right:.4} is right");
    let name = if sum < right { "gamma-before-mean" } else { "emission-missing" };
    let next = "look for what is not linear (clamp, gamma, 8 bits), or for a term that the layers leave out";
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

/// What a pattern with its constant is called; several where it does not tell.
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
    let apart = "render it with connections only, and with hits only: which of the two is wrong?";
    match pattern {
        Pattern::Everything => {
            let why = format!("every term, emission too, is {number} times the right one");
            vec![make("exposure", why, "compare the units of the lamp and the gain of the display")]
        }
        Pattern::Connection => {
            let why = format!(
                "r_k = {number} for every k ≥ 1, everywhere: what is wrong happens once per path, where light is found"
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
                "r_k = c^(k−{from}) for k ≥ {from} with c = {number}: direct light is right, every bounce is not"
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
                    vec![make("constant-in-the-bounce", why, "divide by the density that the direction was drawn with")]
                }
            }
        }
        Pattern::Cut(n) => {
            let why = format!("T0 to T{n} are right, and nothing longer is there");
            vec![make("truncated", why, "raise its number of bounces: the sum must rise")]
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
    let why =
        format!("direct light itself is wrong, and not by a constant: r_1 = {lo:.2} to {hi:.2} from region to region");
    points("area-density", why, "scale the scene by 10: light of surfaces must not change (--scale 10=FILE)")
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
        "{} is {:.3} of the right one in mirrors and glass, {:.3} over the image",
        r.slot, r.regions[at], r.value
    );
    points("no-emission-after-mirror", why, "count emission that is hit after a mirror: no connection can find it")
}

fn cut_at_the_top(f: &Facts) -> Vec<Suspicion> {
    let e = f.evidence;
    let low = e.ratios.iter().all(|r| r.value < 1.0 + 2.0 * r.half_width || r.value.is_nan());
    if !(f.rejected && e.brightest < 0.8 && low && e.ratios.iter().any(|r| r.flat < 1e-3)) {
        return vec![];
    }
    let why = format!("the brightest value is {:.3} of the right one, and what is dimmer is nearer to it", e.brightest);
    points("clamped", why, "remove the clamp: noise will rise, and the mean with it")
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
        "{} is {:.4} ± {:.4} of the right one, and {:.4} ± {:.4} in the scene scaled by {scale}: lengths enter where they must cancel",
        here.slot, here.value, here.half_width, there.value, there.half_width
    );
    let name = if (here.value - 1.0).abs() < 0.05 { "mixed-measures" } else { "area-density" };
    points(name, why, "convert the density of a light point: p_ω = p_A r²/cos θ_y")
}
