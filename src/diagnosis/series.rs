//! One render with growing numbers of samples: does its mean stay constant, and does its error fall?
//!
//! ```text
//! mean(n) is constant           mean over pixels of (S_n − T)² = v n^b + …,   b = −1 for independent samples
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | n | samples per pixel | [`BySamples::means`] |
//! | b | slope of log squared error against log n, by least squares | [`BySamples::slope`] |
//! | – | fraction of the first error that further samples have replaced | [`BySamples::renewed`] |
//! | p | p-value of the hypothesis that the mean is constant | [`BySamples::p_constant`] |

use super::Case;
use super::curve::Curve;
use super::explain::{Suspicion, finding};
use super::gap::ratio;
use super::picture::{Layer, Pictures, Slot};
use super::prepare::Ready;
use super::regions::Region;
use crate::stats::{Measured, difference, holm, two_sided_p};
use serde::Serialize;

/// Changes of a render as its number of samples grows.
#[derive(Clone, Debug, Serialize)]
pub struct BySamples {
    /// n, and the mean divided by the mean of the reference.
    pub means: Vec<[f64; 2]>,
    /// Smallest p-value of the hypothesis that the means at n and at the largest n are equal, adjusted for the number of
    /// tests.
    pub p_constant: f64,
    /// Largest relative change of the mean.
    pub largest_change: f64,
    /// The slope b; NaN with fewer than two values of n. The noise of the reference is subtracted.
    pub slope: f64,
    /// Mean of (S_first − S_last)² divided by the squared error of S_first. It is about 1 if later samples are independent
    /// of the first ones, and 0 if they repeat them.
    pub renewed: f64,
}

/// Analyses the whole image (or else the first picture) of renders with growing n, read like the suspect.
pub(super) fn by_samples(renders: &[(u32, Pictures)], ready: &Ready, case: &Case) -> Option<BySamples> {
    let (curve, exposure) = (ready.display.curve, ready.display.exposure as f32);
    let read = |p: &Pictures| {
        let radiance = |v: &[f32; 3]| curve.decode(v.map(f64::from)).map(|x| x as f32 / exposure);
        let layer = |l: &Layer| Layer {
            slot: l.slot,
            mean: l.mean.iter().map(radiance).collect(),
            std_error: l.std_error.clone().filter(|_| curve == Curve::LINEAR),
        };
        Pictures { layers: p.layers.iter().map(layer).collect(), ..p.clone() }.shrunk(case.factor)
    };
    let renders: Vec<(u32, Pictures)> = renders.iter().map(|(n, p)| (*n, read(p))).collect();
    analysed(&renders, &ready.reference, ready.regions.first()?)
}

/// What the growth of the number of samples shows to be wrong, if anything. `rejected` is true if the picture with the most samples is
/// wrong.
pub(super) fn in_words(s: &BySamples, rejected: bool) -> Option<Suspicion> {
    if s.p_constant < 1e-3 && s.largest_change > 5e-3 {
        let means: Vec<String> = s.means.iter().map(|m| format!("{:.4} at {}", m[1], m[0])).collect();
        let found = finding(
            "mean-changes-with-samples",
            "its mean changes with the number of samples per pixel".into(),
            format!(
                "{} (p = {:.1e}): the mean of an unbiased estimator does not change. A nonlinear step acts before the mean: gamma, \
                 tone map, clamp or 8 bits",
                means.join(", "),
                s.p_constant
            ),
            "average linear radiance, and apply gamma, tone map and clamp afterwards",
        );
        return Some(Suspicion { members: vec!["gamma-before-mean"], ..found });
    }
    if s.renewed < 0.3 && !rejected {
        let found = finding(
            "same-numbers",
            "further samples repeat the first ones".into(),
            format!(
                "further samples replace {:.1} % of the error of the first ones; independent samples would replace nearly all of it",
                100.0 * s.renewed
            ),
            "give every sample its own random numbers",
        );
        return Some(found);
    }
    None
}

fn analysed(renders: &[(u32, Pictures)], reference: &Pictures, image: &Region) -> Option<BySamples> {
    let pick = |p: &Pictures| p.layer(Slot::Whole).or(p.layers.first()).map(|l| l.slot);
    let slot = pick(&renders.first()?.1)?;
    let right = reference.layer(slot)?;
    let own = right.std_error.as_ref().map_or(0.0, |e| {
        let square = |p: usize| e[p].iter().map(|&s| f64::from(s).powi(2)).sum::<f64>();
        image.pixels.iter().map(|&p| square(p)).sum::<f64>() / (3 * image.pixels.len()) as f64
    });
    let mut rows: Vec<(u32, Measured, f64)> = vec![];
    for (n, pictures) in renders {
        let layer = pictures.layer(slot)?;
        let r = ratio(layer, right, pictures.size[0], &image.pixels);
        let square = |p: usize, c: usize| f64::from(layer.mean[p][c] - r.mean as f32 * right.mean[p][c]).powi(2);
        let error = image.pixels.iter().map(|&p| (0..3).map(|c| square(p, c)).sum::<f64>()).sum::<f64>();
        rows.push((*n, r, error / (3 * image.pixels.len()) as f64 - own));
    }
    rows.sort_by_key(|r| r.0);
    let least = renders.iter().min_by_key(|r| r.0).and_then(|r| r.1.layer(slot))?;
    let most = renders.iter().max_by_key(|r| r.0).and_then(|r| r.1.layer(slot))?;
    let change = |p: usize| (0..3).map(|c| f64::from(least.mean[p][c] - most.mean[p][c]).powi(2)).sum::<f64>();
    let changed = image.pixels.iter().map(|&p| change(p)).sum::<f64>() / (3 * image.pixels.len()) as f64;
    let renewed = if rows[0].2 > own { changed / rows[0].2 } else { f64::NAN };
    let (_, last, _) = rows.last()?;
    let others = &rows[..rows.len() - 1];
    let gap = |m: Measured| difference(m, *last);
    let p: Vec<f64> = others
        .iter()
        .map(|r| gap(r.1))
        .map(|d| if d.mean.abs() < 1e-5 { 1.0 } else { two_sided_p(d.mean / d.std_error, d.dof) })
        .collect();
    let change = others.iter().map(|r| (r.1.mean / last.mean - 1.0).abs()).fold(0.0, f64::max);
    Some(BySamples {
        means: rows.iter().map(|r| [f64::from(r.0), r.1.mean]).collect(),
        p_constant: holm(&p).into_iter().fold(1.0, f64::min),
        largest_change: change,
        renewed,
        slope: slope(&rows.iter().map(|r| (f64::from(r.0).ln(), r.2.ln())).collect::<Vec<_>>()),
    })
}

fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mx, my) = points.iter().fold((0.0, 0.0), |a, p| (a.0 + p.0 / n, a.1 + p.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |a, p| (a.0 + (p.0 - mx) * (p.1 - my), a.1 + (p.0 - mx).powi(2)));
    if xx > 0.0 { xy / xx } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_line_has_its_slope() {
        assert!((super::slope(&[(0.0, 1.0), (1.0, 0.0), (2.0, -1.0)]) + 1.0).abs() < 1e-12);
        assert!(super::slope(&[(1.0, 1.0)]).is_nan());
    }
}
