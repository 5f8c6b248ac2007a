//! Directions about a normal by a table: the cosine map of numbers that have been warped.
//!
//! ```text
//! u ∈ [0, 1)²  —table→  u' ∈ cell c  —Malley→  ω        p(ω) = cos θ/π · r(ω)        r(ω) = M² P(c(ω))
//! ```
//!
//! The table is a density on the square, constant in each of its M × M cells; the cosine map carries it to the hemisphere,
//! where the square's own density 1 becomes cos θ/π. Every direction lies in one cell, so p is exact whatever stands behind
//! the direction, and `∫ p dω = Σ_c P(c) = 1`. The BSDF's part of the mixture is in the table too: for a Lambertian surface its
//! density is r = 1, and
//!
//! ```text
//! P(c) ∝ β/M² + (1 − β) W_c / Σ W
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u' | (sin² θ, φ/2π) | [`Warp::sample`] |
//! | r | density over that of the cosine | [`Warp::ratio`] |
//! | β | share of the BSDF | argument of [`Warp::new`] |
//! | W_c | what is expected from the directions of a cell | argument of [`Warp::new`] |
//! | M | cells along each axis | [`CELLS`] |
//!
//! References: Jensen, *Importance driven path tracing using the photon map* (1995), for the table over the square; Guo,
//! Bauszat, Bikker and Eisemann, *Primary Sample Space Path Guiding* (2018), for warped numbers; Hesterberg (1995) for
//! defensive mixtures.

use crate::math::direction::Frame;
use crate::math::distribution::Discrete;
use glam::Vec3;

/// M: cells along each axis.
pub const CELLS: usize = 16;

/// Numbers that choose an entry, by their partial sums: one line of the cache.
type Ends = [u32; CELLS];

/// A density of directions about a normal.
#[derive(Clone, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub struct Warp {
    /// φ.
    rows: Ends,
    /// sin² θ, for each row.
    columns: [Ends; CELLS],
}

impl Warp {
    /// A table of M × M weights, `weights[row · M + column]` with the column by sin² θ and the row by φ, mixed with the
    /// share `bsdf` of the cosine. Nothing where the table has nothing to say: no weights, or all of the share is the BSDF's.
    ///
    /// # Panics
    /// If there are not M² weights, or one is negative.
    pub fn new(weights: &[f64], bsdf: f64) -> Option<Self> {
        assert!(weights.len() == CELLS * CELLS, "{} weights", weights.len());
        let total: f64 = weights.iter().sum();
        if bsdf >= 1.0 || !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let uniform = bsdf / (CELLS * CELLS) as f64;
        let mixed: Vec<f64> = weights.iter().map(|w| uniform + (1.0 - bsdf) * w / total).collect();
        let rows: Vec<f64> = mixed.chunks(CELLS).map(|row| row.iter().sum()).collect();
        let mut columns = [[0; CELLS]; CELLS];
        // a row of zeros is never chosen
        columns.iter_mut().zip(mixed.chunks(CELLS)).for_each(|(to, row)| *to = ends(row).unwrap_or([0; CELLS]));
        Some(Self { rows: ends(&rows)?, columns })
    }

    /// Warped numbers for the cosine map, and r of the direction they choose.
    #[inline(always)]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, y, p) = choose(&self.rows, u[1]);
        let (_, x, q) = choose(&self.columns[row], u[0]);
        ([x, y], p * q)
    }

    /// r of a direction about a normal: the density over that of the cosine; up to rounding at the edges of cells it is the
    /// number that [`Self::sample`] returns with that direction.
    #[inline(always)]
    pub fn ratio(&self, n: Vec3, direction: Vec3) -> f32 {
        let local = Frame::new(n).local(direction);
        let sin2 = local.x * local.x + local.y * local.y;
        let column = ((sin2 * CELLS as f32) as usize).min(CELLS - 1);
        let row = sector(local.x, local.y);
        share(&self.rows, row) * share(&self.columns[row], column)
    }
}

/// The partial sums of the numbers that choose each entry, exactly those of [`Discrete`].
fn ends(weights: &[f64]) -> Option<Ends> {
    let choice = Discrete::new(weights)?;
    let mut sum = 0;
    Some(std::array::from_fn(|i| {
        // a multiple of 1/N, exact in f32
        sum += (choice.probability(i) * Discrete::NUMBERS as f32) as u32;
        sum
    }))
}

#[inline(always)]
fn start(ends: &Ends, i: usize) -> u32 {
    if i == 0 { 0 } else { ends[i - 1] }
}

/// M times the probability of an entry.
#[inline(always)]
fn share(ends: &Ends, i: usize) -> f32 {
    (ends[i] - start(ends, i)) as f32 * (CELLS as f32 / Discrete::NUMBERS as f32)
}

/// The entry that u chooses, the place in it as a number in [0, 1) of the whole row, and its share.
#[inline(always)]
fn choose(ends: &Ends, u: f32) -> (usize, f32, f32) {
    let j = (u * Discrete::NUMBERS as f32) as u32;
    // all at once instead of a search: u < 1, so that the last never counts
    let i = ends.iter().map(|&end| usize::from(end <= j)).sum::<usize>().min(CELLS - 1);
    let first = start(ends, i);
    // what is left of u, at the centre of its part
    let rest = (f64::from(j - first) + 0.5) / f64::from(ends[i] - first);
    // rounding must not reach the next cell, nor 1, which is no number of the cosine map
    let place = ((i as f64 + rest) as f32).min(((i + 1) as f32).next_down());
    (i, place / CELLS as f32, share(ends, i))
}

