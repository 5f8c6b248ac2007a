//! Pixels that no comparison of means can use: values that are not finite, and single pixels that are far too bright (fireflies).
//!
//! ```text
//! pixel i is an outlier if  S_i > 100 max over its neighbours of r T  and  S_i > Σ S/20        r: median of S/T
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, T | the picture and the correct one | arguments of [`outliers`] |
//! | – | such pixels, if they are few | [`Outlier`] |
//!
//! One such pixel can hold most of the light of the picture. Whether it is a rare sample of a correct estimator or a mistake cannot be
//! decided from one picture. It is therefore left out of all comparisons and reported.

use super::picture::{Pictures, Slot};
use serde::Serialize;

/// A pixel that is far too bright.
#[derive(Clone, Debug, Serialize)]
pub struct Outlier {
    /// The picture in which it was found.
    pub slot: Slot,
    /// Column and row.
    pub pixel: [usize; 2],
    /// Its value divided by the largest correct value around it.
    pub times: f64,
    /// Its share of the light of that picture.
    pub share: f64,
}

/// A pixel is an outlier above this multiple of the brightest correct value around it.
const TIMES: f64 = 100.0;
/// An outlier holds more than this share of the light of a picture.
const SHARE: f64 = 0.05;
/// Largest number of outliers, as a fraction of all pixels. More of them are noise.
const MOST: f64 = 1e-3;

/// The outliers of all layers, the brightest first; none if there are many.
pub fn outliers(suspect: &Pictures, reference: &Pictures) -> Vec<Outlier> {
    let [w, h] = suspect.size;
    let mut found = vec![];
    for layer in &suspect.layers {
        let Some(right) = reference.layer(layer.slot) else { continue };
        let grey = |v: &[f32; 3]| v.iter().map(|x| f64::from(*x)).sum::<f64>();
        let sum: f64 = layer.mean.iter().map(grey).filter(|v| v.is_finite()).sum();
        let mut ratios: Vec<f64> =
            layer.mean.iter().zip(&right.mean).filter(|(_, t)| grey(t) > 0.0).map(|(s, t)| grey(s) / grey(t)).collect();
        ratios.retain(|r| r.is_finite());
        ratios.sort_by(f64::total_cmp);
        let usual = ratios.get(ratios.len() / 2).copied().unwrap_or(1.0).max(1.0);
        let average = right.mean.iter().map(grey).sum::<f64>() / right.mean.len() as f64;
        let around = |p: usize| {
            let (x, y) = (p % w, p / w);
            let rows = y.saturating_sub(1)..(y + 2).min(h);
            let columns = x.saturating_sub(1)..(x + 2).min(w);
            rows.flat_map(|v| columns.clone().map(move |u| v * w + u))
                .map(|q| grey(&right.mean[q]))
                .fold(0.1 * average, f64::max)
        };
        for (p, v) in layer.mean.iter().enumerate() {
            let times = grey(v) / (usual * around(p));
            let share = grey(v) / sum;
            if times.is_finite() && times > TIMES && share > SHARE {
                found.push(Outlier { slot: layer.slot, pixel: [p % w, p / w], times, share });
            }
        }
    }
    let mut pixels: Vec<[usize; 2]> = found.iter().map(|o| o.pixel).collect();
    pixels.sort_unstable();
    pixels.dedup();
    if pixels.len() as f64 > (MOST * (w * h) as f64).max(3.0) {
        return vec![];
    }
    found.sort_by(|a, b| b.times.total_cmp(&a.times));
    found
}
