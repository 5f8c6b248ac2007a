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
    /// Fraction of pixels that are left out because they or their neighbours are clipped.
    pub clipped: f64,
    /// The level at which finished pixels seem to be clamped.
    pub plateau: Option<f64>,
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
    /// Number of samples per pixel at which the reference would be as noisy as the suspect; NaN if not known.
    pub samples: f64,
    /// Source of the errors, in words.
    pub errors: &'static str,
    /// Names of the regions.
    pub regions: Vec<String>,
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
        samples: reference_spp * samples(suspect, reference, &regions[0]),
        errors: if known { "the _se layers" } else { "the scatter of neighbouring pixels" },
        regions: regions.iter().map(|r| r.name.clone()).collect(),
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

/// Counts special values: in the stored pictures, and black pixels in the pictures of the size of the reference.
pub fn count(stored: &Pictures, small: &Pictures, reference: &Pictures) -> Counts {
    let all = || stored.layers.iter().flat_map(|l| l.mean.iter().flatten());
    let black = |l: &Layer| {
        let right = reference.layer(l.slot)?;
        let wrong = l.mean.iter().zip(&right.mean).filter(|(s, t)| **s == [0.0; 3] && t.iter().any(|v| *v > 0.0));
        Some(wrong.count() as f64 / l.mean.len() as f64)
    };
    Counts {
        non_finite: all().filter(|v| !v.is_finite()).count() as u64,
        negative: all().filter(|v| **v < 0.0).count() as u64,
        black: small.layers.iter().filter_map(black).fold(0.0, f64::max),
        clipped: 0.0,
        plateau: None,
    }
}
