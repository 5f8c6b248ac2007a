//! Owen-scrambled Sobol points by address: more evenly spread than independent points, so most integrals have less variance.
//!
//! ```text
//! Var(mean of n points) = O(n⁻¹) independent      O(n⁻³ log n) scrambled, smooth integrand, n = 2^m
//! sample i of a pixel = point j = i div R of replicate r = i mod R           seeds = hash(key, pixel, r, place)
//! (u₀, u₁) = S(x(π(j))),  (u₂, u₃) = S(x(π′(j)))        x = (φ(j), P φ(j)): the first two Sobol dimensions
//! ```
//!
//! The seeds choose the scrambles S of each number and the shuffles π, π′ of the points. Each scrambled point is uniform, so every
//! mean stays unbiased. Every pair of numbers of every place on the path (bounce, purpose, draw) has its own seeds, and all pairs
//! use the same two dimensions, which are the best ones ("padding"). The points of one pair are evenly spread; the points of two
//! pairs are independent of each other. Higher dimensions for further places would spread several places jointly. But pairs of
//! higher dimensions are spread much worse at the tens of points that a replicate has (t up to 5), so each single place would be
//! sampled worse.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | R | number of replicates; their scrambles are independent, so that standard errors computed from replicates are correct | [`Key`](super::Key) |
//! | j | index within the replicate; a new scramble begins every 2¹⁶ points | `LONGEST` |
//! | φ | radical inverse in base 2: the bits of j in reverse order | |
//! | P | Pascal's triangle modulo 2, which is the matrix of the second dimension | `pascal` |
//! | S, π | nested uniform scramble (Owen), of the digits of a number and of an index | `owen_scramble_rev` |
//! | t | 2^m points fill every elementary interval of area 2^(t−m): t = 0 in each pair | tests |
//!
//! The numbers are multiples of 2⁻²³. References: Sobol (1967); Owen, *Scrambled net variance for integrals of smooth
//! functions* (1997); Burley, *Practical Hash-based Owen Scrambling* (JCGT 9(4), 2020); Ahmed, *An Implementation Algorithm of
//! 2D Sobol Sequence Fast, Elegant, and Compact* (EGSR 2024), for P by shifts.

use super::pcg::pcg4d;
use sobol_burley::parts::{hash, owen_scramble_rev, u32_to_f32_norm};

/// log2 of the number of points of one scramble.
const LONGEST: u32 = 16;

/// The four numbers at one place of the path that is point `index` of a replicate with this scramble.
///
/// Nothing here branches and nothing is looked up, so a loop over paths becomes a loop over SIMD lanes.
#[inline(always)]
pub(super) fn four(key: [u32; 2], pixel: u32, place: u32, (scramble, index): (u32, u32)) -> [f32; 4] {
    let s = pcg4d([pixel.wrapping_add(key[0]), scramble, place, key[1]]);
    let index = (index & ((1 << LONGEST) - 1)).reverse_bits();
    let [a, b] = [s[0].wrapping_add(s[1]), s[2].wrapping_add(s[3])].map(
        #[inline(always)]
        |seed| owen_scramble_rev(index, hash(seed)).reverse_bits(),
    );
    [scrambled(a, s[0]), scrambled(pascal(a), s[1]), scrambled(b, s[2]), scrambled(pascal(b), s[3])]
}

/// The number in [0, 1) with these binary digits, the first one in the lowest bit, after an Owen scramble.
#[inline(always)]
fn scrambled(digits: u32, seed: u32) -> f32 {
    u32_to_f32_norm(owen_scramble_rev(digits, seed).reverse_bits())
}

/// P times a vector of 16 bits. P is a Kronecker power of (1 1; 0 1), hence four steps.
#[inline(always)]
fn pascal(mut x: u32) -> u32 {
    x ^= x >> 1 & 0x5555;
    x ^= x >> 2 & 0x3333;
    x ^= x >> 4 & 0x0f0f;
    x ^ x >> 8 & 0x00ff
}

/// How samples are dealt to R replicates.
#[derive(Clone, Copy, Debug)]
pub(super) enum Deal {
    /// R = 2^n: shifts, which go in lanes.
    Bits(u32),
    /// Any other R.
    Any(u32),
}

impl Deal {
    #[inline(always)]
    pub(super) fn to(replicates: u32) -> Self {
        if replicates.is_power_of_two() { Self::Bits(replicates.trailing_zeros()) } else { Self::Any(replicates) }
    }

    /// The scramble and the index of a sample.
    #[inline(always)]
    pub(super) fn at(self, sample: u32) -> (u32, u32) {
        match self {
            Self::Bits(n) => ((sample & ((1 << n) - 1)) + (sample >> n >> LONGEST << n), sample >> n),
            Self::Any(n) => (sample % n + ((sample / n) >> LONGEST) * n, sample / n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sobol_burley::parts::sobol_rev;

    /// Before the scramble, the points are those of the library.
    #[test]
    fn digits_are_those_of_the_first_two_sobol_dimensions() {
        for index in 0..1_u32 << LONGEST {
            assert_eq!(index, sobol_rev(index.reverse_bits(), 0));
            assert_eq!(pascal(index), sobol_rev(index.reverse_bits(), 1));
        }
    }

    /// Shifts and divisions agree, and a new scramble begins every 2^16 points.
    #[test]
    fn samples_are_dealt_to_replicates() {
        for sample in (0..1 << 24).step_by(4099) {
            assert_eq!(Deal::to(16).at(sample), Deal::Any(16).at(sample));
        }
        assert_eq!(Deal::to(8).at(8 * (1 << LONGEST) + 3), (8 + 3, 1 << LONGEST));
        assert_eq!(Deal::to(3).at(7), (1, 2));
    }
}
