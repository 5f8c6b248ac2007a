//! The product diag(w) F x.
//!
//! ```text
//! yᵢ = wᵢ Σⱼ Fᵢⱼ xⱼ        Σⱼ as eight interleaved partial sums, which are added at the end
//! ```
//!
//! Each sum has a fixed order, so that its bits depend neither on the number of threads nor on the width of the vector
//! registers. An addition waits for the one before it in the same sum; so several rows are multiplied together.
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | F | form factors | [`FormFactors`] |
//! | w | one factor per row: ρ, or √(ρA) | `w` |

use crate::operator::form_factor::FormFactors;
use pulp::{Arch, Simd};
use rayon::prelude::*;

/// Partial sums of a row.
const SUMS: usize = 8;

/// Rows that are multiplied together.
const ROWS: usize = 4;

/// y = diag(w) F x.
pub(super) fn product(factors: &FormFactors, w: &[f64], x: &[f64], y: &mut [f64]) {
    let (blocks, rest) = y.as_chunks_mut::<ROWS>();
    let alone = ROWS * blocks.len();
    blocks.par_iter_mut().with_min_len(4).enumerate().for_each(|(block, y)| {
        let first = block * ROWS;
        let sums = dots(std::array::from_fn(|k| factors.row(first + k)), x);
        (0..ROWS).for_each(|k| y[k] = w[first + k] * sums[k]);
    });
    rest.iter_mut().zip(alone..).for_each(|(y, i)| *y = w[i] * dot(factors.row(i), x));
}

/// Σ aⱼ xⱼ.
pub(super) fn dot(a: &[f32], x: &[f64]) -> f64 {
    let (blocks, rest) = a.as_chunks::<SUMS>();
    let (xs, tail) = x.as_chunks::<SUMS>();
    let mut sums = [0.0; SUMS];
    for (a, x) in blocks.iter().zip(xs) {
        for l in 0..SUMS {
            sums[l] += f64::from(a[l]) * x[l];
        }
    }
    total(&sums, rest, tail)
}

#[inline(always)]
fn total(sums: &[f64; SUMS], rest: &[f32], tail: &[f64]) -> f64 {
    sums.iter().sum::<f64>() + rest.iter().zip(tail).map(|(a, x)| f64::from(*a) * x).sum::<f64>()
}

/// Several rows times x, with the bits of [`dot`].
#[pulp::with_simd(dots = Arch::new())]
#[inline(always)]
fn dots_with_simd<'a, S: Simd>(_simd: S, rows: [&'a [f32]; ROWS], x: &'a [f64]) -> [f64; ROWS] {
    let (xs, tail) = x.as_chunks::<SUMS>();
    let [a, b, c, d] = rows.map(|r| r.as_chunks::<SUMS>().0);
    let mut sums = [[0.0; SUMS]; ROWS];
    for ((((x, a), b), c), d) in xs.iter().zip(a).zip(b).zip(c).zip(d) {
        for (sums, row) in sums.iter_mut().zip([a, b, c, d]) {
            for l in 0..SUMS {
                sums[l] += f64::from(row[l]) * x[l];
            }
        }
    }
    let mut out = [0.0; ROWS];
    for (out, (sums, row)) in out.iter_mut().zip(sums.iter().zip(rows)) {
        *out = total(sums, row.as_chunks::<SUMS>().1, tail);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::chance;

    /// Every number of rows and columns that leaves a rest gives the bits of one row at a time.
    #[test]
    fn rows_together_have_the_bits_of_single_rows() {
        let mut next = chance::numbers();
        for n in [1, 3, 4, 7, 8, 9, 61, 64] {
            let f = (0..n * n).map(|_| next() as f32).collect();
            let [area, w, x] = [(); 3].map(|()| (0..n).map(|_| next()).collect::<Vec<f64>>());
            let factors = FormFactors { n, f, area, rays: 0 };
            let mut y = vec![0.0; n];
            product(&factors, &w, &x, &mut y);
            let plain: Vec<f64> = (0..n).map(|i| w[i] * dot(factors.row(i), &x)).collect();
            assert_eq!(y, plain);
        }
    }
}
