//! Finished pixels that were clamped: the brightest values of the picture are all the same number.
//!
//! ```text
//! S_i = min(T_i, c)          c: the largest value of the picture, if several values are equal to it and T is larger there
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | S, T | the picture and the correct one | arguments of [`level`] |
//! | c | level of the clamp | result of [`level`] |

use super::picture::{Layer, Pictures, Slot};

/// Fewest equal values at the level.
const FEWEST: usize = 3;
/// The correct picture must be larger by this factor there.
const LARGER: f32 = 1.05;

/// The level at which finished values were clamped, if they were.
pub fn level(suspect: &Pictures, reference: &Pictures) -> Option<f32> {
    let largest = suspect.layers.iter().flat_map(|l| l.mean.iter().flatten()).fold(0.0f32, |a, v| a.max(*v));
    let at = |v: f32| (v - largest).abs() <= 1e-5 * largest;
    let held = |l: &Layer| {
        let right = reference.layer(l.slot)?;
        let pairs = l.mean.iter().flatten().zip(right.mean.iter().flatten());
        Some(pairs.filter(|(s, t)| at(**s) && **t > LARGER * largest).count())
    };
    // a lamp has the same value in every pixel: what is clamped is held below the correct value
    (largest > 0.0 && suspect.layers.iter().filter_map(held).sum::<usize>() >= FEWEST).then_some(largest)
}

/// The correct pictures after the clamp.
pub fn clamped(reference: &Pictures, level: f32) -> Pictures {
    let mut clamped = reference.only(|s| s != Slot::Tail);
    clamped.layers.iter_mut().flat_map(|l| l.mean.iter_mut().flatten()).for_each(|v| *v = v.min(level));
    clamped
}
