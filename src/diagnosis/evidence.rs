//! Evidence about a suspect, collected by comparison with the reference before any cause is considered.
//!
//! ```text
//! r_k = mean S_k / mean T_k          constant over the image: Σ ((r_k,i − r_k)/s_i)² is as large as noise makes it
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | r_k | ratio of means, with its 95 % interval | [`Ratio`] |
//! | r_k,i | the same ratio in region i, with standard error s_i | [`Ratio::regions`] |
//! | – | non-finite values, black pixels, the brightest value | [`Counts`] |
//! | v/s² | variance of neighbouring pixels divided by the variance in the `_se` layer: 1 for independent pixels | [`Evidence::noise`] |

use super::gap::{difference, ratio};
use super::picture::{Layer, Pictures, Slot};
use super::regions::Region;
use crate::stats::{Measured, critical};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A ratio of means, over the image and in its regions.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// The picture it belongs to.
    pub slot: Slot,
    /// The ratio r; NaN if the reference is black.
    pub value: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
    /// p-value of the hypothesis that the ratio is the same in all regions; NaN with fewer than two regions.
    pub flat: f64,
    /// r in each region, in the order of [`Evidence::regions`]; NaN where the reference is black.
    pub regions: Vec<f64>,
    /// Image means of the suspect and of the reference.
    pub means: [f64; 2],
}

/// Counts of special values in the original pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Counts {
    /// Number of values that are not finite.
    pub non_finite: u64,
    /// Number of values below zero.
    pub negative: u64,
    /// Fraction of pixels that are black although the reference is not; the largest of all pictures.
    pub black: f64,
    /// Fraction of pixels of an 8-bit picture that have the value 255.
    pub clipped: f64,
}

/// The evidence about one suspect.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// r_k of every slot.
    pub ratios: Vec<Ratio>,
    /// Counts.
    pub counts: Counts,
    /// Three numbers: the whole image divided by the sum of its own terms and tail, the half width of its 95 % interval, and
    /// the same ratio of the reference (1 if there is a tail). None if a part is missing.
    pub sum: Option<[f64; 3]>,
    /// Largest value of the whole image divided by that of the reference.
    pub brightest: f64,
    /// Scatter of neighbouring pixels divided by the variance in the `_se` layers; NaN without these layers.
    pub noise: f64,
    /// Number of samples per pixel at which the reference would be as noisy as the suspect; NaN if not known.
    pub samples: f64,
    /// Source of the errors, in words.
    pub errors: &'static str,
    /// Names of the regions.
    pub regions: Vec<String>,
    /// Correlation with the reference itself, with its left-right mirror image, and with the reference upside down.
    pub likeness: [f64; 3],
}

impl Evidence {
    /// The ratio of a slot, if it was measured.
    pub fn ratio(&self, slot: Slot) -> Option<&Ratio> {
        self.ratios.iter().find(|r| r.slot == slot)
    }
}

/// Collects the evidence. `counts` come from the original pictures, before they are averaged down. `reference_spp` is NaN if
/// it is not known.
pub fn collect(
    suspect: &Pictures,
    reference: &Pictures,
    regions: &[Region],
    counts: Counts,
    reference_spp: f64,
) -> Evidence {
    let width = suspect.size[0];
    let one = |l: &Layer| -> Option<Ratio> {
        let right = reference.layer(l.slot)?;
        let of = |r: &Region| ratio(l, right, width, &r.pixels);
        let image = of(&regions[0]);
        let half = critical(0.05, image.dof) * image.std_error;
        let each: Vec<Measured> = regions.iter().map(of).collect();
        let mean = |l: &Layer| l.mean.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / (3 * l.mean.len()) as f64;
        Some(Ratio {
            slot: l.slot,
            value: image.mean,
            half_width: half,
            flat: flat(&each[1..]),
            regions: each.iter().map(|m| m.mean).collect(),
            means: [mean(l), mean(right)],
        })
    };
    let known = suspect.layers.iter().all(|l| l.std_error.is_some());
    Evidence {
        ratios: suspect.layers.iter().filter_map(one).collect(),
        counts,
        sum: sum(suspect, reference, &regions[0]),
        brightest: brightest(suspect, reference),
        noise: noise(suspect, reference, &regions[0]),
        samples: reference_spp * samples(suspect, reference, &regions[0]),
        errors: if known { "the _se layers" } else { "the difference of neighbouring pixels from the reference" },
        regions: regions.iter().map(|r| r.name.clone()).collect(),
        likeness: likeness(suspect, reference),
    }
}

