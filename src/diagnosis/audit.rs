//! Are the error bars of the file honest? The variance that its `_se` layers state, against the scatter of its pixels.
//!
//! ```text
//! q = mean of (e_x − e_{x+1})²/2 in a block / (s² + r² t²),   e = S − r T          1 for independent pixels with honest errors
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, s | pixels of the picture and their stated standard errors | argument |
//! | T, t | the same of the correct picture; r = ΣS/ΣT in the block | argument |
//! | q | geometric mean over the blocks, with its 95 % interval from their scatter | [`Audit`] |
//!
//! Errors that are too small make a correct picture look wrong. If they are not honest, the comparison uses the scatter instead.

use super::picture::{Layer, Pictures, Slot};
use super::regions::holds;
use serde::Serialize;

/// The audit of one picture.
#[derive(Clone, Debug, Serialize)]
pub struct Audit {
    /// The picture.
    pub slot: Slot,
    /// The ratio q of variances: above 1 if the stated errors are too small.
    pub ratio: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
}

/// Ratios inside this range count as honest.
const HONEST: [f64; 2] = [0.5, 2.0];
/// Side of the blocks, in pixels.
const BLOCK: usize = 8;
/// Fewest blocks for an audit.
const FEWEST: usize = 4;

impl Audit {
    /// Returns false if the stated errors are certainly wrong.
    pub fn honest(&self) -> bool {
        self.interval[1] >= HONEST[0] && self.interval[0] <= HONEST[1]
    }
}

/// The audits of all pictures with `_se` layers that have noise. Pixels of the mask are left out.
pub fn audit(suspect: &Pictures, reference: &Pictures, mask: &[bool]) -> Vec<Audit> {
    let reflected = suspect.layers.iter().filter(|l| l.slot != Slot::Term(0));
    reflected.filter_map(|l| one(l, reference.layer(l.slot)?, suspect.size, mask)).collect()
}

fn one(layer: &Layer, right: &Layer, [w, h]: [usize; 2], mask: &[bool]) -> Option<Audit> {
    let (s, t) = layer.std_error.as_ref().zip(right.std_error.as_ref())?;
    let mut logs = vec![];
    for (y0, x0) in (0..h / BLOCK).flat_map(|y| (0..w / BLOCK).map(move |x| (y * BLOCK, x * BLOCK))) {
        let inside = (0..BLOCK * BLOCK).map(|i| (y0 + i / BLOCK) * w + x0 + i % BLOCK);
        let pixels: Vec<usize> = inside.filter(|&p| !holds(mask, p)).collect();
        if 2 * pixels.len() < BLOCK * BLOCK {
            continue;
        }
        let sum = |of: &dyn Fn(usize, usize) -> f64| {
            pixels.iter().map(|&p| (0..3).map(|c| of(p, c)).sum::<f64>()).sum::<f64>()
        };
        let value = |v: &[[f32; 3]], p: usize, c: usize| f64::from(v[p][c]);
        let r = sum(&|p, c| value(&layer.mean, p, c)) / sum(&|p, c| value(&right.mean, p, c));
        let off = |p: usize, c: usize| value(&layer.mean, p, c) - r * value(&right.mean, p, c);
        // neighbours in a row: a difference that changes slowly over the image is no noise
        let pairs: Vec<usize> =
            pixels.iter().copied().filter(|p| (p + 1) % w != 0 && pixels.contains(&(p + 1))).collect();
        let step = |p: usize| (0..3).map(|c| (off(p, c) - off(p + 1, c)).powi(2)).sum::<f64>();
        let found = pairs.iter().map(|&p| step(p)).sum::<f64>() * pixels.len() as f64 / (2.0 * pairs.len() as f64);
        let stated = sum(&|p, c| value(s, p, c).powi(2) + (r * value(t, p, c)).powi(2));
        if found > 0.0 && stated > 0.0 && r.is_finite() {
            logs.push((found / stated).ln());
        }
    }
    let n = logs.len() as f64;
    if logs.len() < FEWEST {
        return None;
    }
    let mean = logs.iter().sum::<f64>() / n;
    let error = (logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    let half = crate::stats::critical(0.05, n - 1.0) * error;
    Some(Audit { slot: layer.slot, ratio: mean.exp(), interval: [(mean - half).exp(), (mean + half).exp()] })
}