/// (cos, sin) of the angles at which one row of cells ends and the next begins, in the first quadrant.
const EDGES: [[f32; 2]; CELLS / 4 - 1] = {
    // cos π/8, sin π/8 and √½
    let (c, s, h) = (0.923_879_5, 0.382_683_43, std::f32::consts::FRAC_1_SQRT_2);
    [[c, s], [h, h], [s, c]]
};

/// ⌊M φ/2π⌋ of the direction (x, y), by comparison with the edges themselves: no arcus tangent, the same on every machine.
#[inline(always)]
fn sector(x: f32, y: f32) -> usize {
    // turned into the first quadrant: x > 0, y ≥ 0, or the origin
    let (quarter, x, y) = match (x, y) {
        (x, y) if x > 0.0 && y >= 0.0 => (0, x, y),
        (x, y) if x <= 0.0 && y > 0.0 => (1, y, -x),
        (x, y) if x < 0.0 && y <= 0.0 => (2, -x, -y),
        (x, y) if y < 0.0 => (3, -y, x),
        _ => return 0,
    };
    quarter * (CELLS / 4) + EDGES.iter().map(|[c, s]| usize::from(y * c >= x * s)).sum::<usize>()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::direction::{cos_sin_turn, cosine_hemisphere};

    const ALL: usize = CELLS * CELLS;

    fn example(bsdf: f64) -> Warp {
        let weights: Vec<f64> = (0..ALL).map(|i| if i % 3 == 0 { 0.0 } else { ((i * 7919) % 101) as f64 }).collect();
        Warp::new(&weights, bsdf).unwrap()
    }

    fn ratios(w: &Warp) -> Vec<f32> {
        (0..ALL).map(|i| share(&w.rows, i / CELLS) * share(&w.columns[i / CELLS], i % CELLS)).collect()
    }

    /// Σ_c P(c) = 1, and no ratio is below the BSDF's share.
    #[test]
    fn the_density_adds_up_to_one_and_is_never_below_the_share_of_the_bsdf() {
        for bsdf in [0.0, 0.1, 0.5, 0.9] {
            let ratios = ratios(&example(bsdf));
            let sum: f64 = ratios.iter().map(|&r| f64::from(r)).sum::<f64>() / ALL as f64;
            assert!((sum - 1.0).abs() < 1e-6, "{bsdf}: {sum}");
            let least = ratios.iter().copied().fold(f32::INFINITY, f32::min);
            // probabilities are multiples of 2⁻²⁴
            assert!(f64::from(least) >= bsdf * 0.999, "{bsdf}: {least}");
        }
    }

    /// The direction of every sample lies in the cell that it was drawn from, whichever way the normal points.
    #[test]
    fn sampled_directions_have_the_ratio_they_claim() {
        let (w, all) = (example(0.3), 1u32 << 18);
        let mut wrong = 0;
        for i in 0..all {
            // multiples of 2⁻²⁴, as the numbers of a walk; a product of floats would lie on edges too often
            let u =
                [0x9e37_79b1u32, 0x85eb_ca77].map(|m| (m.wrapping_mul(i + 1) >> 8) as f32 / Discrete::NUMBERS as f32);
            let n = Vec3::new((i % 7) as f32 - 3.0, (i % 5) as f32 - 2.0, (i % 3) as f32 - 1.5).normalize();
            let (u, ratio) = w.sample(u);
            assert!(u.iter().all(|x| (0.0..1.0).contains(x)));
            wrong += u32::from(w.ratio(n, cosine_hemisphere(n, u).0) != ratio);
        }
        // rounding moves a direction by 4·10⁻⁷ or less over one of 16 edges of each kind
        assert!(wrong <= all / 20_000, "{wrong} of {all}");
    }

    /// Each number chooses the entry that [`Discrete`] chooses, and stays below 1.
    #[test]
    fn numbers_choose_as_they_do_elsewhere() {
        let weights: Vec<f64> = (0..CELLS).map(|i| if i % 5 == 2 { 0.0 } else { (1 + i * i) as f64 }).collect();
        let (choice, ends) = (Discrete::new(&weights).unwrap(), ends(&weights).unwrap());
        for j in (0..Discrete::NUMBERS).step_by(97).chain([Discrete::NUMBERS - 1]) {
            let u = j as f32 / Discrete::NUMBERS as f32;
            let ((i, place, p), (expected, rest)) = (choose(&ends, u), choice.sample(u));
            assert_eq!((i, p), (expected, CELLS as f32 * choice.probability(expected)), "{j}");
            assert!((place * CELLS as f32 - i as f32 - rest).abs() < 2e-6 && place < 1.0, "{j}");
        }
    }

    #[test]
    fn sectors_are_those_of_the_angle() {
        for i in 0..4096 {
            let x = (i as f32 + 0.5) / 4096.0;
            let (c, s) = cos_sin_turn(x);
            assert_eq!(sector(0.3 * c, 0.3 * s), (x * CELLS as f32) as usize, "{x}");
        }
        assert_eq!(
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 0.0)].map(|(x, y)| sector(x, y)),
            [0, 4, 8, 12, 0]
        );
    }

    #[test]
    fn nothing_to_say_is_no_table() {
        assert_eq!(Warp::new(&[0.0; ALL], 0.5), None);
        assert_eq!(Warp::new(&[1.0; ALL], 1.0), None);
    }
}
