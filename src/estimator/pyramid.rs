//! The bidirectional estimator with a separate slot for each strategy, along the same walks.
//!
//! ```text
//! T^k E = Σ_s E[w_s · C_s]          slot (k, s): w_s · C_s          slot len + (k, s): C_s
//! ```
//!
//! C_s is what strategy s found of term k, and w_s its weight: see [`bidirectional`](super::bidirectional). The weighted
//! slots of a term add up to it. A slot without weights is what the strategy would give as the only one. Reference: the
//! pyramid of pictures of Veach (1997), sec. 10.3.

use super::{Bidirectional, Job, Paths, Plan, TermEstimator, TermSink};
use crate::math::Columns;
use crate::operator::{Adjoint, Sensor};

/// The strategies of the bidirectional estimator, one slot each.
#[derive(Clone, Debug, PartialEq)]
pub struct Pyramid(pub Plan);

impl Pyramid {
    /// The weighted slot of strategy s of term k.
    pub fn slot(k: usize, s: usize) -> usize {
        // terms before k have 2 + 3 + … + (k + 1) strategies
        k * (k + 3) / 2 + s
    }

    /// Number of strategies of all terms k ≤ K. Slot i is weighted, slot `len + i` is the same without the weight.
    pub fn len(max_bounces: usize) -> usize {
        Self::slot(max_bounces + 1, 0)
    }

    /// All pairs (k, s), in the order of the slots.
    pub fn strategies(max_bounces: usize) -> impl Iterator<Item = (usize, usize)> {
        (0..=max_bounces).flat_map(|k| (0..=k + 1).map(move |s| (k, s)))
    }
}

impl<T: Adjoint> TermEstimator<T> for Pyramid {
    fn slots(&self) -> usize {
        2 * Self::len(self.0.max_bounces)
    }

    fn splats(&self) -> bool {
        true
    }

    fn sample<S: Sensor<T>>(&self, job: &Job<'_, T, S>, _: &mut Paths<T::Wave>, sink: &mut impl TermSink) {
        let behind = Self::len(self.0.max_bounces);
        let mut add =
            |slot: usize, pixel: &[u32], sample: &[u32], value: &Columns| sink.add(slot, pixel, sample, value);
        Bidirectional(self.0.clone()).find(
            job,
            |f| {
                let slot = Self::slot(f.k, f.s);
                add(slot + behind, &f.pixel, &f.sample, &f.value);
                f.value.scale(&f.weight, f.weight.len());
                add(slot, &f.pixel, &f.sample, &f.value);
            },
            |_, _| (),
        );
    }
}
