//! Directions about a normal with a tabulated density: a table warps two uniform numbers, then the cosine map turns them
//! into a direction.
//!
//! ```text
//! u ∈ [0, 1)²  —table→  u' ∈ cell c  —Malley→  ω        p(ω) = cos θ/π · r(ω)        r(ω) = M² P(c(ω))
//! ```
//!
//! The table is a density on the unit square, constant in each of its M × M cells. The cosine map carries the square to the
//! hemisphere, where the density 1 of the square becomes cos θ/π. Every direction lies in exactly one cell, so p is known
//! exactly, whatever lies in this direction, and `∫ p dω = Σ_c P(c) = 1`. The table contains the BSDF part of the mixture
//! too. For a Lambertian surface the density of this part is r = 1, and
//!
//! ```text
//! P(c) ∝ β/M² + (1 − β) W_c / Σ W
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | u' | warped numbers (sin² θ, φ/2π) | [`Warp::sample`] |
//! | r | density divided by that of the cosine | [`Warp::ratio`] |
//! | P(c), β | probability of cell c; share of the BSDF | `bsdf` of [`Warp::new`] |
//! | W_c | light expected from the directions of cell c | `weights` of [`Warp::new`] |
//! | M | cells along each axis | [`CELLS`] |
//!
//! References: Jensen, *Importance driven path tracing using the photon map* (1995), for the table over the square; Guo,
//! Bauszat, Bikker and Eisemann, *Primary Sample Space Path Guiding* (2018), for warped numbers; Hesterberg (1995) for
//! defensive mixtures.

use crate::math::direction::Frame;
use glam::Vec3;

/// M: number of cells along each axis.
pub const CELLS: usize = 16;

/// Number of different values that choose among the entries of a row: 2¹⁵, so that a row takes half a cache line.
const NUMBERS: u32 = 1 << 15;

/// Partial sums of the numbers of values that choose each entry.
type Ends = [u16; CELLS];

/// A tabulated density of directions about a normal.
#[derive(Clone, Debug, PartialEq, Eq)]
#[repr(C, align(32))]
pub struct Warp {
    /// Distribution over the rows, which divide φ.
    rows: Ends,
    /// For each row the distribution over its columns, which divide sin² θ.
    columns: [Ends; CELLS],
}

impl Warp {
    /// Builds the table from M × M weights, mixed with the share `bsdf` of the plain cosine. The weights are ordered as
    /// `weights[row · M + column]`, with the column by sin² θ and the row by φ. Returns `None` if the table would be plain
    /// cosine sampling: the weights add up to zero, or `bsdf` is 1.
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

    /// The warped numbers for the cosine map, and the ratio r of the direction that they give.
    #[inline(always)]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let (row, y, p) = self.row(u[1]);
        let (x, q) = self.column(row, u[0]);
        ([x, y], p * q)
    }

    /// The row that `u` chooses, the warped number, and M times the probability of the row.
    #[inline(always)]
    pub(super) fn row(&self, u: f32) -> (usize, f32, f32) {
        choose(&self.rows, u)
    }

    /// The number `u` warped along a row, and M times the probability of the chosen column in this row.
    #[inline(always)]
    pub(super) fn column(&self, row: usize, u: f32) -> (f32, f32) {
        let (_, x, q) = choose(&self.columns[row], u);
        (x, q)
    }

    /// r of a direction about the normal `n`: its density divided by that of the cosine. For a direction from
    /// [`Self::sample`] this is the returned ratio, except for rounding at the edges of cells.
    #[inline(always)]
    pub fn ratio(&self, n: Vec3, direction: Vec3) -> f32 {
        let local = Frame::new(n).local(direction);
        let sin2 = local.x * local.x + local.y * local.y;
        let column = ((sin2 * CELLS as f32) as usize).min(CELLS - 1);
        let row = sector(local.x, local.y);
        share(&self.rows, row) * share(&self.columns[row], column)
    }
}

/// Partial sums of the numbers of values that choose each entry. The numbers are in proportion to the weights, and at least
/// one if the weight is positive. The heaviest entry takes the rest that rounding leaves.
fn ends(weights: &[f64]) -> Option<Ends> {
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let count = |w: &f64| if *w > 0.0 { ((w / total * f64::from(NUMBERS)) as u32).max(1) } else { 0 };
    let mut counts: Vec<u32> = weights.iter().map(count).collect();
    let heaviest = (0..CELLS).max_by(|&a, &b| weights[a].total_cmp(&weights[b]))?;
    counts[heaviest] = NUMBERS + counts[heaviest] - counts.iter().sum::<u32>();
    let mut sum = 0;
    Some(std::array::from_fn(|i| {
        sum += counts[i];
        sum as u16
    }))
}

#[inline(always)]
fn start(ends: &Ends, i: usize) -> u16 {
    if i == 0 { 0 } else { ends[i - 1] }
}

/// M times the probability of an entry.
#[inline(always)]
fn share(ends: &Ends, i: usize) -> f32 {
    f32::from(ends[i] - start(ends, i)) * (CELLS as f32 / NUMBERS as f32)
}

