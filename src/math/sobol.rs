//! Owen-scrambled Sobol points by address: the same integral with fewer clumps and gaps.
//!
//! ```text
//! Var(mean of n points) = O(n⁻¹) independent      O(n⁻³ log n) scrambled, smooth integrand, n = 2^m
//! sample i of a pixel = point j = i div R of replicate r = i mod R           seed = hash(key, pixel, r, place)
//! ```
//!
//! The four numbers of a draw are one point of the first four Sobol dimensions, scrambled (each point is uniform, so
//! every mean stays unbiased) and shuffled by the seed. Every place on the path (bounce, purpose, draw) has a seed of
//! its own and uses these same four dimensions, the best there are ("padding"): the points of one place are evenly
//! spread, those of two places are independent of each other. Higher dimensions for further places would spread places
//! jointly too, but their pairs are spread so much worse at the tens of points that a replicate has (t up to 5) that
//! single places pay for it.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | R | replicates: scrambles that know nothing of each other, so errors from replicates stay honest | [`Key`](super::Key) |
//! | j | index within the replicate; every 2¹⁶ points a new scramble | `LONGEST` |
//! | t | 2^m points fill every elementary interval of area 2^(t−m): t = 0 in dimensions 0, 1, t ≤ 1 in 2, 3 | tests |
//!
//! Numbers are multiples of 2⁻²³. References: Sobol (1967); Owen, *Scrambled net variance for integrals of smooth
//! functions* (1997); Joe and Kuo, *Constructing Sobol sequences with better two-dimensional projections* (2008);
//! Burley, *Practical Hash-based Owen Scrambling* (JCGT 9(4), 2020).

use super::pcg::pcg4d;

/// Points of one scramble, log2: what the tables of the crate hold.
const LONGEST: u32 = 16;

/// Four numbers of sample `sample` at one place of its path.
pub(super) fn four(key: [u32; 2], pixel: u32, sample: u32, place: u32, replicates: u32) -> [f32; 4] {
    let (replicate, index) = (sample % replicates, sample / replicates);
    let scramble = replicate + replicates * (index >> LONGEST);
    let [seed, ..] = pcg4d([pixel.wrapping_add(key[0]), scramble, place, key[1]]);
    sobol_burley::sample_4d(index & ((1 << LONGEST) - 1), 0, seed)
}
