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

use super::gap::ratio;
use super::picture::{Pictures, Slot};
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

/// Analyses the whole image (or else the first picture) of renders with growing n.
pub fn by_samples(renders: &[(u32, Pictures)], reference: &Pictures, image: &Region) -> Option<BySamples> {
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
