//! The points that define the rays of a row: an extensible lattice rule with a random shift.
//!
//! ```text
//! xₛ = { φ₂(s) z + Δ },  s = 0, 1, …        z = (1, 182667, 469891, 498753),  Δ uniform in [0, 1)⁴, one per row
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | φ₂ | radical inverse: the bits of s mirrored at the binary point | [`Lattice::at`] |
//! | { } | fractional part | wrapping 32-bit arithmetic |
//!
//! The first 2^m points are a lattice for every m. Rows are therefore nested, and both halves of a row are lattices, too.
//! The light that a patch sees jumps at edges. For such functions a shifted lattice has less variance than a scrambled net,
//! whose points are random within their cells: the error of u in the Cornell box at 256 rays is 0.76 of the error with Sobol
//! points. A point costs four multiplications. The first two numbers give the direction, the last two the place on the
//! patch.
//!
//! References: Cools, Kuo and Nuyens, *Constructing embedded lattice rules for multivariate integration* (2006), for z;
//! Hickernell, Hong, L'Écuyer and Lemieux, *Extensible lattice sequences for quasi-Monte Carlo quadrature* (2000).

use crate::math::{Key, Purpose, Rng};

const Z: [u32; 4] = [1, 182_667, 469_891, 498_753];

/// The points of one row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    shift: [u32; 4],
}

impl Lattice {
    pub(super) fn new(key: Key, row: usize, purpose: Purpose) -> Self {
        let shift = Rng::at(key, row as u32, 0, 0, purpose).four();
        Self { shift: shift.map(|x| ((x * 16_777_216.0) as u32) << 8) }
    }

    /// Point s; its coordinates are multiples of 2⁻²⁴ below 1.
    #[inline(always)]
    pub(super) fn at(&self, s: u32) -> [f32; 4] {
        let mirrored = s.reverse_bits();
        std::array::from_fn(|k| {
            let x = mirrored.wrapping_mul(Z[k]).wrapping_add(self.shift[k]);
            (x >> 8) as i32 as f32 * (1.0 / 16_777_216.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_meets_every_interval_once() {
        let points = Lattice::new(Key::new(1, "lattice"), 7, Purpose::Scatter);
        // the whole, its halves and a quarter
        for (from, count) in [(0, 256), (0, 128), (128, 128), (0, 64)] {
            for k in 0..4 {
                let mut numbers: Vec<f32> = (from..from + count).map(|s| points.at(s)[k]).collect();
                numbers.sort_by(f32::total_cmp);
                let step = 1.0 / count as f32;
                assert!(numbers.windows(2).all(|w| (w[1] - w[0] - step).abs() < 1e-6), "{from} {count} {k}");
                assert!(numbers.iter().all(|x| (0.0..1.0).contains(x)));
            }
        }
        assert_ne!(points.at(0), Lattice::new(Key::new(1, "lattice"), 8, Purpose::Scatter).at(0));
    }
}
