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
//!
//! References: Jensen, *Importance driven path tracing using the photon map* (1995), for the table over the square; Guo,
//! Bauszat, Bikker and Eisemann, *Primary Sample Space Path Guiding* (2018), for warped numbers; Hesterberg (1995) for
//! defensive mixtures.

use crate::math::direction::{Frame, cos_sin_turn};
use crate::math::distribution::Table;
use glam::Vec3;

/// A density of directions about a normal.
#[derive(Clone, Debug)]
pub struct Warp {
    table: Table,
    /// M² P(c), by column (sin² θ) and row (φ).
    ratio: Vec<f32>,
    edges: Edges,
}

/// The directions in which one row of cells ends and the next begins, in the first quadrant.
#[derive(Clone, Copy, Debug)]
struct Edges([[f32; 2]; MOST / 4]);

/// Largest M.
const MOST: usize = 64;

impl Warp {
    /// A table of M × M weights, `weights[row · M + column]` with the column by sin² θ and the row by φ, mixed with the
    /// share `bsdf` of the cosine. Nothing where the table has nothing to say: no weights, or all of the share is the BSDF's.
    ///
    /// # Panics
    /// If M is not one of 4, 8, … 64, or there are not M² weights.
    pub fn new(m: usize, weights: &[f64], bsdf: f64) -> Option<Self> {
        assert!(m.is_multiple_of(4) && m <= MOST && weights.len() == m * m, "{m} × {m}: {}", weights.len());
        let total: f64 = weights.iter().sum();
        if bsdf >= 1.0 || !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let uniform = bsdf / (m * m) as f64;
        let weight =
            |column: u32, row: u32| uniform + (1.0 - bsdf) * weights[row as usize * m + column as usize] / total;
        let table = Table::new([m as u32; 2], weight)?;
        let cells = (0..m as u32).flat_map(|row| (0..m as u32).map(move |column| [column, row]));
        let ratio = cells.map(|cell| (m * m) as f32 * table.probability(cell)).collect();
        Some(Self { table, ratio, edges: Edges::new(m) })
    }

    /// M: cells along each axis.
    fn cells(&self) -> usize {
        self.ratio.len().isqrt()
    }

    /// Warped numbers for the cosine map, and r of the direction they choose.
    #[inline(always)]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let m = self.cells();
        let ([column, row], rest) = self.table.sample(u);
        // the sum may round up to the next cell, and 1 is no number of the cosine map
        let place = |cell: u32, rest: f32| (cell as f32 + rest).min(((cell + 1) as f32).next_down()) / m as f32;
        ([place(column, rest[0]), place(row, rest[1])], self.ratio[row as usize * m + column as usize])
    }

    /// r of a direction about a normal: the density over that of the cosine; up to rounding at the edges of cells it is the
    /// number that [`Self::sample`] returns with that direction.
    #[inline(always)]
    pub fn ratio(&self, n: Vec3, direction: Vec3) -> f32 {
        let m = self.cells();
        let local = Frame::new(n).local(direction);
        let sin2 = (local.x * local.x + local.y * local.y).min(1.0);
        let column = ((sin2 * m as f32) as usize).min(m - 1);
        self.ratio[self.edges.row(m, local.x, local.y) * m + column]
    }
}

impl Edges {
    fn new(m: usize) -> Self {
        Self(std::array::from_fn(|i| {
            let (c, s) = cos_sin_turn(if i < m / 4 { i as f32 / m as f32 } else { 0.0 });
            [c, s]
        }))
    }

    /// ⌊M φ/2π⌋ of the direction (x, y), by comparison with the edges themselves: no arcus tangent, the same on every machine.
    #[inline(always)]
    fn row(&self, m: usize, x: f32, y: f32) -> usize {
        // turned into the first quadrant, x > 0, y ≥ 0
        let (quarter, x, y) = match (x > 0.0, y >= 0.0) {
            _ if x == 0.0 && y == 0.0 => (0, 1.0, 0.0),
            (true, true) => (0, x, y),
            (false, true) if y > 0.0 => (1, y, -x),
            (false, _) if x < 0.0 => (2, -x, -y),
            _ => (3, -y, x),
        };
        let inside = self.0[1..m / 4].iter().filter(|[c, s]| y * c >= x * s).count();
        quarter * (m / 4) + inside
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::direction::cosine_hemisphere;

    fn example(m: usize, bsdf: f64) -> Warp {
        let weights: Vec<f64> = (0..m * m).map(|i| if i % 3 == 0 { 0.0 } else { ((i * 7919) % 101) as f64 }).collect();
        Warp::new(m, &weights, bsdf).unwrap()
    }

    /// Σ_c P(c) = 1, and no ratio is below the BSDF's share.
    #[test]
    fn the_density_adds_up_to_one_and_is_never_below_the_share_of_the_bsdf() {
        for m in [4, 8, 16, 32, 64] {
            for bsdf in [0.0, 0.1, 0.5, 0.9] {
                let w = example(m, bsdf);
                let sum: f64 = w.ratio.iter().map(|&r| f64::from(r)).sum::<f64>() / (m * m) as f64;
                assert!((sum - 1.0).abs() < 1e-6, "{m}, {bsdf}: {sum}");
                let least = w.ratio.iter().copied().fold(f32::INFINITY, f32::min);
                // the probabilities are multiples of 2⁻²⁴, row by row
                assert!(f64::from(least) > bsdf * 0.99 - 1e-6, "{m}, {bsdf}: {least}");
            }
        }
    }

    /// The direction of every sample lies in the cell that it was drawn from, whichever way the normal points.
    #[test]
    fn sampled_directions_have_the_ratio_they_claim() {
        for m in [4, 16, 64] {
            let w = example(m, 0.3);
            let (mut wrong, mut all) = (0, 0);
            for i in 0..1 << 16 {
                let u = [(i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract()];
                let n = Vec3::new((i % 7) as f32 - 3.0, (i % 5) as f32 - 2.0, (i % 3) as f32 - 1.5).normalize();
                let (u, ratio) = w.sample(u);
                assert!(u.iter().all(|x| (0.0..1.0).contains(x)));
                let (d, _) = cosine_hemisphere(n, u);
                all += 1;
                wrong += usize::from(w.ratio(n, d) != ratio);
            }
            // rounding moves a direction by 10⁻⁷ or so over the edge of one of 2 m edges
            assert!(wrong <= 2 + all * m / 100_000, "{m}: {wrong} of {all}");
        }
    }

    #[test]
    fn the_last_number_stays_below_one() {
        let mut weights = vec![0.0; 256];
        weights[255] = 1.0;
        let w = Warp::new(16, &weights, 0.0).unwrap();
        let last = 1.0 - 0.5 * f32::EPSILON;
        let (u, ratio) = w.sample([last, last]);
        assert!(u.iter().all(|&x| (0.9375..1.0).contains(&x)) && ratio == 256.0, "{u:?} {ratio}");
    }

    #[test]
    fn nothing_to_say_is_no_table() {
        assert!(Warp::new(4, &[0.0; 16], 0.5).is_none());
        assert!(Warp::new(4, &[1.0; 16], 1.0).is_none());
    }
}
