//! Owen-scrambled Sobol points by address: more evenly spread than independent points, so most integrals have less variance.
//!
//! ```text
//! Var(mean of n points) = O(n⁻¹) independent      O(n⁻³ log n) scrambled, smooth integrand, n = 2^m
//! sample i of a pixel = point j = i div R of replicate r = i mod R           seed = hash(key, pixel, r, place)
//! ```
//!
//! The four numbers of a draw are one point of the first four Sobol dimensions. The seed scrambles and shuffles the points.
//! Each scrambled point is uniform, so every mean stays unbiased. Every place on the path (bounce, purpose, draw) has its
//! own seed, and all places use these same four dimensions, which are the best ones ("padding"). The points of one place are
//! evenly spread; the points of two places are independent of each other. Higher dimensions for further places would spread
//! several places jointly. But pairs of higher dimensions are spread much worse at the tens of points that a replicate has
//! (t up to 5), so each single place would be sampled worse.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | R | number of replicates; their scrambles are independent, so that standard errors computed from replicates are correct | [`Key`](super::Key) |
//! | j | index within the replicate; a new scramble begins every 2¹⁶ points | `LONGEST` |
//! | t | 2^m points fill every elementary interval of area 2^(t−m): t = 0 in dimensions 0, 1, t ≤ 1 in 2, 3 | tests |
//!
//! The numbers are multiples of 2⁻²³. References: Sobol (1967); Owen, *Scrambled net variance for integrals of smooth
//! functions* (1997); Joe and Kuo, *Constructing Sobol sequences with better two-dimensional projections* (2008); Burley,
//! *Practical Hash-based Owen Scrambling* (JCGT 9(4), 2020).

use super::pcg::pcg4d;

/// log2 of the number of points of one scramble: the length of the tables in the crate `sobol_burley`.
const LONGEST: u32 = 16;

/// The four numbers of sample `sample` at one place of its path.
pub(super) fn four(key: [u32; 2], pixel: u32, sample: u32, place: u32, replicates: u32) -> [f32; 4] {
    let (replicate, index) = (sample % replicates, sample / replicates);
    let scramble = replicate + replicates * (index >> LONGEST);
    let [seed, ..] = pcg4d([pixel.wrapping_add(key[0]), scramble, place, key[1]]);
    sobol_burley::sample_4d(index & ((1 << LONGEST) - 1), 0, seed)
}
