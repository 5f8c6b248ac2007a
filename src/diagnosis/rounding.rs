//! The largest difference of a mean that the number format of a file explains.
//!
//! ```text
//! tolerance = r |P|                               r: relative rounding of the format
//! stored in steps Δ:   + Δ (0.1 + 0.5 exp(−2π² σ²/Δ²))        σ: spread of the values in the region
//! ```
//!
//! Where values cover many steps, rounding up and down cancel; where all values lie in one step, they do not. With a shared exponent
//! (Radiance HDR), rounding is relative to the largest channel. JPEG rounds whole blocks of pixels, by a few steps.

use super::picture::{Code, Layer, Pictures};
use super::regions::Region;

/// A mean of rounded values may always be off by this fraction of a step.
const ALWAYS: f64 = 0.1;
/// Steps by which a block of JPEG may be off.
const IN_BLOCKS: f64 = 2.0;

/// The tolerance for one channel of a layer and its prediction in a region; `relative` is r |P|.
pub(super) fn tolerance(
    suspect: &Pictures,
    (layer, predicted): (&Layer, &Layer),
    region: &Region,
    channel: usize,
    relative: f64,
) -> f64 {
    let shared =
        if suspect.code == Code::SharedExponent { suspect.code.rounding() * largest(predicted, region) } else { 0.0 };
    relative.max(shared) + coarse(suspect, layer, region, channel)
}

/// Mean of the brightest channel.
fn largest(predicted: &Layer, region: &Region) -> f64 {
    let mean = |c: usize| region.pixels.iter().map(|&p| f64::from(predicted.mean[p][c])).sum::<f64>();
    (0..3).map(mean).fold(0.0, f64::max) / region.pixels.len() as f64
}

/// The part of the mean that may be rounding, if values are stored in steps. Where the values of the region cover many steps, rounding up
/// and down cancel. JPEG rounds whole blocks of pixels, by a few steps.
fn coarse(suspect: &Pictures, layer: &Layer, region: &Region, channel: usize) -> f64 {
    if suspect.step.is_empty() || region.pixels.is_empty() {
        return 0.0;
    }
    let n = region.pixels.len() as f64;
    let mean = |of: &dyn Fn(usize) -> f64| region.pixels.iter().map(|&p| of(p)).sum::<f64>() / n;
    let step = mean(&|p| f64::from(suspect.step[p][channel]));
    let mut values: Vec<f32> = region.pixels.iter().map(|&p| layer.mean[p][channel]).collect();
    values.sort_by(f32::total_cmp);
    // σ of a normal distribution from its quartiles, which a few bright pixels do not move
    let spread = (f64::from(values[values.len() * 3 / 4] - values[values.len() / 4]) / 1.349 / step).powi(2);
    // the bias of rounding falls as exp(−2π² σ²) with the spread σ before it; rounding itself adds up to 1/4 to σ²
    let cancelled = (-2.0 * std::f64::consts::PI.powi(2) * (spread - 0.25).max(0.0)).exp();
    let blocks = if suspect.code == Code::Jpeg { IN_BLOCKS } else { 0.0 };
    step * (ALWAYS + 0.5 * cancelled.min(1.0) + blocks)
}