/// p-value of the hypothesis that all regions have the same ratio.
pub fn flat(regions: &[Measured]) -> f64 {
    // differences below a tenth of a percent count as rounding
    let known: Vec<(f64, f64)> = regions
        .iter()
        .filter(|m| m.mean.is_finite() && m.std_error.is_finite())
        .map(|m| (m.mean, m.std_error.hypot(1e-3 * m.mean.abs()).powi(2).max(1e-12)))
        .collect();
    if known.len() < 2 {
        return f64::NAN;
    }
    let (weights, sum) = known.iter().fold((0.0, 0.0), |a, (r, v)| (a.0 + 1.0 / v, a.1 + r / v));
    let mean = sum / weights;
    let chi2: f64 = known.iter().map(|(r, v)| (r - mean).powi(2) / v).sum();
    ChiSquared::new((known.len() - 1) as f64).map_or(f64::NAN, |d| d.sf(chi2))
}

/// The whole divided by the sum of the terms and the tail, with its error, and the same ratio of the reference.
fn sum(suspect: &Pictures, reference: &Pictures, image: &Region) -> Option<[f64; 3]> {
    suspect.last_term()?;
    let slots: Vec<Slot> = suspect.layers.iter().map(|l| l.slot).filter(|s| *s != Slot::Whole).collect();
    let of = |pictures: &Pictures| {
        let whole = pictures.layer(Slot::Whole)?;
        let parts = slots.iter().map(|s| pictures.layer(*s)).collect::<Option<Vec<&Layer>>>()?;
        let add = |pixel: &dyn Fn(&Layer) -> Option<[f32; 3]>| -> [f32; 3] {
            parts.iter().filter_map(|l| pixel(l)).fold([0.0; 3], |a, v| std::array::from_fn(|c| a[c] + v[c]))
        };
        let mean = (0..whole.mean.len()).map(|p| add(&|l| Some(l.mean[p]))).collect();
        let errors = whole.std_error.is_some() && parts.iter().all(|l| l.std_error.is_some());
        let std_error =
            errors.then(|| (0..whole.mean.len()).map(|p| add(&|l| l.std_error.as_ref().map(|s| s[p]))).collect());
        let total = Layer { slot: Slot::Whole, mean, std_error };
        Some(ratio(whole, &total, pictures.size[0], &image.pixels))
    };
    let (own, right) = (of(suspect)?, of(reference)?);
    Some([own.mean, critical(0.05, own.dof) * own.std_error.hypot(right.std_error), right.mean])
}

fn brightest(suspect: &Pictures, reference: &Pictures) -> f64 {
    let top = |p: &Pictures| -> f64 {
        let layer = p.layer(Slot::Whole).or(p.layers.first());
        layer.map_or(f64::NAN, |l| l.mean.iter().flatten().map(|&v| f64::from(v)).fold(0.0, f64::max))
    };
    top(suspect) / top(reference)
}

/// Scatter of S − r T inside blocks, divided by the variance from the errors of both. Measured in the term k ≥ 1 with the
/// largest claimed variance.
fn noise(suspect: &Pictures, reference: &Pictures, image: &Region) -> f64 {
    let one = |l: &Layer| {
        let right = reference.layer(l.slot)?;
        let r = ratio(l, right, suspect.size[0], &image.pixels).mean;
        if l.std_error.is_none() || right.std_error.is_none() || !r.is_finite() {
            return None;
        }
        let v = |known| difference((l, right, r), suspect.size[0], &image.pixels, 1, known).0.std_error.powi(2);
        let (claimed, found) = (v(true), v(false));
        (claimed > 0.0).then_some((claimed, found / claimed))
    };
    let all = suspect.layers.iter().filter(|l| matches!(l.slot, Slot::Term(k) if k > 0)).filter_map(one);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(f64::NAN, |a| a.1)
}

