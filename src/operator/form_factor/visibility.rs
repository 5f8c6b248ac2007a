//! The visible share of a pair of patches.
//!
//! ```text
//! V = Σ k(xₛ, yₛ) v(xₛ, yₛ) / Σ k(xₛ, yₛ)        k = cos θₓ cos θᵧ / r²,  v = 1 if the segment is free
//! ```
//!
//! Numerator and denominator use the same samples. Therefore V is exactly 1 for a pair without blockers, and reciprocity
//! holds up to rounding. The samples follow the additive recurrence of the four-dimensional golden ratio (Roberts 2018).
//! Each pair has its own random shift, so that the errors in a row do not add up.

use crate::operator::patches::{BruteForce, LANES, Lane, Patch, Segments, SurfacePoint};
use glam::DVec3;
use pulp::{Arch, Simd};

/// A test whether two surface points see each other.
pub trait Visibility: Sync {
    /// Returns true if nothing blocks the open segment between the two points. The points lie on the true surface;
    /// implementations move them off it along their normals.
    fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool;
}

impl Visibility for BruteForce {
    fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool {
        self.free(a, b, 0..self.len())
    }
}

/// Number of samples for a pair that is not provably unblocked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibilitySampling {
    /// Samples in the first pass; 128 by default.
    pub rays: u32,
    /// Total samples for a pair that the first pass found partly visible; 576 by default.
    pub refined: u32,
}

impl Default for VisibilitySampling {
    fn default() -> Self {
        Self { rays: 128, refined: 576 }
    }
}

/// A patch, and the part of its polygon that faces the other patch.
pub(super) type Part<'a> = (&'a Patch, &'a [DVec3]);

/// The visible share of the pair, in [0, 1], and the number of rays used. `flat_kernel` is false for pairs on one sphere,
/// where k is constant. `block` marks the segments that are blocked.
pub(super) fn visible_share(
    sampling: VisibilitySampling,
    a: Part<'_>,
    b: Part<'_>,
    flat_kernel: bool,
    pair: u64,
    segments: &mut Segments,
    mut block: impl FnMut(&mut Segments),
) -> (f64, u32) {
    let shift = [0, 1, 2, 3].map(|d| uniform(pair.wrapping_mul(4).wrapping_add(d)));
    let mut seen = Tally::default();
    let mut numbers = [[0.0; LANES]; 4];
    let mut look = |from: u32, to: u32| {
        for first in (from..to).step_by(LANES) {
            golden(shift, first, &mut numbers);
            segments.place(a, b, &numbers, flat_kernel);
            // the last batch may hold more samples than required; ignore the surplus
            segments.weight[LANES.min((to - first) as usize)..].fill(0.0);
            block(segments);
            tally(&segments.weight, &segments.blocked, &mut seen);
        }
        seen.hits > 0.0 && seen.misses > 0.0
    };
    let mixed = look(0, sampling.rays);
    if mixed && sampling.refined > sampling.rays {
        look(sampling.rays, sampling.refined);
    }
    let rays = (seen.hits + seen.misses) as u32;
    if seen.misses == 0.0 { (1.0, rays) } else { (seen.free.iter().sum::<f64>() / seen.all.iter().sum::<f64>(), rays) }
}

/// 1/φ, 1/φ², 1/φ³, 1/φ⁴ with φ⁵ = φ + 1.
const STEP: [f64; 4] =
    [0.856_674_883_854_502_9, 0.733_891_856_627_125_9, 0.628_706_721_037_806_6, 0.538_597_257_223_612_5];

/// Points `first`, `first` + 1, … of the additive recurrence, written to `numbers`.
#[pulp::with_simd(golden = Arch::new())]
#[inline(always)]
fn golden_with_simd<S: Simd>(_simd: S, shift: [f64; 4], first: u32, numbers: &mut [Lane; 4]) {
    for ((shift, step), numbers) in shift.into_iter().zip(STEP).zip(numbers) {
        for (k, number) in numbers.iter_mut().enumerate() {
            let x = shift + f64::from(first + k as u32) * step;
            *number = x - x.floor();
        }
    }
}

/// Sums in eight interleaved parts, so that the result does not depend on the width of the vector registers.
#[derive(Default)]
struct Tally {
    free: [f64; 8],
    all: [f64; 8],
    hits: f64,
    misses: f64,
}

#[pulp::with_simd(tally = Arch::new())]
#[inline(always)]
fn tally_with_simd<'a, S: Simd>(_simd: S, weight: &'a Lane, blocked: &'a Lane, sums: &'a mut Tally) {
    let (mut used, mut free) = ([0.0; 8], [0.0; 8]);
    for k in (0..LANES).step_by(8) {
        for l in 0..8 {
            let (w, open) = (weight[k + l], 1.0 - blocked[k + l]);
            let counts = if w > 0.0 { 1.0 } else { 0.0 };
            sums.all[l] += w;
            sums.free[l] += w * open;
            used[l] += counts;
            free[l] += counts * open;
        }
    }
    let (used, free) = (used.iter().sum::<f64>(), free.iter().sum::<f64>());
    sums.hits += free;
    sums.misses += used - free;
}

/// A pseudo-random number in [0, 1) for each key (Steele, Lea and Flood 2014, SplitMix64).
fn uniform(key: u64) -> f64 {
    let mut z = key.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
