//! The visible share of a pair of patches.
//!
//! ```text
//! V = Σ k(xₛ, yₛ) v(xₛ, yₛ) / Σ k(xₛ, yₛ)        k = cos θₓ cos θᵧ / r²,  v = 1 if the segment is free
//! ```
//!
//! Numerator and denominator share the samples, so V is exactly 1 for a clear pair and reciprocity holds to rounding.
//! The samples follow the additive recurrence of the four-dimensional golden ratio (Roberts 2018), shifted at random
//! per pair so that the errors of a row do not add up.

use crate::operator::patches::{BruteForce, Patch, SurfacePoint, polygon::at};
use glam::DVec3;

/// Answers whether two surface points see each other.
pub trait Visibility: Sync {
    /// Is the open segment between the two points free? The points lie on the true surface; implementations move them
    /// off it along their normals.
    fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool;

    /// The same, knowing that only the primitives in `among` can be in the way.
    fn visible_among(&self, a: SurfacePoint, b: SurfacePoint, among: &[u32]) -> bool {
        let _ = among;
        self.visible(a, b)
    }
}

impl Visibility for BruteForce {
    fn visible(&self, a: SurfacePoint, b: SurfacePoint) -> bool {
        self.free(a, b, 0..self.len())
    }

    fn visible_among(&self, a: SurfacePoint, b: SurfacePoint, among: &[u32]) -> bool {
        self.free(a, b, among.iter().map(|i| *i as usize))
    }
}

/// Samples per pair that is not provably clear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// First look: 64.
    pub rays: u32,
    /// Total for pairs of which the first look saw a part: 576.
    pub refined: u32,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { rays: 64, refined: 576 }
    }
}

/// A patch with the part of it that can take part in the exchange.
pub(super) type Part<'a> = (&'a Patch, &'a [DVec3]);

/// The visible share of the pair (in [0, 1]) and the rays it took. `flat_kernel` is off for pairs on one sphere, where k is constant.
pub(super) fn visible_share(
    sampling: Sampling,
    (a, pa): Part<'_>,
    (b, pb): Part<'_>,
    flat_kernel: bool,
    pair: u64,
    visible: impl Fn(SurfacePoint, SurfacePoint) -> bool,
) -> (f64, u32) {
    // 1/φ, 1/φ², 1/φ³, 1/φ⁴ with φ⁵ = φ + 1
    const STEP: [f64; 4] =
        [0.856_674_883_854_502_9, 0.733_891_856_627_125_9, 0.628_706_721_037_806_6, 0.538_597_257_223_612_5];
    let shift = [0, 1, 2, 3].map(|d| uniform(pair.wrapping_mul(4).wrapping_add(d)));
    let (mut seen, mut all) = (0.0, 0.0);
    let (mut hits, mut misses) = (0u32, 0u32);
    let mut look = |from: u32, to: u32| {
        for s in from..to {
            let u = [0, 1, 2, 3].map(|d| (shift[d] + f64::from(s) * STEP[d]).fract());
            let ((x, jx), (y, jy)) = (at(pa, u[0], u[1]), at(pb, u[2], u[3]));
            let r = y - x;
            let kernel =
                if flat_kernel { a.normal.dot(r) * -b.normal.dot(r) / r.length_squared().powi(2) } else { 1.0 };
            let weight = jx * jy * kernel;
            // the horizon of a clipped part may be missed by rounding, and touching parts may share a point
            if weight > 0.0 && weight.is_finite() {
                all += weight;
                if visible(a.lift(x), b.lift(y)) {
                    seen += weight;
                    hits += 1;
                } else {
                    misses += 1;
                }
            }
        }
        hits > 0 && misses > 0
    };
    let mixed = look(0, sampling.rays);
    if mixed && sampling.refined > sampling.rays {
        look(sampling.rays, sampling.refined);
    }
    (if misses == 0 { 1.0 } else { seen / all }, hits + misses)
}

/// A number in [0, 1) per key (Steele, Lea and Flood 2014, SplitMix64).
fn uniform(key: u64) -> f64 {
    let mut z = key.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}