/// Samples of the suspect divided by those of the reference, estimated from their noise. Uses the term k ≥ 1 whose reference
/// is noisiest, or else the whole image.
fn samples(suspect: &Pictures, reference: &Pictures, image: &Region) -> f64 {
    let one = |l: &Layer| {
        let right = reference.layer(l.slot)?;
        right.std_error.as_ref()?;
        let width = suspect.size[0];
        let r = ratio(l, right, width, &image.pixels).mean;
        let found = difference((l, right, r), width, &image.pixels, 1, false).0.std_error.powi(2);
        let nothing = Layer { std_error: Some(vec![[0.0; 3]; right.mean.len()]), ..right.clone() };
        let own = difference((&nothing, right, r), width, &image.pixels, 1, true).0.std_error.powi(2);
        (own > 0.0 && found > own).then(|| (own, own / (found - own)))
    };
    let reflected = suspect.layers.iter().filter(|l| matches!(l.slot, Slot::Term(k) if k > 0)).filter_map(one);
    let best = reflected.max_by(|a, b| a.0.total_cmp(&b.0));
    best.or_else(|| one(suspect.layer(Slot::Whole)?)).map_or(f64::NAN, |a| a.1)
}

/// Correlation of log luminance with the reference itself, with the reference mirrored left to right, and with the reference
/// upside down.
fn likeness(suspect: &Pictures, reference: &Pictures) -> [f64; 3] {
    let layer = suspect.layers.iter().rev().find(|l| reference.layer(l.slot).is_some());
    let Some((a, b)) = layer.and_then(|l| Some((l, reference.layer(l.slot)?))) else { return [f64::NAN; 3] };
    let [w, h] = suspect.size;
    let floor = 1e-3 * b.mean.iter().flatten().map(|&v| f64::from(v)).sum::<f64>() / (3 * b.mean.len()) as f64;
    let log = |v: [f32; 3]| (f64::from(v.iter().sum::<f32>()).max(0.0) + floor).ln();
    let at = |turn: usize, p: usize| match turn {
        0 => p,
        1 => p / w * w + (w - 1 - p % w),
        _ => (h - 1 - p / w) * w + p % w,
    };
    std::array::from_fn(|turn| {
        let pairs: Vec<(f64, f64)> = (0..w * h)
            .map(|p| (log(a.mean[at(turn, p)]), log(b.mean[p])))
            .filter(|(x, y)| x.is_finite() && y.is_finite())
            .collect();
        let n = pairs.len() as f64;
        let (mx, my) = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in pairs {
            xy += (x - mx) * (y - my);
            xx += (x - mx).powi(2);
            yy += (y - my).powi(2);
        }
        xy / (xx * yy).sqrt()
    })
}

/// Counts special values in the original pictures. The reference shows where black pixels are wrong.
pub fn count(suspect: &Pictures, reference: &Pictures, clipped: f64) -> Counts {
    let all = || suspect.layers.iter().flat_map(|l| l.mean.iter().flatten());
    let black = |l: &Layer| {
        let right = reference.layer(l.slot)?;
        if right.mean.len() != l.mean.len() {
            return None;
        }
        let wrong = l.mean.iter().zip(&right.mean).filter(|(s, t)| **s == [0.0; 3] && t.iter().any(|v| *v > 0.0));
        Some(wrong.count() as f64 / l.mean.len() as f64)
    };
    Counts {
        non_finite: all().filter(|v| !v.is_finite()).count() as u64,
        negative: all().filter(|v| **v < 0.0).count() as u64,
        black: suspect.layers.iter().filter_map(black).fold(0.0, f64::max),
        clipped,
    }
}