/// The entry that u chooses, the warped number in [0, 1), and M times the probability of the entry.
#[inline(always)]
fn choose(ends: &Ends, u: f32) -> (usize, f32, f32) {
    // a multiple of 2⁻²⁴ times a power of two: exact
    let x = u * NUMBERS as f32;
    let j = x as u16;
    // compare with all entries instead of a search; u < 1, so the last comparison is never true
    let i = usize::from(ends.iter().map(|&end| u16::from(end <= j)).sum::<u16>()).min(CELLS - 1);
    let first = start(ends, i);
    let width = f32::from(ends[i] - first);
    // the rest of u, at the centre of its part of the entry
    let rest = (x - f32::from(first) + HALF_A_STEP) / width;
    // rounding must reach neither the next cell nor 1, which the cosine map does not accept
    let place = (i as f32 + rest).min(BELOW[i]);
    (i, place * (1.0 / CELLS as f32), width * (CELLS as f32 / NUMBERS as f32))
}

/// Half of the distance between two neighbouring values of u, in units of 1/NUMBERS.
const HALF_A_STEP: f32 = NUMBERS as f32 / (1u32 << 25) as f32;

/// The largest position inside each entry, just below its end.
const BELOW: [f32; CELLS] = {
    let mut below = [0.0; CELLS];
    let mut i = 0;
    while i < CELLS {
        below[i] = ((i + 1) as f32).next_down();
        i += 1;
    }
    below
};

/// (cos, sin) of the angles in the first quadrant at which one row of cells ends and the next begins.
const EDGES: [[f32; 2]; CELLS / 4 - 1] = {
    // cos π/8, sin π/8 and √½
    let (c, s, h) = (0.923_879_5, 0.382_683_43, std::f32::consts::FRAC_1_SQRT_2);
    [[c, s], [h, h], [s, c]]
};

/// ⌊M φ/2π⌋ of the direction (x, y), by comparison with the edges themselves. Without an arc tangent the result is the same
/// on every machine.
#[inline(always)]
fn sector(x: f32, y: f32) -> usize {
    // rotated into the first quadrant: x > 0, y ≥ 0; the origin belongs to sector 0
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

    /// The number of different random numbers u.
    const ALL_NUMBERS: u32 = 1 << 24;

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
            // probabilities are products of multiples of 2⁻¹⁵
            assert!(f64::from(least) >= bsdf * 0.97, "{bsdf}: {least}");
        }
    }

    /// The direction of every sample lies in the cell from which it was sampled, for normals of every orientation.
    #[test]
    fn sampled_directions_have_the_ratio_they_claim() {
        let (w, all) = (example(0.3), 1u32 << 18);
        let mut wrong = 0;
        for i in 0..all {
            // multiples of 2⁻²⁴, like the random numbers of a walk; products of floats would lie on edges too often
            let u = [0x9e37_79b1u32, 0x85eb_ca77].map(|m| (m.wrapping_mul(i + 1) >> 8) as f32 / ALL_NUMBERS as f32);
            let n = Vec3::new((i % 7) as f32 - 3.0, (i % 5) as f32 - 2.0, (i % 3) as f32 - 1.5).normalize();
            let (u, ratio) = w.sample(u);
            assert!(u.iter().all(|x| (0.0..1.0).contains(x)));
            wrong += u32::from(w.ratio(n, cosine_hemisphere(n, u).0) != ratio);
        }
        // rounding moves a direction by at most 4·10⁻⁷, possibly across one of 16 edges in each coordinate
        assert!(wrong <= all / 20_000, "{wrong} of {all}");
    }

    /// Over all numbers u each entry is chosen as often as its share says. The warped number stays inside the entry, and a
    /// search finds the same entry.
    #[test]
    fn numbers_choose_in_proportion_to_the_weights() {
        let weights: Vec<f64> = (0..CELLS).map(|i| if i % 5 == 2 { 0.0 } else { 1e-7 + (i * i) as f64 }).collect();
        let (ends, total) = (ends(&weights).unwrap(), weights.iter().sum::<f64>());
        let mut counts = [0u32; CELLS];
        let mut last = 0.0;
        for j in 0..ALL_NUMBERS {
            let u = j as f32 / ALL_NUMBERS as f32;
            let (i, place, p) = choose(&ends, u);
            assert_eq!(i, ends.partition_point(|&end| f32::from(end) <= u * NUMBERS as f32));
            assert!(place >= last && (place * CELLS as f32) as usize == i && place < 1.0, "{j}: {place}");
            assert_eq!(p, share(&ends, i));
            counts[i] += 1;
            last = place;
        }
        for (i, (&n, w)) in counts.iter().zip(&weights).enumerate() {
            assert_eq!(n, (share(&ends, i) * (ALL_NUMBERS / CELLS as u32) as f32) as u32);
            // rounded down, at least one, and the heaviest entry takes the rest
            let (n, expected) = (f64::from(n) / f64::from(ALL_NUMBERS / NUMBERS), w / total * f64::from(NUMBERS));
            assert!((n - expected).abs() <= if i == CELLS - 1 { CELLS as f64 } else { 1.0 }, "{i}: {n} {expected}");
            assert_eq!(n > 0.0, *w > 0.0);
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
